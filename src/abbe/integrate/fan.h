/// Fans: what one camera sample has become, one ray per wavelength lane.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "abbe/accel/query.h"
#include "abbe/base/aligned.h"
#include "abbe/integrate/fan_origin.h"
#include "abbe/integrate/surface/contact.h"
#include "abbe/integrate/surface/media.h"
#include "abbe/math/lane_mask.h"
#include "abbe/math/random.h"
#include "abbe/math/vec.h"

namespace abbe {

/// A set of rays, one per lane: united (one ray, all lanes) or spread (a ray per lane).
///
/// Throughputs are basic: radiance over the square of the index of its medium. Basic radiance is
/// conserved at a refraction, so that k_r + k_t ≤ 1 bounds the weights of children inside glass,
/// too; light added inside a medium is divided by n² there instead.
struct Fan {
  Vec3f origin{0.0f};     ///< Of a united fan.
  Vec3f direction{0.0f};  ///< Of a united fan; unit length.
  LaneMask lanes;
  std::uint64_t path = kCameraPath;  ///< What happened since the camera (math/random.h).
  std::uint32_t sample = 0;          ///< Which camera sample of the wave.
  std::uint32_t data = 0;            ///< Offset of its lanes in the list's pool.
  float weight = 1.0f;               ///< Σ throughput × luminance weight.
  float path_length_m = 0.0f;
  std::uint16_t depth = 0;
  FanOrigin made_by = FanOrigin::Camera;
  FanOrigin first_turn = FanOrigin::Camera;  ///< Reflected or refracted at the first surface.
  bool spread = false;
  bool common_origin = false;
  /// The exact shape that all its rays begin in, if that is known.
  std::uint32_t inside = kNoPrimitive;
  Departure departure;  ///< From a surface with something nearby: origins are on it.
  MediumStack media;
  std::uint32_t parent_record = 0;  ///< For probes: 1 + number of the record that led here.
};

/// Fans with their lanes: throughput for every fan, then origin x, y, z and direction x, y, z for
/// spread ones, each lane_stride floats.
struct FanList {
  std::vector<Fan> fans;
  AlignedVector<float> pool;

  static constexpr std::size_t kUnitedArrays = 1;
  static constexpr std::size_t kSpreadArrays = 7;

  void clear() {
    fans.clear();
    pool.clear();
  }
  /// Makes room for the lanes of the fan to be appended next; returns their offset.
  std::uint32_t reserve_lanes(bool spread, int lane_stride) {
    const std::size_t offset = pool.size();
    pool.resize(offset +
                (spread ? kSpreadArrays : kUnitedArrays) * static_cast<std::size_t>(lane_stride));
    return static_cast<std::uint32_t>(offset);
  }
  std::size_t bytes() const {
    return fans.capacity() * sizeof(Fan) + pool.capacity() * sizeof(float);
  }
};

}  // namespace abbe
