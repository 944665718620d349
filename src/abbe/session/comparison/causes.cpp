#include "abbe/session/comparison/causes.h"

#include <algorithm>
#include <set>

#include "abbe/base/constants.h"
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

std::optional<std::size_t> Causes::index_of(Cause cause) const {
  const auto found = std::find(acting.begin(), acting.end(), cause);
  if (found == acting.end()) return std::nullopt;
  return static_cast<std::size_t>(found - acting.begin());
}

double Causes::mean_whole() const {
  return map_statistics(whole).mean;
}

int max_frozen_wavelengths(const Scene& scene, const Spectrum& d65) {
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

}  // namespace abbe
