/// Shadow rays of a batch of fans, and the light that waits for them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "abbe/accel/query.h"
#include "abbe/base/aligned.h"
#include "abbe/integrate/fan.h"
#include "abbe/integrate/light/coherent_shadow_rays.h"

namespace abbe {

/// Light on its way to lanes that wait to know whether it is blocked.
struct ShadowJob {
  std::uint32_t sample = 0;
  std::uint32_t data = 0;  ///< Offset of the light per lane, then of the visibility per lane.
  std::uint32_t first_query = 0;  ///< Index of its ray, or of its first packet.
  std::uint32_t record = 0;       ///< 1 + number of the record it belongs to.
  LaneMask lanes;                 ///< Lanes that any light can reach.
  MediumStack media;
  FanOrigin first_turn = FanOrigin::Camera;
  bool spread = false;
  bool ends_at_glass = false;  ///< Flat glass blocks it: that light comes on chains.
  /// A part of a chain's path that only multiplies the visibility of another job, of this data.
  std::optional<std::uint32_t> gate_of;
};

/// Ways on which something may stand, one query each, and whether something opaque does.
struct ShadowQueries {
  std::vector<Ray> rays;
  std::vector<std::uint32_t> ray_lamps;  ///< Per ray, as CoherentShadowRays has it.
  std::vector<std::uint8_t> ray_occluded;
  std::vector<RayPacket> packets;
  std::vector<std::uint32_t> packet_occluded;
};

/// What stops shadow rays of a kind for good, and what may let them by weakened.
inline VisibilityMask blocking_bits(bool ends_at_glass) {
  return ends_at_glass ? kOpaqueBit | kExactGlassBit : kOpaqueBit;
}
inline VisibilityMask passing_bits(bool ends_at_glass) {
  return ends_at_glass ? kTransparentBit : kTransparentBit | kExactGlassBit;
}

/// Light that waits for its shadow rays: the working memory of a batch.
struct ShadowBuffers {
  std::vector<ShadowJob> jobs;
  AlignedVector<float> data;  ///< Light and visibility of the jobs.
  /// Of paths that pass exact glass, and that end there.
  std::array<ShadowQueries, 2> queries;
  CoherentShadowRays coherent;
  AlignedVector<float> direct_light;  ///< What has arrived, per sample and lane.

  ShadowQueries& queries_of(const ShadowJob& job) { return queries[job.ends_at_glass]; }
  const ShadowQueries& queries_of(const ShadowJob& job) const { return queries[job.ends_at_glass]; }
};

}  // namespace abbe
