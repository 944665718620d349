#include "abbe/report/comparison/page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/color/spectrum_colors.h"
#include "abbe/image/channels.h"
#include "abbe/image/exr/exr.h"
#include "abbe/image/metrics/heat_map.h"
#include "abbe/report/json.h"
#include "abbe/report/pack.h"
#include "abbe/report/page.h"

namespace abbe {
namespace {

using Json = nlohmann::ordered_json;

Json statistics_json(const MapStatistics& statistics) {
  return {{"mean", statistics.mean}, {"p95", statistics.percentile_95}, {"max", statistics.max}};
}

Json statistics_json(const std::vector<float>& map) {
  return statistics_json(map_statistics(map));
}

struct CauseText {
  Cause cause;
  const char* color;  // Okabe and Ito's palette, which keeps apart without colour vision.
  const char* text;
};
constexpr std::array<CauseText, kCauseCount> kCauseTexts{
    {{Cause::IndexDispersion, "#0072b2", "the index of refraction per wavelength, against n_d"},
     {Cause::Fresnel, "#e69f00",
      "metals by n and k and films per wavelength, against F0 and Schlick's rule"},
     {Cause::Absorption, "#009e73",
      "Beer and Lambert's law per wavelength, against three channels"},
     {Cause::Lamps, "#cc79a7", "spectra of lamps, against their Rec.709"},
     {Cause::Reflectances, "#d55e00",
      "reflectances as spectra and their products, against products of Rec.709"}}};

std::string method_text(const Causes& causes) {
  if (causes.acting.empty()) return "Nothing in this scene can make the two modes differ.";
  const std::size_t count = causes.acting.size();
  std::string text = "ΔE2000 of rgb → spectral, shared out among what differs between them: ";
  if (causes.method == AttributionMethod::Shapley || count <= 3) {
    return text + fmt::format(
                      "Shapley values over the {} cause{} that can act in this scene, from "
                      "images with each set of them switched on. They add up to the whole.",
                      count, count == 1 ? "" : "s");
  }
  return text + fmt::format(
                    "the mean of the first and the last effect of each of the {} causes "
                    "that can act in this scene. What they leave over is their interaction; "
                    "Shapley values would share it out, too.",
                    count);
}

bool has_interaction(const Causes& causes) {
  return causes.method == AttributionMethod::FirstAndLast && causes.acting.size() > 3;
}

double share_of(const std::vector<float>& map, double mean_whole) {
  return mean_whole > 0.0 ? map_statistics(map).mean / mean_whole : 0.0;
}

Json cause_json(const Causes& causes, Cause cause) {
  const auto index = causes.index_of(cause);
  if (!index) {
    return {{"acts", false}, {"share", 0.0}, {"delta_e2000", statistics_json(MapStatistics{})}};
  }
  const std::vector<float>& map = causes.attribution.shares[*index];
  const auto dominated =
      std::count(causes.dominant.begin(), causes.dominant.end(), static_cast<int>(*index));
  return {{"acts", true},
          {"share", share_of(map, causes.mean_whole())},
          {"delta_e2000", statistics_json(map)},
          {"dominant_pixels",
           static_cast<double>(dominated) / static_cast<double>(causes.dominant.size())}};
}

// Bins of ΔE2000; the last one is open.
std::vector<double> histogram_edges() {
  return {0.0, 0.1, 0.2, 0.5, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0, 50.0};
}

// Shares of pixels.
std::vector<double> histogram(const std::vector<float>& delta_e2000) {
  const std::vector<double> edges = histogram_edges();
  std::vector<double> shares(edges.size(), 0.0);
  for (const float value : delta_e2000) {
    const auto above = std::upper_bound(edges.begin(), edges.end(), static_cast<double>(value));
    const auto bin = std::max<std::ptrdiff_t>(above - edges.begin() - 1, 0);
    shares[static_cast<std::size_t>(bin)] += 1.0 / static_cast<double>(delta_e2000.size());
  }
  return shares;
}

std::string white_text(double exposure_ev) {
  return fmt::format("D65, xy 0.3127, 0.3290, at 1, 1, 1 of linear Rec.709 brightened by {:.4g} EV",
                     exposure_ev);
}

std::string summary_text(const CompareResult& result) {
  const double mean = result.causes.mean_whole();
  const auto counted = [](int count, const char* what) {
    return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
  };
  std::string text =
      fmt::format("{}x{} pixels of {}, {}. ", result.settings.size.x, result.settings.size.y,
                  counted(result.settings.samples_per_pixel, "sample"),
                  counted(result.settings.wavelengths.count, "wavelength"));
  text += fmt::format("rgb is off by ΔE2000 {:.2f} in the mean, {:.1f} at most; ", mean,
                      map_statistics(result.causes.whole).max);
  Cause first = Cause::Reflectances;
  double largest = 0.0;
  for (const Cause cause : result.causes.acting) {
    const double share =
        share_of(result.causes.attribution.shares[*result.causes.index_of(cause)], mean);
    if (share > largest) {
      largest = share;
      first = cause;
    }
  }
  if (largest > 0.0) {
    text += fmt::format("{} is {:.0f} % of that. ", cause_name(first), 100.0 * largest);
  }
  return text + "White: " + white_text(result.exposure_ev) + ".";
}

struct NamedMap {
  std::string id, label, unit;
  std::vector<float> values;
  double scale = 1.0;  // Of the brightest colour; 0: by the map.
};

std::vector<NamedMap> maps_of(const CompareResult& result) {
  std::vector<NamedMap> maps;
  for (const auto& [mode, difference] : result.differences) {
    maps.push_back(
        {"delta_e2000-" + mode, mode + ": ΔE2000", "ΔE2000", difference.maps.delta_e2000, 0.0});
    maps.push_back(
        {"delta_e_itp-" + mode, mode + ": ΔE ITP", "ΔE ITP", difference.maps.delta_e_itp, 0.0});
    maps.push_back({"flip-" + mode, mode + ": FLIP", "FLIP", difference.maps.flip, 1.0});
  }
  for (std::size_t i = 0; i < result.causes.acting.size(); ++i) {
    const std::string name = cause_name(result.causes.acting[i]);
    maps.push_back({name, "cause: " + name, "ΔE2000", result.causes.attribution.shares[i], 0.0});
  }
  if (has_interaction(result.causes)) {
    maps.push_back({"interaction", "cause: interaction", "ΔE2000",
                    result.causes.attribution.interaction, 0.0});
  }
  return maps;
}

// The brightest colour stands for half of the largest value, so that a few pixels do not leave the
// rest in the dark, but for no more than twenty just noticeable differences.
double scale_of(const NamedMap& map) {
  if (map.scale > 0.0) return map.scale;
  return std::clamp(0.5 * map_statistics(map.values).max, 0.5, 20.0);
}

Json packed_json(const NamedMap& map, int width, int height, int block) {
  const PackedMap packed = packed_map(map.values, width, height, block);
  return {{"id", map.id},           {"label", map.label},         {"unit", map.unit},
          {"scale", scale_of(map)}, {"width", packed.width},      {"height", packed.height},
          {"max", packed.max},      {"signed", packed.is_signed}, {"data", packed.data}};
}

// Numbers of causes have no mean: the pixel in the corner of its block stands for it.
Json dominant_json(const CompareResult& result, int width, int height, int block) {
  std::vector<float> picked;
  for (int y = 0; y < height; y += block) {
    for (int x = 0; x < width; x += block) {
      const int player = result.causes.dominant[static_cast<std::size_t>(y) * width + x];
      picked.push_back(
          player < 0 ? -1.0f
                     : static_cast<float>(result.causes.acting[static_cast<std::size_t>(player)]));
    }
  }
  const NamedMap map{"dominant", "dominant cause", "", std::move(picked), 1.0};
  return packed_json(map, (width + block - 1) / block, (height + block - 1) / block, 1);
}

std::string css_color(const Vec3d& rgb_srgb_encoded) {
  const Vec3d codes = 255.0 * rgb_srgb_encoded;
  return fmt::format("rgb({:.0f} {:.0f} {:.0f})", codes.x, codes.y, codes.z);
}

struct Bands {
  std::vector<std::size_t> channels;
  std::vector<double> nm;
};

Bands bands_of(const Image& image) {
  Bands bands;
  for (std::size_t c = 0; c < image.channel_count(); ++c) {
    if (const auto nm = spectral_channel_wavelength_nm(image.channels[c])) {
      bands.channels.push_back(c);
      bands.nm.push_back(*nm);
    }
  }
  return bands;
}

Json probe_json(const CompareResult& result, const Bands& bands, int block) {
  const Image& spectral = result.modes.at("spectral").image;
  const int width = spectral.width, height = spectral.height;
  std::vector<float> colors(static_cast<std::size_t>(width) * height * 3 * result.modes.size());
  std::size_t mode = 0;
  for (const auto& [name, shot] : result.modes) {
    const Image rgb = exposed(shot.image, 0.0);
    for (std::size_t p = 0; p < rgb.pixels.size() / 3; ++p) {
      std::copy_n(rgb.pixels.data() + 3 * p, 3,
                  colors.data() + (p * result.modes.size() + mode) * 3);
    }
    ++mode;
  }
  const Blocks color_blocks = block_means(colors, width, height, 3 * result.modes.size(), block);
  const PackedNumbers packed = packed_numbers(color_blocks.values);
  const Blocks spectra = block_means(picked_values(spectral, bands.channels), width, height,
                                     bands.channels.size(), block);
  return {{"block", block},
          {"width", color_blocks.width},
          {"height", color_blocks.height},
          {"colors", {{"max", packed.max}, {"data", packed.data}}},
          {"spectra", packed_spectra(spectra, bands.channels.size())}};
}

Json provenance_json(const Image& image) {
  Json out = Json::object();
  for (const auto& [name, value] : image.attributes) {
    if (!name.starts_with("abbe:")) continue;
    std::visit(
        [&out, &name = name](const auto& v) {
          if constexpr (std::is_same_v<std::decay_t<decltype(v)>, std::string>) {
            out[name.substr(5)] = v;
          } else {
            out[name.substr(5)] = fmt::format("{}", v);
          }
        },
        value);
  }
  return out;
}

Json sweeps_json(const CompareResult& result) {
  Json sweeps = Json::array();
  for (const Sweep& sweep : result.sweeps) {
    Json runs = Json::array();
    for (const SweepRun& run : sweep.runs) {
      runs.push_back({{"value", run.value},
                      {"delta_e2000", statistics_json(run.delta_e2000)},
                      {"rmse", run.rmse},
                      {"seconds", run.seconds}});
    }
    sweeps.push_back({{"parameter", sweep.parameter}, {"finest", sweep.finest}, {"runs", runs}});
  }
  return sweeps;
}

Json stats_json(const CompareResult& result) {
  Json stats;
  stats["scene"] = result.scene;
  stats["size"] = {result.settings.size.x, result.settings.size.y};
  stats["white"] = white_text(result.exposure_ev);
  stats["exposure_ev"] = result.exposure_ev;
  for (const auto& [mode, shot] : result.modes) {
    stats["modes"][mode] = {{"seconds", shot.seconds}, {"reused", shot.is_reused}};
  }
  for (const auto& [mode, difference] : result.differences) {
    stats["difference"][mode] = {{"delta_e2000", statistics_json(difference.maps.delta_e2000)},
                                 {"delta_e_itp", statistics_json(difference.maps.delta_e_itp)},
                                 {"flip", statistics_json(difference.maps.flip)},
                                 {"rmse", difference.rmse}};
  }
  stats["method"] = has_interaction(result.causes) ? "first and last effects" : "Shapley values";
  for (const Cause cause : kCauses) {
    stats["causes"][cause_name(cause)] = cause_json(result.causes, cause);
  }
  const std::vector<float>& rest = result.causes.attribution.interaction;
  stats["interaction"] = {{"shown", has_interaction(result.causes)},
                          {"share", share_of(rest, result.causes.mean_whole())},
                          {"delta_e2000", statistics_json(rest)}};
  stats["histogram"]["edges"] = histogram_edges();
  for (const auto& [mode, difference] : result.differences) {
    stats["histogram"]["modes"][mode] = histogram(difference.maps.delta_e2000);
  }
  stats["sweeps"] = sweeps_json(result);
  stats["renders"] = {
      {"rendered", result.rendered}, {"reused", result.reused}, {"seconds", result.render_seconds}};
  return stats;
}

Json page_data(const CompareResult& result, const std::map<std::string, std::string>& pictures,
               const Observer& observer, int map_block, int probe_block) {
  const Image& spectral = result.modes.at("spectral").image;
  const int width = spectral.width, height = spectral.height;
  const Bands bands = bands_of(spectral);
  Json data = stats_json(result);
  data["summary"] = summary_text(result);
  data["full_size"] = data["size"];
  data["size"] = {width, height};
  data["origin"] = {spectral.data_origin.x, spectral.data_origin.y};
  data["images"] = pictures;
  data["least_delta_e"] = kLeastDeltaE;
  // The page wants them in order, with their looks.
  Json causes = Json::array();
  for (const CauseText& text : kCauseTexts) {
    Json cause = cause_json(result.causes, text.cause);
    cause["name"] = cause_name(text.cause);
    cause["color"] = text.color;
    cause["text"] = text.text;
    causes.push_back(std::move(cause));
  }
  data["causes"] = std::move(causes);
  data["attribution"] = {
      {"text", method_text(result.causes)},
      {"note",
       "Negative where a cause brings the two closer. Causes in grey cannot act: nothing in "
       "the scene has what they need. Few samples of few wavelengths err in colour by "
       "themselves; that error counts as lamps."}};
  data["maps"] = Json::array();
  if (!result.causes.acting.empty()) {
    data["maps"].push_back(dominant_json(result, width, height, map_block));
  }
  for (const NamedMap& map : maps_of(result)) {
    data["maps"].push_back(packed_json(map, width, height, map_block));
  }
  data["heat"] = Json::array();
  for (int i = 0; i <= 32; ++i) {
    const Vec3f color = 255.0f * heat_color(i / 32.0);
    data["heat"].push_back({std::round(color.x), std::round(color.y), std::round(color.z)});
  }
  data["bands"] = Json::array();
  const SpectrumColors colors(observer);
  for (const double nm : bands.nm) {
    data["bands"].push_back({{"nm", nm}, {"color", css_color(colors.bright_at(nm))}});
  }
  data["probe"] = probe_json(result, bands, probe_block);
  data["trees"] = Json::array();
  for (const KeptTree& tree : result.trees) {
    data["trees"].push_back({{"x", tree.pixel.x}, {"y", tree.pixel.y}, {"text", tree.text}});
  }
  data["provenance"] = Json::object();
  for (const auto& [mode, shot] : result.modes) {
    data["provenance"][mode] = provenance_json(shot.image);
  }
  return data;
}

}  // namespace

std::string compare_stats(const CompareResult& result) {
  return document_text(stats_json(result));
}

std::string compare_page(const CompareResult& result,
                         const std::map<std::string, std::string>& pictures,
                         const Observer& observer, std::size_t most_bytes) {
  const Image& spectral = result.modes.at("spectral").image;
  const double pixels = static_cast<double>(spectral.width) * spectral.height;
  const auto bands = static_cast<double>(bands_of(spectral).nm.size());
  // Three bytes in four of what a probe keeps come through compression.
  constexpr double kProbeBytes = 2.5e6;
  int probe_block =
      std::max(1, static_cast<int>(std::ceil(std::sqrt(pixels * (bands + 22.0) / kProbeBytes))));
  int map_block = 1;
  while (true) {
    const std::string page = comparison_page(
        "abbe compare: " + result.scene,
        document_text(page_data(result, pictures, observer, map_block, probe_block)));
    if (page.size() <= most_bytes || map_block >= 16) return page;
    ++map_block;
    ++probe_block;
  }
}

}  // namespace abbe
