/// Paths found by rays from the lamp, corrected by what they miss the place: the search that most
/// paths need. Double precision.
#pragma once

#include <array>
#include <functional>
#include <span>

#include "abbe/caustics/flat/point_chain.h"

namespace abbe {

/// Where light crosses the refracting faces of a chain, in the coordinates of their frames.
using Crossings = std::array<Vec2d, kMaxRefractions>;

/// Whether a path is of no use whose crossings are these, off by at most so much.
using GivesUp = std::function<bool(const Crossings& at, double off_m)>;

/// What is left behind a step of a search that shrinks fast is less than the step, times this to be
/// sure.
inline constexpr double kSurely = 12.0;

/// What shooting at a place has told.
enum class Shooting { Arrives, GivenUp, Unknown };

/// Newton's method on the first crossing alone, from the first of `crossings` on: a few steps where
/// the guess is good and the path runs clear of edges and of total reflection. What arrives there,
/// with all segments ahead, is the path of least optical length.
/// Shape:  one index per segment, chain.crossings.size() + 1 of them.
/// Domain: the chain crosses a plane; place is relative to the chain's origin, and unfolded.
/// Source: Igehy, Tracing Ray Differentials, SIGGRAPH 1999.
Shooting shoot(const PointChain& chain, std::span<const double> n, const Vec3d& place,
               Crossings& crossings, const GivesUp& gives_up);

}  // namespace abbe
