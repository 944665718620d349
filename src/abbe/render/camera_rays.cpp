#include "abbe/render/camera_rays.h"

#include <cmath>

namespace abbe {

CameraRays::CameraRays(const Camera& camera, const Vec2i& size) : size_(size) {
  // A camera has a place and a direction; the scale of its node means nothing to it.
  origin_ = Vec3d(camera.to_world[3]);
  right_ = glm::normalize(Vec3d(camera.to_world[0]));
  up_ = glm::normalize(Vec3d(camera.to_world[1]));
  forward_ = -glm::normalize(Vec3d(camera.to_world[2]));
  if (const auto* perspective = std::get_if<PerspectiveCamera>(&camera.projection)) {
    const double half_height = std::tan(0.5 * perspective->yfov_rad);
    half_extent_ = {half_height * size_.x / size_.y, half_height};
  } else {
    const auto& orthographic = std::get<OrthographicCamera>(camera.projection);
    is_perspective_ = false;
    half_extent_ = {orthographic.xmag, orthographic.ymag};
  }
}

void CameraRays::aim(const Vec2d& film_px, CameraSample& sample) const {
  const double x = (2.0 * film_px.x / size_.x - 1.0) * half_extent_.x;
  const double y = (1.0 - 2.0 * film_px.y / size_.y) * half_extent_.y;
  const double pixel_width = 2.0 * half_extent_.y / size_.y;
  const Vec3f rightwards(2.0 * half_extent_.x / size_.x * right_);
  const Vec3f downwards(-pixel_width * up_);
  if (is_perspective_) {
    sample.origin = Vec3f(origin_);
    const Vec3d along = forward_ + x * right_ + y * up_;
    const auto scale = static_cast<float>(1.0 / glm::length(along));
    sample.direction = Vec3f(glm::normalize(along));
    sample.direction_per_px = {scale * rightwards, scale * downwards};
    sample.footprint_m = 0.0f;
    sample.footprint_per_m = static_cast<float>(pixel_width);
  } else {
    sample.origin = Vec3f(origin_ + x * right_ + y * up_);
    sample.direction = Vec3f(forward_);
    sample.origin_per_px = {rightwards, downwards};
    sample.footprint_m = static_cast<float>(pixel_width);
    sample.footprint_per_m = 0.0f;
  }
}

}  // namespace abbe
