/// Light that comes through flat glass and off flat mirrors, found path by path instead of sampled.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "abbe/base/notes.h"
#include "abbe/caustics/flat/bodies.h"
#include "abbe/caustics/flat/chain_index.h"
#include "abbe/caustics/flat/parallel_chain.h"
#include "abbe/caustics/flat/point_chain.h"
#include "abbe/world/world.h"

namespace abbe {

/// How light is followed over facets.
struct CausticOptions {
  bool exact = true;  ///< Otherwise straight shadow rays everywhere.
  static constexpr int kMostInnerReflections = 20;
  int inner_reflections = 16;  ///< Most of them on one chain, at most those.
  double cutoff = 1e-4;        ///< Chains whose weight stays below this are cut.
  /// What the tables of all chains of parallel light may hold, floats: 256 MiB. Of chains for which
  /// there is no room those with least light are left out.
  std::size_t table_floats = std::size_t{1} << 26;
};

/// Light of lamps that falls first on a body, and what of it chains leave out that would have lit
/// something. Units: lumens of one lamp over its intensity, or shares of the light on all bodies.
struct BodyLight {
  double started = 0.0;
  double faint = 0.0;     ///< On paths that carry too little.
  double too_long = 0.0;  ///< On paths with too many reflections or facets.
  double no_room = 0.0;   ///< On paths that do not fit into the tables of parallel light.
};

/// What was found and what was left out.
struct CausticReport {
  std::size_t bodies = 0, facets = 0, chains = 0;
  double share_cut = 0.0;              ///< Share of the light on facets that is left out.
  double share_too_long = 0.0;         ///< The part of it on paths with too many reflections.
  double share_no_room = 0.0;          ///< The part for which the tables have no room.
  std::vector<BodyLight> by_body;      ///< Shares, in the order of FlatBodies::bodies.
  std::vector<std::string> fallbacks;  ///< As in FlatBodies.
};

/// What chains start from: a lamp or, of one with an extent, a place that stands for a part of it.
struct ChainSource {
  WorldLight light;         ///< Its light is that of the whole lamp, as if it were the only place.
  std::uint32_t lamp = 0;   ///< The number of the lamp in the scene.
  std::uint32_t place = 0;  ///< Of as many as FlatCaustics::near_places has.
  bool is_part = false;     ///< One of several.
};

/// Chains that are looked for together. Their indices tell numbers of all chains.
struct ChainsNear {
  ChainIndex parallel, point;
  std::size_t parallel_count = 0, point_count = 0;
};

/// The chains of one light, as numbers of those of all.
struct LightChains {
  std::vector<std::uint32_t> parallel;  ///< In ParallelChains::chains.
  std::vector<std::uint32_t> point;     ///< In PointChains::chains.
};

/// All light that is followed over flat facets.
struct FlatCaustics {
  FlatBodies flat;
  ParallelChains parallel;
  PointChains point;
  std::vector<ChainSource> sources;
  /// By the number of a light; fewer where the last ones have none. A light that is followed has an
  /// entry, if only an empty one: its straight rays end at what followed light passes.
  std::vector<std::optional<LightChains>> of_lights;
  ChainsNear near;  ///< The chains of sources that are whole lamps.
  /// Those of the others, by place. Whoever looks for light follows one, drawn for all lamps at
  /// once: the mean over samples is the light of all places.
  std::vector<ChainsNear> near_places;
  /// Per surface: not 0 where light that it lets pass comes on chains.
  std::vector<std::uint8_t> surface_is_exact;
  /// Whether straight lines may cross more facets of glass than chains do.
  bool exceeds_chains = false;
  CausticReport report;

  const WorldLight& source_of(const ChainPath& chain) const { return sources[chain.source].light; }
  std::uint32_t lamp_of(const ChainPath& chain) const { return sources[chain.source].lamp; }
  const LightChains* of_light(std::size_t light) const {
    return light < of_lights.size() && of_lights[light] ? &*of_lights[light] : nullptr;
  }
};

}  // namespace abbe
