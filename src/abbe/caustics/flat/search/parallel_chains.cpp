#include "abbe/caustics/flat/search/parallel_chains.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "abbe/caustics/flat/search/bundle.h"
#include "abbe/caustics/flat/search/paths.h"
#include "abbe/math/polygon.h"

namespace abbe {
namespace {

// Sides of what a chain lights, as a guess before they are known.
constexpr std::size_t kUsualSides = 8;
// Shorter edges of what a facet passes, in its radii, are made by rounding.
constexpr double kShort = 1e-8;

class Builder {
 public:
  Builder(const ChainSearch& search, const PathTree& tree, const LampPlace& place,
          std::uint32_t source, std::size_t sources_left, ParallelChains& chains)
      : search_(search),
        tables_(search.tables),
        facets_(search.flat.facets),
        tree_(tree),
        light_(place.light),
        times_(place.times),
        source_(source),
        sources_left_(sources_left),
        direction_(direction_of(place.light)),
        chains_(chains),
        waves_(search.waves()),
        no_room_(search.flat.bodies.size(), 0.0) {}

  // Returns by the body that it falls on first the light on paths for which there was no room.
  std::vector<double> run() {
    const auto disperses = [&](const FlatBody& body) {
      return !body.is_mirror && search_.ranges[body.material].disperses();
    };
    const bool is_one =
        std::none_of(search_.flat.bodies.begin(), search_.flat.bodies.end(), disperses);
    BundleSet lamp;
    lamp.bundles.resize(is_one ? 1 : waves_);
    choose(is_one);
    for (Bundle& bundle : lamp.bundles) bundle.direction = direction_;
    lamp.weights.resize(waves_, times_);
    const std::vector<HalfSpace> beam = beam_bounds(light_);
    for (const std::uint32_t child : tree_.nodes[0].children) {
      if (!is_wanted_[child]) continue;
      std::vector<Vec3d> polygon = facets_[tree_.nodes[child].place].corners;
      for (const HalfSpace& bound : beam) {
        polygon = clipped(polygon, bound.normal, bound.distance);
      }
      polygon = without_short_edges(polygon, kShort * facets_[tree_.nodes[child].place].radius_m);
      for (Bundle& bundle : lamp.bundles) bundle.polygon = polygon;
      arrive(lamp, child);
    }
    return no_room_;
  }

 private:
  // Leaves out the paths with least light where there is no room for all. What sources before this
  // one have left is for it and those after it alike.
  void choose(bool is_one) {
    has_room_.assign(tree_.nodes.size(), false);
    std::vector<std::size_t> depths(tree_.nodes.size(), 0);
    std::vector<std::uint32_t> lit;
    first_.assign(tree_.nodes.size(), 0);
    // Children come after their parents.
    for (std::uint32_t number = 0; number < tree_.nodes.size(); ++number) {
      const PathNode& node = tree_.nodes[number];
      for (const std::uint32_t child : node.children) {
        depths[child] = depths[number] + 1;
        first_[child] = number == 0 ? child : first_[number];
      }
      if (number > 0 && search_.lights_places(node.region)) lit.push_back(number);
    }
    std::stable_sort(lit.begin(), lit.end(), [&](std::uint32_t a, std::uint32_t b) {
      return tree_.nodes[a].flux > tree_.nodes[b].flux;
    });
    std::size_t floats = chains_.rows.size();
    const std::size_t left =
        search_.options.table_floats - std::min(floats, search_.options.table_floats);
    const std::size_t most = floats + left / sources_left_;
    for (const std::uint32_t number : lit) {
      const std::size_t arrays = 3 * depths[number] + 4 * kUsualSides;
      floats +=
          chains_.lane_stride * (chains_.set_count + (is_one ? 1 : chains_.set_count) * arrays);
      has_room_[number] = floats <= most;
      if (!has_room_[number]) leave_out(number);
    }
    is_wanted_ = has_room_;
    for (std::size_t number = tree_.nodes.size(); number-- > 1;) {
      for (const std::uint32_t child : tree_.nodes[number].children) {
        if (is_wanted_[child]) is_wanted_[number] = true;
      }
    }
  }

  void leave_out(std::uint32_t number) {
    no_room_[facets_[tree_.nodes[first_[number]].place].body] += tree_.nodes[number].flux;
  }

