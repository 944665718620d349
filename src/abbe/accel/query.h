/// Questions to an accelerator and their answers, one ray or sixteen at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "abbe/accel/shapes.h"
#include "abbe/math/ray.h"

namespace abbe {

inline constexpr std::uint32_t kNoPrimitive = std::numeric_limits<std::uint32_t>::max();

/// Where a ray first meets a primitive.
/// Triangle: u, v are the barycentric weights of its second and third corner. Polyhedron: u is the
/// index of the face among its planes. Ellipsoid: u and v are 0.
struct Hit {
  float t = kInfinity;
  std::uint32_t primitive = kNoPrimitive;
  float u = 0.0f;
  float v = 0.0f;

  bool is_hit() const { return primitive != kNoPrimitive; }
};

inline constexpr int kPacketLanes = 16;

/// Up to sixteen rays in SIMD layout; lane i takes part when bit i of `active` is set.
/// With `common_origin` all active lanes start at the same point, which is told to the
/// accelerator because it is faster; the origin arrays are filled all the same.
struct alignas(64) RayPacket {
  float origin_x[kPacketLanes], origin_y[kPacketLanes], origin_z[kPacketLanes];
  float direction_x[kPacketLanes], direction_y[kPacketLanes], direction_z[kPacketLanes];
  float t_max[kPacketLanes];
  std::uint32_t active = 0;
  bool common_origin = false;
  /// A solid that all active lanes start in, if the caller knows one. The answers are the same, but
  /// may be found without a search.
  std::uint32_t inside = kNoPrimitive;
};

/// Writes one lane's ray; the packet's flags stay as they are.
inline void set_ray(RayPacket& packet, int lane, const Ray& ray) {
  packet.origin_x[lane] = ray.origin.x;
  packet.origin_y[lane] = ray.origin.y;
  packet.origin_z[lane] = ray.origin.z;
  packet.direction_x[lane] = ray.direction.x;
  packet.direction_y[lane] = ray.direction.y;
  packet.direction_z[lane] = ray.direction.z;
  packet.t_max[lane] = ray.t_max;
}

/// The ray in one lane.
inline Ray ray_of(const RayPacket& packet, int lane) {
  return {{packet.origin_x[lane], packet.origin_y[lane], packet.origin_z[lane]},
          packet.t_max[lane],
          {packet.direction_x[lane], packet.direction_y[lane], packet.direction_z[lane]}};
}

/// Answers of a packet; lanes that were not active or met nothing have kNoPrimitive.
struct alignas(64) HitPacket {
  float t[kPacketLanes];
  float u[kPacketLanes];
  float v[kPacketLanes];
  std::uint32_t primitive[kPacketLanes];
};

/// The answer in one lane.
inline Hit hit_of(const HitPacket& packet, int lane) {
  return {packet.t[lane], packet.primitive[lane], packet.u[lane], packet.v[lane]};
}

/// Lists of hits, one for each ray of a query, behind each other in one array: what is used again
/// and again allocates only while it grows.
class HitLists {
 public:
  void clear() {
    hits_.clear();
    ends_.clear();
  }
  /// Adds to the list that end_list() ends; the next one begins behind it.
  void add(const Hit& hit) { hits_.push_back(hit); }
  void end_list() { ends_.push_back(hits_.size()); }

  std::size_t size() const { return ends_.size(); }
  /// The list of a ray, counted from 0.
  std::span<const Hit> operator[](std::size_t ray) const {
    const std::size_t first = ray == 0 ? 0 : ends_[ray - 1];
    return {hits_.data() + first, ends_[ray] - first};
  }

 private:
  std::vector<Hit> hits_;
  std::vector<std::size_t> ends_;
};

/// Work done by queries, for heat maps and tuning.
struct QueryCost {
  std::uint64_t nodes = 0;
  std::uint64_t primitives = 0;
};

}  // namespace abbe
