#include "abbe/caustics/flat/search/parallel_chains.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "abbe/caustics/flat/facet_optics.h"
#include "abbe/caustics/flat/search/bundle.h"
#include "abbe/caustics/flat/search/rounding.h"
#include "abbe/math/polygon.h"
#include "abbe/optics/snell.h"

namespace abbe {
namespace {

// What the tables of a scene's chains may take, and the fronts of light that may be followed to
// find them: 256 MiB and about ten seconds.
constexpr std::size_t kMaxChainFloats = std::size_t{1} << 26;
constexpr std::size_t kMaxBundleSets = 200000;

class Builder {
 public:
  Builder(const ChainSearch& search, const Light& light, std::uint32_t number,
          ParallelChains& chains)
      : search_(search),
        tables_(search.tables),
        facets_(search.flat.facets),
        beam_(beam_bounds(light)),
        light_(number),
        direction_(direction_of(light)),
        chains_(chains) {
    lanes_ = static_cast<std::size_t>(tables_.lanes.lane_count());
    waves_ = lanes_ * static_cast<std::size_t>(tables_.lanes.set_count());
  }

  ChainYield run() {
    BundleSet lamp;
    lamp.bundles.resize(waves_);
    for (Bundle& bundle : lamp.bundles) {
      bundle.direction = direction_;
      bundle.power = bundle.weight = 1.0;
    }
    for (std::uint32_t f = 0; f < facets_.size(); ++f) {
      const Facet& facet = facets_[f];
      const bool is_mirror = search_.body_of(facet).is_mirror;
      const double cosine = -glm::dot(facet.normal, direction_);
      if (is_mirror ? cosine == 0.0 : cosine <= 0.0) continue;
      const std::vector<Vec3d> polygon = lit_by_beam(facet);
      if (polygon.empty()) continue;
      started_ += area_of(polygon) * std::abs(cosine);
      BundleSet front = lamp;
      for (Bundle& bundle : front.bundles) bundle.polygon = polygon;
      arrive_outside(front, f, kMaxChainBodies);
    }
    const auto waves = static_cast<double>(waves_);
    return {started_, cut_ / waves, too_large_};
  }

 private:
  int set_of(std::size_t wave) const { return static_cast<int>(wave / lanes_); }
  int lane_of(std::size_t wave) const { return static_cast<int>(wave % lanes_); }
  double value(RowId row, std::size_t wave) const {
    return static_cast<double>(tables_.row(row, set_of(wave))[lane_of(wave)]);
  }
  const SurfaceMaterial& material_of(const Facet& facet) const {
    return search_.material_of(search_.body_of(facet));
  }

  // The part of a facet that the lamp's beam falls on.
  std::vector<Vec3d> lit_by_beam(const Facet& facet) const {
    std::vector<Vec3d> polygon = facet.corners;
    for (const HalfSpace& bound : beam_) polygon = clipped(polygon, bound.normal, bound.distance);
    return polygon;
  }

  // Light meets a facet from outside: `front` has its polygons there, directions still before it.
  void arrive_outside(const BundleSet& front, std::uint32_t f, int bodies_left) {
    const Facet& facet = facets_[f];
    const FlatBody& body = search_.body_of(facet);
    const SurfaceMaterial& material = material_of(facet);
    BundleSet entered;
    BundleSet reflected = front;
    if (!body.is_mirror) entered = front;
    for (std::size_t w = 0; w < waves_; ++w) {
      const Bundle& before = front.bundles[w];
      if (before.polygon.empty()) continue;
      const double cosine = std::min(1.0, std::abs(glm::dot(before.direction, facet.normal)));
      const double reflectance =
          facet_reflectance(tables_, material, set_of(w), lane_of(w), cosine, FacetSide::Outside);
      if (!body.is_mirror) {
        const double n = value(material.index, w);
        const auto direction = refracted_direction(before.direction, facet.normal, n);
        const double share = (1.0 - reflectance) * value(material.base_color, w);
        Bundle& after = entered.bundles[w];
        if (direction && share > 0.0) {
          after.direction = *direction;
          after.power *= share;
          after.weight *= share * cosine / std::abs(glm::dot(*direction, facet.normal));
        } else {
          after.polygon.clear();  // A medium thinner than air reflects all of it.
        }
      }
      Bundle& after = reflected.bundles[w];
      after.direction = reflected_direction(before.direction, facet.normal);
      after.power *= reflectance;
      after.weight *= reflectance;
    }
    // Reflection at a surface that light met before would be a chain of two.
    if (steps_.empty()) {
      steps_.push_back(step(f, ChainEvent::ReflectOutside));
      emit(reflected, false);
      steps_.pop_back();
    }
    if (body.is_mirror) return;
    steps_.push_back(step(f, ChainEvent::Enter));
    follow_inside(entered, f, search_.options.inner_reflections, bodies_left - 1);
    steps_.pop_back();
  }