  // Light meets the facet of a node: `front` has its polygons there, directions still before it.
  void arrive(BundleSet front, std::uint32_t number) {
    const PathNode& node = tree_.nodes[number];
    const Facet& facet = facets_[node.place];
    const FacetMedia media = search_.media_of(facet);
    steps_.push_back(make_chain_step(search_.flat, node.place, node.event));
    weigh(facet, media, front);
    for (std::size_t w = 0; w < front.bundles.size(); ++w) {
      Bundle& bundle = front.bundles[w];
      if (bundle.polygon.empty()) continue;
      const FacetAnswer answer =
          answer_of(tables_, media, search_.wave(w), facet.normal, bundle.direction);
      if (!steps_.back().refracts()) {
        bundle.direction = answer.reflected_direction;
      } else if (passes(answer, facet)) {
        bundle.direction = answer.refracted_direction;
      } else {
        bundle.polygon.clear();
      }
    }
    front.bound();
    if (front.is_alive()) {
      if (has_room_[number]) emit(front, number);
      for (const std::uint32_t child : node.children) {
        if (!is_wanted_[child]) continue;
        BundleSet arrived = front;
        const bool inside = comes_from_inside(tree_.nodes[child].event);
        for (Bundle& bundle : arrived.bundles) {
          if (bundle.polygon.empty()) continue;
          bundle.polygon = next_polygon(bundle, facet, facets_[tree_.nodes[child].place], inside);
        }
        arrive(std::move(arrived), child);
      }
    }
    steps_.pop_back();
  }

  static bool passes(const FacetAnswer& answer, const Facet& facet) {
    return answer.transmitted > 0.0 && glm::dot(answer.refracted_direction, facet.normal) != 0.0;
  }

  // What a facet leaves of each wavelength; the bundles have the directions before it.
  void weigh(const Facet& facet, const FacetMedia& media, BundleSet& front) const {
    const bool is_alike = front.is_one() && search_.range_of(media.inside).is_grey &&
                          search_.range_of(media.outside).is_grey;
    FacetAnswer answer;
    for (std::size_t w = 0; w < waves_; ++w) {
      const Bundle& bundle = front.of(w);
      if (bundle.polygon.empty()) continue;
      if (w == 0 || !is_alike) {
        answer = answer_of(tables_, media, search_.wave(w), facet.normal, bundle.direction);
      }
      if (!steps_.back().refracts()) {
        front.weights[w] *= answer.reflected;
      } else if (passes(answer, facet)) {
        front.weights[w] *=
            answer.transmitted * std::abs(glm::dot(bundle.direction, facet.normal) /
                                          glm::dot(answer.refracted_direction, facet.normal));
      } else {
        front.weights[w] = 0.0;
      }
    }
  }

  std::vector<Vec3d> next_polygon(const Bundle& bundle, const Facet& last, const Facet& facet,
                                  bool inside) const {
    const double cosine = glm::dot(bundle.direction, facet.normal);
    if (inside ? cosine <= 1e-9 : cosine >= -1e-9) return {};
    // What lies behind the last facet cannot be ahead.
    const Vec3d ahead = glm::dot(bundle.direction, last.normal) > 0.0 ? last.normal : -last.normal;
    const std::vector<Vec3d> window =
        clipped(facet.corners, -ahead, -glm::dot(ahead, bundle.polygon.front()));
    if (window.empty()) return {};
    std::vector<Vec3d> polygon = without_short_edges(
        clipped_by_shadow(window, bundle.polygon, bundle.direction), kShort * facet.radius_m);
    // A sliver made by rounding.
    if (polygon.empty() || !(area_of(polygon) > 1e-12 * facet.radius_m * facet.radius_m)) return {};
    return polygon;
  }

  // Adds the chain of steps_.
  void emit(const BundleSet& front, std::uint32_t number) {
    double largest = 0.0;
    std::size_t sides = 0;
    for (std::size_t w = 0; w < waves_; ++w) {
      if (!front.of(w).polygon.empty()) largest = std::max(largest, front.weights[w]);
    }
    for (const Bundle& bundle : front.bundles) sides = std::max(sides, bundle.polygon.size());
    if (!(largest > 0.0)) return;
    ParallelChain chain;
    chain.source = source_;
    chain.steps = steps_;
    const Facet& last = facets_[steps_.back().facet];
    const Vec3d origin = rounded_to_single(last.center);
    chain.origin = Vec3f(origin);
    search_.obstacles.mark(chain);
    for (ChainStep& s : chain.steps) {
      const Facet& facet = facets_[s.facet];
      s.distance_m = static_cast<float>(facet.distance - glm::dot(facet.normal, origin));
    }
    chain.bound_center = Vec3f(front.ball.center);
    chain.bound_radius_m = static_cast<float>(front.ball.radius_m * 1.001 + 1e-6);
    chain.bound_axis = Vec3f(front.axis);
    chain.bound_tan = static_cast<float>(std::min(front.tan_spread * 1.001 + 1e-5, 1e30));
    chain.side_count = sides + 1;
    chain.weight = static_cast<float>(largest);
    chain.rows = chains_.rows.size();
    chain.disperses =
        !front.is_one() &&
        std::any_of(steps_.begin(), steps_.end(), [](const ChainStep& s) { return s.refracts(); });
    const std::size_t floats = chain.array_count(chains_.set_count) * chains_.lane_stride;
    if (chain.rows + floats > search_.options.table_floats) {
      leave_out(number);
      return;
    }
    chains_.rows.resize(chain.rows + floats, 0.0f);
    tabulate(front, tree_.nodes[number].lanes, chain);
    chains_.chains.push_back(std::move(chain));
  }

