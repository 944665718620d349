#include "abbe/image/metrics/heat_map.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace abbe {
namespace {

// L* 0, 20, 40, 60, 80 and 95.
constexpr std::array<std::array<float, 3>, 6> kStops{{{0.000f, 0.000f, 0.000f},
                                                      {0.180f, 0.110f, 0.450f},
                                                      {0.610f, 0.120f, 0.500f},
                                                      {0.920f, 0.350f, 0.320f},
                                                      {0.990f, 0.690f, 0.360f},
                                                      {0.990f, 0.960f, 0.740f}}};

}  // namespace

Vec3f heat_color(double share) {
  if (std::isnan(share)) share = 1.0;
  const double place = std::clamp(share, 0.0, 1.0) * (kStops.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(place), kStops.size() - 2);
  const auto f = static_cast<float>(place - static_cast<double>(i));
  const auto stop = [](std::size_t k) { return Vec3f(kStops[k][0], kStops[k][1], kStops[k][2]); };
  return (1.0f - f) * stop(i) + f * stop(i + 1);
}

Image heat_map(const std::vector<float>& map, int width, int height, double full_scale) {
  Image picture;
  picture.width = width;
  picture.height = height;
  picture.channels = {"R", "G", "B"};
  picture.pixels.reserve(map.size() * 3);
  for (const float value : map) {
    const Vec3f rgb_srgb_encoded = heat_color(static_cast<double>(value) / full_scale);
    picture.pixels.insert(picture.pixels.end(),
                          {rgb_srgb_encoded.x, rgb_srgb_encoded.y, rgb_srgb_encoded.z});
  }
  return picture;
}

}  // namespace abbe
