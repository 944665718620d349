/// Newton's experiment, made in code.
#pragma once

#include "abbe/optics/dispersion.h"
#include "abbe/scene/scene.h"

namespace abbe::test {

inline constexpr double kBeamWidth_m = 0.002;
inline constexpr double kBeamHeight_m = 0.016;
inline constexpr double kDistance_m = 0.5;

/// A beam, a 60° prism with the d line at minimum deviation, and a matte screen that the d line
/// meets at right angles; the camera sees the screen from its front, one pixel a known width.
struct Newton {
  Scene scene;
  Dispersion index;
  Vec3d beam_direction{1.0, 0.0, 0.0};
  Vec3d normal_in, normal_out;  ///< Of the faces, outwards.
  Vec3d entry{0.0};             ///< Where the middle of the beam enters.
  double inradius_m = 0.0;
  Vec3d screen_center{0.0}, screen_normal{0.0}, screen_x{0.0};
  Vec2i size{512, 32};
  double pixel_m = 0.0005;

  Vec3d lamp{0.0};  ///< Of newton_with_slit.
};

Newton newton(const char* glass_id);

/// The same with a point lamp of 1 cd half a metre before the prism instead of the beam, and 0.1 m
/// before the prism a black plate with a slit of the beam's size.
Newton newton_with_slit(const char* glass_id);

}  // namespace abbe::test
