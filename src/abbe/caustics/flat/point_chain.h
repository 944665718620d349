/// Chains of point and spot lights: the paths of their light over flat faces.
///
/// All reflections of a chain are undone by mirroring the space behind each of them: then light
/// goes through a row of planes and is refracted at each, and of all paths from the lamp to a place
/// the one that light takes has the least optical length Σ n·distance. This sum is convex in the
/// places where the planes are crossed, so there is one such path or none.
///
/// What a chain lights lies in front of its last face, and seen along eight directions of that
/// plane it grows with the distance at most as the steepest ray does: eight planes that hold it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "abbe/caustics/flat/chain.h"
#include "abbe/math/lane_mask.h"
#include "abbe/math/vec.h"

namespace abbe {

/// Coordinates in the plane of a face, and its outline in them.
struct FaceFrame {
  Vec3d origin{0.0}, normal{0.0}, u{0.0}, v{0.0};
  /// Convex pieces; each edge (a, b, c) is a·u + b·v + c ≥ 0 inside, in metres. An edge that two
  /// pieces share is the same numbers with the opposite sign in each: no point lies in neither.
  std::vector<std::vector<Vec3f>> pieces;

  /// How far inside the outline a place of the plane, u and v, lies; negative outside. A bound
  /// where pieces meet.
  double distance_inside(const Vec2d& at_m) const;
};

/// A face of a chain, mirrored into the space in which all reflections before it are undone; all
/// relative to the chain's origin.
struct UnfoldedFace {
  Vec3d origin{0.0}, normal{0.0}, u{0.0}, v{0.0};
  std::uint32_t face = 0;  ///< Index into FlatBodies::faces and PointChains::frames.
  double radius_m = 0.0;   ///< The outline lies within it of `center`.
  Vec2d center{0.0};
  Mat3d to_world{1.0};  ///< Takes places back: x = to_world·x′ + shift.
  Vec3d shift{0.0};
};

/// Where light of a chain goes, in the frame of the chain's group: a lit place at height h over the
/// last face has along direction k of the bounds a coordinate of at most reach + h·slope.
template <typename T>
struct BoundsOf {
  static constexpr T kNone = -std::numeric_limits<T>::infinity();
  std::array<T, 8> reach{kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone};
  std::array<T, 8> slope = reach;

  void include(const BoundsOf& other) {
    for (std::size_t k = 0; k < 8; ++k) {
      reach[k] = std::max(reach[k], other.reach[k]);
      slope[k] = std::max(slope[k], other.slope[k]);
    }
  }
};
using ConeBounds = BoundsOf<float>;

/// Neighbouring parts of the light of a chain, cones [first_cone, last_cone) of PointChains, and
/// bounds of all of them.
struct ConeBunch {
  ConeBounds bounds;
  std::uint32_t first_cone = 0, last_cone = 0;
};

/// A chain of a point or spot light.
struct PointChain : ChainPath {
  std::uint32_t group = 0;                          ///< In PointChains::groups.
  std::vector<UnfoldedFace> faces;                  ///< Of each step.
  std::vector<std::uint32_t> crossings;             ///< The steps that refract.
  std::vector<std::optional<std::uint32_t>> media;  ///< Before each crossing and behind the last.
  std::vector<Vec3d> directions;  ///< Typical ones on those segments, in the unfolded space.
  LaneMask lanes;                 ///< That are followed over it.
  float kept = 0.0f;              ///< Of its light, what its facets have left it, as a mean.
  Vec3d lamp{0.0};
  /// Where the lamp's rays are counted from on the first crossed plane, in the coordinates of its
  /// frame: below the lamp, if that is near the face. So rays of a lamp that almost touches the
  /// face have directions in single precision.
  Vec2d start{0.0};
  Vec3d start_place{0.0};  ///< The same.
  Mat3d fold{1.0};  ///< Takes a lit place into the unfolded space: x′ = fold·x + fold_shift.
  Vec3d fold_shift{0.0};
  ConeBounds bounds;  ///< Of all its light.
  /// Its light in parts, bunches [first_bunch, last_bunch) of PointChains: no place is lit that
  /// lies in none of their cones.
  std::uint32_t first_bunch = 0, last_bunch = 0;
};

/// Sets where the lamp's rays are counted from. Domain: the chain crosses a plane.
void set_start(PointChain& chain);

/// Chains of one source that end at the same face and side; they share a frame.
struct PointChainGroup {
  std::uint32_t source = 0;
  std::optional<std::uint32_t> ends_in;                ///< As in ChainPath.
  Vec3f origin{0.0f}, normal{0.0f}, u{0.0f}, v{0.0f};  ///< The normal points to what is lit.
  ConeBounds bounds;                                   ///< Of all of them.
  std::uint32_t first_chain = 0, chain_count = 0;
  float weight = 0.0f;
};

/// The chains of all point and spot lights.
struct PointChains {
  std::vector<PointChain> chains;
  std::vector<PointChainGroup> groups;  ///< Largest first, and so are the chains in each.
  std::vector<ConeBunch> bunches;
  std::vector<ConeBounds> cones;
  std::vector<FaceFrame> frames;    ///< Of all faces of FlatBodies; empty without chains.
  std::vector<Vec2d> index_ranges;  ///< Per material and wavelength set.
  std::size_t set_count = 0;

