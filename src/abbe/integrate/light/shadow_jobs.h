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

/// What flat glass does to a shadow ray.
enum class AtGlass : std::uint8_t {
  Passes,   ///< It goes on, weakened: no chains bring this light.
  Ends,     ///< Its light comes on chains, or it is a part of one.
  Counts,   ///< So it does through as many facets as chains have; through more it passes.
  Ignores,  ///< Only what lies on it counts: light of a chain goes through it there.
};
inline constexpr std::size_t kAtGlassRules = 4;

/// Where a shadow ray ends short of a surface that shines: by 1e-5 of its length, and by
/// `rounding_m` over its cosine.
struct ShadowEnd {
  std::uint32_t surface = 0;
  Vec3f normal{0.0f};
  float rounding_m = 0.0f;
};

/// Light on its way to lanes that wait to know whether it is blocked.
struct ShadowJob {
  std::uint32_t sample = 0;
  std::uint32_t data = 0;  ///< Offset of the light per lane, then of the visibility per lane.
  std::uint32_t first_query = 0;  ///< Index of its ray, or of its first packet.
  std::uint32_t record = 0;       ///< 1 + number of the record it belongs to.
  LaneMask lanes;                 ///< Lanes that any light can reach.
  MediumStack media;
  Departure departure;  ///< From a surface with something nearby on the side of the light.
  FanOrigin first_turn = FanOrigin::Camera;
  bool spread = false;
  bool is_unbent = false;  ///< Its light ends where the eye's rays would not go on straight.
  /// Where it ends, if at a surface that shines: what lies on that counts for such light, too.
  std::optional<ShadowEnd> ends_on;
  AtGlass at_glass = AtGlass::Passes;
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
inline VisibilityMask blocking_bits(AtGlass at_glass) {
  return at_glass == AtGlass::Ends ? kOpaqueBit | kExactGlassBit : kOpaqueBit;
}
inline VisibilityMask passing_bits(AtGlass at_glass) {
  const bool is_met = at_glass == AtGlass::Passes || at_glass == AtGlass::Counts;
  return is_met ? kTransparentBit | kExactGlassBit : kTransparentBit;
}

/// Light that waits for its shadow rays: the working memory of a batch.
struct ShadowBuffers {
  std::vector<ShadowJob> jobs;
  AlignedVector<float> data;                         ///< Light and visibility of the jobs.
  std::array<ShadowQueries, kAtGlassRules> queries;  ///< By AtGlass.
  CoherentShadowRays coherent;
  AlignedVector<float> direct_light;  ///< What has arrived, per sample and lane.

  ShadowQueries& queries_of(const ShadowJob& job) {
    return queries[static_cast<std::size_t>(job.at_glass)];
  }
  const ShadowQueries& queries_of(const ShadowJob& job) const {
    return queries[static_cast<std::size_t>(job.at_glass)];
  }
};

}  // namespace abbe
