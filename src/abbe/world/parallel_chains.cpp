#include "abbe/world/parallel_chains.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "abbe/math/polygon.h"
#include "abbe/optics/fresnel.h"
#include "abbe/optics/snell.h"
#include "abbe/world/bundle.h"
#include "abbe/world/facet_optics.h"
#include "abbe/world/rounding.h"
#include "abbe/world/world.h"

namespace abbe {
namespace {

// What the tables of a scene's chains may take, and the fronts of light that may be followed to
// find them: 256 MiB and about ten seconds.
constexpr std::size_t kMostChainFloats = std::size_t{1} << 26;
constexpr std::size_t kMostFronts = 200000;

class Builder {
 public:
  Builder(const Scene& scene, const CausticOptions& options, std::uint32_t light, World& world)
      : scene_(scene), options_(options), world_(world), facets_(world.flat.facets), light_(light) {
    lanes_ = static_cast<std::size_t>(world.lanes.lane_count());
    waves_ = lanes_ * static_cast<std::size_t>(world.lanes.set_count());
    direction_ = glm::normalize(Vec3d(scene_.lights[light].to_world * Vec4d(0.0, 0.0, -1.0, 0.0)));
  }

  ChainYield run() {
    Front lamp;
    lamp.bundles.resize(waves_);
    for (Bundle& bundle : lamp.bundles) {
      bundle.direction = direction_;
      bundle.power = bundle.weight = 1.0;
    }
    for (std::uint32_t f = 0; f < facets_.size(); ++f) {
      const Facet& facet = facets_[f];
      const bool is_mirror = world_.flat.bodies[facet.body].is_mirror;
      const double cosine = -glm::dot(facet.normal, direction_);
      if (is_mirror ? cosine == 0.0 : cosine <= 0.0) continue;
      const std::vector<Vec3d> polygon = lit_by_beam(facet);
      if (polygon.empty()) continue;
      started_ += area_of(polygon) * std::abs(cosine);
      Front front = lamp;
      for (Bundle& bundle : front.bundles) bundle.polygon = polygon;
      arrive_outside(front, f, kMostChainBodies);
    }
    const auto waves = static_cast<double>(waves_);
    return {started_, cut_ / waves, too_large_};
  }

 private:
  int set_of(std::size_t wave) const { return static_cast<int>(wave / lanes_); }
  int lane_of(std::size_t wave) const { return static_cast<int>(wave % lanes_); }
  double value(RowId row, std::size_t wave) const {
    return static_cast<double>(world_.row(row, set_of(wave))[lane_of(wave)]);
  }
  const SurfaceMaterial& material_of(const Facet& facet) const {
    return world_.materials[world_.flat.bodies[facet.body].material];
  }

  // The part of a facet in front of the lamp and inside its rectangle.
  std::vector<Vec3d> lit_by_beam(const Facet& facet) const {
    const Light& light = scene_.lights[light_];
    if (!light.beam) return facet.corners;
    const Vec3d origin(light.to_world[3]);
    const Vec3d x = glm::normalize(Vec3d(light.to_world[0]));
    const Vec3d y = glm::normalize(Vec3d(light.to_world[1]));
    std::vector<Vec3d> polygon = clipped(facet.corners, -direction_, -glm::dot(direction_, origin));
    const double half_x = 0.5 * light.beam->width_m;
    const double half_y = 0.5 * light.beam->height_m;
    polygon = clipped(polygon, x, glm::dot(x, origin) + half_x);
    polygon = clipped(polygon, -x, -glm::dot(x, origin) + half_x);
    polygon = clipped(polygon, y, glm::dot(y, origin) + half_y);
    return clipped(polygon, -y, -glm::dot(y, origin) + half_y);
  }

