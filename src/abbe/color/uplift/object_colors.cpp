#include "abbe/color/uplift/object_colors.h"

#include <cmath>
#include <vector>

#include "abbe/base/constants.h"
#include "abbe/color/uplift/table.h"

namespace abbe {
namespace {

// The solid is a sum of segments from 0 to each wavelength's weight, symmetric about grey ½: along
// a direction n it reaches ½ Σ |n·weight| from there, at the point ½ Σ ±weight.
struct Tangent {
  Vec3d normal;
  double distance = 0.0;
  Vec3d point{0.0};
};

Tangent tangent_along(const Vec3d& normal) {
  Tangent tangent{normal};
  for (std::size_t w = 0; w < kUpliftWavelengths; ++w) {
    const double* weight = &kUpliftProjection[3 * w];
    const Vec3d half(0.5 * weight[0], 0.5 * weight[1], 0.5 * weight[2]);
    tangent.point += glm::dot(normal, half) < 0.0 ? -half : half;
  }
  tangent.distance = glm::dot(normal, tangent.point);
  return tangent;
}

const std::vector<Tangent>& tangents() {
  static const std::vector<Tangent> many = [] {
    constexpr int kCount = 2048;
    const double golden_angle = kPi * (3.0 - std::sqrt(5.0));
    std::vector<Tangent> made;
    for (int i = 0; i < kCount; ++i) {
      const double z = 1.0 - (2.0 * i + 1.0) / kCount;
      const double r = std::sqrt(1.0 - z * z), angle = golden_angle * i;
      made.push_back(tangent_along({r * std::cos(angle), r * std::sin(angle), z}));
    }
    return made;
  }();
  return many;
}

}  // namespace

bool is_object_color(const Vec3d& rgb_rec709) {
  constexpr double kRounding = 1e-6;  // White and black lie on the surface.
  // How far outside a colour is, is concave in the direction: near the surface the best of a few
  // is improved along its gradient until it says so or gains no more.
  constexpr double kNear = 0.05;
  const Vec3d from_middle = rgb_rec709 - Vec3d(0.5);
  const auto excess = [&from_middle](const Tangent& tangent) {
    return glm::dot(tangent.normal, from_middle) - tangent.distance;
  };
  const Tangent* best = &tangents().front();
  for (const Tangent& tangent : tangents()) {
    if (excess(tangent) > excess(*best)) best = &tangent;
    if (excess(*best) > kRounding) return false;
  }
  Tangent here = *best;
  double step = 0.1;
  while (excess(here) > -kNear && step > 1e-4) {
    const Vec3d gradient = from_middle - here.point;
    const double length = glm::length(gradient);
    if (!(length > 0.0)) break;
    const Tangent next = tangent_along(glm::normalize(here.normal + step / length * gradient));
    if (excess(next) > excess(here)) {
      here = next;
      if (excess(here) > kRounding) return false;
    } else {
      step *= 0.5;
    }
  }
  return true;
}

}  // namespace abbe
