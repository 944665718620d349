#include "accel/brute_force.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace abbe::test {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

// What can be said about one primitive and one ray: it must be met at `t`, may be, or must not.
struct Verdict {
  bool may = false;
  bool must = false;
  double t = kInfinite;
  double t_error = 0.0;
};

Verdict judge_triangle(const World& world, const Triangle& triangle, const Ray& ray) {
  const Vec3d o(ray.origin);
  const Vec3d d = Vec3d(ray.direction) / glm::length(Vec3d(ray.direction));
  const double scale = glm::length(Vec3d(ray.direction));
  Vec3d p[3];
  double reach = 0.0;
  for (int i = 0; i < 3; ++i) {
    p[i] = Vec3d(world.positions[triangle[static_cast<std::size_t>(i)]]) - o;
    reach = std::max({reach, std::abs(p[i].x), std::abs(p[i].y), std::abs(p[i].z)});
  }
  // Signed distance of the ray from each edge line, seen along the ray.
  const double error = 16.0 * 0x1p-24 * reach;  // Three roundings of each corner, twice sheared.
  double side[3];
  bool inside_wide = false, inside_narrow = false;
  double lengths[3];
  for (int i = 0; i < 3; ++i) {
    const Vec3d a = p[(i + 1) % 3], b = p[(i + 2) % 3];
    const Vec3d across = glm::cross(b - a, d);
    lengths[i] = glm::length(across);
    side[i] = glm::dot(d, glm::cross(b, a));
  }
  double least = kInfinite, most = -kInfinite;
  for (int i = 0; i < 3; ++i) {
    const double distance = lengths[i] > 0.0 ? side[i] / lengths[i] : 0.0;
    least = std::min(least, distance);
    most = std::max(most, distance);
  }
  inside_wide = least >= -error || most <= error;
  inside_narrow = least > error || most < -error;
  if (!inside_wide) return {};
  // The distance by the plane; seen edge-on it is only known to lie between the corners.
  const double sum = side[0] + side[1] + side[2];
  double low = kInfinite, high = -kInfinite;
  for (const Vec3d& corner : p) {
    low = std::min(low, glm::dot(corner, d));
    high = std::max(high, glm::dot(corner, d));
  }
  Verdict verdict;
  verdict.may = true;
  const Vec3d normal = glm::cross(p[1] - p[0], p[2] - p[0]);
  const double cosine = std::abs(glm::dot(normal, d)) / std::max(glm::length(normal), 1e-300);
  const double by_plane = sum != 0.0 ? (side[0] * glm::dot(p[0], d) + side[1] * glm::dot(p[1], d) +
                                        side[2] * glm::dot(p[2], d)) /
                                           sum
                                     : 0.5 * (low + high);
  double error_t = 4.0 * error / std::max(cosine, 1e-12) + 4.0 * error;
  error_t = std::min(error_t, high - low + 4.0 * error);
  verdict.t = std::clamp(by_plane, low, high) / scale;
  verdict.t_error = error_t / scale;
  const double t_max = static_cast<double>(ray.t_max);
  verdict.must =
      inside_narrow && verdict.t - verdict.t_error > 0.0 && verdict.t + verdict.t_error < t_max;
  verdict.may = verdict.t + verdict.t_error >= 0.0 && verdict.t - verdict.t_error <= t_max;
  return verdict;
}

Verdict at(double t, double error, double t_max) {
  Verdict verdict;
  verdict.t = t;
  verdict.t_error = error;
  verdict.may = t >= -error && t <= t_max + error;
  verdict.must = t > error && t < t_max - error;
  return verdict;
}

Verdict nearest_root(double near, double far, double error, double t_max) {
  const Verdict first = at(near, error, t_max);
  // Which root is the answer is open when the near one lies at the origin.
  if (first.must || (!first.may && near > 0.0)) return first;
  Verdict second = at(far, error, t_max);
  if (first.may) {
    second.must = false;
    second.may = true;
    second.t_error = std::max(std::abs(far - near), error) + error;
  }
  return second;
}

Verdict judge_ellipsoid(const Ellipsoid& e, const Ray& ray) {
  const auto linear = [&](const Vec3d& v) { return e.world_to_unit_linear * v; };
  const Vec3d o = linear(Vec3d(ray.origin)) + e.world_to_unit_offset;
  const Vec3d d = linear(Vec3d(ray.direction));
  const double a = glm::dot(d, d), b = glm::dot(o, d);
  const Vec3d closest = o - d * (b / a);
  const double inside = 1.0 - glm::dot(closest, closest);
  const double root = std::sqrt(std::max(inside, 0.0) / a);
  const double size = (std::abs(b / a) + root);
  const double error = 0x1p-23 * size + 1e-12;  // The answer is a float.
  if (inside < -1e-9) return {};                // Double rounding beside a grazing ray.
  Verdict verdict =
      nearest_root(-b / a - root, -b / a + root, error, static_cast<double>(ray.t_max));
  if (inside < 1e-9) {
    verdict.must = false;
    verdict.t_error += root + std::sqrt(1e-9 / a);
  }
  return verdict;
}

