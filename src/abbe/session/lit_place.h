/// The light of a lamp on what a pixel shows: every path on which it comes, made readable.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "abbe/integrate/light/light_paths.h"
#include "abbe/session/probe.h"

namespace abbe {

/// A facet on a path, with the names of what happens there.
struct LitCrossing {
  LightPathCrossing at;
  std::string event;          ///< "enter", "leave", "reflect inside", "reflect".
  std::string body;           ///< Name of the instance.
  std::uint32_t surface = 0;  ///< Index into World::surfaces.

  bool is_refraction() const { return refracts(at.event); }
};

/// The path of one wavelength (or channel).
struct LitPath {
  LightPath path;
  std::vector<LitCrossing> crossings;   ///< Of the path, in its order.
  std::optional<double> wavelength_nm;  ///< None in the RGB modes.
  std::string lane;                     ///< `587.5600`, or `R`, `G`, `B`.
};

/// A chain of facets with the paths of all wavelengths that go over it.
struct LitChain {
  std::string title;  ///< `enter prism, leave prism`; `straight`.
  bool is_blocked = false;
  bool is_straight = false;
  std::vector<LitPath> paths;  ///< At least one.

  const LitPath& middle() const { return paths[paths.size() / 2]; }
};

/// A place on a surface, and the light that may reach it.
struct LitPlace {
  std::string light, surface;  ///< Names.
  Vec3d place{0.0};
  std::vector<LitChain> chains;
  std::vector<double> wavelengths_nm;  ///< Of all lanes; empty in the RGB modes.
};

/// The number of a lamp by its name, or by `#2` for the third.
/// Errors: a usage Error that lists the names.
std::uint32_t light_named(const LitWorld& world, const std::string& name);

/// The surface that the heaviest path of a probe ends on, seen through glass if need be, and all
/// chains from the lamp to there; none where that path leaves the scene.
/// Shape:  `set` is the wavelength set of the probe's sample.
std::optional<LitPlace> lit_place(std::span<const ProbeNode> nodes, const LitWorld& world,
                                  const Scene& scene, int set, std::uint32_t light);

/// Moves its places by `by`: from the world that was traced to the scene's coordinates.
void move_places(LitPlace& lit, const Vec3d& by);

}  // namespace abbe
