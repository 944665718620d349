#include "support/image_difference.h"

#include "abbe/color/color.h"
#include "abbe/image/metrics/metrics.h"

namespace abbe::test {

double mean_delta_e2000(const Image& first, const Image& second) {
  const Mat3d to_xyz = rec709_to_xyz();
  const Vec3d white = xyz_of_xy(kD65_xy);
  double sum = 0.0;
  for (int y = 0; y < first.height; ++y) {
    for (int x = 0; x < first.width; ++x) {
      const auto lab = [&](const Image& image) {
        const Vec3d rgb_rec709(image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2));
        return lab_of_xyz(to_xyz * rgb_rec709, white);
      };
      sum += delta_e2000(lab(first), lab(second));
    }
  }
  return sum / (first.width * first.height);
}

}  // namespace abbe::test
