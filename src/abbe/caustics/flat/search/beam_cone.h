/// Bounds of bundles of rays: where they are and where they go, as they cross flat faces.
/// Everything here errs on the side of more rays, never of fewer.
#pragma once

#include <optional>

#include "abbe/math/vec.h"

namespace abbe {

/// Rays from points of a ball, in directions within an angle of an axis.
struct BeamCone {
  Vec3d center{0.0};
  double radius_m = 0.0;
  Vec3d axis{0.0, 0.0, 1.0};  ///< Unit length.
  double angle_rad = 0.0;
};

/// A cone about all directions of another that cross a plane along its normal: its own axis does.
BeamCone crossing(const BeamCone& cone, const Vec3d& normal);

/// The angles with a normal that directions of a cone can have.
/// Domain: of the smaller of the two angles between line and normal; high at most π/2.
struct AngleRange {
  double low_rad = 0.0, high_rad = 0.0;
};
AngleRange angles_with(const BeamCone& cone, const Vec3d& normal);

/// The cone behind a boundary; nothing where all of it is totally reflected.
/// Units:  eta_ti = n_transmitted / n_incident, of all wavelengths at once.
/// Domain: the axis is not along the boundary; the ball stays where it is.
std::optional<BeamCone> refracted_cone(const BeamCone& cone, const Vec3d& normal, double eta_ti_low,
                                       double eta_ti_high);

/// A ball about all that a cone meets of a plane n·x = distance, coming to it along n; nothing
/// where it meets none of it, and a ball of infinite radius where rays nearly graze it.
struct ConeSection {
  Vec3d center{0.0};  ///< In the plane, where the axis meets it.
  double radius_m = 0.0;
};
std::optional<ConeSection> plane_section(const BeamCone& cone, const Vec3d& normal,
                                         double distance);

/// Largest slope u·d/(n·d) of directions of a cone; infinite where n·d can be 0.
/// Domain: u and n unit vectors at right angles.
double largest_slope(const BeamCone& cone, const Vec3d& u, const Vec3d& n);

}  // namespace abbe
