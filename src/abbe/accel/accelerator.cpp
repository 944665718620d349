#include "abbe/accel/accelerator.h"

#include <algorithm>
#include <array>

#include "abbe/accel/brute/brute_force.h"
#include "abbe/accel/instances/placed_meshes.h"
#include "abbe/accel/kd/tree.h"
#include "abbe/base/error.h"

namespace abbe {
namespace {

constexpr auto kLanes = static_cast<std::size_t>(kPacketLanes);

// The rays of packets. Those that take no part have no length, and meet nothing.
std::vector<Ray> rays_of(std::span<const RayPacket> packets) {
  std::vector<Ray> rays;
  rays.reserve(kLanes * packets.size());
  for (const RayPacket& packet : packets) {
    for (int lane = 0; lane < kPacketLanes; ++lane) {
      const bool is_active = (packet.active >> lane & 1u) != 0;
      rays.push_back(is_active ? ray_of(packet, lane) : Ray{Vec3f(0.0f), 0.0f});
    }
  }
  return rays;
}

// What is known by name: another accelerator is a folder beside these two, and a line here. Tests
// of hits then run over it too.
struct Kind {
  const char* name;
  std::unique_ptr<const Accelerator> (*build)(const ShapeSpans&);
};

const std::array<Kind, 2> kKinds{{
    {"kdtree",
     [](const ShapeSpans& shapes) -> std::unique_ptr<const Accelerator> {
       return std::make_unique<const KdTree>(KdTree::build(shapes));
     }},
    {"brute",
     [](const ShapeSpans& shapes) -> std::unique_ptr<const Accelerator> {
       return std::make_unique<const BruteForce>(shapes);
     }},
}};

}  // namespace

void Accelerator::closest_hits(std::span<const RayPacket> packets, QueryMask mask,
                               std::span<HitPacket> hits) const {
  const std::vector<Ray> rays = rays_of(packets);
  std::vector<Hit> found(rays.size());
  closest_hits(std::span<const Ray>(rays), mask, std::span<Hit>(found));
  for (std::size_t i = 0; i < rays.size(); ++i) {
    HitPacket& to = hits[i / kLanes];
    to.t[i % kLanes] = found[i].t;
    to.u[i % kLanes] = found[i].u;
    to.v[i % kLanes] = found[i].v;
    to.primitive[i % kLanes] = found[i].primitive;
  }
}

void Accelerator::any_hits(std::span<const RayPacket> packets, QueryMask mask,
                           std::span<std::uint32_t> occluded) const {
  const std::vector<Ray> rays = rays_of(packets);
  std::vector<std::uint8_t> found(rays.size());
  any_hits(std::span<const Ray>(rays), mask, std::span<std::uint8_t>(found));
  std::fill_n(occluded.begin(), packets.size(), 0u);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    occluded[i / kLanes] |= static_cast<std::uint32_t>(found[i]) << (i % kLanes);
  }
}

void Accelerator::all_hits(std::span<const RayPacket> packets, QueryMask mask, VisibilityMask stops,
                           HitLists& hits) const {
  all_hits(std::span<const Ray>(rays_of(packets)), mask, stops, hits);
}

const std::vector<std::string>& accelerator_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    all.reserve(kKinds.size());
    for (const Kind& kind : kKinds) all.emplace_back(kind.name);
    return all;
  }();
  return names;
}

std::unique_ptr<const Accelerator> build_accelerator(std::string_view name,
                                                     const ShapeSpans& shapes) {
  const auto build =
      kKinds[check_choice("accelerator", std::string(name), "an accelerator", accelerator_names())]
          .build;
  if (shapes.places.empty()) return build(shapes);
  return std::make_unique<const PlacedMeshes>(shapes, build);
}

}  // namespace abbe