  /// Least and greatest index of a material among the lanes of a set.
  const Vec2d& index_range(std::uint32_t material, int set) const {
    return index_ranges[material * set_count + static_cast<std::size_t>(set)];
  }
};

/// Cosine and sine of the directions of the bounds.
inline constexpr float kHalfRoot = 0.70710678118654752f;
inline constexpr std::array<float, 8> kBoundCosine{1,  kHalfRoot,  0, -kHalfRoot,
                                                   -1, -kHalfRoot, 0, kHalfRoot};
inline constexpr std::array<float, 8> kBoundSine{0, kHalfRoot,  1,  kHalfRoot,
                                                 0, -kHalfRoot, -1, -kHalfRoot};

/// A place that touches a face is in front of it, too: closer than this share of its coordinates.
inline constexpr float kTouches = 4e-6f;

/// Where a ball lies in the frame of a group of chains.
struct PlaceInGroup {
  float height_m = 0.0f, radius_m = 0.0f;
  float along_m[8];  ///< Along the directions of the bounds.
};

/// Whether a ball may get light from any chain of a group; a quick no.
inline bool may_light(const PointChainGroup& group, const Vec3f& center, float radius_m,
                      PlaceInGroup& place) {
  const Vec3f v = center - group.origin;
  place.height_m = glm::dot(v, group.normal);
  place.radius_m = radius_m + kTouches * (std::abs(v.x) + std::abs(v.y) + std::abs(v.z));
  if (place.height_m < -place.radius_m) return false;
  const float u = glm::dot(v, group.u);
  const float w = glm::dot(v, group.v);
  for (std::size_t k = 0; k < 8; ++k) place.along_m[k] = u * kBoundCosine[k] + w * kBoundSine[k];
  return true;
}

/// Whether a ball may lie in the bounds of a chain or group.
inline bool may_be_in_bounds(const PlaceInGroup& place, const ConeBounds& bounds) {
  const float height = std::max(place.height_m, 0.0f);
  for (std::size_t k = 0; k < 8; ++k) {
    const float grown = height * bounds.slope[k] + place.radius_m * std::abs(bounds.slope[k]);
    if (place.along_m[k] > bounds.reach[k] + place.radius_m + grown) return false;
  }
  return true;
}

/// Whether a ball may get light from a chain; a quick no.
inline bool may_light(const PointChains& all, const PointChain& chain, const Vec3f& center,
                      float radius_m) {
  PlaceInGroup place;
  if (!may_light(all.groups[chain.group], center, radius_m, place)) return false;
  if (!may_be_in_bounds(place, chain.bounds)) return false;
  for (std::uint32_t b = chain.first_bunch; b < chain.last_bunch; ++b) {
    const ConeBunch& bunch = all.bunches[b];
    if (!may_be_in_bounds(place, bunch.bounds)) continue;
    for (std::uint32_t c = bunch.first_cone; c < bunch.last_cone; ++c) {
      if (may_be_in_bounds(place, all.cones[c])) return true;
    }
  }
  return false;
}

/// A place of a face, from its coordinates.
inline Vec3d on_face(const UnfoldedFace& face, const Vec2d& at) {
  return face.origin + at.x * face.u + at.y * face.v;
}

}  // namespace abbe
