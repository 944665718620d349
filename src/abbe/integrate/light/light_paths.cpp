#include "abbe/integrate/light/light_paths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "abbe/integrate/light/chain_solver.h"
#include "abbe/integrate/surface/point.h"
#include "abbe/world/facet_optics.h"

namespace abbe {
namespace {

// What a place on a facet may be off by, relative to the size of coordinates.
constexpr double kOffFacet = 4e-6;

class Paths {
 public:
  Paths(const World& world, std::uint32_t light, const Vec3d& place, int set,
        std::optional<std::uint32_t> medium)
      : world_(world),
        light_(world.lights[light]),
        number_(light),
        place_(place),
        set_(set),
        medium_(medium) {}

  std::vector<LightChain> all() {
    add_straight();
    const std::size_t straight = chains_.size();
    for (const Chain& chain : world_.chains) {
      if (chain.light != number_ || !ends_here(chain)) continue;
      add(chain, [&](int lane) { return parallel_path(chain, lane); });
    }
    for (const PointChain& chain : world_.point_chains.chains) {
      if (chain.light != number_ || !ends_here(chain)) continue;
      add(chain, [&](int lane) { return point_path(chain, lane); });
    }
    const auto brightest = [](const LightChain& chain) {
      double most = 0.0;
      for (const LightPath& path : chain.paths) most = std::max(most, path.irradiance);
      return most;
    };
    std::stable_sort(
        chains_.begin() + static_cast<std::ptrdiff_t>(straight), chains_.end(),
        [&](const LightChain& a, const LightChain& b) { return brightest(a) > brightest(b); });
    return std::move(chains_);
  }

 private:
  double value(RowId row, int lane) const {
    return static_cast<double>(world_.row(row, set_)[lane]);
  }
  double index(const std::optional<std::uint32_t>& medium, int lane) const {
    return medium ? value(world_.materials[*medium].index, lane) : 1.0;
  }
  double slack_m() const {
    return kOffFacet * (std::abs(place_.x) + std::abs(place_.y) + std::abs(place_.z) + 1.0);
  }

  bool ends_here(const ChainPath& chain) const {
    if (!chain.ends_inside) return !medium_.has_value();
    return medium_ == chain.steps.back().material;
  }

  template <typename Make>
  void add(const ChainPath& chain, const Make& make) {
    LightChain result;
    for (const ChainStep& step : chain.steps) result.events.push_back(step.event);
    for (int lane = 0; lane < world_.lanes.lane_count(); ++lane) {
      if (auto path = make(lane)) {
        path->lane = lane;
        finish(*path);
        result.paths.push_back(std::move(*path));
      }
    }
    if (!result.paths.empty()) chains_.push_back(std::move(result));
  }

  // KHR_lights_punctual's window of distance and cone of a spot.
  double window(double distance_m, const Vec3d& first_direction) const {
    double result = 1.0;
    if (light_.range_m < kInfinity) {
      const double ratio = distance_m / static_cast<double>(light_.range_m);
      result = std::clamp(1.0 - std::pow(ratio, 4), 0.0, 1.0);
    }
    if (light_.type == LightType::Spot) {
      const double cosine = glm::dot(first_direction, Vec3d(light_.direction));
      const double cone = std::clamp(
          cosine * static_cast<double>(light_.spot_scale) + static_cast<double>(light_.spot_offset),
          0.0, 1.0);
      result *= cone * cone;
    }
    return result;
  }

  void add_straight() {
    LightPath path;
    const Vec3d lamp(light_.position);
    if (light_.type == LightType::Directional) {
      path.arrival = Vec3d(light_.direction);
      path.start = place_;
      path.length_m = std::numeric_limits<double>::infinity();
      path.irradiance = 1.0;
      if (light_.is_beam) {
        const Vec3d off = place_ - lamp;
        path.length_m = glm::dot(off, path.arrival);
        if (path.length_m < 0.0 || !is_in_beam(off)) return;
        path.start = place_ - path.length_m * path.arrival;
      }
    } else {
      const Vec3d way = place_ - lamp;
      path.length_m = glm::length(way);
      if (!(path.length_m > 0.0)) return;
      path.arrival = way / path.length_m;
      path.start = lamp;
      path.irradiance = window(path.length_m, path.arrival) / (path.length_m * path.length_m);
    }
    if (!(path.irradiance > 0.0)) return;
    const bool meets = is_blocked(place_, -path.arrival, path.length_m, true);
    if (meets) return;
    LightChain straight;
    for (int lane = 0; lane < world_.lanes.lane_count(); ++lane) {
      LightPath one = path;
      one.lane = lane;
      const double fog_way = std::isfinite(path.length_m) ? path.length_m : 0.0;
      one.transmittance = passes(medium_, fog_way, lane);
      one.irradiance *= one.transmittance;
      straight.paths.push_back(one);
    }
    chains_.push_back(std::move(straight));
  }

