/// Rays of perspective and orthographic cameras.
#pragma once

#include "abbe/integrate/integrator.h"
#include "abbe/math/vec.h"
#include "abbe/scene/scene.h"

namespace abbe {

/// A camera prepared for an image size: pixel coordinates in, rays out.
/// yfov (or ymag) spans the height, and the width follows from the image's shape; of xmag and ymag
/// both are used as given.
class CameraRays {
 public:
  CameraRays(const Camera& camera, const Vec2i& size);

  /// Fills origin, direction, footprint and their change per pixel for a place on the film.
  /// Units:  pixels from the upper left corner of the image; y downwards.
  void aim(const Vec2d& film_px, CameraSample& sample) const;

 private:
  Vec2d half_extent_{1.0};  ///< At distance 1, or in metres.
  Vec2d size_;
  Vec3d origin_, right_, up_, forward_;
  bool is_perspective_ = true;
};

}  // namespace abbe
