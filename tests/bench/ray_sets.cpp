#include "bench/ray_sets.h"

#include <bit>
#include <cmath>
#include <optional>
#include <random>
#include <span>

namespace abbe::bench {
namespace {

struct Surface {
  Vec3f point;
  Vec3f normal;  ///< Of the triangle, towards the side the ray came from.
  Vec3f incoming;
  bool from_outside = true;
};

class Maker {
 public:
  Maker(const BenchScene& scene, const Accelerator& tree) : scene_(scene), tree_(tree) {}

  std::vector<Hit> trace(const std::vector<Ray>& rays) const {
    std::vector<Hit> hits(rays.size());
    tree_.closest_hits(rays, kAllBits, hits);
    return hits;
  }

  std::optional<Surface> surface(const Ray& ray, const Hit& hit) const {
    if (!hit.is_hit()) return std::nullopt;
    const Triangle& t = scene_.triangles[hit.primitive];
    const Vec3f a = scene_.positions[t[0]], b = scene_.positions[t[1]], c = scene_.positions[t[2]];
    Vec3f normal = glm::normalize(glm::cross(b - a, c - a));
    const bool from_outside = glm::dot(normal, ray.direction) < 0.0f;
    if (!from_outside) normal = -normal;
    return Surface{(1.0f - hit.u - hit.v) * a + hit.u * b + hit.v * c, normal, ray.direction,
                   from_outside};
  }

  // Beyond the rounding error of the hit, on the side of the new ray.
  static Vec3f leave(const Surface& s, float side) { return s.point + side * 2e-5f * s.normal; }

  Vec3f cosine_direction(const Vec3f& normal) {
    const float r = std::sqrt(uniform_(random_));
    const float phi = 2.0f * static_cast<float>(kPi) * uniform_(random_);
    const Basis basis(normal);
    return glm::normalize(basis.to_world(
        {r * std::cos(phi), r * std::sin(phi), std::sqrt(std::max(1e-4f, 1.0f - r * r))}));
  }

  float uniform() { return uniform_(random_); }

  const BenchScene& scene_;

 private:
  const Accelerator& tree_;
  std::mt19937 random_{7};
  std::uniform_real_distribution<float> uniform_{0.0f, 1.0f};
};

// Total reflection where the medium allows no refraction.
Vec3f refract(const Vec3f& direction, const Vec3f& normal, float eta_it, bool& is_refracted) {
  const float c = -glm::dot(direction, normal);
  const float k = 1.0f - eta_it * eta_it * (1.0f - c * c);
  is_refracted = k >= 0.0f;
  if (!is_refracted) return direction + 2.0f * c * normal;
  return glm::normalize(eta_it * direction + (eta_it * c - std::sqrt(k)) * normal);
}

void add_packet(RaySet& set, std::span<const Ray> rays, std::uint32_t active, bool common_origin) {
  RayPacket packet{};
  packet.active = active;
  packet.common_origin = common_origin;
  for (std::size_t i = 0; i < static_cast<std::size_t>(kPacketLanes); ++i) {
    const Ray& ray = rays[std::min(i, rays.size() - 1)];
    set_ray(packet, static_cast<int>(i), ray);
    if ((active >> i & 1u) != 0) set.rays.push_back(ray);
  }
  set.packets.push_back(packet);
}

void pack(RaySet& set, const std::vector<Ray>& rays, bool common_origin) {
  for (std::size_t i = 0; i < rays.size(); i += 16) {
    const std::size_t count = std::min<std::size_t>(16, rays.size() - i);
    add_packet(set, std::span(rays).subspan(i, count), (1u << count) - 1u, common_origin);
  }
}

// Pixels in tiles of 4 × 4, sixteen neighbours a packet, those in blocks of 4 × 4 packets.
std::vector<Ray> camera_rays(Maker& maker, int width) {
  const BenchScene& s = maker.scene_;
  const Vec3f forward = glm::normalize(s.target - s.eye);
  const Vec3f right = glm::normalize(glm::cross(forward, Vec3f(0.0f, 1.0f, 0.0f)));
  const Vec3f up = glm::cross(right, forward);
  std::vector<Ray> rays;
  for (int tile = 0; tile < (width / 16) * (width / 16); ++tile) {
    for (int i = 0; i < 256; ++i) {
      const int x = tile % (width / 16) * 16 + (i >> 4 & 3) * 4 + (i & 3);
      const int y = tile / (width / 16) * 16 + (i >> 6 & 3) * 4 + (i >> 2 & 3);
      const float scale = 2.0f * s.half_angle_tangent / static_cast<float>(width);
      const float u = (static_cast<float>(x) + maker.uniform()) * scale - s.half_angle_tangent;
      const float v = (static_cast<float>(y) + maker.uniform()) * scale - s.half_angle_tangent;
      rays.push_back({s.eye, kInfinity, glm::normalize(forward + u * right + v * up)});
    }
  }
  return rays;
}

std::vector<Ray> bounce(Maker& maker, const std::vector<Ray>& rays, const std::vector<Hit>& hits) {
  std::vector<Ray> result;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (const auto s = maker.surface(rays[i], hits[i])) {
      result.push_back({Maker::leave(*s, 1.0f), kInfinity, maker.cosine_direction(s->normal)});
    }
  }
  return result;
}

}  // namespace