  bool is_in_beam(const Vec3d& off) const {
    return std::abs(glm::dot(off, Vec3d(light_.beam_x))) <=
               static_cast<double>(light_.beam_half_x_m) &&
           std::abs(glm::dot(off, Vec3d(light_.beam_y))) <=
               static_cast<double>(light_.beam_half_y_m);
  }

  // What a stretch lets through.
  double passes(const std::optional<std::uint32_t>& medium, double length_m, int lane) const {
    if (medium) {
      const SurfaceMaterial& material = world_.materials[*medium];
      if (!material.absorption_per_m) return 1.0;
      return std::exp(-value(*material.absorption_per_m, lane) * length_m);
    }
    if (!world_.fog) return 1.0;
    return std::exp(-static_cast<double>(world_.fog->extinction_per_m) * length_m);
  }

  std::optional<LightPath> parallel_path(const Chain& chain, int lane) const {
    const auto stride = static_cast<std::size_t>(world_.lanes.lane_stride());
    const float* rows = world_.chain_rows.data() + chain.rows +
                        static_cast<std::size_t>(set_) * chain.array_count() * stride +
                        static_cast<std::size_t>(lane);
    const auto at = [&](std::size_t array) { return static_cast<double>(rows[array * stride]); };
    const auto vector_at = [&](std::size_t array) {
      return Vec3d(at(array), at(array + 1), at(array + 2));
    };
    const double weight = at(0);
    if (!(weight > 0.0)) return std::nullopt;
    Vec3d place = place_ - Vec3d(chain.origin);
    const std::size_t count = chain.steps.size();
    for (std::size_t side = 0; side < static_cast<std::size_t>(chain.side_count); ++side) {
      const std::size_t array = 1 + 3 * count + 4 * side;
      if (glm::dot(vector_at(array), place) + at(array + 3) < 0.0) return std::nullopt;
    }
    LightPath path;
    path.arrival = glm::normalize(vector_at(1 + 3 * (count - 1)));
    path.crossings.resize(count);
    for (std::size_t s = count; s-- > 0;) {
      const ChainStep& step = chain.steps[s];
      const Vec3d after = glm::normalize(vector_at(1 + 3 * s));
      const Vec3d normal(step.normal);
      const double height = glm::dot(normal, place) - static_cast<double>(step.distance_m);
      place -= height / glm::dot(normal, after) * after;
      LightPathCrossing& crossing = path.crossings[s];
      crossing.event = step.event;
      crossing.position = place + Vec3d(chain.origin);
      crossing.direction_after = after;
      crossing.direction_before =
          s > 0 ? glm::normalize(vector_at(1 + 3 * (s - 1))) : Vec3d(light_.direction);
      describe(step, lane, crossing);
    }
    const Vec3d first = path.crossings.front().position;
    path.start = first;
    path.length_m = std::numeric_limits<double>::infinity();
    if (light_.is_beam) {
      const double along = glm::dot(first - Vec3d(light_.position), Vec3d(light_.direction));
      path.start = first - along * Vec3d(light_.direction);
      path.length_m = 0.0;
    }
    // The weight has Fresnel's shares in it; what is left is absorbed on the way.
    path.irradiance = weight;
    for (const LightPathCrossing& crossing : path.crossings) path.irradiance /= crossing.share;
    return path;
  }

