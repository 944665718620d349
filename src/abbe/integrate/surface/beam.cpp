#include "abbe/integrate/surface/beam.h"

#include <algorithm>
#include <cmath>

namespace abbe {
namespace {

// Beams wider or parting faster have lost all detail anyway.
constexpr float kWidest = 1e6f;
constexpr float kFastest = 10.0f;
constexpr float kLeastSlope = 0.01f;  // Of on_surface().

Vec3f perpendicular(const Vec3f& v, const Vec3f& direction) {
  return v - glm::dot(v, direction) * direction;
}

// At most that long; what is no number is as long.
Vec3f bounded(const Vec3f& v, float most) {
  const float length2 = glm::dot(v, v);
  if (length2 <= most * most) return v;
  const float scale = most / std::sqrt(length2);
  return scale > 0.0f ? v * scale : Vec3f(most, 0.0f, 0.0f);
}

Vec3f unit_or_zero(const Vec3f& v) {
  const float length2 = glm::dot(v, v);
  return length2 > 1e-12f ? v / std::sqrt(length2) : Vec3f(0.0f);
}

// Of the vectors' squares the mean.
float mean_square(const std::array<Vec3f, 2>& v) {
  return 0.5f * (glm::dot(v[0], v[0]) + glm::dot(v[1], v[1]));
}

// The normal's changes on the side of a normal that the ray turned about.
std::array<Vec3f, 2> changes_towards(const BeamTurn& turn, const Vec3f& normal) {
  const float side = glm::dot(turn.normal, normal) < 0.0f ? -1.0f : 1.0f;
  return {side * turn.normal_change[0], side * turn.normal_change[1]};
}

Beam leaving(const Beam& beam, const BeamTurn& turn, const std::array<Vec3f, 2>& turns) {
  const std::array<Vec3f, 2> places = on_surface(beam, turn.arrival, turn.outward);
  Beam result;
  for (std::size_t i = 0; i < 2; ++i) {
    result.across[i] = bounded(perpendicular(places[i], turn.departure), kWidest);
    result.turn[i] = bounded(perpendicular(turns[i], turn.departure), kFastest);
  }
  return result;
}

std::array<Vec3f, 2> triangle_changes(const World& world, const SurfaceHit& hit, int lane,
                                      const std::array<Vec3f, 2>& along, bool of_coat) {
  const Surface& surface = world.geometry.surfaces[hit.surface];
  const SurfaceMaterial& material = world.materials[surface.material];
  const bool is_mapped =
      (of_coat && material.coat_has_own_normal() ? material.layers->coat->normal_texture.has_value()
                                                 : material.normal_texture.has_value());
  if (!surface.normals_offset && !is_mapped) return {Vec3f(0.0f), Vec3f(0.0f)};
  const TriangleFrame frame = triangle_frame(world, hit.primitive(lane));
  // What an offset along the triangle does to the weights of b and c.
  const Vec3f ab = frame.b - frame.a;
  const Vec3f ac = frame.c - frame.a;
  const float per_area = 1.0f / frame.twice_area;
  const Vec3f of_b = per_area * glm::cross(ac, frame.normal);
  const Vec3f of_c = per_area * glm::cross(frame.normal, ab);
  const Vec3f from_a = hit.position.get(lane) - frame.a;
  const Vec2f here(glm::dot(of_b, from_a), glm::dot(of_c, from_a));
  std::array<Vec3f, 2> changes;
  if (is_mapped) {
    const auto normal_at = [&](const Vec2f& at) {
      const SurfacePoint point =
          triangle_point(world, frame, {0.0f, hit.primitive(lane), at.x, at.y});
      return of_coat && material.coat_has_own_normal() ? point.coat_normal : point.shading_normal;
    };
    const Vec3f normal = normal_at(here);
    for (std::size_t i = 0; i < 2; ++i) {
      const Vec2f step(glm::dot(of_b, along[i]), glm::dot(of_c, along[i]));
      changes[i] = normal_at(here + step) - normal;
    }
    return changes;
  }
  const Vec3f sum = (1.0f - here.x - here.y) * frame.normals[0] + here.x * frame.normals[1] +
                    here.y * frame.normals[2];
  const float length = glm::length(sum);
  const Vec3f unit = unit_or_zero(sum);
  for (std::size_t i = 0; i < 2; ++i) {
    const Vec3f change = glm::dot(of_b, along[i]) * (frame.normals[1] - frame.normals[0]) +
                         glm::dot(of_c, along[i]) * (frame.normals[2] - frame.normals[0]);
    changes[i] = length > 1e-6f ? perpendicular(change, unit) / length : Vec3f(0.0f);
    // Towards the side of the triangle's normal, as points have it.
    if (glm::dot(unit, frame.normal) < 0.0f) changes[i] = -changes[i];
  }
  return changes;
}

}  // namespace

Beam round_beam(const Vec3f& direction, float width_m, float per_m) {
  const Basis basis(direction);
  return {{width_m * basis.tangent, width_m * basis.bitangent},
          {per_m * basis.tangent, per_m * basis.bitangent}};
}

Beam moved(const Beam& beam, float distance_m) {
  Beam result = beam;
  for (std::size_t i = 0; i < 2; ++i) result.across[i] += distance_m * beam.turn[i];
  return result;
}

float beam_width_m(const Beam& beam, const Vec3f& direction) {
  const float area = glm::dot(direction, glm::cross(beam.across[0], beam.across[1]));
  const float mean = mean_square(beam.across);
  const float longer = mean + std::sqrt(std::max(mean * mean - area * area, 0.0f));
  return longer > 0.0f ? std::abs(area) / std::sqrt(longer) : 0.0f;
}

std::array<Vec3f, 2> on_surface(const Beam& beam, const Vec3f& arrival, const Vec3f& outward) {
  float cosine = glm::dot(arrival, outward);
  if (std::abs(cosine) < kLeastSlope) cosine = std::copysign(kLeastSlope, cosine);
  std::array<Vec3f, 2> places;
  for (std::size_t i = 0; i < 2; ++i) {
    places[i] = beam.across[i] - (glm::dot(beam.across[i], outward) / cosine) * arrival;
  }
  return places;
}

Beam reflected(const Beam& beam, const BeamTurn& turn) {
  const Vec3f normal = unit_or_zero(turn.departure - turn.arrival);
  const std::array<Vec3f, 2> changes = changes_towards(turn, normal);
  const float along = glm::dot(turn.arrival, normal);
  std::array<Vec3f, 2> turns;
  for (std::size_t i = 0; i < 2; ++i) {
    const float change = glm::dot(beam.turn[i], normal) + glm::dot(turn.arrival, changes[i]);
    turns[i] = beam.turn[i] - 2.0f * (along * changes[i] + change * normal);
  }
  return leaving(beam, turn, turns);
}

Beam refracted(const Beam& beam, const BeamTurn& turn, float eta_ti) {
  // The refracted direction is that of arrival over eta, and a part along the normal: r·D + μ·n.
  const float r = 1.0f / eta_ti;
  Vec3f normal = unit_or_zero(r * turn.arrival - turn.departure);
  if (normal == Vec3f(0.0f)) return leaving(beam, turn, beam.turn);
  if (glm::dot(turn.arrival, normal) > 0.0f) normal = -normal;
  const std::array<Vec3f, 2> changes = changes_towards(turn, normal);
  const float cos_i = -glm::dot(turn.arrival, normal);
  const float cos_t = std::max(-glm::dot(turn.departure, normal), kLeastSlope);
  const float along = r * cos_i - cos_t;
  std::array<Vec3f, 2> turns;
  for (std::size_t i = 0; i < 2; ++i) {
    const float cos_change = -(glm::dot(beam.turn[i], normal) + glm::dot(turn.arrival, changes[i]));
    const float along_change = r * cos_change * (1.0f - r * cos_i / cos_t);
    turns[i] = r * beam.turn[i] + along * changes[i] + along_change * normal;
  }
  return leaving(beam, turn, turns);
}

Beam widened(const Beam& beam, const Vec3f& direction, float angle_rad) {
  // |across + t·turn| is at most the sum of the roots of mean squares: by the triangle inequality.
  return round_beam(direction, std::sqrt(mean_square(beam.across)),
                    std::sqrt(mean_square(beam.turn) + angle_rad * angle_rad));
}

float lobe_width_rad(float per_sr, std::uint32_t before) {
  const float rays_per_sr = per_sr * (static_cast<float>(before) + 1.0f);
  return rays_per_sr > 1.0f ? 1.0f / std::sqrt(rays_per_sr) : per_sr > 0.0f ? 1.0f : 0.0f;
}

std::array<Vec3f, 2> normal_changes(const World& world, const SurfaceHit& hit, int lane,
                                    const std::array<Vec3f, 2>& along, bool of_coat) {
  const Geometry& geometry = world.geometry;
  const std::uint32_t primitive = hit.primitive(lane);
  if (geometry.is_triangle(primitive)) return triangle_changes(world, hit, lane, along, of_coat);
  std::array<Vec3f, 2> changes{Vec3f(0.0f), Vec3f(0.0f)};
  const std::size_t index = primitive - geometry.triangles.size();
  if (index >= geometry.ellipsoids.size()) return changes;
  // The normal is along Mᵀ·q, where q = M·p + o is on the unit ball.
  const Ellipsoid& ellipsoid = geometry.ellipsoids[index];
  const Mat3d& to_unit = ellipsoid.world_to_unit_linear;
  const Mat3d back = glm::transpose(to_unit);
  const Vec3d q = to_unit * Vec3d(hit.position.get(lane)) + ellipsoid.world_to_unit_offset;
  const double length = glm::length(back * q);
  const Vec3d normal(hit.outward.get(lane));
  for (std::size_t i = 0; i < 2; ++i) {
    const Vec3d change = back * (to_unit * Vec3d(along[i])) / length;
    changes[i] = Vec3f(change - glm::dot(change, normal) * normal);
  }
  return changes;
}

}  // namespace abbe
