/// The lights of a scene, ready to shine, and all that depends on their kind. Vector code for them
/// is in world/light/lights-inl.h.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "abbe/base/constants.h"
#include "abbe/math/lane_array.h"
#include "abbe/math/vec.h"
#include "abbe/scene/scene.h"
#include "abbe/world/lanes.h"
#include "abbe/world/light/lamp_shape.h"
#include "abbe/world/rows.h"

namespace abbe {

/// A rectangle that parallel light shines from.
struct BeamWindow {
  Vec3f x{1.0f, 0.0f, 0.0f}, y{0.0f, 1.0f, 0.0f};  ///< Unit vectors across the light.
  float half_x_m = 0.0f, half_y_m = 0.0f;
};

/// A lamp, from its middle. Its row is radiant intensity or, of parallel light, irradiance.
struct WorldLight {
  std::string name;
  Vec3f position{0.0f};                ///< Of a beam, the middle of its rectangle.
  Vec3f direction{0.0f, 0.0f, -1.0f};  ///< In which it shines; unit length.
  bool is_parallel = false;            ///< The same direction everywhere.
  std::optional<BeamWindow> beam;      ///< Of parallel light; absent where that has no bounds.
  std::optional<LampExtent> extent;    ///< What surfaces see instead of its middle.
  float range_m = kInfinity;           ///< Where its light ends.
  // A spot shines where cosine · spot_scale + spot_offset, cut to [0, 1] and squared, is not 0.
  bool is_spot = false;
  float spot_scale = 0.0f, spot_offset = 0.0f;
  RowId row = 0;

  /// Whether its light has come a known distance: the sun shines from outside the fog.
  bool has_distance() const { return !is_parallel || beam; }
  /// How far its light has come in parallel to a place; infinite without a beam.
  float parallel_distance_m(const Vec3f& place) const {
    return beam ? glm::dot(place - position, direction) : kInfinity;
  }
};

/// Where light comes from in every lane: unit directions to it, and how much of it.
struct LightGeometry {
  LaneArray3 direction;
  LaneArray distance_m;
  LaneArray irradiance;  ///< Across that direction, before visibility.
};

/// A part of a ray; nothing where end ≤ begin.
struct RaySegment {
  float begin_m = 0.0f, end_m = 0.0f;
};

/// The part of a ray [0, end) inside the cone of a spot.
/// Domain: light.is_spot.
RaySegment segment_in_cone(const WorldLight& light, const Vec3f& origin, const Vec3f& direction,
                           float end_m);

/// A straight line from a lamp to a place, in double precision.
struct StraightPath {
  Vec3d start{0.0};         ///< The lamp; in the rectangle of a beam; otherwise the place itself.
  Vec3d direction{0.0};     ///< In which light arrives.
  double length_m = 0.0;    ///< Infinite for parallel light without a beam.
  double irradiance = 0.0;  ///< Before visibility, over the lamp's intensity.
};
/// Absent where the lamp does not shine on the place.
std::optional<StraightPath> straight_path(const WorldLight& light, const Vec3d& place);

/// WindowFromMiddle of world/light/lights-inl.h in double precision.
double lamp_window(const WorldLight& light, double distance_m, double cosine);

/// A half-space normal·x ≤ distance.
struct HalfSpace {
  Vec3d normal{0.0};
  double distance = 0.0;
};

/// What a kind of light is, for those who describe it.
struct LightKind {
  const char* name;       ///< As in glTF.
  const char* intensity;  ///< What its intensity is, with the unit as suffix.
  bool has_position = false, has_direction = false, has_cone = false;
};
LightKind kind_of(const Light& light);

/// The lights of a scene, numbered as there; their spectra are added to `rows`.
std::vector<WorldLight> tabulate_lights(const Scene& scene, const LaneModel& lanes, Rows& rows);

/// Where a light of the scene shines: along −Z of its node. Unit length.
Vec3d direction_of(const Light& light);

/// Whether light of it has the same direction everywhere.
bool is_parallel(const Light& light);

/// The half-spaces that hold all that parallel light falls on; none without a beam.
std::vector<HalfSpace> beam_bounds(const Light& light);

/// A pyramid of eight sides about the cone of a spot; empty for other lights and for spots whose
/// cone is wider than a pyramid holds well.
std::vector<HalfSpace> spot_bounds(const Light& light);

/// Whether a lamp may shine on a ball; errs to yes.
/// Domain: no parallel light; `axis` points from the lamp to the ball, which it sees within
///         `angle_rad` of it.
bool may_shine_on(const Light& light, const Vec3d& center, double radius_m, const Vec3d& axis,
                  double angle_rad);

}  // namespace abbe
