#include "support/newton.h"

#include <cmath>

#include "abbe/base/constants.h"
#include "support/scene_builder.h"

namespace abbe::test {

Newton newton(const char* glass_id) {
  Newton n;
  const Material glass = test::glass(glass_id);
  n.index = glass.index;
  const double inside = std::asin(refractive_index(n.index, kLine_d_nm) * 0.5);
  // Half the deviation, 2·(incidence − 30°)/2, turns the beam to the way inside.
  const double half = inside - glm::radians(30.0);
  const Vec3d way(std::cos(half), 0.0, -std::sin(half));
  const Vec3d apex(std::sin(half), 0.0, std::cos(half));
  const double c30 = std::cos(glm::radians(30.0));
  n.normal_in = -c30 * way + 0.5 * apex;
  n.normal_out = c30 * way + 0.5 * apex;
  n.inradius_m = 0.06 / (2.0 * std::sqrt(3.0));
  ConvexShape prism;
  for (const Vec3d& normal : {n.normal_in, n.normal_out, -apex}) {
    prism.planes.push_back(Vec4d(normal, n.inradius_m));
  }
  prism.planes.push_back(Vec4d(0, 1, 0, 0.05));
  prism.planes.push_back(Vec4d(0, -1, 0, 0.05));
  add_shape(n.scene, {.name = "prism", .geometry = prism}, add(n.scene, glass), Mat4d(1.0));
  n.entry = -way * (n.inradius_m / c30);
  const Vec3d out(std::cos(2.0 * half), 0.0, -std::sin(2.0 * half));
  n.screen_normal = -out;
  n.screen_x = glm::cross(Vec3d(0, 1, 0), n.screen_normal);
  n.screen_center = -n.entry + kDistance_m * out;
  const Mat4d place(Vec4d(n.screen_x, 0), Vec4d(0, 1, 0, 0), Vec4d(n.screen_normal, 0),
                    Vec4d(n.screen_center, 1));
  add_square(n.scene, add(n.scene, matte(Vec3f(1.0f))), 0.3, place);
  Light beam = directional_light(n.beam_direction, 1000.0);
  beam.beam = BeamSize{kBeamWidth_m, kBeamHeight_m};
  beam.to_world[3] = Vec4d(n.entry - 0.4 * n.beam_direction, 1.0);
  n.scene.lights.push_back(beam);
  // Just in front of the screen, so that the prism does not stand before it.
  n.scene.cameras.push_back(orthographic_camera(n.screen_center + 0.2 * n.screen_normal,
                                                n.screen_center, 0.5 * n.size.x * n.pixel_m,
                                                0.5 * n.size.y * n.pixel_m));
  return n;
}

Newton newton_with_slit(const char* glass_id) {
  Newton n = newton(glass_id);
  n.lamp = n.entry - 0.5 * n.beam_direction;
  n.scene.lights.front() = point_light(n.lamp, 1.0);
  const Vec3d slit = n.entry - 0.1 * n.beam_direction;
  const std::uint32_t black = add(n.scene, matte(Vec3f(0.0f)));
  constexpr double kHalfPlate_m = 0.2;
  const auto plate = [&](double y, double z, double half_y, double half_z) {
    add_box(n.scene, black, {0.0005, half_y, half_z}, translation(slit + Vec3d(0.0, y, z)));
  };
  for (const double side : {-1.0, 1.0}) {
    plate(0.0, side * (0.5 * kBeamWidth_m + kHalfPlate_m), 2.0 * kHalfPlate_m, kHalfPlate_m);
    plate(side * (0.5 * kBeamHeight_m + kHalfPlate_m), 0.0, kHalfPlate_m, 0.5 * kBeamWidth_m);
  }
  return n;
}

}  // namespace abbe::test