  void describe(const ChainStep& step, int lane, LightPathCrossing& crossing) const {
    const Facet& facet = world_.flat.facets[step.facet];
    const SurfaceMaterial& material = world_.materials[step.material];
    crossing.body = facet.body;
    crossing.normal = facet.normal;
    const double n = world_.flat.bodies[facet.body].is_mirror ? 1.0 : value(material.index, lane);
    crossing.n_before = step.comes_from_inside() ? n : 1.0;
    crossing.n_after = step.goes_on_inside() ? n : 1.0;
    const auto angle = [&](const Vec3d& direction) {
      const double cosine = std::abs(glm::dot(direction, facet.normal));
      return std::atan2(glm::length(glm::cross(direction, facet.normal)), cosine);
    };
    crossing.incidence_rad = angle(crossing.direction_before);
    crossing.exit_rad = angle(crossing.direction_after);
    const FacetSide side = step.comes_from_inside() ? FacetSide::Inside : FacetSide::Outside;
    const double reflectance =
        facet_reflectance(world_, material, set_, lane, std::cos(crossing.incidence_rad), side);
    const bool passes = step.event == ChainEvent::Enter || step.event == ChainEvent::Leave;
    crossing.share = passes ? (1.0 - reflectance) * value(material.base_color, lane) : reflectance;
  }

  std::optional<LightPath> point_path(const PointChain& chain, int lane) const {
    const std::size_t count = chain.crossings.size();
    std::array<double, kMostCrossings + 1> n{};
    for (std::size_t j = 0; j <= count; ++j) n[j] = index(chain.media[j], lane);
    const Vec3d place = chain.fold * (place_ - Vec3d(chain.origin)) + chain.fold_shift;
    Crossings crossings{};
    const std::span<const double> indices(n.data(), count + 1);
    if (!solve_crossings(chain, indices, place, crossings)) return std::nullopt;
    LightPath path;
    path.start = Vec3d(light_.position);
    // The way in the unfolded space, stretch by stretch.
    std::array<Vec3d, kMostCrossings + 2> row{};
    row[0] = chain.lamp;
    for (std::size_t k = 0; k < count; ++k) {
      row[k + 1] = on_face(chain.faces[chain.crossings[k]], crossings[k]);
    }
    row[count + 1] = place;
    std::size_t stretch = 0;
    double gone_m = 0.0;
    for (std::size_t s = 0; s < chain.steps.size(); ++s) {
      const UnfoldedFace& face = chain.faces[s];
      const Vec3d way = row[stretch + 1] - row[stretch];
      const double length_m = glm::length(way);
      const Vec3d before = way / length_m;
      Vec3d after = before;
      Vec3d at = row[stretch + 1];
      const bool refracts = stretch < count && chain.crossings[stretch] == s;
      const double slope = glm::dot(face.normal, before);
      if (refracts) {
        const bool enters = chain.steps[s].event == ChainEvent::Enter;
        if (enters ? slope >= 0.0 : slope <= 0.0) return std::nullopt;
        if (length_m < gone_m) return std::nullopt;
        ++stretch;
        after = glm::normalize(row[stretch + 1] - row[stretch]);
        // The shortest way to a place on the wrong side of a plane turns back there.
        if (glm::dot(face.normal, after) * slope <= 0.0) return std::nullopt;
        gone_m = 0.0;
      } else {
        const double t = glm::dot(face.normal, face.origin - row[stretch]) / slope;
        if (!(t >= gone_m)) return std::nullopt;
        if (chain.steps[s].event == ChainEvent::ReflectInside && slope <= 0.0) return std::nullopt;
        gone_m = t;
        at = row[stretch] + t * before;
        after = before - 2.0 * slope * face.normal;
      }
      const Vec3d off = at - face.origin;
      const FaceFrame& frame = world_.point_chains.frames[face.face];
      if (frame.distance_inside(glm::dot(face.u, off), glm::dot(face.v, off)) < 0.0) {
        return std::nullopt;
      }
      LightPathCrossing crossing;
      crossing.event = chain.steps[s].event;
      crossing.position = face.to_world * at + face.shift + Vec3d(chain.origin);
      crossing.direction_before = face.to_world * before;
      crossing.direction_after = face.to_world * after;
      describe(chain.steps[s], lane, crossing);
      path.crossings.push_back(crossing);
    }
    const Vec3d last = place - row[count];
    if (glm::length(last) < gone_m - slack_m()) return std::nullopt;
    path.arrival = glm::transpose(chain.fold) * glm::normalize(last);
    const double sharpness = crossing_sharpness(chain, indices, place, crossings);
    double length_m = 0.0;
    for (std::size_t j = 0; j <= count; ++j) length_m += glm::distance(row[j + 1], row[j]);
    path.irradiance = sharpness * window(length_m, glm::normalize(row[1] - row[0]));
    if (!(path.irradiance > 0.0)) return std::nullopt;
    return path;
  }