  // Light meets a facet from outside: `front` has its polygons there, directions still before it.
  void arrive_outside(const Front& front, std::uint32_t f, int bodies_left) {
    const Facet& facet = facets_[f];
    const FlatBody& body = world_.flat.bodies[facet.body];
    const SurfaceMaterial& material = material_of(facet);
    Front entered;
    Front reflected = front;
    if (!body.is_mirror) entered = front;
    for (std::size_t w = 0; w < waves_; ++w) {
      const Bundle& before = front.bundles[w];
      if (before.polygon.empty()) continue;
      const double cosine = std::min(1.0, std::abs(glm::dot(before.direction, facet.normal)));
      const double reflectance =
          facet_reflectance(world_, material, set_of(w), lane_of(w), cosine, FacetSide::Outside);
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
    follow_inside(entered, f, options_.inner_reflections, bodies_left - 1);
    steps_.pop_back();
  }

  void follow_inside(Front& front, std::uint32_t from, int reflections_left, int bodies_left) {
    if (++fronts_ > kMostFronts) too_large_ = facets_[steps_.front().facet].body;
    if (too_large_) return;
    front.bound();
    if (!front.is_alive()) return;
    emit(front, true);
    const Facet& last = facets_[from];
    const FlatBody& body = world_.flat.bodies[last.body];
    for (std::uint32_t g = body.first_facet; g < body.first_facet + body.facet_count; ++g) {
      if (g == from || !front.may_meet(facets_[g])) continue;
      const Facet& facet = facets_[g];
      Front arrived = front;
      bool any = false;
      for (Bundle& bundle : arrived.bundles) {
        if (bundle.polygon.empty()) continue;
        bundle.polygon = next_polygon(bundle, last, facet, true);
        any |= !bundle.polygon.empty();
      }
      if (any) arrive_inside(arrived, g, reflections_left, bodies_left);
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
    std::vector<Vec3d> polygon = clipped_by_shadow(window, bundle.polygon, bundle.direction);
    // A sliver made by rounding.
    if (polygon.empty() || !(area_of(polygon) > 1e-12 * facet.radius_m * facet.radius_m)) return {};
    return polygon;
  }

  void arrive_inside(const Front& front, std::uint32_t g, int reflections_left, int bodies_left) {
    const Facet& facet = facets_[g];
    const SurfaceMaterial& material = material_of(facet);
    Front left = front;
    Front reflected = front;
    bool any_left = false;
    for (std::size_t w = 0; w < waves_; ++w) {
      const Bundle& before = front.bundles[w];
      if (before.polygon.empty()) continue;
      const double n = value(material.index, w);
      const double cosine = std::min(1.0, glm::dot(before.direction, facet.normal));
      const double reflectance =
          facet_reflectance(world_, material, set_of(w), lane_of(w), cosine, FacetSide::Inside);
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

  void enter_others(const Front& front, std::uint32_t from, int bodies_left) {
    for (std::uint32_t f = 0; f < facets_.size(); ++f) {
      const Facet& facet = facets_[f];
      if (facet.body == facets_[from].body || world_.flat.bodies[facet.body].is_mirror) continue;
      if (!front.may_meet(facet)) continue;
      Front arrived = front;
      bool any = false;
      for (Bundle& bundle : arrived.bundles) {
        if (bundle.polygon.empty()) continue;
        bundle.polygon = next_polygon(bundle, facets_[from], facet, false);
        any |= !bundle.polygon.empty();
      }
      if (any) arrive_outside(arrived, f, bodies_left);
    }
  }

  // Light that a chain below the cutoff would have carried counts as cut.
  bool is_worth_following(const Front& front) {
    double most = 0.0;
    double carried = 0.0;
    for (const Bundle& bundle : front.bundles) {
      if (bundle.polygon.empty()) continue;
      // Leaving at a grazing angle narrows a beam: power is not yet irradiance. τ·cosθ_i/cosθ_t
      // grows up to 2(n + 1/n) where cosθ_t goes to 0, which is 10.4 for n = 5.
      most = std::max(most, 10.4 * bundle.power);
      carried += flux(bundle);
    }
    if (most >= options_.cutoff) return true;
    cut_ += carried;
    return false;
  }

  double flux(const Bundle& bundle) const {
    const Vec3d normal = facets_[steps_.empty() ? 0 : steps_.back().facet].normal;
    return bundle.weight * area_of(bundle.polygon) * std::abs(glm::dot(bundle.direction, normal));
  }

  ChainStep step(std::uint32_t f, ChainEvent event) const {
    return make_chain_step(world_, f, event);
  }

  // Adds the chain of steps_ unless it is too weak; returns whether it is there.
  bool emit(Front& front, bool ends_inside) {
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
    if (largest < options_.cutoff) {
      cut_ += carried;
      return false;
    }
    front.bound();
    if (!front.is_alive()) return false;
    Chain chain;
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
    chain.bound_center = Vec3f(front.center);
    chain.bound_radius_m = static_cast<float>(front.radius_m * 1.001 + 1e-6);
    chain.bound_axis = Vec3f(front.axis);
    chain.bound_tan = static_cast<float>(std::min(front.tan_spread * 1.001 + 1e-5, 1e30));
    chain.side_count = static_cast<int>(sides) + 1;
    chain.largest = static_cast<float>(largest);
    chain.rows = world_.chain_rows.size();
    const std::size_t floats = chain.array_count() *
                               static_cast<std::size_t>(world_.lanes.set_count()) *
                               static_cast<std::size_t>(world_.lanes.lane_stride());
    if (chain.rows + floats > kMostChainFloats) {
      too_large_ = facets_[steps_.front().facet].body;
      return false;
    }
    tabulate(front, last, origin, chain);
    world_.chains.push_back(std::move(chain));
    return true;
  }

  void tabulate(const Front& front, const Facet& last, const Vec3d& origin, const Chain& chain) {
    const auto stride = static_cast<std::size_t>(world_.lanes.lane_stride());
    const std::size_t arrays = chain.array_count();
    const auto sets = static_cast<std::size_t>(world_.lanes.set_count());
    world_.chain_rows.resize(chain.rows + sets * arrays * stride, 0.0f);
    for (std::size_t set = 0; set < sets; ++set) {
      float* rows = world_.chain_rows.data() + chain.rows + set * arrays * stride;
      for (std::size_t lane = 0; lane < stride; ++lane) {
        const std::size_t wave = set * lanes_ + std::min(lane, lanes_ - 1);
        const Bundle& bundle = front.bundles[wave];
        const bool is_lit = lane < lanes_ && !bundle.polygon.empty();
        std::size_t a = 0;
        const auto put = [&](double v) { rows[a++ * stride + lane] = static_cast<float>(v); };
        put(is_lit ? bundle.weight : 0.0);
        for (const Vec3d& d : directions(wave)) {
          put(d.x);
          put(d.y);
          put(d.z);
        }
        const Vec3d ahead =
            glm::dot(bundle.direction, last.normal) > 0.0 ? last.normal : -last.normal;
        std::size_t side = 0;
        const auto put_side = [&](const Vec3d& normal, const Vec3d& on_it) {
          put(normal.x);
          put(normal.y);
          put(normal.z);
          put(-glm::dot(normal, on_it - origin));
          ++side;
        };
        if (is_lit) {
          put_side(ahead, last.corners.front());
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
            put_side(normal, p);
          }
        }
        // Planes that are not needed hold everything.
        for (; side < static_cast<std::size_t>(chain.side_count); ++side) {
          for (int i = 0; i < 3; ++i) put(0.0);
          put(1.0);
        }
      }
    }
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

  const Scene& scene_;
  const CausticOptions& options_;
  World& world_;
  const std::vector<Facet>& facets_;
  std::size_t lanes_ = 0, waves_ = 0;
  std::uint32_t light_ = 0;
  Vec3d direction_{0.0};
  std::vector<ChainStep> steps_;
  double started_ = 0.0, cut_ = 0.0;
  std::size_t fronts_ = 0;
  std::optional<std::uint32_t> too_large_;
};

}  // namespace

ChainYield add_parallel_chains(const Scene& scene, const CausticOptions& options,
                               std::uint32_t light, World& world) {
  return Builder(scene, options, light, world).run();
}

}  // namespace abbe
