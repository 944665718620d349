/// Shadow rays of neighbours become packets, lamp by lamp.
#include "abbe/integrate/light/coherent_shadow_rays.h"

#include <gtest/gtest.h>

#include <bit>
#include <vector>

namespace abbe {
namespace {

TEST(CoherentShadowRays, rays_to_a_lamp_are_packed_in_their_order_and_the_rest_stays_single) {
  // Two lamps in turn, and every fifth ray without one.
  std::vector<Ray> rays;
  std::vector<std::uint32_t> lamps;
  for (std::uint32_t i = 0; i < 100; ++i) {
    rays.push_back({Vec3f(static_cast<float>(i)), 1.0f + static_cast<float>(i), {0, 0, 1}});
    lamps.push_back(i % 5 == 4 ? kIncoherent : i % 2);
  }
  CoherentShadowRays coherent;
  for (int round = 0; round < 2; ++round) {  // The second time it has old memory.
    coherent.sort(rays, lamps, 2);
    ASSERT_EQ(coherent.others.size(), 20u);
    for (std::size_t i = 0; i < 20; ++i) {
      EXPECT_EQ(coherent.other_numbers[i], 5 * i + 4);
      EXPECT_EQ(coherent.others[i].origin.x, static_cast<float>(5 * i + 4));
    }
    // Forty rays to each lamp: two full packets and one of eight.
    ASSERT_EQ(coherent.packets.size(), 6u);
    std::vector<int> met(rays.size(), 0);
    std::size_t lanes = 0;
    for (std::size_t p = 0; p < 6; ++p) {
      const RayPacket& packet = coherent.packets[p];
      const int count = std::popcount(packet.active);
      EXPECT_EQ(packet.active, (1u << count) - 1u);
      lanes += static_cast<std::size_t>(count);
      std::uint32_t before = 0;
      for (std::size_t lane = 0; lane < static_cast<std::size_t>(count); ++lane) {
        const std::uint32_t number = coherent.numbers[p * kPacketLanes + lane];
        ++met[number];
        EXPECT_EQ(lamps[number], lamps[coherent.numbers[p * kPacketLanes]]);
        EXPECT_TRUE(lane == 0 || number > before);
        EXPECT_EQ(packet.origin_x[lane], rays[number].origin.x);
        EXPECT_EQ(packet.t_max[lane], rays[number].t_max);
        before = number;
      }
      // Lanes that take no part are numbers all the same.
      for (std::size_t lane = static_cast<std::size_t>(count); lane < kPacketLanes; ++lane) {
        EXPECT_EQ(packet.direction_z[lane], 1.0f);
      }
    }
    EXPECT_EQ(lanes, 80u);
    for (std::size_t i = 0; i < met.size(); ++i) EXPECT_EQ(met[i], i % 5 == 4 ? 0 : 1);
  }
}

}  // namespace
}  // namespace abbe
