/// The path of one wavelength on a chain of a point light, in double precision: where the lanes
/// start from, and what they fall back on.
#pragma once

#include <array>
#include <span>

#include "abbe/caustics/flat/light/known_misses.h"
#include "abbe/caustics/flat/light/shooting.h"
#include "abbe/caustics/flat/point_chain.h"

namespace abbe {

/// How crossings move.
struct CrossingSlopes {
  Crossings by_index{};                 ///< Per unit of the change of indices that was asked for.
  std::array<Crossings, 3> by_place{};  ///< Per metre of the lit place along x, y, z, unfolded.
};

/// A place that touches the last face of a chain, moved off it: the last segment of a path needs a
/// direction. Other places as they are. Domain: unfolded.
Vec3d off_last_face(const PointChain& chain, const Vec3d& place);

/// Finds the path of least optical length from the lamp to a place over the planes of a chain,
/// whether or not it stays inside the outlines of the faces. First by rays from the lamp, corrected
/// by what they miss the place, where that leads there in a few steps. Otherwise by Newton's method
/// on the convex sum Σ n·distance, with shorter steps where a whole one goes too far. Where none of
/// them shortens the path, the sum is rounded off at the edges that planes meet in, less and less:
/// so paths that end at an edge are told from those that pass close to it. Else a step of
/// Weiszfeld's, which always shortens it.
/// Once steps get shorter fast, `gives_up` is asked whether to go on.
/// Shape:  one index per segment, chain.crossings.size() + 1 of them.
/// Domain: place is relative to the chain's origin, and unfolded. Without crossings always true.
/// Errors: false where no smooth minimum was found: the path wants to pass an edge, or misses
/// faces, or it was given up. Source: Weiszfeld, Tohoku Math. J. 43, 1937, for the step that always
/// shortens.
bool solve_crossings(const PointChain& chain, std::span<const double> n, const Vec3d& place,
                     Crossings& crossings, const GivesUp& gives_up = {});

/// Whether light that goes on over those crossings leaves each plane on its far side. The least
/// path may turn back at one; light does not.
bool goes_ahead(const PointChain& chain, const Crossings& crossings);

/// Derivatives of the crossings of a path that solve_crossings found.
/// Shape:  as there; n_change is the change of each index that counts as 1.
CrossingSlopes crossing_slopes(const PointChain& chain, std::span<const double> n,
                               std::span<const double> n_change, const Vec3d& place,
                               const Crossings& crossings);

/// Whether a path, off by at most so much, may stay inside the outlines of all faces that it
/// crosses.
bool may_cross(const PointChains& all, const PointChain& chain, const Crossings& crossings,
               double off_m);

/// The same for paths to places within a radius of one that was solved, at any wavelength; what
/// crossings move by is taken four times.
/// Domain: as crossing_slopes, the change of indices being from the least to the greatest.
bool may_cross(const PointChains& all, const PointChain& chain, const Crossings& crossings,
               const CrossingSlopes& slopes, double radius_m, double off_m = 0.0);

/// The face whose outline a path to a place leaves most clearly, at any wavelength, if any; the
/// path is off by at most so much. Units: world coordinates but for `place`. Domain: as
/// crossing_slopes.
Miss clearest_miss(const PointChains& all, const PointChain& chain, const Vec3d& place,
                   const Crossings& crossings, const CrossingSlopes& slopes, double off_m);

/// Solid angle at the lamp over area across the beam at the place, m⁻², of a path that
/// solve_crossings found: what the irradiance is for a lamp of intensity 1 and no losses.
/// dΩ/dA = Π_j n_j²/length_j² · Π_k cosθ_k·cosθ′_k / (n_0² · det H) with H the second derivatives
/// of the optical length by the crossings: dΩ is the change of momentum at the lamp, n_0⁻²·det of
/// the mixed derivatives of the least optical length by lamp and place, and those are the product
/// of the mixed derivatives of each segment over det H.
double crossing_jacobian(const PointChain& chain, std::span<const double> n, const Vec3d& place,
                         const Crossings& crossings);

}  // namespace abbe
