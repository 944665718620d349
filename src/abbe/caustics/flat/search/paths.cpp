#include "abbe/caustics/flat/search/paths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "abbe/math/polygon.h"
#include "abbe/math/spherical_triangle.h"
#include "abbe/world/light/lights.h"

namespace abbe {
namespace {

constexpr std::uint32_t kNoFacet = std::numeric_limits<std::uint32_t>::max();

// Rays of a lamp: at first, and steps of all of them at most, about a second.
constexpr double kFirstRays = 8192.0;
// For each polygon at least so many, but where there are too many of them.
constexpr std::size_t kFewestRays = 64;
constexpr std::size_t kFewestRaysInAll = 16384;
constexpr std::size_t kMostSteps = 3000000;
// More are sent while paths that only one of them took carry more of the light than this: what no
// ray has found is about as much. Source: Good, The population frequencies of species and the
// estimation of population parameters, Biometrika 40, 1953.
constexpr double kUnknownShare = 0.0002;
// Paths that carry less of the light that falls on their first body are left out, of those that
// keep more than kBright of their light a third of that, and of those that go on without losing any
// to reflection at glass all that matter at all. The share is halved while more than kMostCut of
// the light is left out, if that does not take too many steps of paths.
constexpr double kLeastShare = 2e-4;
constexpr double kLeastMainShare = 1e-7;
constexpr double kBright = 0.01;
constexpr double kBrightShare = 1.0 / 3.0;
constexpr double kMostCut = 0.0075;
constexpr double kMostKept = 4000.0;
// It is raised by half while more steps of paths than this would be left.
constexpr double kMostPaths = 20000.0;
// All that is for this cutoff. Whoever asks for a smaller one gets as many times more.
constexpr double kUsualCutoff = 1e-4;
// Light that meets so many facets without being let out is trapped.
constexpr int kTrappedSteps = 256;

/// A polygon that a lamp shines on.
struct LitPolygon {
  FacetSide side;
  std::vector<Vec3d> corners;
  /// What falls on its triangles about the first corner: their solid angles seen from a lamp, or
  /// areas across parallel light.
  std::vector<double> triangles = {};
  double flux = 0.0;     ///< Of all of them.
  std::size_t rays = 0;  ///< In the first round.
};

class PathFinder {
 public:
  /// Follows light of one wave, of all of them without one.
  PathFinder(const ChainSearch& search, const Light& light, std::optional<std::size_t> wave)
      : search_(search),
        only_wave_(wave),
        regions_(search.regions),
        light_(light),
        is_parallel_(is_parallel(light)),
        direction_(direction_of(light)),
        lamp_(light.to_world[3]),
        by_body_(search.flat.bodies.size()),
        ask_(std::clamp(search.options.cutoff / kUsualCutoff, 0.1, 1.0)) {
    const FlatBodies& flat = search.flat;
    face_of_.resize(flat.facets.size());
    for (std::uint32_t face = 0; face < flat.faces.size(); ++face) {
      for (std::uint32_t i = 0; i < flat.faces[face].facet_count; ++i) {
        face_of_[flat.faces[face].first_facet + i] = face;
      }
    }
  }

