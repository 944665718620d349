/// The ways on which light of a lamp comes to what a pixel shows: as text, as JSON and as a
/// drawing.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "abbe/cli/probe_tree.h"
#include "abbe/cli/ray_figure.h"
#include "abbe/integrate/light/light_paths.h"
#include "abbe/scene/scene.h"
#include "abbe/spectrum/observer.h"

namespace abbe {

/// A place on a surface, and the light that may reach it.
struct LitPlace {
  std::string light, surface;  ///< Names.
  Vec3d place{0.0};
  int set = 0;  ///< Wavelength set of the chains' lanes.
  std::vector<LightChain> chains;
};

/// The number of a lamp by its name, or by `#2` for the third.
/// Errors: a usage Error of `--light` that lists the names.
std::uint32_t light_named(const World& world, const std::string& name);

/// The surface that the heaviest way of a probe ends on, seen through glass if need be, and all
/// chains from the lamp to there; none where that way leaves the scene.
std::optional<LitPlace> lit_place(std::span<const ProbeNode> nodes, const World& world, int set,
                                  std::uint32_t light);

std::string light_text(const LitPlace& lit, const World& world, const Scene& scene);
nlohmann::ordered_json light_json(const LitPlace& lit, const World& world, const Scene& scene);

/// Chains in the colours of their wavelengths, numbered facets and a table of the middle one's
/// angles.
RayFigure light_figure(const LitPlace& lit, const World& world, const Scene& scene,
                       const std::string& title, const Observer& observer);

}  // namespace abbe
