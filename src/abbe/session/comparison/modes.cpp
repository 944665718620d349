#include "abbe/session/comparison/modes.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "abbe/display/display.h"

namespace abbe {
namespace {

constexpr Mode kModes[] = {Mode::Rgb, Mode::Rgb3, Mode::Spectral};

std::optional<Sweep> run_sweep(Study& study, const SweepPlan& plan, const RenderSettings& settings,
                               double exposure_ev) {
  const auto shot_of = [&](int value) {
    return study.render(fmt::format("sweeps/{}-{}.exr", plan.parameter, value),
                        fmt::format("{} {}", plan.parameter, value),
                        with_value(settings, plan, value));
  };
  const int finest = plan.values.back();
  const auto reference = shot_of(finest);
  if (!reference) return std::nullopt;
  Sweep sweep{plan.parameter, finest, {}};
  for (const int value : plan.values) {
    if (value == finest) continue;
    const auto shot = shot_of(value);
    if (!shot) return std::nullopt;
    const ModeDifference difference = mode_difference(shot->image, reference->image, exposure_ev);
    sweep.runs.push_back(
        {value, map_statistics(difference.maps.delta_e2000), difference.rmse, shot->seconds});
  }
  return sweep;
}

void announce(Study& study, const ModesPlan& plan, std::size_t acting) {
  study.announce(static_cast<int>(std::size(kModes) +
                                  coalitions_needed(static_cast<int>(acting), plan.method).size()));
  for (const SweepPlan& sweep : plan.sweeps) study.announce(static_cast<int>(sweep.values.size()));
}

}  // namespace

RenderSettings with_value(RenderSettings settings, const SweepPlan& plan, int value) {
  (plan.parameter == "spp" ? settings.samples_per_pixel : settings.wavelengths.count) = value;
  settings.bands.reset();
  return settings;
}

std::optional<ModesCompared> compare_modes(Study& study, const ModesPlan& plan) {
  const Scene& scene = study.prepared().scene;
  const Spectrum& d65 = study.standards().d65;
  const std::vector<Cause> acting = acting_causes(scene, d65);
  announce(study, plan, acting.size());

  ModesCompared result;
  result.settings = plan.settings;
  for (const Mode mode : kModes) {
    RenderSettings of_mode = plan.settings;
    of_mode.mode = mode;
    if (mode != Mode::Spectral) of_mode.bands.reset();
    const std::string name = mode_name(mode);
    std::optional<StudyImage> shot = study.render(name + ".exr", name, of_mode);
    if (!shot) return std::nullopt;
    result.modes.emplace(name, std::move(*shot));
  }
  const Image& spectral = result.modes.at("spectral").image;
  result.exposure_ev = plan.exposure_ev ? *plan.exposure_ev : auto_exposure_ev(spectral);
  for (const char* mode : {"rgb", "rgb3"}) {
    result.differences.emplace(
        mode, mode_difference(result.modes.at(mode).image, spectral, result.exposure_ev));
  }
  RenderSettings frozen = plan.settings;
  frozen.wavelengths.count = std::min(frozen.wavelengths.count, max_frozen_wavelengths(scene, d65));
  std::optional<Causes> causes =
      find_causes(study, acting, plan.method, frozen, result.modes.at("rgb").image,
                  result.differences.at("rgb"), result.exposure_ev);
  if (!causes) return std::nullopt;
  result.causes = std::move(*causes);
  for (const SweepPlan& sweep : plan.sweeps) {
    std::optional<Sweep> swept = run_sweep(study, sweep, plan.settings, result.exposure_ev);
    if (!swept) return std::nullopt;
    result.sweeps.push_back(std::move(*swept));
  }
  return result;
}

}  // namespace abbe
