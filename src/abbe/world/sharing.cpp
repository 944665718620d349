#include "abbe/world/sharing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <variant>

#include "abbe/accel/box_tree.h"
#include "abbe/accel/instances/bounds.h"
#include "abbe/accel/touching.h"

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

Box3f rounded(const Box3d& box) {
  Box3f out;
  if (box.is_empty()) return out;
  for (int axis = 0; axis < 3; ++axis) {
    out.low[axis] = std::nextafter(static_cast<float>(box.low[axis]), -kInfinity);
    out.high[axis] = std::nextafter(static_cast<float>(box.high[axis]), kInfinity);
  }
  return out;
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

// An instance that may share the data of its mesh.
struct Candidate {
  std::uint32_t instance;
  const std::vector<Box3f>* parts;  // Of its mesh, in mesh space.
  bool is_glass;
};

// Contacts are found among primitives in the world: glass that may be in contact with something has
// its own, and what it may be in contact with has, too.
class ContactFinder {
 public:
  ContactFinder(const Scene& scene, std::vector<Candidate> candidates)
      : scene_(scene), candidates_(std::move(candidates)), is_near_(candidates_.size(), 0) {
    const Box3d all = bounds_of(scene);
    const Vec3d farthest = glm::max(glm::abs(all.low), glm::abs(all.high));
    margin_m_ = static_cast<float>(1e-6 * (farthest.x + farthest.y + farthest.z));
    for (const Candidate& candidate : candidates_) {
      boxes_.push_back(grown(bounds_at(*candidate.parts, candidate)));
      is_any_glass_ = is_any_glass_ || candidate.is_glass;
    }
    tree_.build(boxes_);
  }

  // By instance, whether it may touch something that matters.
  std::vector<bool> find() {
    std::vector<bool> is_candidate(scene_.instances.size(), false);
    for (const Candidate& candidate : candidates_) is_candidate[candidate.instance] = true;
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
      if (!is_candidate[i]) meet(scene_.instances[i]);
    }
    for (std::uint32_t i = 0; i < candidates_.size(); ++i) {
      if (candidates_[i].is_glass) meet_candidates(i);
      if (candidates_[i].is_glass && touches_itself(candidates_[i])) is_near_[i] = 1;
    }
    std::vector<bool> found(scene_.instances.size(), false);
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      found[candidates_[i].instance] = is_near_[i] != 0;
    }
    return found;
  }

 private:
  Box3f grown(Box3f box) const {
    box.low -= margin_m_;
    box.high += margin_m_;
    return box;
  }

  Box3f bounds_at(std::span<const Box3f> boxes, const Candidate& candidate) const {
    const Mat4d& to_world = scene_.instances[candidate.instance].to_world;
    return abbe::bounds_at(boxes, Mat3d(to_world), Vec3d(to_world[3]));
  }

  // Whether a part of a candidate overlaps a box.
  bool comes_into(const Candidate& candidate, const Box3f& box) const {
    return std::any_of(candidate.parts->begin(), candidate.parts->end(), [&](const Box3f& part) {
      return overlap(grown(bounds_at({&part, 1}, candidate)), box);
    });
  }

  // What has primitives of its own.
  void meet(const Instance& instance) {
    const auto* number = std::get_if<std::uint32_t>(&instance.what);
    const std::uint32_t material = number != nullptr ? scene_.meshes[*number].material
                                                     : std::get<Shape>(instance.what).material;
    const bool is_glass = lets_light_in(scene_.materials[material]);
    if (!is_glass && !is_any_glass_) return;
    const auto meet_box = [&](const Box3f& box) {
      tree_.for_each_overlapping(box, [&](std::uint32_t i) {
        if (is_near_[i] == 0 && (is_glass || candidates_[i].is_glass) &&
            comes_into(candidates_[i], box)) {
          is_near_[i] = 1;
        }
      });
    };
    const Box3f whole = rounded(bounds_of(scene_, instance));
    if (number == nullptr) {
      meet_box(whole);
      return;
    }
    bool is_far = true;
    tree_.for_each_overlapping(whole, [&](std::uint32_t) { is_far = false; });
    if (is_far) return;
    const Mesh& mesh = scene_.meshes[*number];
    for (const auto& triangle : mesh.triangles) {
      Box3d box;
      for (const std::uint32_t corner : triangle) {
        const Vec3d place(instance.to_world * Vec4d(Vec3d(mesh.positions[corner]), 1.0));
        box.extend({place, place});
      }
      meet_box(rounded(box));
    }
  }

  void meet_candidates(std::uint32_t glass) {
    std::vector<Box3f> own;  // Of its parts in the world.
    tree_.for_each_overlapping(boxes_[glass], [&](std::uint32_t other) {
      if (other == glass || (is_near_[other] != 0 && is_near_[glass] != 0)) return;
      if (own.empty()) {
        for (const Box3f& part : *candidates_[glass].parts) {
          own.push_back(grown(bounds_at({&part, 1}, candidates_[glass])));
        }
      }
      if (std::any_of(own.begin(), own.end(),
                      [&](const Box3f& box) { return comes_into(candidates_[other], box); })) {
        is_near_[glass] = is_near_[other] = 1;
      }
    });
  }

  // Whether pieces of its own mesh are in contact.
  bool touches_itself(const Candidate& candidate) {
    const Instance& instance = scene_.instances[candidate.instance];
    const Mat3d back = glm::inverse(Mat3d(instance.to_world));
    double largest = 0.0;
    for (int column = 0; column < 3; ++column) {
      largest += glm::dot(back[column], back[column]);
    }
    // In steps of a factor of 2, so that most instances ask for the same.
    const int exponent = std::ilogb(std::max(margin_m_ * std::sqrt(largest), 1e-30)) + 1;
    const std::uint32_t number = std::get<std::uint32_t>(instance.what);
    const auto [known, is_new] = touches_itself_.try_emplace({number, exponent}, false);
    if (is_new) {
      const Mesh& mesh = scene_.meshes[number];
      const std::vector<std::uint32_t> surface(mesh.triangles.size(), 0);
      const std::uint8_t matters = 1;
      known->second =
          !find_touching({.positions = mesh.positions, .triangles = mesh.triangles}, surface,
                         {&matters, 1}, static_cast<float>(std::ldexp(1.0, exponent)))
               .empty();
    }
    return known->second;
  }

  const Scene& scene_;
  std::vector<Candidate> candidates_;
  std::vector<std::uint8_t> is_near_;  // Per candidate.
  std::vector<Box3f> boxes_;
  BoxTree tree_;
  float margin_m_ = 0.0f;
  bool is_any_glass_ = false;
  std::map<std::pair<std::uint32_t, int>, bool> touches_itself_;  // By mesh and margin.
};

