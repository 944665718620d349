#include "abbe/scene/lamps.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "abbe/base/constants.h"

namespace abbe {
double luminance_of(const Vec3d& rgb_rec709) {
  // The middle row of the matrix of Rec.709 to XYZ.
  return 0.212639005871510 * rgb_rec709.x + 0.715168678767756 * rgb_rec709.y +
         0.0721923153607337 * rgb_rec709.z;
}

EnvironmentMean mean_of(const Environment& environment) {
  const EnvironmentImage& image = environment.image;
  EnvironmentMean mean;
  mean.band_nm.assign(image.band_nm.begin(), image.band_nm.end());
  mean.bands.assign(image.band_nm.size(), 0.0);
  double weights = 0.0;
  std::size_t texel = 0;
  for (int y = 0; y < image.height; ++y) {
    const double weight = std::sin(kPi * (y + 0.5) / image.height);  // As large as its texels are.
    for (int x = 0; x < image.width; ++x, ++texel) {
      weights += weight;
      if (mean.bands.empty()) mean.rgb_rec709 += weight * Vec3d(image.rgb_rec709[texel]);
      for (std::size_t b = 0; b < mean.bands.size(); ++b) {
        mean.bands[b] += weight * static_cast<double>(image.bands[texel * mean.bands.size() + b]);
      }
    }
  }
  const double scale = environment.scale / weights;
  mean.rgb_rec709 *= scale;
  for (double& band : mean.bands) band *= scale;
  return mean;
}

void replace_lamps(Scene& scene, const NamedSpectrum& lamp) {
  for (Light& light : scene.lights) {
    if (!light.spectrum) light.intensity *= luminance_of(light.color_rec709);
    light.color_rec709 = Vec3d(1.0);
    light.spectrum = lamp;
  }
  for (Material& material : scene.materials) {
    if (material.emission) {
      material.emission->spectrum = lamp;
    } else if (material.emissive_rec709 != Vec3f(0.0f)) {
      material.emission = SpectralEmission{lamp, luminance_of(Vec3d(material.emissive_rec709))};
    }
  }
  if (scene.ambient) scene.ambient->spectrum = lamp;
  if (scene.environment && scene.environment->image.band_nm.empty()) {
    Environment changed = *scene.environment;
    changed.spectrum = lamp;
    scene.environment = std::make_shared<const Environment>(std::move(changed));
  }
}

double illuminance_lux(const Light& light, const Vec3d& place, double nearest_m) {
  if (light.type == LightType::Directional) return light.intensity;
  const double distance_m = std::max(glm::distance(Vec3d(light.to_world[3]), place), nearest_m);
  return distance_m > 0.0 ? light.intensity / (distance_m * distance_m) : light.intensity;
}

}  // namespace abbe
