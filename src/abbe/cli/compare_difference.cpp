#include "abbe/cli/compare_difference.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "abbe/base/constants.h"
#include "abbe/image/metrics/metrics.h"
#include "abbe/world/world.h"

namespace abbe {
namespace {

CauseSet frozen_but(const std::vector<Cause>& acting, Coalition active) {
  CauseSet frozen;
  for (std::size_t i = 0; i < acting.size(); ++i) {
    if ((active >> i & 1u) == 0) frozen.insert(acting[i]);
  }
  return frozen;
}

std::string name_of(const std::vector<Cause>& acting, Coalition active, const char* separator) {
  std::string name;
  for (std::size_t i = 0; i < acting.size(); ++i) {
    if ((active >> i & 1u) != 0) name += (name.empty() ? "" : separator) + cause_name(acting[i]);
  }
  return name;
}

}  // namespace

Image exposed(const Image& image, double exposure_ev) {
  Image result;
  result.width = image.width;
  result.height = image.height;
  result.channels = {"R", "G", "B"};
  const std::size_t channels = image.channel_count();
  const std::size_t r = *image.channel_index("R"), g = *image.channel_index("G"),
                    b = *image.channel_index("B");
  const auto gain = static_cast<float>(std::exp2(exposure_ev));
  const std::size_t pixels = image.pixels.size() / channels;
  result.pixels.reserve(3 * pixels);
  for (std::size_t p = 0; p < pixels; ++p) {
    const float* in = image.pixels.data() + p * channels;
    result.pixels.insert(result.pixels.end(), {gain * in[r], gain * in[g], gain * in[b]});
  }
  return result;
}

ModeDifference mode_difference(const Image& image, const Image& reference, double exposure_ev) {
  const Image here = exposed(image, exposure_ev), there = exposed(reference, exposure_ev);
  ModeDifference difference;
  difference.maps = color_maps(here, there, DiffOptions{});
  difference.rmse =
      combined_metrics(image_metrics(exposed(image, 0.0), exposed(reference, 0.0)), "color").rmse;
  return difference;
}

std::optional<std::size_t> Causes::index_of(Cause cause) const {
  const auto found = std::find(acting.begin(), acting.end(), cause);
  if (found == acting.end()) return std::nullopt;
  return static_cast<std::size_t>(found - acting.begin());
}

double Causes::mean_whole() const {
  return map_statistics(whole).mean;
}

int most_frozen_wavelengths(const Scene& scene, const Spectrum& d65) {
  std::set<double> lines_nm;
  for (const Spectrum& lamp : lamp_spectra(scene, d65)) {
    for (const SpectralLine& line : lamp.lines()) lines_nm.insert(line.wavelength_nm);
  }
  return std::max(1, kMaxLanes / 3 - static_cast<int>(lines_nm.size()));
}

std::optional<Causes> find_causes(Study& study, const std::vector<Cause>& acting,
                                  AttributionMethod method, const RenderSettings& settings,
                                  const Image& rgb, const ModeDifference& rgb_to_spectral,
                                  double exposure_ev) {
  Causes causes;
  causes.acting = acting;
  causes.method = method;
  causes.whole = rgb_to_spectral.maps.delta_e2000;
  const int players = static_cast<int>(acting.size());
  const Image rgb_exposed = exposed(rgb, exposure_ev);
  std::map<Coalition, std::vector<float>> values;
  values[0] = std::vector<float>(causes.whole.size(), 0.0f);
  for (const Coalition active : coalitions_needed(players, method)) {
    RenderSettings with = settings;
    with.bands.reset();
    with.frozen = frozen_but(acting, active);
    const auto image = study.render("causes/" + name_of(acting, active, "+") + ".exr",
                                    "only " + name_of(acting, active, ", "), with);
    if (!image) return std::nullopt;
    values[active] = delta_e2000_map(exposed(image->image, exposure_ev), rgb_exposed);
  }
  if (players > 0) values[(Coalition{1} << players) - 1u] = causes.whole;
  causes.attribution =
      players > 0 ? attribute(players, method, values) : Attribution{{}, causes.whole};
  causes.dominant = dominant_players(causes.attribution, causes.whole, kLeastDeltaE);
  return causes;
}

std::vector<double> histogram_edges() {
  return {0.0, 0.1, 0.2, 0.5, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0, 50.0};
}

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

}  // namespace abbe
