/// Glass that throws the light of a point lamp onto a floor, made in code.
#pragma once

#include <string>
#include <vector>

#include "abbe/scene/scene.h"
#include "support/forward_light.h"

namespace abbe::test {

/// A piece of glass over a white floor at y = 0; the camera sees the floor from below the glass.
struct CausticScene {
  std::string name;
  Scene scene;
  Vec3d lamp{0.0};
  double half_angle_rad = 0.0;  ///< Of a cone straight down that holds the floor and the glass.
  Vec2i size{8, 8};

  Screen screen() const { return screen_of(scene.cameras.front(), Vec3d(0.0), size); }
};

/// A tilted cube, a wedge of 25° and a brilliant of 57 facets.
CausticScene cube_over_floor();
CausticScene wedge_over_floor();
CausticScene gem_over_floor();

}  // namespace abbe::test
