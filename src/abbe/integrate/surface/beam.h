/// Beams: what the rays of one pixel cover together, from the camera through mirrors and lenses to
/// where they meet a texture. By its width textures choose their level.
#pragma once

#include <array>

#include "abbe/integrate/surface/hit.h"
#include "abbe/math/vec.h"
#include "abbe/world/world.h"

namespace abbe {

/// How the place and the direction of a ray change from pixel to pixel, in two directions.
/// Units:  metres and radians a pixel; both perpendicular to the ray.
/// Source: Igehy, Tracing Ray Differentials, SIGGRAPH 1999.
struct Beam {
  std::array<Vec3f, 2> across{Vec3f(0.0f), Vec3f(0.0f)};
  std::array<Vec3f, 2> turn{Vec3f(0.0f), Vec3f(0.0f)};
};

/// A round beam along a direction of unit length.
Beam round_beam(const Vec3f& direction, float width_m, float per_m);

/// The beam further along its ray.
Beam moved(const Beam& beam, float distance_m);

/// The beam's width where it is narrowest: textures have one level for both directions, and a wider
/// one would lose what the samples of a pixel still tell apart. So it is for a surface that is seen
/// at a slant, where only what lies across the beam counts.
float beam_width_m(const Beam& beam, const Vec3f& direction);

/// How the ray of a beam goes on at a surface.
struct BeamTurn {
  Vec3f arrival{0.0f}, departure{0.0f};  ///< Unit length.
  Vec3f outward{0.0f};                   ///< Geometric normal, on either side.
  /// How the normal that it turns about changes from pixel to pixel, for where on_surface() is; on
  /// either side: `normal` tells which.
  std::array<Vec3f, 2> normal_change{Vec3f(0.0f), Vec3f(0.0f)};
  Vec3f normal{0.0f};
};

/// Where a beam meets the plane of a surface, from pixel to pixel. Below a cosine of 0.01 it is met
/// at that one.
std::array<Vec3f, 2> on_surface(const Beam& beam, const Vec3f& arrival, const Vec3f& outward);

/// A beam mirrored at the surface that it has come to, or refracted there.
/// Units:  eta_ti = n_transmitted / n_incident.
/// Source: Igehy 1999, equations 13 to 18.
Beam reflected(const Beam& beam, const BeamTurn& turn);
Beam refracted(const Beam& beam, const BeamTurn& turn, float eta_ti);

/// What a beam becomes where a rough lobe sends its ray by chance: round, growing from there on as
/// it would have, and by an angle more. It is nowhere narrower than the beam would have been.
Beam widened(const Beam& beam, const Vec3f& direction, float angle_rad);

/// Width of what a ray drawn with this density stands for, as the one of a pixel's sequence that
/// has `before` others before it: the root of its solid angle. All samples of a pixel share the
/// lobe, so that this tends to nothing; and none depends on how many are still to come.
/// Units:  sr⁻¹, rad. Domain: 0 where nothing is known.
/// Source: Křivánek & Colbert, Real-time Shading with Filtered Importance Sampling, EGSR 2008.
float lobe_width_rad(float per_sr, std::uint32_t before);

/// How the normal of a surface that lanes met changes along it: that of exact shapes and smooth
/// meshes by their curvature, that of normal maps by what they have there; zero on flat ones.
/// `of_coat`: of its clearcoat. `along` are places from the hit's, in its plane.
std::array<Vec3f, 2> normal_changes(const World& world, const SurfaceHit& hit, int lane,
                                    const std::array<Vec3f, 2>& along, bool of_coat);

}  // namespace abbe
