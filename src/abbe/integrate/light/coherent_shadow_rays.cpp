#include "abbe/integrate/light/coherent_shadow_rays.h"

#include <bit>

namespace abbe {

void CoherentShadowRays::sort(std::span<const Ray> rays, std::span<const std::uint32_t> lamps,
                              std::size_t lamp_count) {
  packets.clear();
  numbers.clear();
  others.clear();
  other_numbers.clear();
  open_.assign(lamp_count, 0);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto number = static_cast<std::uint32_t>(i);
    if (lamps[i] == kIncoherent) {
      others.push_back(rays[i]);
      other_numbers.push_back(number);
      continue;
    }
    std::uint32_t& open = open_[lamps[i]];
    if (open == 0) {
      RayPacket& packet = packets.emplace_back();
      // Lanes without a ray are inactive, but have to be numbers.
      for (int lane = 0; lane < kPacketLanes; ++lane) set_ray(packet, lane, rays[i]);
      packet.active = 0;
      numbers.resize(numbers.size() + kPacketLanes);
      open = static_cast<std::uint32_t>(packets.size());
    }
    RayPacket& packet = packets[open - 1];
    const int lane = std::popcount(packet.active);
    set_ray(packet, lane, rays[i]);
    packet.active |= 1u << lane;
    numbers[(open - 1) * kPacketLanes + static_cast<std::size_t>(lane)] = number;
    if (lane + 1 == kPacketLanes) open = 0;
  }
}

}  // namespace abbe
