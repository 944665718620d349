/// Light followed forwards, ray by ray, from a point lamp through convex glass onto a screen: the
/// brute force that exact chains are measured against. It shares no code with them.
#pragma once

#include <cstdint>
#include <vector>

#include "abbe/scene/scene.h"

namespace abbe::test {

/// A screen of square pixels; x to the right and y down as its picture is seen.
struct Screen {
  Vec3d center{0.0}, x{1.0, 0.0, 0.0}, y{0.0, 0.0, 1.0};
  double pixel_m = 0.001;
  Vec2i size{8, 8};
};

/// The pixels that an orthographic camera sees of the plane at right angles through `center`.
Screen screen_of(const Camera& camera, const Vec3d& center, const Vec2i& size);

struct ForwardLight {
  /// Per pixel, row by row: irradiance from a lamp of intensity 1, in m⁻².
  std::vector<double> irradiance;
  double aimed_sr = 0.0;      ///< Solid angle of the cone that rays were sent into.
  double on_glass_sr = 0.0;   ///< Of those that met glass first.
  double on_screen_sr = 0.0;  ///< What all pixels got, straight light included.
};

/// Sends rays of one wavelength into a cone about `axis`, evenly by a low-discrepancy sequence, and
/// splits each at every face: outside reflection only where it is the first thing to happen, at
/// most `inner_reflections` per body. Only convex shapes stand in the way; opaque ones absorb. The
/// screen lets light pass; only its front gets some.
ForwardLight follow_forward(const Scene& scene, const Vec3d& lamp, const Vec3d& axis,
                            double half_angle_rad, double wavelength_nm, int inner_reflections,
                            std::uint64_t rays, const Screen& screen);

}  // namespace abbe::test
