#include "support/caustic_scenes.h"

#include <cmath>

#include "support/gems.h"
#include "support/scene_builder.h"

namespace abbe::test {
namespace {

CausticScene over_floor(const std::string& name, const Vec3d& lamp, double half_floor_m) {
  CausticScene result;
  result.name = name;
  result.lamp = lamp;
  Scene& scene = result.scene;
  add_square(scene, add(scene, matte(Vec3f(1.0f))), 20.0, rotation({1, 0, 0}, -90.0));
  scene.lights.push_back(point_light(lamp, 1.0));
  scene.cameras.push_back(orthographic_camera({0, 0.02, 0}, {0, 0, 0}, half_floor_m, half_floor_m));
  // Wide enough for the floor and for the glass between.
  result.half_angle_rad = 0.95;
  return result;
}

}  // namespace

CausticScene cube_over_floor() {
  CausticScene result = over_floor("cube", {0.25, 3.0, 0.4}, 1.0);
  add_box(result.scene, add(result.scene, glass("glass/schott/N-BK7")), {0.4, 0.4, 0.4},
          translation({0, 1, 0}) * rotation({0, 1, 0}, 20.0) * rotation({1, 0, 0}, 15.0));
  return result;
}

CausticScene wedge_over_floor() {
  CausticScene result = over_floor("wedge", {-0.3, 3.0, 0.2}, 1.0);
  const double slope = glm::radians(25.0);
  ConvexShape wedge;
  wedge.planes = {Vec4d(0, 1, 0, 1.2),
                  Vec4d(std::sin(slope), -std::cos(slope), 0, -0.8 * std::cos(slope)),
                  Vec4d(-1, 0, 0, 0.5), Vec4d(0, 0, 1, 0.5), Vec4d(0, 0, -1, 0.5)};
  add_shape(result.scene, {.name = "wedge", .geometry = wedge},
            add(result.scene, glass("glass/schott/N-SF11")), Mat4d(1.0));
  return result;
}

CausticScene gem_over_floor() {
  CausticScene result = over_floor("gem", {1.2, 5.0, 0.8}, 2.0);
  add_shape(result.scene, {.name = "gem", .geometry = brilliant()},
            add(result.scene, glass("glass/schott/N-SF66")), translation({0, 1.6, 0}));
  return result;
}

}  // namespace abbe::test