  PathTree run() {
    tree_.nodes.resize(1);
    if (!is_parallel_) tree_.nodes[0].region = regions_.at(lamp_);
    find_lit_polygons();
    double flux = 0.0;
    for (const LitPolygon& polygon : lit_) flux += polygon.flux;
    if (!(flux > 0.0)) return std::move(tree_);
    const std::size_t fewest = std::min(kFewestRays, kFewestRaysInAll / lit_.size());
    for (LitPolygon& polygon : lit_) {
      const auto share = static_cast<std::size_t>(kFirstRays * polygon.flux / flux);
      polygon.rays = std::max({share, fewest, std::size_t{1}});
    }
    double rounds = 1.0;
    for (std::size_t first = 0, last = 1;; first = last, last *= 2, rounds *= 2.0) {
      for (const LitPolygon& polygon : lit_) send(polygon, first, last);
      if (steps_ > kMostSteps || unknown_share() < kUnknownShare) break;
    }
    for (PathNode& node : tree_.nodes) {
      node.flux /= rounds;
      node.sent /= rounds;
    }
    for (BodyLight& light : by_body_) light.started /= rounds;
    // Children come after their parents.
    for (std::size_t i = tree_.nodes.size(); i-- > 1;) {
      PathNode& node = tree_.nodes[i];
      for (const std::uint32_t child : node.children) node.useful += tree_.nodes[child].useful;
      if (search_.lights_places(node.region)) node.useful += node.flux;
      node.useful = std::min(node.useful, node.flux);
    }
    PathTree result = kept(ask_ * kLeastShare);
    for (double least = 1.5 * ask_ * kLeastShare;
         static_cast<double>(result.nodes.size()) > kMostPaths / ask_; least *= 1.5) {
      result = kept(least);
    }
    for (double least = 0.5 * ask_ * kLeastShare;
         result.cut > ask_ * kMostCut * result.started && least > kLeastMainShare; least *= 0.5) {
      PathTree more = kept(least);
      if (static_cast<double>(more.nodes.size()) > kMostKept / ask_) break;
      result = std::move(more);
    }
    result.cut = 0.0;
    for (const BodyLight& light : result.by_body) result.cut += light.faint + light.too_long;
    return result;
  }

 private:
  /// Light behind a facet.
  struct RayState {
    Vec3d place{0.0}, direction{0.0};
    double power = 0.0;  ///< Share of what the ray started with.
    std::uint32_t node = 0;
    std::uint32_t facet = 0;
    int steps = 0, refractions = 0, inner_reflections = 0;
  };

  void find_lit_polygons() {
    const std::vector<HalfSpace> beam = is_parallel_ ? beam_bounds(light_) : spot_bounds(light_);
    for (const Regions::Group& group : regions_.border(tree_.nodes[0].region)) {
      for (const FacetSide& side : group.sides) {
        const Facet& facet = search_.flat.facets[side.facet];
        const double height = is_parallel_ ? glm::dot(facet.normal, direction_)
                                           : facet.distance - glm::dot(facet.normal, lamp_);
        if (side.from_inside ? height <= 0.0 : height >= 0.0) continue;
        LitPolygon polygon{side, facet.corners};
        for (const HalfSpace& bound : beam) {
          polygon.corners = clipped(polygon.corners, bound.normal, bound.distance);
        }
        if (polygon.corners.size() < 3) continue;
        for (std::size_t i = 2; i < polygon.corners.size(); ++i) {
          polygon.triangles.push_back(light_on(triangle_of(polygon, i)));
          polygon.flux += polygon.triangles.back();
        }
        if (!(polygon.flux > 0.0)) continue;
        lit_.push_back(std::move(polygon));
      }
    }
  }

  using Triangle = std::array<Vec3d, 3>;

  // Between the first corner of a polygon and corners last − 1 and last.
  static Triangle triangle_of(const LitPolygon& polygon, std::size_t last) {
    return {polygon.corners[0], polygon.corners[last - 1], polygon.corners[last]};
  }

  // What falls on a triangle; m² of parallel light, sr of a lamp.
  double light_on(const Triangle& t) const {
    if (is_parallel_)
      return 0.5 * std::abs(glm::dot(direction_, glm::cross(t[1] - t[0], t[2] - t[0])));
    return solid_angle(t[0] - lamp_, t[1] - lamp_, t[2] - lamp_);
  }

