/// Chains: the paths on which light of a lamp goes round a corner over flat facets, each known
/// without chance.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "abbe/caustics/flat/bodies.h"
#include "abbe/math/vec.h"

namespace abbe {

/// What happens to light at a facet of a chain.
enum class ChainEvent : std::uint8_t { Enter, Leave, ReflectInside, ReflectOutside };

/// Whether light comes from the inside of the facet's body, whether it goes on there, and whether
/// it goes through.
constexpr bool comes_from_inside(ChainEvent event) {
  return event == ChainEvent::Leave || event == ChainEvent::ReflectInside;
}
constexpr bool goes_on_inside(ChainEvent event) {
  return event == ChainEvent::Enter || event == ChainEvent::ReflectInside;
}
constexpr bool refracts(ChainEvent event) {
  return event == ChainEvent::Enter || event == ChainEvent::Leave;
}

/// A facet of a chain.
struct ChainStep {
  ChainEvent event = ChainEvent::Enter;
  std::uint32_t facet = 0;               ///< Index into FlatBodies::facets.
  std::uint32_t material = 0;            ///< Of its body.
  std::optional<std::uint32_t> outside;  ///< The medium before the facet; none: air.
  Vec3f normal{0.0f};
  float distance_m = 0.0f;  ///< Plane n·x = distance, x relative to the chain's origin.
  bool is_checked = false;  ///< The segment inside that ends here may meet something.
  bool is_touched = false;  ///< Something that chains do not lead through may lie on the facet.

  /// The media that light comes from and goes on in, by their materials; none: air.
  std::optional<std::uint32_t> comes_from() const {
    return comes_from_inside() ? std::optional(material) : outside;
  }
  std::optional<std::uint32_t> goes_on_in() const {
    return goes_on_inside() ? std::optional(material) : outside;
  }

  bool comes_from_inside() const { return abbe::comes_from_inside(event); }
  bool goes_on_inside() const { return abbe::goes_on_inside(event); }
  bool refracts() const { return abbe::refracts(event); }
};

/// Step of a chain over a facet; its plane is relative to the world's origin until the chain has
/// one.
ChainStep make_chain_step(const FlatBodies& flat, std::uint32_t facet, ChainEvent event);

/// The facets that light of one lamp, or place of one, meets one after the other.
struct ChainPath {
  std::uint32_t source = 0;  ///< In FlatCaustics::sources.
  std::vector<ChainStep> steps;
  Vec3f origin{0.0f};    ///< Points are taken relative to it: keeps precision.
  float slack_m = 0.0f;  ///< Covers the rounding errors of places on its facets across them.
  float drift_m = 0.0f;  ///< What such places may be off along their facets.
  /// Of two the one that brings more comes first: light in all or, of parallel light, the most that
  /// any place may get.
  float weight = 0.0f;

  /// The medium in which it lights places; none: air.
  std::optional<std::uint32_t> ends_in() const { return steps.back().goes_on_in(); }
};

/// Most facets of a chain.
inline constexpr std::size_t kMaxChainSteps = 36;

/// Most boundaries of a chain at which light is refracted: six panes in a row, and back and forth
/// between the first and the last.
inline constexpr std::size_t kMaxRefractions = 32;

}  // namespace abbe
