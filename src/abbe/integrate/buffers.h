/// The working memory of one integrating thread.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "abbe/accel/query.h"
#include "abbe/base/aligned.h"
#include "abbe/caustics/flat/light/known_misses.h"
#include "abbe/integrate/fan.h"
#include "abbe/integrate/integrator.h"
#include "abbe/integrate/light/shadow_jobs.h"

namespace abbe {

struct IntegratorScratch::Buffers {
  std::vector<FanList> spare_lists;

  // Closest-hit queries of a batch of fans.
  std::vector<Ray> rays;
  std::vector<Hit> hits;
  std::vector<RayPacket> packets;
  std::vector<HitPacket> packet_hits;
  std::vector<std::uint32_t> first_query;  ///< Per fan of the batch.
  // Where surfaces may touch: what is there besides the surface that was met, the first nothing;
  // and its number per hit, and per lane of the packets.
  std::vector<Contact> contacts;
  std::vector<std::uint32_t> hit_contacts;
  AlignedVector<std::uint32_t> lane_contacts;

  ShadowBuffers shadows;
  KnownMisses misses;
  AlignedVector<float> local_light;  ///< Emission and ambient light, per sample and lane.
  /// The number of the material that each sample's camera ray begins in.
  std::vector<std::optional<std::uint32_t>> camera_media;
};

}  // namespace abbe