// From so many on, triangles that are not shared after all are worth a line.
constexpr std::size_t kWorthALine = std::size_t{1} << 20;

}  // namespace

std::vector<SharedMesh> find_shared_meshes(const Scene& scene, const SharingRule& rule,
                                           std::span<const std::uint8_t> ends_light, Notes& notes) {
  std::map<std::pair<std::uint32_t, bool>, std::vector<std::uint32_t>> groups;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const auto* number = std::get_if<std::uint32_t>(&instance.what);
    if (number == nullptr || !is_usable(instance.to_world)) continue;
    if (scene.meshes[*number].triangles.size() < rule.least_triangles) continue;
    // Of exact light, rays start at faces that were computed in the world.
    if (!ends_light.empty() && ends_light[i] != 0) continue;
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

  std::map<std::uint32_t, std::vector<Box3f>> parts;  // By mesh.
  std::vector<Candidate> candidates;
  for (const auto& [key, instances] : groups) {
    const Mesh& mesh = scene.meshes[key.first];
    const auto [of_mesh, is_new] = parts.try_emplace(key.first);
    if (is_new) of_mesh->second = boxes_of_parts(mesh.positions, mesh.triangles);
    const bool is_glass = lets_light_in(scene.materials[mesh.material]);
    for (const std::uint32_t instance : instances) {
      candidates.push_back({instance, &of_mesh->second, is_glass});
    }
  }
  const std::vector<bool> is_near = ContactFinder(scene, std::move(candidates)).find();
  std::vector<SharedMesh> shared;
  for (auto& [key, instances] : groups) {
    const Mesh& mesh = scene.meshes[key.first];
    const std::size_t all = instances.size();
    std::erase_if(instances, [&](std::uint32_t number) { return is_near[number]; });
    const bool is_shared = is_worth_it(key.first, instances.size());
    const std::size_t own = (is_shared ? all - instances.size() : all) * mesh.triangles.size();
    if (own >= kWorthALine) {
      notes.info(mesh.name.empty() ? "" : "mesh \"" + mesh.name + "\"",
                 fmt::format("{} of its {} places are in contact with transparent surfaces, or are "
                             "transparent and in contact with others: these do not share it, and "
                             "take {:.3g} million triangles",
                             is_shared ? all - instances.size() : all, all,
                             static_cast<double>(own) * 1e-6));
    }
    if (!is_shared) continue;
    shared.push_back({key.first, key.second, center_of(parts[key.first]), std::move(instances)});
  }
  return shared;
}

}  // namespace abbe
