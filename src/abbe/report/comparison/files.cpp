#include "abbe/report/comparison/files.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "abbe/image/channels.h"
#include "abbe/image/exr/exr.h"
#include "abbe/image/metrics/heat_map.h"
#include "abbe/image/raster/raster.h"
#include "abbe/report/pack.h"
#include "abbe/report/probe_text.h"
#include "abbe/session/picture.h"
#include "abbe/session/probe.h"

namespace abbe {
namespace {

// Ray trees kept in the page, along the longer side.
constexpr int kTrees = 16;
constexpr std::size_t kMaxTreeLines = 80;

}  // namespace

std::map<std::string, double> earlier_seconds(const std::filesystem::path& stats_file) {
  std::ifstream stream(stats_file);
  const auto stats = nlohmann::json::parse(stream, nullptr, false);
  std::map<std::string, double> seconds;
  if (!stats.is_object()) return seconds;
  const auto found = stats.find("renders");
  if (found == stats.end() || !found->is_object() || !found->contains("seconds")) return seconds;
  for (const auto& [file, value] : (*found)["seconds"].items()) {
    if (value.is_number()) seconds[file] = value.get<double>();
  }
  return seconds;
}

// A picture of each mode as PNG, and what the page shows of it.
std::map<std::string, std::string> write_pictures(DisplayOptions display,
                                                  const RasterOptions& raster,
                                                  const std::filesystem::path& folder,
                                                  const CompareResult& result) {
  std::map<std::string, std::string> pictures;
  display.auto_exposure = false;
  display.exposure_ev = result.exposure_ev;
  std::size_t bytes = 0;
  for (const auto& [mode, shot] : result.modes) {
    write_raster(folder / (mode + ".png"), to_display(shot.image, display), raster);
    pictures[mode] = data_uri(folder / (mode + ".png"), "image/png");
    bytes += pictures[mode].size();
  }
  // Noise does not compress: what would not leave room for the rest is shown as JPEG.
  if (bytes <= kMaxPageBytes / 2) return pictures;
  for (const auto& [mode, shot] : result.modes) {
    const std::filesystem::path file = folder / (mode + ".jpg");
    write_raster(file, to_display(shot.image, display));
    pictures[mode] = data_uri(file, "image/jpeg");
    std::filesystem::remove(file);
  }
  return pictures;
}

void write_maps(const std::filesystem::path& folder, const CompareResult& result) {
  const Image& spectral = result.modes.at("spectral").image;
  Image maps = same_window(spectral, {});
  std::vector<const std::vector<float>*> layers;
  const auto add = [&](const std::string& name, const std::vector<float>& map) {
    maps.channels.push_back(name);
    layers.push_back(&map);
    constexpr double kFullScale = 10.0;
    write_raster(folder / ("map-" + name + ".png"),
                 heat_map(map, maps.width, maps.height, kFullScale));
  };
  for (const auto& [mode, difference] : result.differences) {
    add(mode, difference.maps.delta_e2000);
  }
  for (std::size_t i = 0; i < result.causes.acting.size(); ++i) {
    add(cause_name(result.causes.acting[i]), result.causes.attribution.shares[i]);
  }
  add("interaction", result.causes.attribution.interaction);
  const std::size_t pixels = static_cast<std::size_t>(maps.width) * maps.height;
  maps.pixels.reserve(pixels * layers.size());
  for (std::size_t p = 0; p < pixels; ++p) {
    for (const auto* layer : layers) maps.pixels.push_back((*layer)[p]);
  }
  write_exr(folder / "delta_e2000.exr", maps, {});
}

std::vector<KeptTree> kept_trees(const PreparedScene& prepared, const Standards& standards,
                                 const RenderSettings& settings) {
  RenderSettings plain = settings;
  plain.bands.reset();
  Notes notes;
  const LitWorld world = make_lit_world(prepared, plain, standards, notes);
  const PixelRect window =
      settings.crop.value_or(PixelRect{0, 0, settings.size.x, settings.size.y});
  const int longer = std::max(window.width(), window.height());
  const int columns = std::max(1, std::min(window.width(), kTrees * window.width() / longer));
  const int rows = std::max(1, std::min(window.height(), kTrees * window.height() / longer));
  std::vector<KeptTree> trees;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Vec2i pixel(window.x0 + (2 * column + 1) * window.width() / (2 * columns),
                        window.y0 + (2 * row + 1) * window.height() / (2 * rows));
      const Probed probed =
          probe_pixel(world, prepared.chosen_camera(), plain, pixel, std::nullopt);
      const auto nodes = probe_tree(probed.records, prepared.scene, world, probed.sample);
      std::string text = tree_text(nodes, {.least_weight = 0.01});
      std::size_t end = 0, lines = 0;
      while (lines < kMaxTreeLines && end != std::string::npos) {
        end = text.find('\n', end == 0 ? 0 : end + 1);
        ++lines;
      }
      if (end != std::string::npos && end + 1 < text.size()) {
        text.resize(end + 1);
        text += "… and more: abbe probe shows all\n";
      }
      trees.push_back({pixel - Vec2i(window.x0, window.y0), std::move(text)});
    }
  }
  return trees;
}

}  // namespace abbe
