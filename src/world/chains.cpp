#include "world/chains.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "optics/fresnel.h"
#include "optics/polygon.h"
#include "optics/snell.h"
#include "world/world.h"

namespace abbe {
namespace {

/// A bundle of parallel rays of one wavelength at a facet.
struct Bundle {
  std::vector<Vec3d> polygon;  ///< Where it meets the facet; empty: nothing is left.
  Vec3d direction{0.0};        ///< Behind the facet.
  double power = 0.0;          ///< Share of the power of its rays.
  double weight = 0.0;         ///< Irradiance across the beam over the lamp's.
};

/// The bundles of all wavelengths behind a facet, and a cone that holds them.
struct Front {
  std::vector<Bundle> bundles;
  Vec3d center{0.0};
  double radius_m = 0.0;
  Vec3d axis{0.0, 0.0, 1.0};
  double tan_spread = 0.0;

  bool is_alive() const { return radius_m > 0.0; }

  void bound() {
    Vec3d low(std::numeric_limits<double>::infinity());
    Vec3d high = -low;
    Vec3d sum(0.0);
    for (const Bundle& bundle : bundles) {
      for (const Vec3d& corner : bundle.polygon) {
        low = glm::min(low, corner);
        high = glm::max(high, corner);
      }
      if (!bundle.polygon.empty()) sum += bundle.direction;
    }
    radius_m = 0.0;
    if (!(glm::length(sum) > 0.0)) return;
    center = 0.5 * (low + high);
    axis = glm::normalize(sum);
    double cosine = 1.0;
    for (const Bundle& bundle : bundles) {
      if (bundle.polygon.empty()) continue;
      cosine = std::min(cosine, glm::dot(axis, bundle.direction));
      for (const Vec3d& corner : bundle.polygon) {
        radius_m = std::max(radius_m, glm::distance(corner, center));
      }
    }
    // Wider than 84°: a cone is no help.
    tan_spread = cosine > 0.1 ? std::sqrt(std::max(0.0, 1.0 - cosine * cosine)) / cosine : 1e30;
  }

  bool may_meet(const Facet& facet) const {
    if (tan_spread > 1e29) return true;
    const Vec3d v = facet.center - center;
    const double along = glm::dot(v, axis);
    const double reach = radius_m + facet.radius_m;
    if (along < -reach) return false;
    const double across = std::sqrt(std::max(0.0, glm::dot(v, v) - along * along));
    return across <= reach * (1.0 + tan_spread) + std::max(along, 0.0) * tan_spread;
  }
};

class Builder {
 public:
  Builder(const Scene& scene, const CausticOptions& options, World& world)
      : scene_(scene), options_(options), world_(world), facets_(world.flat.facets) {
    lanes_ = static_cast<std::size_t>(world.lanes.lane_count());
    waves_ = lanes_ * static_cast<std::size_t>(world.lanes.set_count());
    find_inclusions();
  }

  void add_parallel(std::uint32_t light) {
    light_ = light;
    direction_ = glm::normalize(Vec3d(scene_.lights[light].to_world * Vec4d(0.0, 0.0, -1.0, 0.0)));
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
  }

  void finish() {
    std::stable_sort(world_.chains.begin(), world_.chains.end(),
                     [](const Chain& a, const Chain& b) { return a.largest > b.largest; });
    world_.caustics.chains = world_.chains.size();
    const double started = started_ * static_cast<double>(waves_);
    world_.caustics.share_cut = started > 0.0 ? cut_ / started : 0.0;
  }

 private:
  double value(RowId row, std::size_t wave) const {
    return static_cast<double>(world_.row(row, static_cast<int>(wave / lanes_))[wave % lanes_]);
  }
  const SurfaceMaterial& material_of(const Facet& facet) const {
    return world_.materials[world_.flat.bodies[facet.body].material];
  }

