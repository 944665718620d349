#include "abbe/integrate/light/light_paths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "abbe/caustics/flat/facet_optics.h"
#include "abbe/caustics/flat/light/solver.h"
#include "abbe/integrate/surface/point.h"
#include "abbe/optics/absorption.h"
#include "abbe/optics/snell.h"

namespace abbe {
namespace {

// What a place on a facet may be off by, relative to the size of coordinates.
constexpr double kOffFacet = 4e-6;

class Paths {
 public:
  Paths(const LitWorld& world, std::uint32_t light, const Vec3d& place, int set,
        std::optional<std::uint32_t> medium)
      : world_(world),
        light_(world.lights[light]),
        number_(light),
        place_(place),
        set_(set),
        medium_(medium),
        shown_(place_by_middle()) {}

  std::vector<LightChain> all() {
    add_straight();
    const std::size_t straight = chains_.size();
    const LightChains* found = world_.caustics.of_light(number_);
    const LightChains chains = found != nullptr ? *found : LightChains{};
    for (const std::uint32_t i : chains.parallel) {
      const ParallelChain& chain = world_.caustics.parallel.chains[i];
      if (is_shown(chain)) add(chain, [&](int lane) { return parallel_path(chain, lane); });
    }
    for (const std::uint32_t i : chains.point) {
      const PointChain& chain = world_.caustics.point.chains[i];
      if (is_shown(chain)) add(chain, [&](int lane) { return point_path(chain, lane); });
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

  const WorldLight& source_of(const ChainPath& chain) const {
    return world_.caustics.source_of(chain);
  }

  // Of the places of a lamp with an extent one is as good as another: that next to its middle.
  std::uint32_t place_by_middle() const {
    std::uint32_t nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (const ChainSource& source : world_.caustics.sources) {
      if (source.lamp != number_) continue;
      const Vec3d off = light_.is_parallel ? Vec3d(source.light.direction) - Vec3d(light_.direction)
                                           : Vec3d(source.light.position) - Vec3d(light_.position);
      if (!(glm::dot(off, off) < least)) continue;
      least = glm::dot(off, off);
      nearest = source.place;
    }
    return nearest;
  }

  bool is_shown(const ChainPath& chain) const {
    return medium_ == chain.ends_in() && world_.caustics.sources[chain.source].place == shown_;
  }

  template <typename Make>
  void add(const ChainPath& chain, const Make& make) {
    LightChain result;
    for (const ChainStep& step : chain.steps) result.events.push_back(step.event);
    for (int lane = 0; lane < world_.lanes.lane_count(); ++lane) {
      if (auto path = make(lane)) {
        path->lane = lane;
        finish(chain, *path);
        result.paths.push_back(std::move(*path));
      }
    }
    if (!result.paths.empty()) chains_.push_back(std::move(result));
  }

  void add_straight() {
    const auto straight = straight_path(light_, place_);
    if (!straight) return;
    if (is_blocked(place_, -straight->direction, straight->length_m, kCullFront)) return;
    LightPath path;
    path.start = straight->start;
    path.arrival = straight->direction;
    path.length_m = straight->length_m;
    LightChain chain;
    for (path.lane = 0; path.lane < world_.lanes.lane_count(); ++path.lane) {
      const double length_m = std::isfinite(path.length_m) ? path.length_m : 0.0;
      path.transmittance = passes(medium_, length_m, path.lane);
      path.irradiance = straight->irradiance * path.transmittance;
      chain.paths.push_back(path);
    }
    chains_.push_back(std::move(chain));
  }

  // What a segment lets through.
  double passes(const std::optional<std::uint32_t>& medium, double length_m, int lane) const {
    if (medium) {
      const SurfaceMaterial& material = world_.materials[*medium];
      if (!material.absorption_per_m) return 1.0;
      return transmittance_after(value(*material.absorption_per_m, lane), length_m);
    }
    // The illuminance of a sun is what it is at the scene.
    if (!world_.fog || !light_.has_distance()) return 1.0;
    return transmittance_after(static_cast<double>(world_.fog->extinction_per_m), length_m);
  }

  std::optional<LightPath> parallel_path(const ParallelChain& chain, int lane) const {
    const auto rows = world_.caustics.parallel.of(chain, set_);
    const auto at = [&](const float* row, std::size_t part) {
      return static_cast<double>(row[part * rows.stride + static_cast<std::size_t>(lane)]);
    };
    const auto vector_at = [&](const float* row) {
      return Vec3d(at(row, 0), at(row, 1), at(row, 2));
    };
    const double weight = at(rows.weight, 0);
    if (!(weight > 0.0)) return std::nullopt;
    Vec3d place = place_ - Vec3d(chain.origin);
    for (std::size_t side = 0; side < chain.side_count; ++side) {
      const float* plane = rows.side(side);
      if (glm::dot(vector_at(plane), place) + at(plane, 3) < 0.0) return std::nullopt;
    }
    const std::size_t count = chain.steps.size();
    LightPath path;
    path.arrival = glm::normalize(vector_at(rows.direction(count - 1)));
    path.crossings.resize(count);
    for (std::size_t s = count; s-- > 0;) {
      const ChainStep& step = chain.steps[s];
      const Vec3d after = glm::normalize(vector_at(rows.direction(s)));
      const Vec3d normal(step.normal);
      const double height = glm::dot(normal, place) - static_cast<double>(step.distance_m);
      place -= height / glm::dot(normal, after) * after;
      LightPathCrossing& crossing = path.crossings[s];
      crossing.event = step.event;
      crossing.position = place + Vec3d(chain.origin);
      crossing.direction_after = after;
      crossing.direction_before = s > 0 ? glm::normalize(vector_at(rows.direction(s - 1)))
                                        : Vec3d(source_of(chain).direction);
      describe(step, lane, crossing);
    }
    const Vec3d first = path.crossings.front().position;
    path.start = first;
    path.length_m = std::numeric_limits<double>::infinity();
    if (light_.beam) {
      const double along = glm::dot(first - Vec3d(light_.position), Vec3d(light_.direction));
      path.start = first - along * Vec3d(light_.direction);
      path.length_m = 0.0;
    }
    // The weight has Fresnel's shares in it; what is left is absorbed on the path.
    path.irradiance = weight;
    for (const LightPathCrossing& crossing : path.crossings) path.irradiance /= crossing.share;
    return path;
  }

  void describe(const ChainStep& step, int lane, LightPathCrossing& crossing) const {
    const Facet& facet = world_.caustics.flat.facets[step.facet];
    const SurfaceMaterial& material = world_.materials[step.material];
    crossing.body = facet.body;
    crossing.normal = facet.normal;
    crossing.n_before = index(step.comes_from(), lane);
    crossing.n_after = index(step.goes_on_in(), lane);
    const auto angle = [&](const Vec3d& direction) {
      const double cosine = std::abs(glm::dot(direction, facet.normal));
      return std::atan2(glm::length(glm::cross(direction, facet.normal)), cosine);
    };
    crossing.incidence_rad = angle(crossing.direction_before);
    crossing.exit_rad = angle(crossing.direction_after);
    const SurfaceMaterial* outside = step.outside ? &world_.materials[*step.outside] : nullptr;
    const double reflectance =
        facet_reflectance(world_, {&material, outside}, {set_, lane},
                          std::cos(crossing.incidence_rad), step.comes_from_inside());
    crossing.share =
        step.refracts() ? (1.0 - reflectance) * value(material.base_color, lane) : reflectance;
  }

  std::optional<LightPath> point_path(const PointChain& chain, int lane) const {
    if (!chain.lanes.test(lane)) return std::nullopt;
    const std::size_t count = chain.crossings.size();
    std::array<double, kMaxRefractions + 1> n{};
    for (std::size_t j = 0; j <= count; ++j) n[j] = index(chain.media[j], lane);
    const Vec3d place = chain.fold * (place_ - Vec3d(chain.origin)) + chain.fold_shift;
    Crossings crossings{};
    const std::span<const double> indices(n.data(), count + 1);
    if (!solve_crossings(chain, indices, off_last_face(chain, place), crossings))
      return std::nullopt;
    LightPath path;
    path.start = Vec3d(source_of(chain).position);
    // The path in the unfolded space, segment by segment.
    std::array<Vec3d, kMaxRefractions + 2> corner{};
    corner[0] = chain.lamp;
    for (std::size_t k = 0; k < count; ++k) {
      corner[k + 1] = on_face(chain.faces[chain.crossings[k]], crossings[k]);
    }
    corner[count + 1] = place;
    std::size_t segment = 0;
    double gone_m = 0.0;
    for (std::size_t s = 0; s < chain.steps.size(); ++s) {
      const UnfoldedFace& face = chain.faces[s];
      const Vec3d offset = corner[segment + 1] - corner[segment];
      const double length_m = glm::length(offset);
      const Vec3d before = offset / length_m;
      Vec3d after = before;
      Vec3d at = corner[segment + 1];
      const bool refracts = segment < count && chain.crossings[segment] == s;
      const double slope = glm::dot(face.normal, before);
      if (refracts) {
        const bool enters = chain.steps[s].event == ChainEvent::Enter;
        if (enters ? slope >= 0.0 : slope <= 0.0) return std::nullopt;
        if (length_m < gone_m) return std::nullopt;
        ++segment;
        after = glm::normalize(corner[segment + 1] - corner[segment]);
        // The shortest path to a place on the wrong side of a plane turns back there.
        if (glm::dot(face.normal, after) * slope <= 0.0) return std::nullopt;
        gone_m = 0.0;
      } else {
        const double t = glm::dot(face.normal, face.origin - corner[segment]) / slope;
        if (!(t >= gone_m)) return std::nullopt;
        if (chain.steps[s].event == ChainEvent::ReflectInside && slope <= 0.0) return std::nullopt;
        gone_m = t;
        at = corner[segment] + t * before;
        after = reflected_direction(before, face.normal);
      }
      const Vec3d off = at - face.origin;
      const FaceFrame& frame = world_.caustics.point.frames[face.face];
      if (frame.distance_inside({glm::dot(face.u, off), glm::dot(face.v, off)}) < 0.0) {
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
    const Vec3d last = place - corner[count];
    if (glm::length(last) < gone_m - slack_m()) return std::nullopt;
    path.arrival = glm::transpose(chain.fold) * glm::normalize(last);
    const double jacobian = crossing_jacobian(chain, indices, place, crossings);
    double length_m = 0.0;
    for (std::size_t j = 0; j <= count; ++j) length_m += glm::distance(corner[j + 1], corner[j]);
    const WorldLight& lamp = source_of(chain);
    const double cosine = glm::dot(glm::normalize(corner[1] - corner[0]), Vec3d(lamp.direction));
    path.irradiance = jacobian * lamp_window(lamp, length_m, cosine);
    if (!(path.irradiance > 0.0)) return std::nullopt;
    return path;
  }

  // Lengths, absorption, and whether the path is free.
  void finish(const ChainPath& chain, LightPath& path) const {
    Vec3d from = path.start;
    for (std::size_t s = 0; s < chain.steps.size(); ++s) {
      add_segment(from, path.crossings[s].position, chain.steps[s].comes_from(), path);
      path.transmittance *= path.crossings[s].share;
      from = path.crossings[s].position;
      if (chain.steps[s].is_touched) path.is_blocked |= is_covered(chain, s, from);
    }
    add_segment(from, place_, chain.ends_in(), path);
    if (!light_.has_distance()) {
      path.is_blocked |=
          is_blocked(path.start, -Vec3d(source_of(chain).direction), kInfinity, kCullFront);
    }
    path.irradiance = path.is_blocked ? 0.0 : path.irradiance * path.transmittance;
  }

  void add_segment(const Vec3d& from, const Vec3d& to, const std::optional<std::uint32_t>& medium,
                   LightPath& path) const {
    const double length_m = glm::distance(from, to);
    path.length_m += length_m;
    path.transmittance *= passes(medium, length_m, path.lane);
    if (length_m > 0.0)
      path.is_blocked |= is_blocked(from, (to - from) / length_m, length_m, kCullBack);
  }

  // Whether anything opaque lies on a facet where light goes through it; what stands on the last
  // one is what it lights.
  bool is_covered(const ChainPath& chain, std::size_t s, const Vec3d& at) const {
    const Vec3d normal(chain.steps[s].normal);
    const double near_m = 2.0 * static_cast<double>(chain.slack_m);
    const bool is_last = s + 1 == chain.steps.size();
    if (is_last && std::abs(glm::dot(place_ - at, normal)) <= 2.0 * near_m) return false;
    const Ray through{Vec3f(at - near_m * normal), static_cast<float>(2.0 * near_m), Vec3f(normal)};
    std::uint8_t is_met = 0;
    world_.accelerator->any_hits(std::span<const Ray>(&through, 1), kOpaqueBit,
                                 std::span<std::uint8_t>(&is_met, 1));
    return is_met != 0;
  }

  // Whether anything opaque stands on a segment or anything that bends light. `culled` is kCullBack
  // where it goes as light does, else kCullFront.
  bool is_blocked(const Vec3d& from, const Vec3d& direction, double length_m,
                  QueryMask culled) const {
    const double slack = slack_m() + kOffFacet * (std::isfinite(length_m) ? length_m : 0.0);
    Ray ray;
    ray.origin = Vec3f(from + slack * direction);
    ray.direction = Vec3f(direction);
    ray.t_max = static_cast<float>(length_m - 2.0 * slack);
    constexpr int kMaxSurfaces = 64;
    for (int i = 0; i < kMaxSurfaces && ray.t_max > 0.0f; ++i) {
      Hit hit;
      world_.accelerator->closest_hits(std::span<const Ray>(&ray, 1),
                                       static_cast<QueryMask>(kAllBits | culled),
                                       std::span<Hit>(&hit, 1));
      if (!hit.is_hit()) return false;
      const SurfacePoint point = surface_point(world_, ray.origin, ray.direction, hit);
      const Surface& surface = world_.geometry.surfaces[point.surface];
      if (!world_.materials[surface.material].lets_light_pass()) return true;
      if (world_.caustics.surface_is_exact[point.surface] != 0) return true;
      const Vec3f next = off_surface(point, ray.direction);
      ray.t_max -= glm::dot(next - ray.origin, ray.direction);
      ray.origin = next;
    }
    return ray.t_max > 0.0f;
  }

  const LitWorld& world_;
  const WorldLight& light_;
  const std::uint32_t number_;
  const Vec3d place_;
  const int set_;
  const std::optional<std::uint32_t> medium_;
  const std::uint32_t shown_;  ///< Of the places of the lamp.
  std::vector<LightChain> chains_;
};

}  // namespace

std::vector<LightChain> chains_to_light(const LitWorld& world, std::uint32_t light,
                                        const Vec3d& place, int set,
                                        std::optional<std::uint32_t> medium) {
  return Paths(world, light, place, set, medium).all();
}

}  // namespace abbe
