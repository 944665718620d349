#include "abbe/optics/absorption.h"

#include <algorithm>
#include <cmath>

namespace abbe {

double transmittance_after(double absorption_per_m, double distance_m) {
  // 0 · infinity is not a number; a clear medium is clear however long the path.
  return absorption_per_m > 0.0 ? std::exp(-absorption_per_m * distance_m) : 1.0;
}

double absorption_of_attenuation_per_m(double attenuation_color, double attenuation_distance_m) {
  if (attenuation_color >= 1.0 || std::isinf(attenuation_distance_m)) return 0.0;
  if (attenuation_color <= 0.0) return kLargestAbsorption_per_m;
  return std::min(-std::log(attenuation_color) / attenuation_distance_m, kLargestAbsorption_per_m);
}

Vec3d absorption_of_attenuation_per_m(const Vec3d& attenuation_color_rec709,
                                      double attenuation_distance_m) {
  Vec3d absorption_per_m;
  for (int channel = 0; channel < 3; ++channel) {
    absorption_per_m[channel] =
        absorption_of_attenuation_per_m(attenuation_color_rec709[channel], attenuation_distance_m);
  }
  return absorption_per_m;
}

}  // namespace abbe