  // A place of a polygon; all get the same light. Source: Roberts, The unreasonable effectiveness
  // of quasirandom sequences, 2018.
  Vec3d place_of(const LitPolygon& polygon, std::size_t number) const {
    const auto at = static_cast<double>(number);
    double u = std::fmod(0.5 + at * 0.7548776662466927, 1.0) * polygon.flux;
    const double v = std::fmod(0.5 + at * 0.5698402909980532, 1.0);
    std::size_t i = 0;
    for (; i + 1 < polygon.triangles.size() && u >= polygon.triangles[i]; ++i) {
      u -= polygon.triangles[i];
    }
    const double light = polygon.triangles[i];
    const Triangle t = triangle_of(polygon, i + 2);
    const double share = light > 0.0 ? std::clamp(u / light, 0.0, 1.0) : 0.0;
    if (is_parallel_ || light < kLeastSolidAngle_sr) {
      const double root = std::sqrt(share);
      return (1.0 - root) * t[0] + root * (1.0 - v) * t[1] + root * v * t[2];
    }
    const Vec3d direction =
        direction_to_triangle(t[0] - lamp_, t[1] - lamp_, t[2] - lamp_, {share, v});
    const Vec3d normal = glm::cross(t[1] - t[0], t[2] - t[0]);
    const double away = glm::dot(normal, t[0] - lamp_) / glm::dot(normal, direction);
    return std::isfinite(away) ? lamp_ + away * direction : t[0];
  }

  // Rays of a polygon, rounds [first, last) of them.
  void send(const LitPolygon& polygon, std::size_t first, std::size_t last) {
    const Facet& facet = search_.flat.facets[polygon.side.facet];
    ray_flux_ = polygon.flux / static_cast<double>(polygon.rays);
    for (std::size_t i = first * polygon.rays; i < last * polygon.rays; ++i) {
      const Vec3d place = place_of(polygon, i);
      const Vec3d offset = place - lamp_;
      const double length = glm::length(offset);
      const Vec3d direction = is_parallel_ ? direction_ : offset / length;
      if (is_shaded(polygon.side.facet, place, direction, length)) continue;
      wave_ = search_.wave(only_wave_.value_or((i * 7919) % search_.waves()));
      first_body_ = facet.body;
      is_counted_ = i < polygon.rays;
      by_body_[first_body_].started += ray_flux_;
      arrive({place, direction, 1.0}, polygon.side);
      while (!pending_.empty()) {
        const RayState ray = pending_.back();
        pending_.pop_back();
        const Region region = tree_.nodes[ray.node].region;
        ++steps_;
        const auto hit = regions_.first_hit(region, ray.place, ray.direction, ray.facet);
        if (!hit) continue;
        RayState there = ray;
        there.place += hit->distance_m * ray.direction;
        arrive(there, hit->side);
      }
    }
  }

  // Whether light comes to a place only over other facets, or not at all.
  bool is_shaded(std::uint32_t facet, const Vec3d& place, const Vec3d& direction,
                 double length) const {
    if (is_parallel_) return regions_.first_hit({}, place, -direction, facet).has_value();
    if (!may_shine_on(light_, place, 0.0, direction, 0.0)) return true;
    const auto hit = regions_.first_hit(tree_.nodes[0].region, lamp_, direction, kNoFacet);
    return hit && hit->side.facet != facet && hit->distance_m < length * (1.0 - 1e-9);
  }

  void arrive(const RayState& ray, const FacetSide& side) {
    const Facet& facet = search_.flat.facets[side.facet];
    const FacetAnswer answer =
        answer_of(search_.tables, search_.media_of(facet), wave_, facet.normal, ray.direction);
    if (ray.steps == static_cast<int>(kMaxChainSteps)) {
      stop(ray, side, answer.transmitted, answer);
      return stop(ray, side, answer.reflected, answer);
    }
    RayState next = ray;
    next.facet = side.facet;
    ++next.steps;
    const auto go_on = [&](ChainEvent event, double share, const Vec3d& direction) {
      RayState there = next;
      there.power *= share;
      if (there.power < search_.options.cutoff) {
        if (is_counted_) by_body_[first_body_].faint += ray_flux_ * there.power;
        return;
      }
      there.direction = direction;
      there.node = step(ray.node, side, event);
      PathNode& node = tree_.nodes[there.node];
      node.flux += ray_flux_ * there.power;
      node.sent += ray_flux_;
      ++node.rays;
      pending_.push_back(there);
    };
    if (ray.inner_reflections < search_.options.inner_reflections || !side.from_inside) {
      if (side.from_inside) ++next.inner_reflections;
      go_on(side.from_inside ? ChainEvent::ReflectInside : ChainEvent::ReflectOutside,
            answer.reflected, answer.reflected_direction);
      next.inner_reflections = ray.inner_reflections;
    } else {
      stop(ray, side, answer.reflected, answer);
    }
    if (ray.refractions == static_cast<int>(kMaxRefractions)) {
      return stop(ray, side, answer.transmitted, answer);
    }
    ++next.refractions;
    go_on(side.from_inside ? ChainEvent::Leave : ChainEvent::Enter, answer.transmitted,
          answer.refracted_direction);
  }

