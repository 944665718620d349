#include "support/forward_light.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <cmath>
#include <limits>
#include <optional>
#include <variant>

#include "abbe/base/constants.h"
#include "abbe/optics/dispersion.h"
#include "abbe/optics/fresnel.h"
#include "abbe/optics/snell.h"

namespace abbe::test {
namespace {

struct Solid {
  std::vector<Vec4d> planes;  ///< n·x ≤ w inside.
  bool is_glass = false;
  double n = 1.0;
};

struct Crossing {
  double t = std::numeric_limits<double>::infinity();
  Vec3d normal{0.0};
  std::size_t solid = 0;
};

std::vector<Solid> solids_of(const Scene& scene, double wavelength_nm) {
  std::vector<Solid> solids;
  for (const Instance& instance : scene.instances) {
    const auto* shape = std::get_if<Shape>(&instance.what);
    if (shape == nullptr) continue;
    const Material& material = scene.materials[shape->material];
    Solid solid;
    solid.is_glass = material.transmission > 0.0f;
    solid.n = refractive_index(material.index, wavelength_nm);
    const Mat3d for_normals = glm::transpose(glm::inverse(Mat3d(instance.to_world)));
    for (const Vec4d& plane : std::get<ConvexShape>(shape->geometry).planes) {
      const Vec3d normal = for_normals * Vec3d(plane);
      const double length = glm::length(normal);
      const double w = plane.w + glm::dot(normal, Vec3d(instance.to_world[3]));
      solid.planes.push_back(Vec4d(normal, w) / length);
    }
    solids.push_back(std::move(solid));
  }
  return solids;
}

class Follower {
 public:
  Follower(const std::vector<Solid>& solids, const Screen& screen, ForwardLight& result)
      : solids_(solids), screen_(screen), result_(result) {
    normal_ = glm::cross(screen.y, screen.x);
  }

  void send(const Vec3d& lamp, const Vec3d& direction, double sr, int inner_reflections) {
    const auto hit = first_from_outside(lamp, direction);
    land(lamp, direction, hit ? hit->t : std::numeric_limits<double>::infinity(), sr);
    if (!hit || !solids_[hit->solid].is_glass) return;
    result_.on_glass_sr += sr;
    const Solid& glass = solids_[hit->solid];
    const Vec3d at = lamp + hit->t * direction;
    const double share =
        fresnel_dielectric(-glm::dot(direction, hit->normal), glass.n).transmittance();
    go_outside(at, reflected_direction(direction, hit->normal), hit->normal, sr * (1.0 - share));
    go_inside(at, *refracted_direction(direction, hit->normal, glass.n), hit->solid, sr * share,
              inner_reflections);
  }

 private:
  std::optional<Crossing> first_from_outside(const Vec3d& from, const Vec3d& direction) const {
    Crossing first;
    for (std::size_t s = 0; s < solids_.size(); ++s) {
      double enter = 1e-9;
      double leave = std::numeric_limits<double>::infinity();
      Vec3d normal(0.0);
      bool is_missed = false;
      for (const Vec4d& plane : solids_[s].planes) {
        const double slope = glm::dot(Vec3d(plane), direction);
        const double t = (plane.w - glm::dot(Vec3d(plane), from)) / slope;
        if (slope < 0.0 && t > enter) {
          enter = t;
          normal = Vec3d(plane);
        }
        if (slope > 0.0) leave = std::min(leave, t);
        if (slope == 0.0 && glm::dot(Vec3d(plane), from) > plane.w) is_missed = true;
      }
      if (!is_missed && enter < leave && normal != Vec3d(0.0) && enter < first.t) {
        first = {enter, normal, s};
      }
    }
    if (!std::isfinite(first.t)) return std::nullopt;
    return first;
  }

  // Light that has left glass: to the screen unless something stands before it. A second body
  // would be entered here; the scenes of the reference have one.
  void go_outside(const Vec3d& from, const Vec3d& direction, const Vec3d& normal, double sr) {
    const auto hit = first_from_outside(from + 1e-9 * normal, direction);
    land(from, direction, hit ? hit->t : std::numeric_limits<double>::infinity(), sr);
  }

