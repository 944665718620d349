#include "abbe/scene/surface_finder.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace abbe {
namespace {

// The ray in the space of an instance; its direction keeps the length that makes distances those of
// the world.
struct LocalRay {
  Vec3d origin, direction;
};

struct Crossing {
  double distance_m = 0.0;
  Vec3d normal{0.0};  // In the space of the instance, to the front; of any length.
};

bool meets(const Box3d& box, const Vec3d& origin, const Vec3d& direction, double far_m) {
  double begin = 0.0, end = far_m;
  for (int c = 0; c < 3; ++c) {
    if (direction[c] == 0.0) {
      if (origin[c] < box.low[c] || origin[c] > box.high[c]) return false;
      continue;
    }
    const double a = (box.low[c] - origin[c]) / direction[c];
    const double b = (box.high[c] - origin[c]) / direction[c];
    // A flat box is met within the rounding of its planes.
    const double slack = 1e-12 * std::max(std::abs(a), std::abs(b));
    begin = std::max(begin, std::min(a, b) - slack);
    end = std::min(end, std::max(a, b) + slack);
  }
  return begin <= end;
}

// Möller & Trumbore, Fast, Minimum Storage Ray/Triangle Intersection, 1997.
std::optional<Crossing> crossing(const LocalRay& ray, const Vec3d& a, const Vec3d& b,
                                 const Vec3d& c) {
  const Vec3d ab = b - a, ac = c - a;
  const Vec3d across = glm::cross(ray.direction, ac);
  const double determinant = glm::dot(ab, across);
  if (determinant == 0.0) return std::nullopt;
  const Vec3d off = ray.origin - a;
  const double u = glm::dot(off, across) / determinant;
  if (!(u >= 0.0 && u <= 1.0)) return std::nullopt;
  const Vec3d around = glm::cross(off, ab);
  const double v = glm::dot(ray.direction, around) / determinant;
  if (!(v >= 0.0 && u + v <= 1.0)) return std::nullopt;
  return Crossing{glm::dot(ac, around) / determinant, glm::cross(ab, ac)};
}

// In and out of a ball and a body of planes.
std::vector<Crossing> crossings(const LocalRay& ray, const SphereShape& sphere) {
  const double a = glm::dot(ray.direction, ray.direction);
  const double b = glm::dot(ray.origin, ray.direction);
  const double c = glm::dot(ray.origin, ray.origin) - sphere.radius_m * sphere.radius_m;
  const double discriminant = b * b - a * c;
  if (!(discriminant > 0.0)) return {};
  const double root = std::sqrt(discriminant);
  std::vector<Crossing> found;
  for (const double t : {(-b - root) / a, (-b + root) / a}) {
    found.push_back({t, ray.origin + t * ray.direction});
  }
  return found;
}

std::vector<Crossing> crossings(const LocalRay& ray, const ConvexShape& body) {
  Crossing in{-std::numeric_limits<double>::infinity(), {}};
  Crossing out{std::numeric_limits<double>::infinity(), {}};
  for (const Vec4d& plane : body.planes) {
    const Vec3d normal(plane);
    const double slope = glm::dot(normal, ray.direction);
    const double height = plane.w - glm::dot(normal, ray.origin);
    if (slope == 0.0) {
      if (height < 0.0) return {};
      continue;
    }
    const double t = height / slope;
    if (slope < 0.0 && t > in.distance_m) in = {t, normal};
    if (slope > 0.0 && t < out.distance_m) out = {t, normal};
  }
  if (!(in.distance_m < out.distance_m)) return {};
  return {in, out};
}

}  // namespace

SurfaceFinder::SurfaceFinder(const Scene& scene) : scene_(scene) {
  for (const Instance& instance : scene.instances) {
    boxes_.push_back(bounds_of(scene, instance));
    const auto* mesh = std::get_if<std::uint32_t>(&instance.what);
    size_ += mesh != nullptr ? scene.meshes[*mesh].triangles.size() : 1;
  }
}

std::optional<FoundSurface> SurfaceFinder::first(const Vec3d& origin, const Vec3d& direction,
                                                 double from_m, const Counts& counts) const {
  std::optional<FoundSurface> nearest;
  double far_m = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) {
    if (!meets(boxes_[i], origin, direction, far_m)) continue;
    const Instance& instance = scene_.instances[i];
    const Mat4d to_local = glm::inverse(instance.to_world);
    const LocalRay ray{Vec3d(to_local * Vec4d(origin, 1.0)),
                       Vec3d(to_local * Vec4d(direction, 0.0))};
    const auto take = [&](const Crossing& found, std::uint32_t material) {
      if (!(found.distance_m > from_m && found.distance_m < far_m)) return;
      const bool is_front = glm::dot(found.normal, ray.direction) < 0.0;
      if (!counts(scene_.materials[material], is_front)) return;
      far_m = found.distance_m;
      const Vec3d normal = glm::transpose(Mat3d(to_local)) * found.normal;
      nearest = FoundSurface{far_m, i, material, glm::normalize(normal), is_front};
    };
    if (const auto* index = std::get_if<std::uint32_t>(&instance.what)) {
      const Mesh& mesh = scene_.meshes[*index];
      for (const auto& corners : mesh.triangles) {
        const auto found =
            crossing(ray, Vec3d(mesh.positions[corners[0]]), Vec3d(mesh.positions[corners[1]]),
                     Vec3d(mesh.positions[corners[2]]));
        if (found) take(*found, mesh.material);
      }
      continue;
    }
    const Shape& shape = std::get<Shape>(instance.what);
    const std::vector<Crossing> found = std::visit(
        [&ray](const auto& geometry) { return crossings(ray, geometry); }, shape.geometry);
    for (const Crossing& one : found) take(one, shape.material);
  }
  return nearest;
}

}  // namespace abbe