  // Light that would go on, but has had all the facets that a chain may have. It counts if it would
  // get out, or has.
  void stop(RayState ray, FacetSide side, double share, FacetAnswer answer) {
    if (!is_counted_ || !(share > 0.0)) return;
    const double flux = ray_flux_ * ray.power * share;
    const Region region = tree_.nodes[ray.node].region;
    for (int i = 0; !(answer.transmitted > 0.0); ++i) {
      ray.direction = answer.reflected_direction;
      const auto hit = regions_.first_hit(region, ray.place, ray.direction, side.facet);
      if (!hit || i == kTrappedSteps) return;
      side = hit->side;
      ray.place += hit->distance_m * ray.direction;
      const Facet& facet = search_.flat.facets[side.facet];
      answer =
          answer_of(search_.tables, search_.media_of(facet), wave_, facet.normal, ray.direction);
    }
    by_body_[first_body_].too_long += flux;
  }

  // The child of a node, made where it is not there.
  std::uint32_t step(std::uint32_t node, const FacetSide& side, ChainEvent event) {
    const std::uint32_t place = is_parallel_ ? side.facet : face_of_[side.facet];
    const std::uint32_t known = tree_.child(node, place, event);
    if (known != 0) return known;
    const auto number = static_cast<std::uint32_t>(tree_.nodes.size());
    const Region region = refracts(event) ? regions_.behind(side) : tree_.nodes[node].region;
    tree_.nodes[node].children.push_back(number);
    tree_.nodes.push_back({place, event, region});
    return number;
  }

  // Light that ends on paths which only one ray has taken, of all.
  double unknown_share() const {
    double all = 0.0;
    double single = 0.0;
    for (std::size_t i = 1; i < tree_.nodes.size(); ++i) {
      const PathNode& node = tree_.nodes[i];
      double ends = node.flux;
      for (const std::uint32_t child : node.children) ends -= tree_.nodes[child].flux;
      ends = std::max(ends, 0.0);
      all += ends;
      if (node.rays == 1) single += ends;
    }
    return all > 0.0 ? single / all : 0.0;
  }

  LaneMask lanes() const {
    if (!only_wave_) return LaneMask::first(static_cast<int>(search_.lanes()));
    LaneMask one;
    one.set(search_.wave(*only_wave_).lane);
    return one;
  }

  std::uint32_t body_of(const PathNode& node) const {
    const FlatBodies& flat = search_.flat;
    return is_parallel_ ? flat.facets[node.place].body : flat.faces[node.place].body;
  }

  // The paths that carry at least a share of the light that falls on their first body.
  PathTree kept(double least) const {
    PathTree kept;
    kept.nodes.resize(1);
    kept.nodes[0].region = tree_.nodes[0].region;
    kept.by_body = by_body_;
    for (const std::uint32_t child : tree_.nodes[0].children) {
      BodyLight& light = kept.by_body[body_of(tree_.nodes[child])];
      keep(child, 0, true, least * light.started, kept, light);
    }
    for (const BodyLight& light : kept.by_body) kept.started += light.started;
    return kept;
  }

