#include "abbe/world/scene_white.h"

#include "abbe/base/constants.h"
#include "abbe/color/uplift/uplift.h"
#include "abbe/scene/lamps.h"

namespace abbe {

White scene_white(const Scene& scene, const Box3d& bounds, const Spectrum& d65,
                  const Observer& observer) {
  White white{"scene", {}, std::nullopt};
  const double radius_m = 0.5 * glm::distance(bounds.low, bounds.high);
  const Spectrum d65_of_1_cd = d65.scaled(1.0 / xyz_of(d65, observer).y);
  const auto add_rgb = [&](const Vec3d& rgb_rec709, double share) {
    // Every uplift gives a lamp's colour this white.
    const Spectrum spectrum = uplift_emission(Uplift::JakobHanika, rgb_rec709, d65_of_1_cd);
    const double luminance = xyz_of(spectrum, observer).y;
    if (luminance > 0.0) white.lamps.emplace_back(spectrum, share * luminance);
  };
  const auto add_environment = [&](const Environment& environment) {
    // The mean of all directions, as many lux as it gives to what faces it.
    const EnvironmentMean mean = mean_of(environment);
    if (!mean.bands.empty()) {
      const Spectrum spectrum = Spectrum::tabulated(mean.band_nm, mean.bands, OutsideTable::Zero);
      const double luminance = xyz_of(spectrum, observer).y;
      if (luminance > 0.0) white.lamps.emplace_back(spectrum, kPi * luminance);
    } else if (environment.spectrum) {
      const double luminance = luminance_of(mean.rgb_rec709);
      if (luminance > 0.0) {
        white.lamps.emplace_back(environment.spectrum->spectrum, kPi * luminance);
      }
    } else {
      add_rgb(mean.rgb_rec709, kPi);
    }
  };
  for (const Light& light : scene.lights) {
    // A lamp amid the scene counts as one at its edge, not as infinitely bright.
    const double lux = illuminance_lux(light, bounds.center(), radius_m);
    if (light.spectrum) {
      white.lamps.emplace_back(light.spectrum->spectrum, lux);
    } else {
      add_rgb(light.color_rec709, lux);
    }
  }
  if (!scene.environment && scene.ambient && scene.ambient->luminance_cd_per_m2 > 0.0) {
    white.lamps.emplace_back(scene.ambient->spectrum.spectrum,
                             kPi * scene.ambient->luminance_cd_per_m2);
  }
  if (scene.environment) add_environment(*scene.environment);
  if (!white.lamps.empty()) return white;
  for (const Material& material : scene.materials) {
    if (material.emission) {
      white.lamps.emplace_back(material.emission->spectrum.spectrum,
                               material.emission->luminance_cd_per_m2);
    } else if (material.emissive_rec709 != Vec3f(0.0f)) {
      add_rgb(Vec3d(material.emissive_rec709), 1.0);
    }
  }
  if (white.lamps.empty()) white.lamps.emplace_back(d65, 1.0);
  return white;
}

}  // namespace abbe
