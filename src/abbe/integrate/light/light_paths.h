/// The bent paths from a place to a lamp, one by one and in double precision: what `abbe probe`
/// draws, and what the lanes' single precision is measured against.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "abbe/caustics/lit_world.h"

namespace abbe {

/// A facet that light meets on its path, as one wavelength sees it.
struct LightPathCrossing {
  ChainEvent event = ChainEvent::Enter;
  std::uint32_t body = 0;  ///< Index into FlatBodies::bodies.
  Vec3d position{0.0};
  Vec3d normal{0.0};                                  ///< Of the facet, out of its body.
  Vec3d direction_before{0.0}, direction_after{0.0};  ///< In which light goes.
  double n_before = 1.0, n_after = 1.0;               ///< Equal at a reflection.
  double incidence_rad = 0.0, exit_rad = 0.0;         ///< With the normal, before and after.
  double share = 1.0;                                 ///< Of power, by Fresnel, thin film and tint.
};

/// The path of one wavelength.
struct LightPath {
  int lane = 0;
  Vec3d start{0.0};  ///< The lamp; of a beam, in its rectangle; of other parallel light, the first
                     ///< crossing or the place itself.
  std::vector<LightPathCrossing> crossings;  ///< From the lamp on.
  Vec3d arrival{0.0};                        ///< Direction in which light arrives at the place.
  double length_m = 0.0;                     ///< Infinite for parallel light without a rectangle.
  double transmittance = 1.0;                ///< Shares of all crossings, absorption and fog.
  /// Irradiance across the arrival over the lamp's intensity (m⁻²) or irradiance (1), shares,
  /// absorption, distance and the beam's cross section included. 0 where something stands between.
  double irradiance = 0.0;
  bool is_blocked = false;
};

/// A chain of facets that links a place to a lamp, with the wavelengths that go over it.
struct LightChain {
  std::vector<ChainEvent> events;  ///< Empty: straight light.
  std::vector<LightPath> paths;    ///< By lane; lanes that do not arrive are left out.
};

/// All chains on which light of a lamp comes to a place, straight light first, then by what they
/// bring; also those on which something opaque stands. Of a lamp with an extent those of one place
/// of it, as if it were the only one.
/// Shape:  paths of the lanes of wavelength set `set`.
/// Domain: light < world.lights.size(). A place inside glass has `medium`, the material it is in.
///         Straight light here is that which meets no surface at all.
std::vector<LightChain> chains_to_light(const LitWorld& world, std::uint32_t light,
                                        const Vec3d& place, int set,
                                        std::optional<std::uint32_t> medium = std::nullopt);

}  // namespace abbe
