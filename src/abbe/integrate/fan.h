/// Fans: what one camera sample has become, one ray per wavelength lane.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "abbe/accel/query.h"
#include "abbe/base/aligned.h"
#include "abbe/integrate/fan_origin.h"
#include "abbe/integrate/surface/beam.h"
#include "abbe/integrate/surface/contact.h"
#include "abbe/integrate/surface/media.h"
#include "abbe/math/lane_mask.h"
#include "abbe/math/random.h"
#include "abbe/math/vec.h"

namespace abbe {

/// What the rays of a fan share with samples of light. They were drawn by the rough lobes of a
/// surface that shining surfaces and the environment were sampled for, too; what both may find
/// counts on either way by the balance heuristic (light/shared_light-inl.h).
struct SharedRays {
  // What light was sampled for.
  Vec3f place{0.0f};
  Vec3f normal{0.0f};          ///< Of its horizon; 0 where light comes from all around.
  float light_samples = 0.0f;  ///< Of shining surfaces, and as many of the environment.
  float environment = 0.0f;    ///< LightCells::Seen::total of what the normal sees.
  // Of a united fan; spread ones have them per lane.
  float per_sr = 0.0f;  ///< The density of its direction.
  float way_m = 0.0f;   ///< From the surface to the fan's origin.

  bool any() const { return light_samples > 0.0f; }
};

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
  SharedRays shared;
  std::uint32_t parent_record = 0;  ///< For probes: 1 + number of the record that led here.
};

/// Fans with their lanes: throughput for every fan, then origin x, y, z and direction x, y, z for
/// spread ones, then density and way where those share their rays; each lane_stride floats.
struct FanList {
  std::vector<Fan> fans;
  std::vector<Beam> beams;  ///< One per fan, where the world has textures: at its origin.
  AlignedVector<float> pool;

  static constexpr std::size_t kUnitedArrays = 1;
  static constexpr std::size_t kSpreadArrays = 7;
  static constexpr std::size_t kSharedArrays = 9;

  void clear() {
    fans.clear();
    beams.clear();
    pool.clear();
  }
  /// Makes room for the lanes of the fan to be appended next; returns their offset.
  std::uint32_t reserve_lanes(bool spread, bool shared, int lane_stride) {
    const std::size_t offset = pool.size();
    const std::size_t arrays = !spread ? kUnitedArrays : shared ? kSharedArrays : kSpreadArrays;
    pool.resize(offset + arrays * static_cast<std::size_t>(lane_stride));
    return static_cast<std::uint32_t>(offset);
  }
  /// The beam of one of its fans; null where none is needed.
  const Beam* beam_of(const Fan& fan) const {
    return beams.empty() ? nullptr : &beams[static_cast<std::size_t>(&fan - fans.data())];
  }
  /// The density of a fan's direction in a lane, and the way from the surface that drew it.
  /// Domain: fan.shared.any().
  float per_sr(const Fan& fan, int lane, int lane_stride) const {
    return fan.spread ? shared_of(fan, lane_stride)[lane] : fan.shared.per_sr;
  }
  float way_m(const Fan& fan, int lane, int lane_stride) const {
    return fan.spread ? shared_of(fan, lane_stride)[lane_stride + lane] : fan.shared.way_m;
  }
  std::size_t bytes() const {
    return fans.capacity() * sizeof(Fan) + beams.capacity() * sizeof(Beam) +
           pool.capacity() * sizeof(float);
  }

 private:
  const float* shared_of(const Fan& fan, int lane_stride) const {
    return pool.data() + fan.data + kSpreadArrays * static_cast<std::size_t>(lane_stride);
  }
};

}  // namespace abbe
