/// What makes fans.
#pragma once

#include <cstddef>
#include <cstdint>

namespace abbe {

/// What led to a fan; also its place in the path word that random numbers belong to.
enum class FanOrigin : std::uint8_t { Camera, Reflected, Refracted, Passed };

/// Most coherent lobes that a surface has, each a child of the fan that meets it: glass has two,
/// reflection and refraction, and a polished clearcoat on it a third.
inline constexpr std::size_t kMaxLobes = 3;

}  // namespace abbe