Verdict judge_polyhedron(const World& world, const ConvexPolyhedron& p, const Ray& ray) {
  double enter = -kInfinite, leave = kInfinite;
  bool grazes = false;
  for (std::uint32_t i = 0; i < p.plane_count; ++i) {
    const Plane& plane = world.planes[p.first_plane + i];
    const double towards = glm::dot(plane.normal, Vec3d(ray.direction));
    const double distance = plane.distance - glm::dot(plane.normal, Vec3d(ray.origin));
    if (std::abs(towards) < 1e-12) {
      if (distance < -1e-9) return {};
      grazes = grazes || distance < 1e-9;
      continue;
    }
    (towards < 0.0 ? enter : leave) =
        towards < 0.0 ? std::max(enter, distance / towards) : std::min(leave, distance / towards);
  }
  const double error = 0x1p-22 * std::max(std::abs(enter), std::abs(leave)) + 1e-9;
  if (enter > leave + error) return {};
  Verdict verdict = nearest_root(enter, leave, error, static_cast<double>(ray.t_max));
  if (grazes || enter > leave - error) verdict.must = false;
  return verdict;
}

Verdict judge(const World& world, std::size_t primitive, const Ray& ray) {
  if (primitive < world.triangles.size()) {
    return judge_triangle(world, world.triangles[primitive], ray);
  }
  primitive -= world.triangles.size();
  if (primitive < world.ellipsoids.size()) return judge_ellipsoid(world.ellipsoids[primitive], ray);
  return judge_polyhedron(world, world.polyhedra[primitive - world.ellipsoids.size()], ray);
}

// The nearest distance by which something must have been met.
struct Limit {
  double t = kInfinite;
  std::size_t primitive = 0;
  bool may_any = false;
};

Limit limit_of(const World& world, const Ray& ray, VisibilityMask mask) {
  Limit limit;
  const std::size_t count = world.spans().primitive_count();
  for (std::size_t i = 0; i < count; ++i) {
    if (!world.masks.empty() && (world.masks[i] & mask) == 0) continue;
    const Verdict verdict = judge(world, i, ray);
    limit.may_any = limit.may_any || verdict.may;
    if (verdict.must && verdict.t + verdict.t_error < limit.t) {
      limit.t = verdict.t + verdict.t_error;
      limit.primitive = i;
    }
  }
  return limit;
}

}  // namespace

void World::add_triangle(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const auto first = static_cast<std::uint32_t>(positions.size());
  positions.insert(positions.end(), {a, b, c});
  triangles.push_back({first, first + 1, first + 2});
}

void World::add_ellipsoid(const Vec3d& center, const Vec3d& radii) {
  Ellipsoid e;
  e.world_to_unit_linear =
      Mat3d(Vec3d(1.0 / radii.x, 0, 0), Vec3d(0, 1.0 / radii.y, 0), Vec3d(0, 0, 1.0 / radii.z));
  e.world_to_unit_offset = -(e.world_to_unit_linear * center);
  for (int k = 0; k < 3; ++k) {
    e.bounds.low[k] = std::nextafter(static_cast<float>(center[k] - radii[k]), -kInfinity);
    e.bounds.high[k] = std::nextafter(static_cast<float>(center[k] + radii[k]), kInfinity);
  }
  ellipsoids.push_back(e);
}

void World::add_box_solid(const Vec3d& low, const Vec3d& high) {
  ConvexPolyhedron p;
  p.first_plane = static_cast<std::uint32_t>(planes.size());
  p.plane_count = 6;
  for (int k = 0; k < 3; ++k) {
    Vec3d normal(0.0);
    normal[k] = 1.0;
    planes.push_back({normal, high[k]});
    planes.push_back({-normal, -low[k]});
    p.bounds.low[k] = std::nextafter(static_cast<float>(low[k]), -kInfinity);
    p.bounds.high[k] = std::nextafter(static_cast<float>(high[k]), kInfinity);
  }
  polyhedra.push_back(p);
}

std::string check_closest(const World& world, const Ray& ray, VisibilityMask mask, const Hit& hit) {
  const Limit limit = limit_of(world, ray, mask);
  if (!hit.is_hit()) {
    if (limit.t == kInfinite) return {};
    return fmt::format("missed primitive {} before {}", limit.primitive, limit.t);
  }
  if (hit.primitive >= world.spans().primitive_count()) return "primitive number out of range";
  if (!world.masks.empty() && (world.masks[hit.primitive] & mask) == 0) return "masked primitive";
  if (!(hit.t > 0.0f && hit.t < ray.t_max)) return "hit outside (0, t_max)";
  const Verdict verdict = judge(world, hit.primitive, ray);
  if (!verdict.may) return "hit a primitive beside the ray";
  if (std::abs(static_cast<double>(hit.t) - verdict.t) > verdict.t_error + 1e-30) {
    return fmt::format("hit at a wrong distance, expected {} ± {}", verdict.t, verdict.t_error);
  }
  if (static_cast<double>(hit.t) - verdict.t_error > limit.t) {
    return fmt::format("primitive {} is nearer: {}", limit.primitive, limit.t);
  }
  return {};
}

