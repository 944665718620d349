#include "abbe/caustics/flat/search/find.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "abbe/caustics/flat/search/parallel_chains.h"
#include "abbe/caustics/flat/search/point_chains.h"
#include "abbe/world/light/lamp_places.h"

namespace abbe {
namespace {

// Places that stand for a lamp with an extent: each has chains of its own, and what they cost to
// find and keep grows with the facets.
std::size_t places_of_lamps(std::size_t facets) {
  if (facets < 64) return 16;
  return facets <= 1024 ? 4 : 1;
}

/// The chains of all lights.
struct FoundChains {
  std::vector<ChainSource> sources;
  ParallelChains parallel;
  PointChains point;
  double share_cut = 0.0;
  double share_too_long = 0.0;
  double share_no_room = 0.0;
  std::vector<BodyLight> by_body;
};

FoundChains find_chains(const Scene& scene, const ChainSearch& search) {
  FoundChains found;
  found.parallel.lane_stride = static_cast<std::size_t>(search.tables.lanes.lane_stride());
  found.parallel.set_count = static_cast<std::size_t>(search.tables.lanes.set_count());
  found.by_body.resize(search.flat.bodies.size());
  double started = 0.0;
  double cut = 0.0;
  const std::size_t count = places_of_lamps(search.flat.facets.size());
  std::size_t parallel_left = 0;
  for (const Light& light : scene.lights) {
    if (is_parallel(light)) parallel_left += light.shape ? count : 1;
  }
  for (std::uint32_t number = 0; number < scene.lights.size(); ++number) {
    const std::vector<LampPlace> places = lamp_places(scene.lights[number], count);
    for (std::uint32_t p = 0; p < places.size(); ++p) {
      const LampPlace& place = places[p];
      const auto source = static_cast<std::uint32_t>(found.sources.size());
      found.sources.push_back(
          {at_place(search.tables.lights[number], place), number, p, places.size() > 1});
      const ChainYield yield =
          is_parallel(place.light)
              ? add_parallel_chains(search, place, source, parallel_left--, found.parallel)
              : add_point_chains(search, place.light, source, found.point);
      // Lux on square metres and candela in steradians are both lumens.
      const double lumens = place.light.intensity / static_cast<double>(places.size());
      started += yield.started * lumens;
      cut += yield.cut * lumens;
      for (std::size_t b = 0; b < yield.by_body.size(); ++b) {
        found.by_body[b].started += yield.by_body[b].started * lumens;
        found.by_body[b].faint += yield.by_body[b].faint * lumens;
        found.by_body[b].too_long += yield.by_body[b].too_long * lumens;
        found.by_body[b].no_room += yield.by_body[b].no_room * lumens;
      }
    }
  }
  if (!(started > 0.0)) return found;
  found.share_cut = cut / started;
  for (BodyLight& body : found.by_body) {
    body = {body.started / started, body.faint / started, body.too_long / started,
            body.no_room / started};
    found.share_too_long += body.too_long;
    found.share_no_room += body.no_room;
  }
  return found;
}

// Says how much light is left out, and why, if it is worth a word.
void tell(const FoundChains& found, const CausticOptions& options, Notes& notes) {
  constexpr double kWorthAWord = 0.01;
  if (!(found.share_cut > kWorthAWord)) return;
  const double faint = found.share_cut - found.share_too_long - found.share_no_room;
  const bool is_most = options.inner_reflections >= CausticOptions::kMostInnerReflections;
  std::string text = fmt::format(
      "{:.1f} % of the light of lamps on flat glass and mirrors is left out: {:.1f} % takes paths "
      "with more than {} reflections{}, {:.1f} % faint ones (a smaller --cutoff "
      "takes more)",
      100.0 * found.share_cut, 100.0 * found.share_too_long, options.inner_reflections,
      is_most ? "" : " (--chain takes more)", 100.0 * faint);
  if (found.share_no_room > 0.0) {
    text += fmt::format(", {:.1f} % the faintest of too many paths of parallel light",
                        100.0 * found.share_no_room);
  }
  notes.warn("", text);
}

std::vector<Vec2d> index_ranges(const TabulatedScene& tables) {
  std::vector<Vec2d> ranges;
  for (const SurfaceMaterial& material : tables.materials) {
    for (int set = 0; set < tables.lanes.set_count(); ++set) {
      const float* n = tables.row(material.index, set);
      const auto [least, greatest] = std::minmax_element(n, n + tables.lanes.lane_count());
      ranges.emplace_back(*least, *greatest);
    }
  }
  return ranges;
}

std::vector<std::optional<LightChains>> by_light(const FlatCaustics& all, std::size_t lights) {
  std::vector<std::optional<LightChains>> result(lights, LightChains{});
  for (std::uint32_t i = 0; i < all.parallel.chains.size(); ++i) {
    result[all.lamp_of(all.parallel.chains[i])]->parallel.push_back(i);
  }
  for (std::uint32_t i = 0; i < all.point.chains.size(); ++i) {
    result[all.lamp_of(all.point.chains[i])]->point.push_back(i);
  }
  return result;
}

// Fills near and near_places.
void index_chains(const Box3f& bounds, FlatCaustics& all) {
  std::size_t places = 0;
  for (const ChainSource& source : all.sources) {
    if (source.is_part) places = std::max<std::size_t>(places, source.place + 1);
  }
  // Of whole lamps, then of each place.
  std::vector<LightChains> numbers(places + 1);
  const auto of = [&](const ChainPath& chain) -> LightChains& {
    const ChainSource& source = all.sources[chain.source];
    return numbers[source.is_part ? source.place + 1 : 0];
  };
  for (std::uint32_t i = 0; i < all.parallel.chains.size(); ++i) {
    of(all.parallel.chains[i]).parallel.push_back(i);
  }
  for (std::uint32_t i = 0; i < all.point.chains.size(); ++i) {
    of(all.point.chains[i]).point.push_back(i);
  }
  all.near_places.resize(places);
  for (std::size_t i = 0; i <= places; ++i) {
    ChainsNear& near = i == 0 ? all.near : all.near_places[i - 1];
    near.parallel_count = numbers[i].parallel.size();
    near.point_count = numbers[i].point.size();
    // Parallel light is asked about for whole pixels.
    near.parallel = ChainIndex(bounds, std::move(numbers[i].parallel), 1.0f, places + 1);
    near.point = ChainIndex(bounds, std::move(numbers[i].point), 0.125f, places + 1);
  }
}

}  // namespace

FlatCaustics find_flat_caustics(const Scene& scene, const TabulatedScene& tables,
                                const CausticOptions& options, Notes& notes) {
  FlatCaustics result;
  result.surface_is_exact.assign(scene.instances.size(), 0);
  if (!options.exact || scene.lights.empty()) return result;
  result.flat = find_flat_bodies(scene, notes);
  const Regions regions(result.flat);
  Obstacles obstacles(scene, result.flat);
  FoundChains found = find_chains(scene, {result.flat, regions, tables, options, obstacles});
  tell(found, options, notes);
  const FlatBodies& flat = result.flat;
  result.report = {.bodies = flat.bodies.size(),
                   .facets = flat.facets.size(),
                   .chains = found.parallel.chains.size() + found.point.chains.size(),
                   .share_cut = found.share_cut,
                   .share_too_long = found.share_too_long,
                   .share_no_room = found.share_no_room,
                   .by_body = found.by_body,
                   .fallbacks = flat.fallbacks};
  if (flat.bodies.empty()) return result;
  std::size_t crossings = 0;
  for (const FlatBody& body : flat.bodies) {
    if (!body.is_mirror) crossings += body.is_convex ? 2 : body.facet_count;
    const bool ends_light = body.facet_count > 0 || body.is_covered;
    if (!body.is_mirror && ends_light) result.surface_is_exact[body.instance] = 1;
  }
  result.exceeds_chains = crossings > kMaxRefractions;
  result.parallel = std::move(found.parallel);
  result.point = std::move(found.point);
  result.sources = std::move(found.sources);
  std::stable_sort(
      result.parallel.chains.begin(), result.parallel.chains.end(),
      [](const ParallelChain& a, const ParallelChain& b) { return a.weight > b.weight; });
  sort_point_chains(result.point);
  if (!result.point.chains.empty()) {
    result.point.set_count = static_cast<std::size_t>(tables.lanes.set_count());
    result.point.index_ranges = index_ranges(tables);
  }
  const Box3d all = bounds_of(scene);
  Box3f bounds;
  if (!all.is_empty()) bounds = {Vec3f(all.low), Vec3f(all.high)};
  index_chains(bounds, result);
  result.of_lights = by_light(result, scene.lights.size());
  return result;
}

}  // namespace abbe
