#include "abbe/render/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/accel/accelerator.h"
#include "abbe/base/constants.h"
#include "abbe/base/error.h"
#include "abbe/film/filter.h"
#include "abbe/image/exr/exr.h"
#include "abbe/render/render.h"
#include "abbe/render/sample_places.h"

namespace abbe {
namespace {

void check_range(const char* field, double value, double low, double high) {
  // Written so that not-a-number fails.
  if (!(value >= low && value <= high)) {
    throw_usage_error(field, fmt::format("{:.10g}", value),
                      fmt::format("a number from {:.10g} to {:.10g}", low, high));
  }
}

// Of all samples of a pixel.
std::vector<float> wavelength_shifts(const RenderSettings& settings) {
  std::vector<float> shifts;
  shifts.reserve(static_cast<std::size_t>(std::max(settings.samples_per_pixel, 0)));
  for (int i = 0; i < settings.samples_per_pixel; ++i) {
    shifts.push_back(placed_wavelength_shift(settings, static_cast<std::uint32_t>(i)));
  }
  return shifts;
}

void check_wavelengths(const RenderSettings& settings) {
  const WavelengthOptions& options = settings.wavelengths;
  check_range("wavelengths.count", options.count, 1, 64);
  if (options.range_min_nm < kRangeMin_nm || options.range_max_nm > kRangeMax_nm ||
      !(options.range_min_nm < options.range_max_nm)) {
    throw_usage_error("wavelengths.range_min_nm",
                      fmt::format("{:g}:{:g}", options.range_min_nm, options.range_max_nm),
                      fmt::format("A:B with {:g} <= A < B <= {:g}", kRangeMin_nm, kRangeMax_nm));
  }
  if (options.exact_nm.size() > 64) {
    throw_usage_error("wavelengths.exact_nm",
                      fmt::format("{} wavelengths", options.exact_nm.size()), "1 to 64");
  }
  for (std::size_t i = 0; i < options.exact_nm.size(); ++i) {
    check_range("wavelengths.exact_nm", options.exact_nm[i], kRangeMin_nm, kRangeMax_nm);
    if (i == 0) continue;
    const double last_nm = options.exact_nm[i - 1];
    if (!(options.exact_nm[i] > last_nm) ||
        spectral_channel_name(options.exact_nm[i]) == spectral_channel_name(last_nm)) {
      throw_usage_error("wavelengths.exact_nm",
                        fmt::format("{} after {}", options.exact_nm[i], last_nm),
                        "wavelengths in rising order, each once to six decimals");
    }
  }
  if (!options.exact_nm.empty() && settings.bands) {
    throw_usage_error("wavelengths.exact_nm", "`bands` beside it", "one of the two");
  }
  if (settings.mode == Mode::Spectral) {
    // The albedo of lamps in three channels has no spectrum of its own.
    const bool has_albedo = std::find(settings.aovs.begin(), settings.aovs.end(),
                                      "spectralAlbedo") != settings.aovs.end();
    if (settings.frozen.has_channels() && has_albedo) {
      throw_usage_error("frozen", "`aovs` with spectralAlbedo beside it", "one of the two");
    }
    return;
  }
  const std::string mode = "`mode` " + mode_name(settings.mode);
  if (!settings.frozen.empty()) {
    throw_usage_error("frozen", mode, "`mode` spectral: an RGB mode has all causes frozen");
  }
  const auto reject_if = [&mode](bool is_set, const char* field) {
    if (is_set) throw_usage_error(field, mode, "`mode` spectral: an RGB mode has no wavelengths");
  };
  reject_if(!options.exact_nm.empty(), "wavelengths.exact_nm");
  reject_if(settings.bands.has_value(), "bands");
  reject_if(options.range_min_nm != kRangeMin_nm || options.range_max_nm != kRangeMax_nm,
            "wavelengths.range_min_nm");
}

}  // namespace

std::vector<std::string> aov_names() {
  return {"Z",        "P",          "N",         "albedo",         "UV",
          "objectId", "materialId", "cost",      "direct",         "ambient",
          "emitted",  "reflected",  "refracted", "spectralAlbedo", "samples"};
}

WorldOptions world_options(const RenderSettings& settings) {
  return {.mode = settings.mode,
          .wavelengths = settings.wavelengths,
          .uplift = settings.uplift,
          .frozen = settings.frozen,
          .shifts = wavelength_shifts(settings),
          .accelerator = settings.accelerator};
}

CausticOptions caustic_options(const RenderSettings& settings) {
  // What is cut here is left out, not followed by chance.
  return {.exact = settings.caustics,
          .inner_reflections = settings.inner_reflections,
          .cutoff = std::min(settings.cutoff, CausticOptions{}.cutoff)};
}

void check_settings(const RenderSettings& settings) {
  check_world_options(world_options(settings));
  check_range("samples_per_pixel", settings.samples_per_pixel,
              settings.noise != 0.0 ? kPilotSamples : 1, 1 << 20);
  // Smaller errors take longer than anyone lives.
  if (settings.noise != 0.0) check_range("noise", settings.noise, 1e-3, 100.0);
  check_range("noise_exposure_ev", settings.noise_exposure_ev, -100.0, 100.0);
  check_range("max_depth", settings.max_depth, 0, 1000);
  check_range("cutoff", settings.cutoff, 0.0, 1.0);
  check_range("inner_reflections", settings.inner_reflections, 0,
              CausticOptions::kMostInnerReflections);
  check_range("threads", settings.threads, 0, 4096);
  check_range("cluster_lanes", settings.cluster_lanes, 0, kMaxLanes);
  check_wavelengths(settings);
  (void)Filter::named(settings.filter);
  check_choice("accelerator", settings.accelerator, "an accelerator", accelerator_names());
  const std::vector<std::string> names = aov_names();
  for (const std::string& aov : settings.aovs) {
    check_choice("aovs", aov, "a name of an extra channel", names);
    if (aov == "spectralAlbedo" && !settings.bands && settings.wavelengths.exact_nm.empty()) {
      throw_usage_error("aovs", aov + " without spectral channels",
                        "`bands` or `wavelengths.exact_nm`, which say of what wavelengths");
    }
  }
  for (auto aov = settings.aovs.begin(); aov != settings.aovs.end(); ++aov) {
    if (std::find(settings.aovs.begin(), aov, *aov) != aov) {
      throw_usage_error("aovs", *aov + " twice", "each group of channels once");
    }
  }
  check_film(film_options(settings));
}

Vec2i default_size(const Camera& camera) {
  constexpr int kRows = 540;
  double aspect = camera.aspect_ratio;
  if (const auto* orthographic = std::get_if<OrthographicCamera>(&camera.projection)) {
    aspect = std::abs(orthographic->xmag / orthographic->ymag);
  }
  if (!(aspect > 0.01 && aspect < 100.0)) aspect = 16.0 / 9.0;
  return {std::max(1, static_cast<int>(std::lround(kRows * aspect))), kRows};
}

}  // namespace abbe