  void follow_inside(BundleSet& front, std::uint32_t from, int reflections_left, int bodies_left) {
    if (++fronts_ > kMaxBundleSets) too_large_ = facets_[steps_.front().facet].body;
    if (too_large_) return;
    front.bound();
    if (!front.is_alive()) return;
    emit(front, true);
    const Facet& last = facets_[from];
    const FlatBody& body = search_.body_of(last);
    for (std::uint32_t g = body.first_facet; g < body.first_facet + body.facet_count; ++g) {
      if (g == from) continue;
      const auto arrived = arrival(front, last, facets_[g], true);
      if (arrived) arrive_inside(*arrived, g, reflections_left, bodies_left);
    }
  }

  // The bundles behind one facet where they meet another; nothing if they miss it.
  std::optional<BundleSet> arrival(const BundleSet& front, const Facet& last, const Facet& facet,
                                   bool inside) const {
    if (!front.may_meet(facet)) return std::nullopt;
    BundleSet arrived = front;
    bool any = false;
    for (Bundle& bundle : arrived.bundles) {
      if (bundle.polygon.empty()) continue;
      bundle.polygon = next_polygon(bundle, last, facet, inside);
      any |= !bundle.polygon.empty();
    }
    if (!any) return std::nullopt;
    return arrived;
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
    std::vector<Vec3d> polygon = clipped_by_shadow(window, bundle.polygon, bundle.direction);
    // A sliver made by rounding.
    if (polygon.empty() || !(area_of(polygon) > 1e-12 * facet.radius_m * facet.radius_m)) return {};
    return polygon;
  }

  void arrive_inside(const BundleSet& front, std::uint32_t g, int reflections_left,
                     int bodies_left) {
    const Facet& facet = facets_[g];
    const SurfaceMaterial& material = material_of(facet);
    BundleSet left = front;
    BundleSet reflected = front;
    bool any_left = false;
    for (std::size_t w = 0; w < waves_; ++w) {
      const Bundle& before = front.bundles[w];
      if (before.polygon.empty()) continue;
      const double n = value(material.index, w);
      const double cosine = std::min(1.0, glm::dot(before.direction, facet.normal));
      const double reflectance =
          facet_reflectance(tables_, material, set_of(w), lane_of(w), cosine, FacetSide::Inside);
      Bundle& mirrored = reflected.bundles[w];
      mirrored.direction = reflected_direction(before.direction, facet.normal);
      mirrored.power *= reflectance;
      mirrored.weight *= reflectance;
      Bundle& out = left.bundles[w];
      const auto direction = refracted_direction(before.direction, facet.normal, 1.0 / n);
      const double cos_out = direction ? glm::dot(*direction, facet.normal) : 0.0;
      if (!(cos_out > 0.0) || !(reflectance < 1.0)) {
        out.polygon.clear();
        continue;
      }
      const double share = (1.0 - reflectance) * value(material.base_color, w);
      out.direction = *direction;
      out.power *= share;
      out.weight *= share * cosine / cos_out;
      any_left = true;
    }
    if (any_left) {
      steps_.push_back(step(g, ChainEvent::Leave));
      if (emit(left, false) && bodies_left > 0) enter_others(left, g, bodies_left);
      steps_.pop_back();
    }
    if (reflections_left > 0 && is_worth_following(reflected)) {
      steps_.push_back(step(g, ChainEvent::ReflectInside));
      follow_inside(reflected, g, reflections_left - 1, bodies_left);
      steps_.pop_back();
    }
  }

  void enter_others(const BundleSet& front, std::uint32_t from, int bodies_left) {
    for (std::uint32_t f = 0; f < facets_.size(); ++f) {
      const Facet& facet = facets_[f];
      if (facet.body == facets_[from].body || search_.body_of(facet).is_mirror) continue;
      const auto arrived = arrival(front, facets_[from], facet, false);
      if (arrived) arrive_outside(*arrived, f, bodies_left);
    }
  }

  // Light that a chain below the cutoff would have carried counts as cut.
  bool is_worth_following(const BundleSet& front) {
    double most = 0.0;
    double carried = 0.0;
    for (const Bundle& bundle : front.bundles) {
      if (bundle.polygon.empty()) continue;
      // Leaving at a grazing angle narrows a beam: power is not yet irradiance. τ·cosθ_i/cosθ_t
      // grows up to 2(n + 1/n) where cosθ_t goes to 0, which is 10.4 for n = 5.
      most = std::max(most, 10.4 * bundle.power);
      carried += flux(bundle);
    }
    if (most >= search_.options.cutoff) return true;
    cut_ += carried;
    return false;
  }

  double flux(const Bundle& bundle) const {
    const Vec3d normal = facets_[steps_.empty() ? 0 : steps_.back().facet].normal;
    return bundle.weight * area_of(bundle.polygon) * std::abs(glm::dot(bundle.direction, normal));
  }

  ChainStep step(std::uint32_t f, ChainEvent event) const {
    return make_chain_step(search_.flat, f, event);
  }

