// Several prisms: what one takes apart another puts together again, and three glasses compared.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <utility>

#include "abbe/base/constants.h"
#include "abbe/color/color.h"
#include "abbe/color/lamp/lamp.h"
#include "abbe/film/film.h"
#include "abbe/image/exr/exr.h"
#include "abbe/load/gltf.h"
#include "abbe/optics/dispersion.h"
#include "abbe/optics/fresnel.h"
#include "abbe/optics/snell.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

// The scene without fog, ambient light and the room's lamp: beams alone.
Scene beams_of(const std::string& name) {
  Notes notes;
  Scene scene =
      load_gltf(std::filesystem::path(ABBE_SOURCE_DIR) / "scenes" / name / (name + ".gltf"),
                test::catalogue(), {}, notes);
  scene.fog.reset();
  scene.ambient.reset();
  std::erase_if(scene.lights, [](const Light& light) { return !light.beam; });
  return scene;
}

const Instance& instance(const Scene& scene, const std::string& name) {
  for (const Instance& candidate : scene.instances) {
    if (candidate.name == name) return candidate;
  }
  throw std::runtime_error("no instance " + name);
}

// The middle of a screen, its normal, and its width's direction.
struct Screen {
  Vec3d center, normal, right;
};

Screen screen(const Scene& scene, const std::string& name) {
  const Mat4d& place = instance(scene, name).to_world;
  return {Vec3d(place[3]), Vec3d(place[2]), Vec3d(place[0])};
}

// A camera just in front of a screen that sees it square on, x to its right.
Camera before(const Screen& screen, double half_width_m, double half_height_m) {
  return test::orthographic_camera(screen.center + 0.1 * screen.normal, screen.center, half_width_m,
                                   half_height_m);
}

struct Ray2 {
  Vec3d origin, direction;
};

// Through a convex body by Snell at the faces where a ray comes in and goes out.
Ray2 through(const Scene& scene, const std::string& name, Ray2 ray, double n) {
  const Instance& body = instance(scene, name);
  const auto& convex = std::get<ConvexShape>(std::get<Shape>(body.what).geometry);
  const Vec3d offset(body.to_world[3]);
  for (const bool enters : {true, false}) {
    double place_m = enters ? -1e30 : 1e30;
    Vec3d normal(0.0);
    for (const Vec4d& plane : convex.planes) {
      const Vec3d face = glm::normalize(Vec3d(plane));
      const double slope = glm::dot(face, ray.direction);
      if (enters ? slope >= 0.0 : slope <= 0.0) continue;
      const double t = (plane.w + glm::dot(face, offset - ray.origin)) / slope;
      if (enters ? t > place_m : t < place_m) {
        place_m = t;
        normal = face;
      }
    }
    ray.origin += place_m * ray.direction;
    ray.direction = *refracted_direction(ray.direction, normal, enters ? n : 1.0 / n);
  }
  return ray;
}

Ray2 middle_of(const Light& light) {
  return {Vec3d(light.to_world[3]), glm::normalize(-Vec3d(light.to_world[2]))};
}

// Metres to the right of a screen's middle.
double place_on(const Screen& screen, const Ray2& ray) {
  const double t =
      glm::dot(screen.center - ray.origin, screen.normal) / glm::dot(ray.direction, screen.normal);
  return glm::dot(ray.origin + t * ray.direction - screen.center, screen.right);
}

// Centroid along x of the light between two columns, metres from the middle.
double centroid(const Image& image, const std::string& channel, double pixel_m, int from, int to) {
  double sum = 0.0, moment = 0.0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = from; x < to; ++x) {
      const auto value = static_cast<double>(test::pixel(image, x, y, channel));
      sum += value;
      moment += value * (x + 0.5 - 0.5 * image.width) * pixel_m;
    }
  }
  return moment / sum;
}

double index_of(const Scene& scene, const std::string& body, double wavelength_nm) {
  return refractive_index(
      scene.materials[std::get<Shape>(instance(scene, body).what).material].index, wavelength_nm);
}

constexpr std::array<double, 3> kLines_nm{kLineF_nm, kLine_d_nm, kLineC_nm};

