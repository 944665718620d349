/// Coherent shadow rays as packets: those of neighbouring pixels go to a lamp nearly in parallel.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "abbe/accel/query.h"

namespace abbe {

/// Instead of the number of a lamp: a ray that has no neighbour.
inline constexpr std::uint32_t kIncoherent = ~std::uint32_t{0};

/// Rays sorted by whether they have neighbours. Keeps its memory between calls.
struct CoherentShadowRays {
  std::vector<RayPacket> packets;  ///< Each to one lamp, in the order of the rays.
  std::vector<std::uint32_t> packet_occluded;
  std::vector<std::uint32_t> numbers;  ///< Of the rays: sixteen for each packet.
  std::vector<Ray> others;
  std::vector<std::uint8_t> other_occluded;
  std::vector<std::uint32_t> other_numbers;

  /// Shape:  a lamp for each ray: the same for rays that follow each other closely, or kIncoherent.
  /// Domain: lamps below lamp_count.
  void sort(std::span<const Ray> rays, std::span<const std::uint32_t> lamps,
            std::size_t lamp_count);

 private:
  std::vector<std::uint32_t> open_;  // Per lamp, 1 + the packet that has room for a ray.
};

}  // namespace abbe