std::vector<RaySet> make_ray_sets(const BenchScene& scene, const Accelerator& tree, int width) {
  Maker maker(scene, tree);
  RaySet primary{"primary", false, true, {}, {}}, shadow{"shadow", true, true, {}, {}};
  RaySet first{"bounce", false, false, {}, {}}, second{"second_bounce", false, false, {}, {}};
  RaySet fan{"fan", false, true, {}, {}}, fan_after{"fan_after", false, true, {}, {}};

  const std::vector<Ray> camera = camera_rays(maker, width);
  const std::vector<Hit> hits = maker.trace(camera);
  pack(primary, camera, true);

  std::vector<Ray> to_light;
  for (std::size_t i = 0; i < camera.size(); ++i) {
    if (const auto s = maker.surface(camera[i], hits[i])) {
      const Vec3f end = Maker::leave(*s, 1.0f);
      if (glm::dot(scene.light - end, s->normal) <= 0.0f) continue;
      const Vec3f path = end - scene.light;
      const float distance = glm::length(path);
      to_light.push_back({scene.light, distance * (1.0f - 1e-5f), path / distance});
    }
  }
  pack(shadow, to_light, true);

  const std::vector<Ray> bounced = bounce(maker, camera, hits);
  pack(first, bounced, false);
  pack(second, bounce(maker, bounced, maker.trace(bounced)), false);

  const auto index = [](int lane) { return 1.49f + 0.05f * static_cast<float>(lane) / 15.0f; };
  for (std::size_t i = 0; i < camera.size(); i += 16) {
    const auto s = maker.surface(camera[i], hits[i]);
    if (!s) continue;
    // Refraction that would leave the scene is of no interest: a ray of light that is spread
    // already is then reflected, as inside a prism.
    bool is_refracted = false;
    const Ray middle{Maker::leave(*s, -1.0f), kInfinity,
                     refract(s->incoming, s->normal, 1.0f / 1.515f, is_refracted)};
    const bool enters = maker.trace({middle})[0].is_hit();
    std::vector<Ray> lanes;
    for (int lane = 0; lane < 16; ++lane) {
      const Vec3f d = refract(s->incoming, s->normal, 1.0f / index(lane), is_refracted);
      lanes.push_back(enters ? Ray{middle.origin, kInfinity, d}
                             : Ray{Maker::leave(*s, 1.0f), kInfinity,
                                   d - 2.0f * glm::dot(d, s->normal) * s->normal});
    }
    add_packet(fan, lanes, 0xffffu, true);
    // Behind the second surface: lanes that refract go on together, else those that reflect.
    const std::vector<Hit> second_hits = maker.trace(lanes);
    std::uint32_t refracted = 0, reflected = 0;
    for (int lane = 0; lane < 16; ++lane) {
      const auto k = static_cast<std::size_t>(lane);
      if (const auto next = maker.surface(lanes[k], second_hits[k])) {
        Vec3f d = refract(next->incoming, next->normal, index(lane), is_refracted);
        if (!enters && is_refracted) {
          is_refracted = false;
          d = next->incoming - 2.0f * glm::dot(next->incoming, next->normal) * next->normal;
        }
        lanes[k] = {Maker::leave(*next, is_refracted ? -1.0f : 1.0f), kInfinity, d};
        (is_refracted ? refracted : reflected) |= 1u << lane;
      }
    }
    const std::uint32_t active =
        std::popcount(refracted) >= std::popcount(reflected) ? refracted : reflected;
    if (active != 0) add_packet(fan_after, lanes, active, false);
  }
  return {primary, shadow, first, second, fan, fan_after};
}

}  // namespace abbe::bench
