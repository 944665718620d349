/// What makes fans.
#pragma once

#include <cstdint>

namespace abbe {

/// What led to a fan; also its place in the path word that random numbers belong to.
enum class FanOrigin : std::uint8_t { Camera, Reflected, Refracted, Passed };

}  // namespace abbe