  // Lengths, absorption, and whether the way is free.
  void finish(LightPath& path) const {
    Vec3d from = path.start;
    std::optional<std::uint32_t> medium = first_medium(path);
    for (const LightPathCrossing& crossing : path.crossings) {
      add_stretch(from, crossing.position, medium, path);
      path.transmittance *= crossing.share;
      const std::uint32_t material = world_.flat.bodies[crossing.body].material;
      if (crossing.event == ChainEvent::Enter) medium = material;
      if (crossing.event == ChainEvent::Leave) medium.reset();
      from = crossing.position;
    }
    add_stretch(from, place_, medium, path);
    if (light_.type == LightType::Directional && !light_.is_beam) {
      const Vec3d back = -Vec3d(light_.direction);
      path.is_blocked |= is_blocked(path.start, back, kInfinity, true);
    }
    path.irradiance = path.is_blocked ? 0.0 : path.irradiance * path.transmittance;
  }

  std::optional<std::uint32_t> first_medium(const LightPath& path) const {
    const ChainEvent event = path.crossings.front().event;
    const bool inside = event == ChainEvent::Leave || event == ChainEvent::ReflectInside;
    if (!inside) return std::nullopt;
    return world_.flat.bodies[path.crossings.front().body].material;
  }

  void add_stretch(const Vec3d& from, const Vec3d& to, const std::optional<std::uint32_t>& medium,
                   LightPath& path) const {
    const double length_m = glm::distance(from, to);
    path.length_m += length_m;
    const int lane = path.lane;
    path.transmittance *= passes(medium, length_m, lane);
    if (length_m > 0.0) {
      path.is_blocked |= is_blocked(from, (to - from) / length_m, length_m, !medium);
    }
  }

  // Whether anything opaque stands on a stretch or, outside of glass, anything that bends light.
  bool is_blocked(const Vec3d& from, const Vec3d& direction, double length_m,
                  bool is_outside) const {
    const double slack = slack_m() + kOffFacet * (std::isfinite(length_m) ? length_m : 0.0);
    Ray ray;
    ray.origin = Vec3f(from + slack * direction);
    ray.direction = Vec3f(direction);
    ray.t_max = static_cast<float>(length_m - 2.0 * slack);
    constexpr int kMostSurfaces = 64;
    for (int i = 0; i < kMostSurfaces && ray.t_max > 0.0f; ++i) {
      Hit hit;
      world_.accelerator->closest_hits(std::span<const Ray>(&ray, 1),
                                       kOpaqueBit | kTransparentBit | kExactGlassBit,
                                       std::span<Hit>(&hit, 1));
      if (!hit.is_hit()) return false;
      const SurfacePoint point = surface_point(world_, ray.origin, ray.direction, hit);
      const Surface& surface = world_.geometry.surfaces[point.surface];
      if (!world_.materials[surface.material].lets_light_pass()) return true;
      if (is_outside && world_.surface_is_exact[point.surface] != 0) return true;
      const Vec3f next = off_surface(point, ray.direction);
      ray.t_max -= glm::dot(next - ray.origin, ray.direction);
      ray.origin = next;
    }
    return ray.t_max > 0.0f;
  }

  const World& world_;
  const WorldLight& light_;
  const std::uint32_t number_;
  const Vec3d place_;
  const int set_;
  const std::optional<std::uint32_t> medium_;
  std::vector<LightChain> chains_;
};

}  // namespace

std::vector<LightChain> chains_to_light(const World& world, std::uint32_t light, const Vec3d& place,
                                        int set, std::optional<std::uint32_t> medium) {
  return Paths(world, light, place, set, medium).all();
}

}  // namespace abbe
