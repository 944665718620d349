#include "abbe/scene/lamps.h"

namespace abbe {
namespace {

// Luminance of linear Rec.709 whose white is 1 cd/m²: the middle row of its matrix to XYZ.
double luminance(const Vec3d& rgb_rec709) {
  return 0.212639005871510 * rgb_rec709.x + 0.715168678767756 * rgb_rec709.y +
         0.0721923153607337 * rgb_rec709.z;
}

}  // namespace

void replace_lamps(Scene& scene, const NamedSpectrum& lamp) {
  for (Light& light : scene.lights) {
    if (!light.spectrum) light.intensity *= luminance(light.color_rec709);
    light.color_rec709 = Vec3d(1.0);
    light.spectrum = lamp;
  }
  for (Material& material : scene.materials) {
    if (material.emission) {
      material.emission->spectrum = lamp;
    } else if (material.emissive_rec709 != Vec3f(0.0f)) {
      material.emission = SpectralEmission{lamp, luminance(Vec3d(material.emissive_rec709))};
    }
  }
  if (scene.ambient) scene.ambient->spectrum = lamp;
}

}  // namespace abbe