  void tabulate(const BundleSet& front, const LaneMask& among, const ParallelChain& chain) {
    const std::size_t lanes = search_.lanes();
    for (int set = 0; set < tables_.lanes.set_count(); ++set) {
      const ParallelChainRows<float> rows = chains_.of(chain, set);
      const auto put = [&](float* row, const Vec3d& v) {
        for (int axis = 0; axis < 3; ++axis) {
          row[static_cast<std::size_t>(axis) * rows.stride] = static_cast<float>(v[axis]);
        }
      };
      for (std::size_t lane = 0; lane < rows.stride; ++lane) {
        const std::size_t wave = static_cast<std::size_t>(set) * lanes + std::min(lane, lanes - 1);
        const Bundle& bundle = front.of(wave);
        const bool is_lit =
            lane < lanes && among.test(static_cast<int>(lane)) && !bundle.polygon.empty();
        rows.weight[lane] = is_lit ? static_cast<float>(front.weights[wave]) : 0.0f;
        if (!chain.disperses && set > 0) continue;
        std::size_t step = 0;
        for (const Vec3d& d : directions(search_.wave(wave))) put(rows.direction(step++) + lane, d);
        std::vector<Vec4d> sides;
        if (is_lit) sides = sides_of(bundle, Vec3d(chain.origin), chain.slack_m);
        // Planes that are not needed hold everything.
        sides.resize(chain.side_count, Vec4d(0.0, 0.0, 0.0, 1.0));
        for (std::size_t side = 0; side < chain.side_count; ++side) {
          float* row = rows.side(side) + lane;
          put(row, Vec3d(sides[side]));
          row[3 * rows.stride] = static_cast<float>(sides[side].w);
        }
      }
    }
  }

  // The planes of what a bundle lights behind the last facet, normal·x + offset ≥ 0 inside.
  std::vector<Vec4d> sides_of(const Bundle& bundle, const Vec3d& origin, double slack_m) const {
    const Facet& last = facets_[steps_.back().facet];
    std::vector<Vec4d> sides;
    const auto add = [&](const Vec3d& normal, const Vec3d& on_it) {
      sides.emplace_back(normal, -glm::dot(normal, on_it - origin));
    };
    const Vec3d ahead = glm::dot(bundle.direction, last.normal) > 0.0 ? last.normal : -last.normal;
    add(ahead, last.corners.front());
    // What the facet stands on is lit, on whichever side of it rounding has put it.
    sides.back().w += slack_m;
    Vec3d middle(0.0);
    for (const Vec3d& corner : bundle.polygon) middle += corner;
    middle /= static_cast<double>(bundle.polygon.size());
    for (std::size_t i = 0; i < bundle.polygon.size(); ++i) {
      const Vec3d& p = bundle.polygon[i];
      const Vec3d edge = bundle.polygon[(i + 1) % bundle.polygon.size()] - p;
      Vec3d normal = glm::cross(edge, bundle.direction);
      const double length = glm::length(normal);
      if (!(length > 1e-12)) continue;
      normal /= length;
      if (glm::dot(normal, middle - p) < 0.0) normal = -normal;
      add(normal, p);
    }
    return sides;
  }

  // The directions after each step at one wavelength, from the start: what the fronts on the way
  // had.
  std::vector<Vec3d> directions(const Wave& wave) const {
    std::vector<Vec3d> result;
    Vec3d d = direction_;
    for (const ChainStep& s : steps_) {
      const Facet& facet = facets_[s.facet];
      const FacetAnswer answer = answer_of(tables_, search_.media_of(facet), wave, facet.normal, d);
      if (!s.refracts()) d = answer.reflected_direction;
      if (s.refracts() && answer.transmitted > 0.0) d = answer.refracted_direction;
      result.push_back(d);
    }
    return result;
  }

  const ChainSearch& search_;
  const TabulatedScene& tables_;
  const std::vector<Facet>& facets_;
  const PathTree& tree_;
  const Light& light_;
  const double times_;
  const std::uint32_t source_;
  const std::size_t sources_left_;
  const Vec3d direction_;
  ParallelChains& chains_;
  const std::size_t waves_;
  std::vector<ChainStep> steps_;
  std::vector<bool> has_room_;        ///< Per node.
  std::vector<bool> is_wanted_;       ///< Of those and what leads to them.
  std::vector<std::uint32_t> first_;  ///< The first step of each.
  std::vector<double> no_room_;       ///< Per body.
};

}  // namespace

ChainYield add_parallel_chains(const ChainSearch& search, const LampPlace& place,
                               std::uint32_t source, std::size_t sources_left,
                               ParallelChains& chains) {
  const PathTree tree = find_paths(search, place.light);
  ChainYield yield{tree.started, tree.cut, tree.by_body};
  if (tree.nodes.empty()) return yield;
  const std::vector<double> no_room =
      Builder(search, tree, place, source, sources_left, chains).run();
  for (std::size_t b = 0; b < yield.by_body.size(); ++b) {
    yield.by_body[b].no_room = no_room[b];
    yield.cut += no_room[b];
  }
  return yield;
}

}  // namespace abbe
