#include "abbe/accel/accelerator.h"

#include <array>

#include "abbe/accel/brute/brute_force.h"
#include "abbe/accel/kd/tree.h"
#include "abbe/base/error.h"

namespace abbe {
namespace {

constexpr auto kLanes = static_cast<std::size_t>(kPacketLanes);

// The rays of a packet. Those that take no part have no length, and meet nothing.
void unpack(const RayPacket& packet, Ray* rays) {
  for (int lane = 0; lane < kPacketLanes; ++lane) {
    const bool is_active = (packet.active >> lane & 1u) != 0;
    rays[lane] = is_active ? ray_of(packet, lane) : Ray{Vec3f(0.0f), 0.0f};
  }
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

void Accelerator::closest_hits(std::span<const RayPacket> packets, VisibilityMask mask,
                               std::span<HitPacket> hits) const {
  std::array<Ray, kLanes> rays;
  std::array<Hit, kLanes> found;
  for (std::size_t p = 0; p < packets.size(); ++p) {
    unpack(packets[p], rays.data());
    closest_hits(std::span<const Ray>(rays), mask, std::span<Hit>(found));
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      hits[p].t[lane] = found[lane].t;
      hits[p].u[lane] = found[lane].u;
      hits[p].v[lane] = found[lane].v;
      hits[p].primitive[lane] = found[lane].primitive;
    }
  }
}

void Accelerator::any_hits(std::span<const RayPacket> packets, VisibilityMask mask,
                           std::span<std::uint32_t> occluded) const {
  std::array<Ray, kLanes> rays;
  std::array<std::uint8_t, kLanes> found;
  for (std::size_t p = 0; p < packets.size(); ++p) {
    unpack(packets[p], rays.data());
    any_hits(std::span<const Ray>(rays), mask, std::span<std::uint8_t>(found));
    occluded[p] = 0;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      occluded[p] |= static_cast<std::uint32_t>(found[lane]) << lane;
    }
  }
}

void Accelerator::all_hits(std::span<const RayPacket> packets, VisibilityMask mask,
                           VisibilityMask stops, HitLists& hits) const {
  std::vector<Ray> rays(kLanes * packets.size());
  for (std::size_t p = 0; p < packets.size(); ++p) unpack(packets[p], rays.data() + kLanes * p);
  all_hits(std::span<const Ray>(rays), mask, stops, hits);
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
  for (const Kind& kind : kKinds) {
    if (name == kind.name) return kind.build(shapes);
  }
  throw_usage_error("accelerator", std::string(name), "an accelerator", accelerator_names());
}

}  // namespace abbe
