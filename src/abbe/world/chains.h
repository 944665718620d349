/// Chains: the ways on which light of a lamp goes round a corner over flat facets, each known
/// without chance. Those of point and spot lights are in world/point_chains.h.
///
/// Parallel light. Behind every facet of a chain all rays of one wavelength are parallel again, so
/// the light that leaves is a prism in space: the part of the last facet that all facets before it
/// let through, swept along one direction. A point is lit when it lies inside the planes of that
/// prism. Its irradiance across the beam is the lamp's times
///   Π τ_j · cosθ_i,j/cosθ_t,j   over refractions and   Π ρ_j   over reflections:
/// τ and ρ are Fresnel's shares of power, and a bundle of cross section A that meets a facet under
/// θ_i covers A/cosθ_i of it and leaves with A·cosθ_t/cosθ_i; a reflection keeps the cross section.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "abbe/math/vec.h"
#include "abbe/scene/scene.h"
#include "abbe/world/flat_bodies.h"

namespace abbe {

struct World;

/// What happens to light at a facet of a chain.
enum class ChainEvent : std::uint8_t { Enter, Leave, ReflectInside, ReflectOutside };

/// A facet of a chain.
struct ChainStep {
  ChainEvent event = ChainEvent::Enter;
  std::uint32_t facet = 0;     ///< Index into World::flat.
  std::uint32_t material = 0;  ///< Of its body.
  Vec3f normal{0.0f};
  float distance_m = 0.0f;  ///< Plane n·x = distance, x relative to the chain's origin.
  bool is_checked = false;  ///< The way inside that ends here may meet something.

  bool comes_from_inside() const {
    return event == ChainEvent::Leave || event == ChainEvent::ReflectInside;
  }
  bool goes_on_inside() const {
    return event == ChainEvent::Enter || event == ChainEvent::ReflectInside;
  }
};

/// The facets that light of one lamp meets one after the other.
struct ChainPath {
  std::uint32_t light = 0;
  std::vector<ChainStep> steps;
  bool ends_inside = false;  ///< It lights the inside of the last step's body.
  Vec3f origin{0.0f};        ///< Points are taken relative to it: keeps precision.
  float largest = 0.0f;      ///< Bound of what it adds to the light of its lamp, for any lane.
};

/// A chain of parallel light. What depends on the wavelength lies in World::chain_rows, per
/// wavelength set `array_count` arrays of lane_stride floats from `rows` on: its weight (0 in lanes
/// that no light passes), the direction x, y, z after each step, then per side plane normal x, y, z
/// and offset: a point is lit where all normal·x + offset ≥ 0.
struct Chain : ChainPath {
  // All it lights lies in a cone, of which the tip is this sphere: for a quick no.
  Vec3f bound_center{0.0f};  ///< World coordinates.
  float bound_radius_m = 0.0f;
  Vec3f bound_axis{0.0f, 0.0f, 1.0f};
  float bound_tan = 0.0f;  ///< Of its half angle.
  int side_count = 0;
  std::size_t rows = 0;

  std::size_t array_count() const {
    return 1 + 3 * steps.size() + 4 * static_cast<std::size_t>(side_count);
  }
};

/// How light is followed over facets.
struct CausticOptions {
  bool exact = true;          ///< Otherwise straight shadow rays everywhere.
  int inner_reflections = 1;  ///< Most of them in one body.
  double cutoff = 1e-4;       ///< Chains whose weight stays below this are cut.
};

/// What was found and what was left out.
struct CausticReport {
  std::size_t bodies = 0, facets = 0, chains = 0;
  double share_cut = 0.0;  ///< Share of the light on facets that chains below the cutoff carried.
  std::vector<std::string> fallbacks;  ///< As in FlatBodies.
};

/// Most bodies that one chain goes through.
inline constexpr int kMostChainBodies = 2;

/// Most facets of a chain.
inline constexpr std::size_t kMostChainSteps = 16;

/// What a search for the chains of one light has met.
struct ChainYield {
  double started = 0.0;  ///< Light that fell on facets; the unit depends on the kind of light.
  double cut = 0.0;      ///< The part of it that chains below the cutoff would have carried.
  std::optional<std::uint32_t> too_large;  ///< A body that has more chains than can be kept.
};

/// Step of a chain over a facet of the world's flat bodies; its plane is relative to the world's
/// origin until the chain has one.
ChainStep make_chain_step(const World& world, std::uint32_t facet, ChainEvent event);

/// Finds the flat bodies of a scene and the chains of its lights, largest first. Fills World::flat,
/// chains, chain_rows, point_chains, surface_is_exact, and caustics. A body that has too many
/// chains is left to straight shadow rays, with one warning that names it.
/// Domain: materials, lights and surfaces are already in the world.
void add_chains(const Scene& scene, const CausticOptions& options, Notes& notes, World& world);

}  // namespace abbe