  void go_inside(const Vec3d& from, const Vec3d& direction, std::size_t s, double sr,
                 int reflections_left) {
    const Solid& glass = solids_[s];
    Crossing last;
    for (const Vec4d& plane : glass.planes) {
      const double slope = glm::dot(Vec3d(plane), direction);
      if (!(slope > 0.0)) continue;
      const double t = (plane.w - glm::dot(Vec3d(plane), from)) / slope;
      if (t < last.t) last = {t, Vec3d(plane), s};
    }
    const Vec3d at = from + last.t * direction;
    const double share =
        fresnel_dielectric(glm::dot(direction, last.normal), 1.0 / glass.n).transmittance();
    if (const auto out = refracted_direction(direction, last.normal, 1.0 / glass.n)) {
      go_outside(at, *out, last.normal, sr * share);
    }
    if (reflections_left == 0) return;
    go_inside(at, reflected_direction(direction, last.normal), s, sr * (1.0 - share),
              reflections_left - 1);
  }

  void land(const Vec3d& from, const Vec3d& direction, double limit, double sr) {
    const double slope = glm::dot(direction, normal_);
    if (!(slope < 0.0)) return;
    const double t = glm::dot(screen_.center - from, normal_) / slope;
    if (!(t > 0.0 && t < limit)) return;
    const Vec3d at = from + t * direction - screen_.center;
    const double x = glm::dot(at, screen_.x) / screen_.pixel_m + 0.5 * screen_.size.x;
    const double y = glm::dot(at, screen_.y) / screen_.pixel_m + 0.5 * screen_.size.y;
    if (!(x >= 0.0 && y >= 0.0 && x < screen_.size.x && y < screen_.size.y)) return;
    const auto pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(screen_.size.x) +
                       static_cast<std::size_t>(x);
    result_.irradiance[pixel] += sr / (screen_.pixel_m * screen_.pixel_m);
    result_.on_screen_sr += sr;
  }

  const std::vector<Solid>& solids_;
  const Screen& screen_;
  ForwardLight& result_;
  Vec3d normal_{0.0};
};

ForwardLight nothing(const Screen& screen) {
  ForwardLight light;
  light.irradiance.assign(
      static_cast<std::size_t>(screen.size.x) * static_cast<std::size_t>(screen.size.y), 0.0);
  return light;
}

}  // namespace

Screen screen_of(const Camera& camera, const Vec3d& center, const Vec2i& size) {
  const auto& flat = std::get<OrthographicCamera>(camera.projection);
  Screen screen;
  screen.center = center;
  screen.x = Vec3d(camera.to_world[0]);
  screen.y = -Vec3d(camera.to_world[1]);
  screen.pixel_m = 2.0 * flat.xmag / size.x;
  screen.size = size;
  return screen;
}

ForwardLight follow_forward(const Scene& scene, const Vec3d& lamp, const Vec3d& axis,
                            double half_angle_rad, double wavelength_nm, int inner_reflections,
                            std::uint64_t rays, const Screen& screen) {
  const std::vector<Solid> solids = solids_of(scene, wavelength_nm);
  const Vec3d helper = std::abs(axis.x) < 0.6 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
  const Vec3d u = glm::normalize(glm::cross(helper, axis));
  const Vec3d v = glm::cross(axis, u);
  const double cap = 1.0 - std::cos(half_angle_rad);
  const double aimed_sr = 2.0 * kPi * cap;
  const double sr = aimed_sr / static_cast<double>(rays);
  const auto part = [&](const tbb::blocked_range<std::uint64_t>& range, ForwardLight sum) {
    Follower follower(solids, screen, sum);
    for (std::uint64_t i = range.begin(); i < range.end(); ++i) {
      // Roberts' sequence in 64-bit fractions: powers of the inverse plastic number.
      constexpr double kTwoTo64 = 18446744073709551616.0;
      const auto fraction = [&](std::uint64_t step) {
        return static_cast<double>(i * step + 0x8000000000000000ull) / kTwoTo64;
      };
      const double cosine = 1.0 - cap * fraction(0xc13fa9a902a6328full);
      const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
      const double azimuth = 2.0 * kPi * fraction(0x91e10da5c79e7b1dull);
      const Vec3d direction =
          cosine * axis + sine * (std::cos(azimuth) * u + std::sin(azimuth) * v);
      follower.send(lamp, direction, sr, inner_reflections);
    }
    return sum;
  };
  const auto join = [](ForwardLight a, const ForwardLight& b) {
    for (std::size_t i = 0; i < a.irradiance.size(); ++i) a.irradiance[i] += b.irradiance[i];
    a.on_glass_sr += b.on_glass_sr;
    a.on_screen_sr += b.on_screen_sr;
    return a;
  };
  ForwardLight all = tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::uint64_t>(0, rays, 1u << 20), nothing(screen), part, join);
  all.aimed_sr = aimed_sr;
  return all;
}

}  // namespace abbe::test