  // Adds a node and what follows of it, if it carries enough.
  void keep(std::uint32_t from, std::uint32_t parent, bool is_main, double least, PathTree& kept,
            BodyLight& light) const {
    const PathNode& node = tree_.nodes[from];
    is_main &= refracts(node.event) || search_.flat.bodies[body_of(node)].is_mirror;
    const double share = is_main                            ? kLeastMainShare / kLeastShare
                         : node.flux >= kBright * node.sent ? kBrightShare
                                                            : 1.0;
    if (!(node.useful >= share * least && node.useful > 0.0)) {
      kept.cut += node.useful;
      light.faint += node.useful;
      return;
    }
    const auto number = static_cast<std::uint32_t>(kept.nodes.size());
    kept.nodes[parent].children.push_back(number);
    kept.nodes.push_back(node);
    kept.nodes.back().children.clear();
    kept.nodes.back().lanes = lanes();
    double ends = node.useful;
    for (const std::uint32_t child : node.children) {
      ends -= tree_.nodes[child].useful;
      keep(child, number, is_main, least, kept, light);
    }
    // What one ray found stands for as much that none has.
    if (node.rays == 1) light.faint += std::max(ends, 0.0);
  }

  const ChainSearch& search_;
  const std::optional<std::size_t> only_wave_;
  const Regions& regions_;
  const Light& light_;
  const bool is_parallel_;
  const Vec3d direction_, lamp_;
  std::vector<std::uint32_t> face_of_;
  std::vector<LitPolygon> lit_;
  PathTree tree_;
  std::vector<BodyLight> by_body_;  ///< By the body on which it fell first.
  const double ask_;
  std::size_t steps_ = 0;

  // Of the ray at hand.
  double ray_flux_ = 0.0;
  std::uint32_t first_body_ = 0;
  bool is_counted_ = false;  ///< In the first round, what is left out is.
  Wave wave_;
  std::vector<RayState> pending_;
};

// Adds what follows a node of a tree to a node of another.
void join(const PathTree& tree, std::uint32_t from, double share, PathTree& all, std::uint32_t to) {
  for (const std::uint32_t number : tree.nodes[from].children) {
    const PathNode& node = tree.nodes[number];
    std::uint32_t known = all.child(to, node.place, node.event);
    if (known == 0) {
      known = static_cast<std::uint32_t>(all.nodes.size());
      all.nodes[to].children.push_back(known);
      all.nodes.push_back({node.place, node.event, node.region});
    }
    PathNode& there = all.nodes[known];
    there.lanes = there.lanes | node.lanes;
    there.flux += share * node.flux;
    join(tree, number, share, all, known);
  }
}

}  // namespace

std::uint32_t PathTree::child(std::uint32_t node, std::uint32_t place, ChainEvent event) const {
  for (const std::uint32_t child : nodes[node].children) {
    if (nodes[child].place == place && nodes[child].event == event) return child;
  }
  return 0;
}

PathTree find_paths(const ChainSearch& search, const Light& light) {
  if (!search.has_separate_waves()) return PathFinder(search, light, std::nullopt).run();
  PathTree all;
  for (std::size_t wave = 0; wave < search.waves(); ++wave) {
    const PathTree tree = PathFinder(search, light, wave).run();
    const double share = 1.0 / static_cast<double>(search.waves());
    all.nodes.resize(std::max<std::size_t>(all.nodes.size(), 1));
    all.nodes[0].region = tree.nodes[0].region;
    join(tree, 0, share, all, 0);
    all.started += share * tree.started;
    all.cut += share * tree.cut;
    all.by_body.resize(tree.by_body.size());
    for (std::size_t b = 0; b < tree.by_body.size(); ++b) {
      all.by_body[b].started += share * tree.by_body[b].started;
      all.by_body[b].faint += share * tree.by_body[b].faint;
      all.by_body[b].too_long += share * tree.by_body[b].too_long;
    }
  }
  return all;
}

}  // namespace abbe