  // Bodies that something reaches into or lies in, by their boxes.
  void find_inclusions() {
    has_inclusions_.assign(world_.flat.bodies.size(), 0);
    std::vector<Box3f> boxes;
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
      boxes.push_back(bounds_of(scene_, scene_.instances[i]));
    }
    for (std::size_t b = 0; b < world_.flat.bodies.size(); ++b) {
      const Box3f& own = boxes[world_.flat.bodies[b].instance];
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (i == world_.flat.bodies[b].instance) continue;
        const bool apart = glm::any(glm::lessThan(boxes[i].high, own.low)) ||
                           glm::any(glm::lessThan(own.high, boxes[i].low));
        if (!apart) has_inclusions_[b] = 1;
      }
    }
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
      double reflectance = 0.0;
      if (body.is_mirror) {
        const double color = value(material.base_color, w);
        reflectance = material.is_conductor
                          ? fresnel_conductor(cosine, value(material.conductor_n, w),
                                              value(material.conductor_k, w))
                          : fresnel_schlick(cosine, color, 1.0);
      } else {
        const double n = value(material.index, w);
        const DielectricFresnel fresnel = fresnel_dielectric(cosine, n);
        reflectance = fresnel.reflectance();
        const double share = fresnel.transmittance() * value(material.base_color, w);
        Bundle& after = entered.bundles[w];
        after.direction = *refracted_direction(before.direction, facet.normal, n);
        after.power *= share;
        after.weight *= share * cosine / fresnel.cos_transmitted;
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
      const DielectricFresnel fresnel = fresnel_dielectric(cosine, 1.0 / n);
      Bundle& mirrored = reflected.bundles[w];
      mirrored.direction = reflected_direction(before.direction, facet.normal);
      mirrored.power *= fresnel.reflectance();
      mirrored.weight *= fresnel.reflectance();
      Bundle& out = left.bundles[w];
      const auto direction = refracted_direction(before.direction, facet.normal, 1.0 / n);
      if (!direction || !(fresnel.cos_transmitted > 0.0)) {
        out.polygon.clear();
        continue;
      }
      const double share = fresnel.transmittance() * value(material.base_color, w);
      out.direction = *direction;
      out.power *= share;
      out.weight *= share * cosine / fresnel.cos_transmitted;
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
    const Facet& facet = facets_[f];
    const FlatBody& body = world_.flat.bodies[facet.body];
    ChainStep step;
    step.event = event;
    step.facet = f;
    step.material = body.material;
    step.normal = Vec3f(facet.normal);
    step.is_checked = (event == ChainEvent::Leave || event == ChainEvent::ReflectInside) &&
                      (!body.is_convex || has_inclusions_[facet.body] != 0);
    return step;
  }

  // Adds the chain of steps_ unless it is too weak; returns whether it is there.
  bool emit(Front& front, bool ends_inside) {
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
    chain.origin = Vec3f(last.center);
    const Vec3d origin(chain.origin);
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
  std::vector<std::uint8_t> has_inclusions_;
  std::uint32_t light_ = 0;
  Vec3d direction_{0.0};
  std::vector<ChainStep> steps_;
  double started_ = 0.0, cut_ = 0.0;
};

}  // namespace

void add_chains(const Scene& scene, const CausticOptions& options, Notes& notes, World& world) {
  world.surface_is_exact.assign(world.surfaces.size(), 0);
  if (!options.exact || scene.lights.empty()) return;
  world.flat = find_flat_bodies(scene, notes);
  world.caustics.bodies = world.flat.bodies.size();
  world.caustics.facets = world.flat.facets.size();
  world.caustics.fallbacks = world.flat.fallbacks;
  if (world.flat.bodies.empty()) return;
  for (const FlatBody& body : world.flat.bodies) {
    if (!body.is_mirror) world.surface_is_exact[body.instance] = 1;
  }
  Builder builder(scene, options, world);
  for (std::uint32_t light = 0; light < scene.lights.size(); ++light) {
    if (scene.lights[light].type == LightType::Directional) {
      builder.add_parallel(light);
      world.lights[light].has_chains = true;
    }
  }
  builder.finish();
}

}  // namespace abbe
