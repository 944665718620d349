#include "accel/judge.h"

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

// The same where a triangle may be there from the front only.
Verdict judge_sided(const World& world, std::size_t number, const Ray& ray, QueryMask mask) {
  const Triangle& triangle = world.triangles[number];
  Verdict verdict = judge_triangle(world, triangle, ray);
  if (world.front_only.empty() || world.front_only[number] == 0 || !verdict.may) return verdict;
  if ((mask & (kCullBack | kCullFront)) == 0) return verdict;
  const Vec3d a(world.positions[triangle[0]]);
  const Vec3d normal =
      glm::cross(Vec3d(world.positions[triangle[1]]) - a, Vec3d(world.positions[triangle[2]]) - a);
  const Vec3d d(ray.direction);
  const double towards = (mask & kCullBack) != 0 ? glm::dot(normal, d) : -glm::dot(normal, d);
  // The float test has the sign of this from sums of products of coordinates.
  const double doubt = 1e-4 * glm::length(normal) * glm::length(d);
  if (towards > doubt) return {};
  if (towards > -doubt) verdict.must = false;
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

// Where a line enters and leaves a solid.
struct Roots {
  bool may = false;   // It may meet the solid,
  bool must = false;  // and must.
  double near = 0.0, far = 0.0;
  double error = 0.0;          // Of both.
  double grazing_error = 0.0;  // The same where it only may.
};

Roots ellipsoid_roots(const Ellipsoid& e, const Ray& ray) {
  const auto linear = [&](const Vec3d& v) { return e.world_to_unit_linear * v; };
  const Vec3d o = linear(Vec3d(ray.origin)) + e.world_to_unit_offset;
  const Vec3d d = linear(Vec3d(ray.direction));
  const double a = glm::dot(d, d), b = glm::dot(o, d);
  const Vec3d closest = o - d * (b / a);
  const double inside = 1.0 - glm::dot(closest, closest);
  const double root = std::sqrt(std::max(inside, 0.0) / a);
  const double size = (std::abs(b / a) + root);
  const double error = 0x1p-23 * size + 1e-12;  // The answer is a float.
  // Double rounding beside a grazing ray.
  return {inside >= -1e-9, inside >= 1e-9, -b / a - root,
          -b / a + root,   error,          root + std::sqrt(1e-9 / a)};
}

Roots polyhedron_roots(const World& world, const ConvexPolyhedron& p, const Ray& ray) {
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
  return {enter <= leave + error, !grazes && enter <= leave - error, enter, leave, error, 0.0};
}

Roots roots_of(const World& world, std::size_t solid, const Ray& ray) {
  if (solid < world.ellipsoids.size()) return ellipsoid_roots(world.ellipsoids[solid], ray);
  return polyhedron_roots(world, world.polyhedra[solid - world.ellipsoids.size()], ray);
}

Verdict judge_solid(const World& world, std::size_t solid, const Ray& ray) {
  const Roots roots = roots_of(world, solid, ray);
  if (!roots.may) return {};
  Verdict verdict =
      nearest_root(roots.near, roots.far, roots.error, static_cast<double>(ray.t_max));
  if (!roots.must) {
    verdict.must = false;
    verdict.t_error += roots.grazing_error;
  }
  return verdict;
}

// What can be said about each crossing of one ray with one primitive; of none it is nothing.
std::array<Verdict, 2> judge_crossings(const World& world, std::size_t primitive, const Ray& ray,
                                       QueryMask mask) {
  if (primitive < world.triangles.size()) {
    return {judge_sided(world, primitive, ray, mask)};
  }
  const Roots roots = roots_of(world, primitive - world.triangles.size(), ray);
  if (!roots.may) return {};
  const double error = roots.error + (roots.must ? 0.0 : roots.grazing_error);
  const double t_max = static_cast<double>(ray.t_max);
  std::array<Verdict, 2> verdicts = {at(roots.near, error, t_max), at(roots.far, error, t_max)};
  for (Verdict& verdict : verdicts) verdict.must = verdict.must && roots.must;
  return verdicts;
}

Verdict judge(const World& world, std::size_t primitive, const Ray& ray, QueryMask mask) {
  if (primitive < world.triangles.size()) {
    return judge_sided(world, primitive, ray, mask);
  }
  return judge_solid(world, primitive - world.triangles.size(), ray);
}

bool sees(const World& world, std::size_t primitive, QueryMask mask) {
  return world.masks.empty() || (world.masks[primitive] & mask) != 0;
}

// The nearest distance by which something must have been met.
struct Limit {
  double t = kInfinite;
  std::size_t primitive = 0;
  bool may_any = false;
};

Limit limit_of(const World& world, const Ray& ray, QueryMask mask) {
  Limit limit;
  const std::size_t count = world.spans().primitive_count();
  for (std::size_t i = 0; i < count; ++i) {
    if (!sees(world, i, mask)) continue;
    const Verdict verdict = judge(world, i, ray, mask);
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

std::string check_closest(const World& world, const Ray& ray, QueryMask mask, const Hit& hit) {
  const Limit limit = limit_of(world, ray, mask);
  if (!hit.is_hit()) {
    if (limit.t == kInfinite) return {};
    return fmt::format("missed primitive {} before {}", limit.primitive, limit.t);
  }
  if (hit.primitive >= world.spans().primitive_count()) return "primitive number out of range";
  if (!sees(world, hit.primitive, mask)) return "masked primitive";
  if (!(hit.t > 0.0f && hit.t < ray.t_max)) return "hit outside (0, t_max)";
  const Verdict verdict = judge(world, hit.primitive, ray, mask);
  if (!verdict.may) return "hit a primitive beside the ray";
  if (std::abs(static_cast<double>(hit.t) - verdict.t) > verdict.t_error + 1e-30) {
    return fmt::format("hit at a wrong distance, expected {} ± {}", verdict.t, verdict.t_error);
  }
  if (static_cast<double>(hit.t) - verdict.t_error > limit.t) {
    return fmt::format("primitive {} is nearer: {}", limit.primitive, limit.t);
  }
  return {};
}

std::string check_any(const World& world, const Ray& ray, QueryMask mask, bool is_occluded) {
  const Limit limit = limit_of(world, ray, mask);
  if (is_occluded && !limit.may_any) return "occluded by nothing";
  if (!is_occluded && limit.t < kInfinite) {
    return fmt::format("not occluded by primitive {}", limit.primitive);
  }
  return {};
}

std::string check_all(const World& world, const Ray& ray, QueryMask mask, VisibilityMask stops,
                      std::span<const Hit> hits) {
  const std::size_t count = world.spans().primitive_count();
  const auto is_stop = [&](const Hit& hit) {
    return stops != 0 && sees(world, hit.primitive, stops);
  };
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const Hit& hit = hits[i];
    if (hit.primitive >= count) return "primitive number out of range";
    if (!sees(world, hit.primitive, mask)) return "masked primitive";
    if (!(hit.t > 0.0f && hit.t < ray.t_max)) return "hit outside (0, t_max)";
    if (is_stop(hit) && i + 1 < hits.size()) return "goes on behind a hit that stops it";
    if (i > 0) {
      const Hit& before = hits[i - 1];
      const bool is_solid = hit.primitive >= world.triangles.size();
      if (!(before.t < hit.t ||
            (before.t == hit.t && (before.primitive < hit.primitive ||
                                   (is_solid && before.primitive == hit.primitive))))) {
        return fmt::format("hit {} is out of order", i);
      }
    }
    const auto verdicts = judge_crossings(world, hit.primitive, ray, mask);
    const bool is_right = std::any_of(verdicts.begin(), verdicts.end(), [&](const Verdict& v) {
      return v.may && std::abs(static_cast<double>(hit.t) - v.t) <= v.t_error + 1e-30;
    });
    if (!is_right) return fmt::format("hit {} of primitive {} is none", i, hit.primitive);
    const auto times = std::count_if(hits.begin(), hits.end(), [&](const Hit& other) {
      return other.primitive == hit.primitive;
    });
    if (times > (hit.primitive < world.triangles.size() ? 1 : 2)) {
      return fmt::format("primitive {} is met {} times", hit.primitive, times);
    }
  }
  const double end =
      !hits.empty() && is_stop(hits.back()) ? static_cast<double>(hits.back().t) : kInfinite;
  for (std::size_t primitive = 0; primitive < count; ++primitive) {
    if (!sees(world, primitive, mask)) continue;
    for (const Verdict& verdict : judge_crossings(world, primitive, ray, mask)) {
      if (!verdict.must || verdict.t + verdict.t_error >= end) continue;
      const bool is_found = std::any_of(hits.begin(), hits.end(), [&](const Hit& hit) {
        return hit.primitive == primitive &&
               std::abs(static_cast<double>(hit.t) - verdict.t) <= verdict.t_error + 1e-30;
      });
      if (!is_found) return fmt::format("missed primitive {} at {}", primitive, verdict.t);
    }
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

namespace {

// Says of the first few rays what is wrong with their answers.
class Reporter {
 public:
  explicit Reporter(std::span<const Ray> rays) : rays_(rays) {}
  ~Reporter() { EXPECT_EQ(count_, 0); }

  void report(std::size_t i, const std::string& what) {
    if (++count_ <= 5) ADD_FAILURE() << "ray " << i << ": " << what << "; " << text_of(rays_[i]);
  }
  void check(std::size_t i, const std::string& wrong, const Hit& answer) {
    if (!wrong.empty()) report(i, wrong + "; answer " + text_of(answer));
  }

 private:
  std::span<const Ray> rays_;
  int count_ = 0;
};

std::vector<RayPacket> packets_of(std::span<const Ray> rays) {
  std::vector<RayPacket> packets;
  for (std::size_t i = 0; i < rays.size(); i += kPacketLanes) {
    packets.push_back(
        make_packet(rays.subspan(i, std::min<std::size_t>(kPacketLanes, rays.size() - i))));
  }
  return packets;
}

std::size_t stride_of(std::span<const Ray> rays, std::size_t judged) {
  return std::max<std::size_t>(1, rays.size() / std::max<std::size_t>(judged, 1));
}

}  // namespace

void expect_right_answers(const World& world, const Accelerator& accelerator,
                          std::span<const Ray> rays, QueryMask mask, std::size_t judged) {
  std::vector<Hit> hits(rays.size());
  std::vector<std::uint8_t> occluded(rays.size());
  accelerator.closest_hits(rays, mask, hits);
  accelerator.any_hits(rays, mask, occluded);
  Reporter reporter(rays);
  for (std::size_t i = 0; i < rays.size(); i += stride_of(rays, judged)) {
    reporter.check(i, check_closest(world, rays[i], mask, hits[i]), hits[i]);
  }
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if ((occluded[i] != 0) != hits[i].is_hit()) {
      reporter.report(i, "closest and any hit disagree, closest " + text_of(hits[i]));
    }
    QueryCost cost;
    const Hit single = accelerator.closest_hit_with_cost(rays[i], mask, cost);
    if (!is_same(single, hits[i])) reporter.report(i, "alone it meets " + text_of(single));
  }
  const std::vector<RayPacket> packets = packets_of(rays);
  std::vector<HitPacket> packet_hits(packets.size());
  std::vector<std::uint32_t> packet_occluded(packets.size());
  accelerator.closest_hits(packets, mask, packet_hits);
  accelerator.any_hits(packets, mask, packet_occluded);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const std::size_t p = i / kPacketLanes;
    const int lane = static_cast<int>(i % kPacketLanes);
    const Hit hit = lane_of(packet_hits[p], lane);
    if (!is_same(hit, hits[i])) {
      reporter.report(i,
                      "in a packet it meets " + text_of(hit) + " instead of " + text_of(hits[i]));
    }
    if ((packet_occluded[p] >> lane & 1u) != (occluded[i] != 0 ? 1u : 0u)) {
      reporter.report(i, "a packet's any hit disagrees");
    }
  }
  expect_right_lists(world, accelerator, rays, mask, VisibilityMask{0}, judged / 4);
}

void expect_right_lists(const World& world, const Accelerator& accelerator,
                        std::span<const Ray> rays, QueryMask mask, VisibilityMask stops,
                        std::size_t judged) {
  std::vector<Hit> hits(rays.size());
  HitLists lists, in_packets;
  accelerator.closest_hits(rays, mask, hits);
  accelerator.all_hits(rays, mask, stops, lists);
  accelerator.all_hits(packets_of(rays), mask, stops, in_packets);
  ASSERT_EQ(lists.size(), rays.size());
  ASSERT_EQ(in_packets.size(), (rays.size() + 15) / 16 * 16);
  Reporter reporter(rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Hit first = lists[i].empty() ? Hit{} : lists[i].front();
    if (!is_same(first, hits[i])) {
      reporter.report(
          i, "the first of all is " + text_of(first) + ", the closest " + text_of(hits[i]));
    }
    if (!std::equal(lists[i].begin(), lists[i].end(), in_packets[i].begin(), in_packets[i].end(),
                    is_same)) {
      reporter.report(i, "in a packet it meets others");
    }
  }
  for (std::size_t i = 0; i < rays.size(); i += stride_of(rays, judged)) {
    reporter.check(i, check_all(world, rays[i], mask, stops, lists[i]), hits[i]);
  }
}

}  // namespace abbe::test
