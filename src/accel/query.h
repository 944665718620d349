/// Questions to an accelerator and their answers, one ray or sixteen at a time.
#pragma once

#include <cstdint>
#include <limits>

#include "accel/shapes.h"
#include "math/ray.h"

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
};

/// Answers of a packet; lanes that were not active or met nothing have kNoPrimitive.
struct alignas(64) HitPacket {
  float t[kPacketLanes];
  float u[kPacketLanes];
  float v[kPacketLanes];
  std::uint32_t primitive[kPacketLanes];
};

/// Work done by queries, for heat maps and tuning.
struct QueryCost {
  std::uint64_t nodes = 0;
  std::uint64_t primitives = 0;
};

}  // namespace abbe
