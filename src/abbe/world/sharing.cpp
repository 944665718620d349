#include "abbe/world/sharing.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <variant>

#include "abbe/accel/box_tree.h"
#include "abbe/accel/instances/bounds.h"

namespace abbe {
namespace {

// Maps that stretch one way more than this times another lose as many digits of a ray.
constexpr double kMostStretch = 1e3;
// Scales beyond leave the range in which single precision computes areas.
constexpr double kMostScale = 1e6;

bool is_usable(const Mat4d& to_world) {
  const Mat3d linear(to_world);
  const Mat3d inverse = glm::inverse(linear);
  double largest = 0.0, largest_back = 0.0;
  for (int column = 0; column < 3; ++column) {
    largest += glm::dot(linear[column], linear[column]);
    largest_back += glm::dot(inverse[column], inverse[column]);
  }
  largest = std::sqrt(largest);
  largest_back = std::sqrt(largest_back);
  const Vec3d place(to_world[3]);
  return std::isfinite(largest_back) && std::isfinite(glm::dot(place, place)) &&
         largest * largest_back <= kMostStretch && largest <= kMostScale &&
         largest_back <= kMostScale;
}

// Light goes through it: what touches it has to be found.
bool lets_light_in(const Material& material) {
  return material.transmission > 0.0f || material.has_volume;
}

bool shines(const Material& material) {
  return material.emission || material.emissive_rec709 != Vec3f(0.0f);
}

Box3f rounded(const Box3d& box) {
  Box3f out;
  if (box.is_empty()) return out;
  for (int axis = 0; axis < 3; ++axis) {
    out.low[axis] = std::nextafter(static_cast<float>(box.low[axis]), -kInfinity);
    out.high[axis] = std::nextafter(static_cast<float>(box.high[axis]), kInfinity);
  }
  return out;
}

// The boxes of what lets light in: of triangles, or of a whole exact shape.
std::vector<Box3f> boxes_of_glass(const Scene& scene) {
  std::vector<Box3f> boxes;
  for (const Instance& instance : scene.instances) {
    const auto* number = std::get_if<std::uint32_t>(&instance.what);
    const std::uint32_t material = number != nullptr ? scene.meshes[*number].material
                                                     : std::get<Shape>(instance.what).material;
    if (!lets_light_in(scene.materials[material])) continue;
    if (number == nullptr) {
      boxes.push_back(rounded(bounds_of(scene, instance)));
      continue;
    }
    const Mesh& mesh = scene.meshes[*number];
    for (const auto& triangle : mesh.triangles) {
      Box3d box;
      for (const std::uint32_t corner : triangle) {
        const Vec3d place(instance.to_world * Vec4d(Vec3d(mesh.positions[corner]), 1.0));
        box.extend({place, place});
      }
      boxes.push_back(rounded(box));
    }
  }
  return boxes;
}

// Zero, unless the mesh lies far from its origin for its size.
Vec3d center_of(std::span<const Box3f> parts) {
  Box3f box;
  for (const Box3f& part : parts) box.extend(part);
  const Vec3f size = box.size();
  const Vec3f far = glm::max(glm::abs(box.low), glm::abs(box.high));
  const bool is_far = std::max({far.x, far.y, far.z}) > 4.0f * std::max({size.x, size.y, size.z});
  return is_far ? Vec3d(box.center()) : Vec3d(0.0);
}

}  // namespace

std::vector<SharedMesh> find_shared_meshes(const Scene& scene, const SharingRule& rule) {
  std::map<std::pair<std::uint32_t, bool>, std::vector<std::uint32_t>> groups;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const auto* number = std::get_if<std::uint32_t>(&instance.what);
    if (number == nullptr || !is_usable(instance.to_world)) continue;
    const Mesh& mesh = scene.meshes[*number];
    const Material& material = scene.materials[mesh.material];
    if (mesh.triangles.size() < rule.least_triangles || lets_light_in(material) ||
        shines(material)) {
      continue;
    }
    const bool is_mirrored = glm::determinant(Mat3d(instance.to_world)) < 0.0;
    groups[{*number, is_mirrored}].push_back(static_cast<std::uint32_t>(i));
  }
  const auto is_worth_it = [&](std::uint32_t mesh, std::size_t instances) {
    return instances > 1 &&
           (instances - 1) * scene.meshes[mesh].triangles.size() >= rule.least_saved_triangles;
  };
  std::erase_if(groups, [&](const auto& group) {
    return !is_worth_it(group.first.first, group.second.size());
  });
  if (groups.empty()) return {};

  const std::vector<Box3f> glass = boxes_of_glass(scene);
  BoxTree of_glass;
  of_glass.build(glass);
  const Box3d all = bounds_of(scene);
  const Vec3d farthest = glm::max(glm::abs(all.low), glm::abs(all.high));
  const auto margin_m = static_cast<float>(1e-6 * (farthest.x + farthest.y + farthest.z));
  std::vector<SharedMesh> shared;
  for (auto& [key, instances] : groups) {
    const Mesh& mesh = scene.meshes[key.first];
    const std::vector<Box3f> parts = boxes_of_parts(mesh.positions, mesh.triangles);
    std::erase_if(instances, [&](std::uint32_t number) {
      const Mat4d& to_world = scene.instances[number].to_world;
      Box3f box = bounds_at(parts, Mat3d(to_world), Vec3d(to_world[3]));
      box.low -= margin_m;
      box.high += margin_m;
      bool is_near = false;
      of_glass.for_each_overlapping(box, [&](std::uint32_t) { is_near = true; });
      return is_near;
    });
    if (!is_worth_it(key.first, instances.size())) continue;
    shared.push_back({key.first, key.second, center_of(parts), std::move(instances)});
  }
  return shared;
}

}  // namespace abbe