TEST(NewtonTwo, lines_leave_parallel_to_the_beam_moved_aside_as_snell_says) {
  Scene scene = beams_of("newton-two");
  const Screen white = screen(scene, "white screen");
  RenderSettings settings;
  settings.size = {128, 64};
  settings.samples_per_pixel = 16;
  settings.filter = "box";
  settings.wavelengths.exact_nm.assign(kLines_nm.begin(), kLines_nm.end());
  scene.cameras.assign(1, before(white, 0.032, 0.016));
  scene.cameras.front().to_world[3].y = 0.06;
  const LitWorld world = test::make_world(scene, settings);
  const Image image = test::render(world, scene.cameras.front(), settings).image;
  const double pixel_m = 0.0005;
  for (const double nm : kLines_nm) {
    Ray2 ray = middle_of(scene.lights.front());
    const Vec3d towards = ray.direction;
    ray = through(scene, "first prism", ray, index_of(scene, "first prism", nm));
    ray = through(scene, "second prism", ray, index_of(scene, "second prism", nm));
    EXPECT_NEAR(glm::dot(ray.direction, towards), 1.0, 1e-12);
    EXPECT_NEAR(centroid(image, spectral_channel_name(nm), pixel_m, 0, image.width),
                place_on(white, ray), 0.5 * pixel_m)
        << nm;
  }
}

Vec2d xy_of(const Image& image, int x, int y) {
  const Vec3d rgb_rec709(test::pixel(image, x, y, "R"), test::pixel(image, x, y, "G"),
                         test::pixel(image, x, y, "B"));
  return xy_of_xyz(rec709_to_xyz() * rgb_rec709);
}

TEST(NewtonTwo, middle_of_the_recombined_beam_is_as_white_as_the_beam) {
  Scene scene = beams_of("newton-two");
  const Screen white = screen(scene, "white screen");
  RenderSettings settings;
  settings.size = {64, 32};
  settings.samples_per_pixel = 16;
  settings.filter = "box";
  scene.cameras.assign(1, before(white, 0.032, 0.016));
  scene.cameras.front().to_world[3].y = 0.06;
  const Image image = test::render(scene, settings).image;
  // The beam straight on the same screen.
  Scene bare = scene;
  std::erase_if(bare.instances,
                [](const Instance& body) { return body.name.find("prism") != std::string::npos; });
  bare.lights.front().beam.reset();
  const Vec2d beam = xy_of(test::render(bare, settings).image, 32, 16);
  int checked = 0;
  // From 400 nm, moved 6.9 mm to the left, to 700 nm, 1.4 mm to the right, all lines overlap here.
  for (int x = 24; x < 34; ++x) {
    const Vec2d seen = xy_of(image, x, 16);
    // 0.005 is what the eye takes as one white; Fresnel at four faces is what is left.
    EXPECT_LT(glm::length(seen - beam), 0.005) << x << ' ' << seen.x << ' ' << seen.y;
    ++checked;
  }
  EXPECT_GT(checked, 0);
}

TEST(MinimumDeviation, lines_of_three_glasses_land_where_snell_sends_them) {
  Scene scene = beams_of("minimum-deviation");
  const Screen wall = screen(scene, "screen");
  RenderSettings settings;
  settings.size = {768, 32};
  settings.samples_per_pixel = 16;
  settings.filter = "box";
  settings.wavelengths.exact_nm.assign(kLines_nm.begin(), kLines_nm.end());
  const double pixel_m = 0.001;
  scene.cameras.assign(1, before(wall, 0.384, 0.016));
  scene.cameras.front().to_world[3].y = 0.042;
  const Image image = test::render(scene, settings).image;
  const std::array<std::string, 3> glasses{"N-SF11", "N-F2", "N-BK7"};
  for (std::size_t g = 0; g < glasses.size(); ++g) {
    const std::string body = glasses[g] + " prism";
    const double n_d = index_of(scene, body, kLine_d_nm);
    // Half the deviation over the apex angle: n = sin((δ + 60°)/2)/sin 30°.
    const double deviation = 2.0 * std::asin(0.5 * n_d) - kPi / 3.0;
    const Ray2 beam = middle_of(scene.lights[g]);
    const double expected_d = -0.24 + 0.24 * static_cast<double>(g);
    for (const double nm : kLines_nm) {
      const Ray2 out = through(scene, body, beam, index_of(scene, body, nm));
      const double place = place_on(wall, out);
      if (nm == kLine_d_nm) {
        EXPECT_NEAR(std::acos(glm::dot(beam.direction, out.direction)), deviation, 1e-6);
        EXPECT_NEAR(place, expected_d, 1e-5);
      }
      const auto column = static_cast<int>(384.0 + expected_d / pixel_m);
      EXPECT_NEAR(centroid(image, spectral_channel_name(nm), pixel_m, column - 90, column + 90),
                  place, 0.5 * pixel_m)
          << glasses[g] << ' ' << nm;
    }
  }
}

}  // namespace
}  // namespace abbe