std::string check_any(const World& world, const Ray& ray, VisibilityMask mask, bool is_occluded) {
  const Limit limit = limit_of(world, ray, mask);
  if (is_occluded && !limit.may_any) return "occluded by nothing";
  if (!is_occluded && limit.t < kInfinite) {
    return fmt::format("not occluded by primitive {}", limit.primitive);
  }
  return {};
}

RayPacket make_packet(std::span<const Ray> rays) {
  RayPacket packet{};
  packet.common_origin = true;
  for (std::size_t i = 0; i < static_cast<std::size_t>(kPacketLanes); ++i) {
    const Ray& ray = rays[std::min(i, rays.size() - 1)];
    set_ray(packet, static_cast<int>(i), ray);
    if (i < rays.size()) {
      packet.active |= 1u << i;
      packet.common_origin = packet.common_origin && ray.origin == rays[0].origin;
    }
  }
  return packet;
}

Hit lane_of(const HitPacket& hits, int lane) {
  return {hits.t[lane], hits.primitive[lane], hits.u[lane], hits.v[lane]};
}

bool is_same(const Hit& a, const Hit& b) {
  if (a.primitive != b.primitive) return false;
  if (!a.is_hit()) return true;
  return std::bit_cast<std::array<std::uint32_t, 3>>(std::array{a.t, a.u, a.v}) ==
         std::bit_cast<std::array<std::uint32_t, 3>>(std::array{b.t, b.u, b.v});
}

std::string text_of(const Ray& ray) {
  return fmt::format("ray from ({:a}, {:a}, {:a}) towards ({:a}, {:a}, {:a}) until {:a}",
                     ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y,
                     ray.direction.z, ray.t_max);
}

std::string text_of(const Hit& hit) {
  if (!hit.is_hit()) return "no hit";
  return fmt::format("primitive {} at {:a}, u {}, v {}", hit.primitive, hit.t, hit.u, hit.v);
}

void expect_right_answers(const World& world, const KdTree& tree, std::span<const Ray> rays,
                          VisibilityMask mask, std::size_t judged) {
  std::vector<Hit> hits(rays.size());
  std::vector<std::uint8_t> occluded(rays.size());
  tree.closest_hits(rays, mask, hits);
  tree.any_hits(rays, mask, occluded);
  int reported = 0;
  const auto report = [&](std::size_t i, const std::string& what) {
    if (++reported <= 5) {
      ADD_FAILURE() << "ray " << i << ": " << what << "; answer " << text_of(hits[i]) << "; "
                    << text_of(rays[i]);
    }
  };
  const std::size_t stride =
      std::max<std::size_t>(1, rays.size() / std::max<std::size_t>(judged, 1));
  for (std::size_t i = 0; i < rays.size(); i += stride) {
    if (const auto wrong = check_closest(world, rays[i], mask, hits[i]); !wrong.empty()) {
      report(i, wrong);
    }
  }
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if ((occluded[i] != 0) != hits[i].is_hit()) report(i, "closest and any hit disagree");
    QueryCost cost;
    const Hit single = tree.closest_hit_with_cost(rays[i], mask, cost);
    if (!is_same(single, hits[i])) report(i, "alone it meets " + text_of(single));
  }
  std::vector<RayPacket> packets;
  for (std::size_t i = 0; i < rays.size(); i += kPacketLanes) {
    packets.push_back(
        make_packet(rays.subspan(i, std::min<std::size_t>(kPacketLanes, rays.size() - i))));
  }
  std::vector<HitPacket> packet_hits(packets.size());
  std::vector<std::uint32_t> packet_occluded(packets.size());
  tree.closest_hits(packets, mask, packet_hits);
  tree.any_hits(packets, mask, packet_occluded);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const std::size_t p = i / kPacketLanes;
    const int lane = static_cast<int>(i % kPacketLanes);
    const Hit hit = lane_of(packet_hits[p], lane);
    if (!is_same(hit, hits[i])) report(i, "in a packet it meets " + text_of(hit));
    if ((packet_occluded[p] >> lane & 1u) != (occluded[i] != 0 ? 1u : 0u)) {
      report(i, "a packet's any hit disagrees");
    }
  }
  EXPECT_EQ(reported, 0);
}

}  // namespace abbe::test
