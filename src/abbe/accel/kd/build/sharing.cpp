#include "abbe/accel/kd/build/sharing.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

namespace abbe {
namespace {

using PositionBits = std::array<std::uint32_t, 3>;

// Spreads the bits of a position so that its lowest ones depend on all of them.
std::uint32_t mix(const PositionBits& bits) {
  std::uint64_t h = bits[0];
  for (const std::uint32_t b : bits) {
    h = (h ^ b) * 0x9e3779b97f4a7c15u;
    h ^= h >> 32;
  }
  return static_cast<std::uint32_t>(h);
}

}  // namespace

double triangles_per_vertex(const ShapeSpans& shapes) {
  constexpr std::uint32_t kSampled = 64;
  constexpr std::size_t kEnough = 64;
  constexpr double kOfMeshes = 6.0;
  std::vector<PositionBits> seen;
  for (const Triangle& triangle : shapes.triangles) {
    for (const std::uint32_t corner : triangle) {
      const auto bits = std::bit_cast<PositionBits>(shapes.positions[corner]);
      if (mix(bits) % kSampled == 0) seen.push_back(bits);
    }
  }
  if (seen.size() < kEnough) return kOfMeshes;
  const auto corners = static_cast<double>(seen.size());
  std::sort(seen.begin(), seen.end());
  seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
  return corners / static_cast<double>(seen.size());
}

}  // namespace abbe
