/// The rays of a packet, or of two, as leaf tests read them.
#pragma once

#include <cstdint>

#include "abbe/accel/leaf/shear.h"
#include "abbe/accel/query.h"

namespace abbe {

/// Lanes of a packet whose directions have the same longest component.
struct ShearGroup {
  ShearAxes axes;
  std::uint32_t lanes = 0;
};

/// What the rays of a packet or of two have met, as HitPacket has it.
template <int kLanes>
struct alignas(64) HitLanes {
  float t[kLanes], u[kLanes], v[kLanes];
  std::uint32_t primitive[kLanes];
};

/// Sixteen rays, or the thirty-two of two packets, and what they have met so far.
template <int kWidth>
struct alignas(64) PacketRays {
  static constexpr int kLanes = kWidth;

  float origin[3][kLanes];
  float direction[3][kLanes];
  float shear_x[kLanes], shear_y[kLanes], shear_z[kLanes];  ///< As ShearedRay has them.
  HitLanes<kLanes> hits;  ///< hits.t shrinks; lanes that are done or not active have −infinity.
};

}  // namespace abbe