  // Adds the chain of steps_ unless it is too weak; returns whether it is there.
  bool emit(BundleSet& front, bool ends_inside) {
    if (too_large_) return false;
    double largest = 0.0;
    double carried = 0.0;
    std::size_t sides = 0;
    for (const Bundle& bundle : front.bundles) {
      if (bundle.polygon.empty()) continue;
      largest = std::max(largest, bundle.weight);
      if (!ends_inside) carried += flux(bundle);
      sides = std::max(sides, bundle.polygon.size());
    }
    if (!(largest > 0.0)) return false;
    if (largest < search_.options.cutoff) {
      cut_ += carried;
      return false;
    }
    front.bound();
    if (!front.is_alive()) return false;
    ParallelChain chain;
    chain.light = light_;
    chain.steps = steps_;
    chain.ends_inside = ends_inside;
    const Facet& last = facets_[steps_.back().facet];
    const Vec3d origin = rounded_to_single(last.center);
    chain.origin = Vec3f(origin);
    for (ChainStep& s : chain.steps) {
      const Facet& facet = facets_[s.facet];
      s.distance_m = static_cast<float>(facet.distance - glm::dot(facet.normal, origin));
    }
    chain.bound_center = Vec3f(front.ball.center);
    chain.bound_radius_m = static_cast<float>(front.ball.radius_m * 1.001 + 1e-6);
    chain.bound_axis = Vec3f(front.axis);
    chain.bound_tan = static_cast<float>(std::min(front.tan_spread * 1.001 + 1e-5, 1e30));
    chain.side_count = sides + 1;
    chain.largest = static_cast<float>(largest);
    chain.rows = chains_.rows.size();
    chain.bends = std::any_of(steps_.begin(), steps_.end(), [](const ChainStep& s) {
      return s.event == ChainEvent::Enter || s.event == ChainEvent::Leave;
    });
    const std::size_t floats = chain.array_count(chains_.set_count) * chains_.lane_stride;
    if (chain.rows + floats > kMaxChainFloats) {
      too_large_ = facets_[steps_.front().facet].body;
      return false;
    }
    chains_.rows.resize(chain.rows + floats, 0.0f);
    tabulate(front, chain);
    chains_.chains.push_back(std::move(chain));
    return true;
  }

  void tabulate(const BundleSet& front, const ParallelChain& chain) {
    for (int set = 0; set < tables_.lanes.set_count(); ++set) {
      const ParallelChainRows<float> rows = chains_.of(chain, set);
      const auto put = [&](float* row, const Vec3d& v) {
        for (int axis = 0; axis < 3; ++axis) {
          row[static_cast<std::size_t>(axis) * rows.stride] = static_cast<float>(v[axis]);
        }
      };
      for (std::size_t lane = 0; lane < rows.stride; ++lane) {
        const std::size_t wave =
            static_cast<std::size_t>(set) * lanes_ + std::min(lane, lanes_ - 1);
        const Bundle& bundle = front.bundles[wave];
        const bool is_lit = lane < lanes_ && !bundle.polygon.empty();
        rows.weight[lane] = is_lit ? static_cast<float>(bundle.weight) : 0.0f;
        if (!chain.bends && set > 0) continue;
        std::size_t step = 0;
        for (const Vec3d& d : directions(wave)) put(rows.direction(step++) + lane, d);
        std::vector<Vec4d> sides;
        if (is_lit) sides = sides_of(bundle, Vec3d(chain.origin));
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
  std::vector<Vec4d> sides_of(const Bundle& bundle, const Vec3d& origin) const {
    const Facet& last = facets_[steps_.back().facet];
    std::vector<Vec4d> sides;
    const auto add = [&](const Vec3d& normal, const Vec3d& on_it) {
      sides.emplace_back(normal, -glm::dot(normal, on_it - origin));
    };
    const Vec3d ahead = glm::dot(bundle.direction, last.normal) > 0.0 ? last.normal : -last.normal;
    add(ahead, last.corners.front());
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
  std::vector<Vec3d> directions(std::size_t wave) const {
    std::vector<Vec3d> result;
    Vec3d d = direction_;
    for (const ChainStep& s : steps_) {
      const Facet& facet = facets_[s.facet];
      const double n = value(material_of(facet).index, wave);
      switch (s.event) {
        case ChainEvent::Enter:
          d = refracted_direction(d, facet.normal, n).value_or(d);
          break;
        case ChainEvent::Leave:
          d = refracted_direction(d, facet.normal, 1.0 / n).value_or(d);
          break;
        default:
          d = reflected_direction(d, facet.normal);
          break;
      }
      result.push_back(d);
    }
    return result;
  }

  const ChainSearch& search_;
  const TabulatedScene& tables_;
  const std::vector<Facet>& facets_;
  const std::vector<HalfSpace> beam_;
  const std::uint32_t light_;
  const Vec3d direction_;
  ParallelChains& chains_;
  std::size_t lanes_ = 0, waves_ = 0;
  std::vector<ChainStep> steps_;
  double started_ = 0.0, cut_ = 0.0;
  std::size_t fronts_ = 0;
  std::optional<std::uint32_t> too_large_;
};

}  // namespace

ChainYield add_parallel_chains(const ChainSearch& search, const Light& light, std::uint32_t number,
                               ParallelChains& chains) {
  return Builder(search, light, number, chains).run();
}

}  // namespace abbe
