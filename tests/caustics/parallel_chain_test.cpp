// Parallel light through and off flat facets, against closed forms.

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "abbe/base/constants.h"
#include "abbe/image/exr/exr.h"
#include "abbe/optics/dispersion.h"
#include "abbe/optics/fresnel.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

RenderSettings line_settings() {
  RenderSettings settings = test::small_settings();
  settings.wavelengths.exact_nm = {kLineF_nm, kLine_d_nm, kLineC_nm};
  return settings;
}

// Radiance at the middle of the picture.
float radiance(const Scene& scene, RenderSettings settings, double wavelength_nm) {
  return test::pixel(test::render(scene, settings).image, 4, 4,
                     spectral_channel_name(wavelength_nm));
}

// A camera that looks at one point of a matte surface, along `direction`.
Camera spot_camera(const Vec3d& target, const Vec3d& direction) {
  return test::orthographic_camera(target - 3.0 * direction, target, 1e-5, 1e-5);
}

// A matte floor at y = 0, seen at one point from a side; a lamp straight above or aslant.
Scene floor_scene(const Vec3d& light_direction, const Vec3d& target) {
  Scene scene;
  test::add_square(scene, test::add(scene, test::matte(Vec3f(1.0f))), 20.0,
                   test::rotation({1, 0, 0}, -90.0));
  scene.lights.push_back(test::directional_light(light_direction, 1000.0));
  scene.cameras.push_back(spot_camera(target, glm::normalize(Vec3d(0.9, -0.3, 0.0))));
  return scene;
}

TEST(ParallelChain, slab_of_glass_dims_by_both_fresnel_factors_and_absorption) {
  const Vec3d direction = glm::normalize(Vec3d(0.3, -1.0, 0.0));
  Scene scene = floor_scene(direction, {-1.0, 0.0, 0.0});
  RenderSettings settings = line_settings();
  settings.inner_reflections = 0;
  const float open = radiance(scene, settings, kLine_d_nm);
  Material glass = test::glass("glass/schott/N-SF11");
  glass.absorption_per_m = Spectrum::constant(2.0);
  test::add_box(scene, test::add(scene, glass), {1.0, 0.05, 1.0}, test::translation({-1, 0.5, 0}));
  const double n = refractive_index(glass.index, kLine_d_nm);
  const double sin_t = std::sqrt(1.0 - direction.y * direction.y) / n;
  const double tau = fresnel_dielectric(-direction.y, n).transmittance();
  const double path_m = 0.1 / std::sqrt(1.0 - sin_t * sin_t);
  // Parallel faces keep the cross section. Single precision.
  EXPECT_NEAR(radiance(scene, settings, kLine_d_nm) / open, tau * tau * std::exp(-2.0 * path_m),
              2e-5);
}

TEST(ParallelChain, plate_inside_coloured_glass_is_dimmed_once_by_the_way_of_the_light) {
  const Vec3d direction = glm::normalize(Vec3d(0.3, -1.0, 0.0));
  const auto seen = [&](double absorption_per_m) {
    Scene scene = floor_scene(direction, {0.0, 0.5, 0.0});
    scene.cameras.front() = spot_camera({0.0, 0.5, 0.0}, {0.0, -1.0, 0.0});
    Material glass = test::glass("glass/schott/N-SF11");
    glass.absorption_per_m = Spectrum::constant(absorption_per_m);
    test::add_box(scene, test::add(scene, glass), {1.0, 0.05, 1.0}, test::translation({0, 0.5, 0}));
    Material plate = test::matte(Vec3f(1.0f));
    plate.double_sided = true;  // Or light that the glass holds goes up through it.
    test::add_square(scene, test::add(scene, plate), 0.2,
                     test::translation({0, 0.5, 0}) * test::rotation({1, 0, 0}, -90.0));
    return radiance(scene, line_settings(), kLine_d_nm);
  };
  const double n = refractive_index(test::glass("glass/schott/N-SF11").index, kLine_d_nm);
  const double cos_t = std::sqrt(1.0 - (1.0 - direction.y * direction.y) / (n * n));
  // Down to the plate aslant, up to the camera straight. Single precision.
  EXPECT_NEAR(seen(8.0) / seen(0.0), std::exp(-8.0 * 0.05 * (1.0 + 1.0 / cos_t)), 2e-5);
}

TEST(ParallelChain, two_slabs_in_a_row_dim_by_four_boundaries) {
  for (const double slope : {0.3, 2.5}) {
    const Vec3d direction = glm::normalize(Vec3d(slope, -1.0, 0.0));
    Scene scene = floor_scene(direction, {-1.0, 0.0, 0.0});
    // Seen from the side that light goes to, past the slabs.
    scene.cameras.front() = spot_camera({-1.0, 0.0, 0.0}, glm::normalize(Vec3d(-0.9, -0.3, 0.0)));
    RenderSettings settings = line_settings();
    settings.inner_reflections = 0;
    const float open = radiance(scene, settings, kLine_d_nm);
    const Material glass = test::glass("glass/schott/N-SF11");
    const std::uint32_t number = test::add(scene, glass);
    test::add_box(scene, number, {2.5, 0.01, 1.0}, test::translation({-2.5, 0.5, 0}));
    test::add_box(scene, number, {2.5, 0.01, 1.0}, test::translation({-2.5, 0.7, 0}));
    const double tau =
        fresnel_dielectric(-direction.y, refractive_index(glass.index, kLine_d_nm)).transmittance();
    // With what the slabs throw to and fro between them; paths that carry less than 2e-4 of the
    // light are left out.
    const double between = 1.0 / (1.0 - std::pow(1.0 - tau, 2.0));
    EXPECT_NEAR(radiance(scene, settings, kLine_d_nm) / open, std::pow(tau, 4.0) * between, 3e-4)
        << slope;
  }
}

TEST(ParallelChain, wedge_narrows_the_beam_by_the_cosines) {
  // Light enters the wedge's flat top at right angles and leaves through the slope below.
  Scene scene = floor_scene({0, -1, 0}, {0.0, 0.0, 0.0});
  // Seen from below the thin end.
  scene.cameras.front() = spot_camera({0, 0, 0}, glm::normalize(Vec3d(-0.9, -0.3, 0.0)));
  RenderSettings settings = line_settings();
  const float open = radiance(scene, settings, kLine_d_nm);
  const double slope = glm::radians(25.0);
  ConvexShape wedge;
  wedge.planes = {Vec4d(0, 1, 0, 1.0),
                  Vec4d(std::sin(slope), -std::cos(slope), 0, -0.5 * std::cos(slope)),
                  Vec4d(-1, 0, 0, 3.0), Vec4d(0, 0, 1, 1.0), Vec4d(0, 0, -1, 1.0)};
  const Material glass = test::glass("glass/schott/N-BK7");
  test::add_shape(scene, {.name = "wedge", .geometry = wedge}, test::add(scene, glass), Mat4d(1.0));
  const double n = refractive_index(glass.index, kLine_d_nm);
  const double cos_i = std::cos(slope);
  const double cos_t = std::sqrt(1.0 - n * n * std::sin(slope) * std::sin(slope));
  // The deviated light falls aslant on the floor.
  const double floor_cosine = std::cos(std::asin(n * std::sin(slope)) - slope);
  const double tau = fresnel_dielectric(1.0, n).transmittance() *
                     fresnel_dielectric(cos_i, 1.0 / n).transmittance();
  settings.inner_reflections = 0;
  EXPECT_NEAR(radiance(scene, settings, kLine_d_nm) / open, tau * cos_i / cos_t * floor_cosine,
              3e-5);  // Single precision.
}

TEST(ParallelChain, mirror_lights_the_floor_with_its_reflectance) {
  // Light comes in horizontally, 45° mirror sends it down.
  Scene scene = floor_scene({1, 0, 0}, {0.0, 0.0, 0.0});
  const Material silver = test::mirror("metal/Ag-Johnson");
  test::add_square(scene, test::add(scene, silver), 0.5,
                   test::translation({0, 1, 0}) * test::rotation({0, 0, 1}, 45.0) *
                       test::rotation({0, 1, 0}, -90.0));
  RenderSettings settings = line_settings();
  const float lit = radiance(scene, settings, kLine_d_nm);
  Scene straight = floor_scene({0, -1, 0}, {0.0, 0.0, 0.0});
  const double expected =
      fresnel_conductor(std::cos(glm::radians(45.0)), silver.conductor->n.value(kLine_d_nm),
                        silver.conductor->k.value(kLine_d_nm));
  EXPECT_NEAR(lit / radiance(straight, settings, kLine_d_nm), expected, 2e-5);  // Single precision.
}

// Whether a ray from a place meets a square.
bool meets(const Vec3d& place, const Vec3d& direction, const Mat4d& square, double half_m) {
  const Mat4d inverse = glm::inverse(square);
  const Vec3d from(inverse * Vec4d(place, 1.0)), way(inverse * Vec4d(direction, 0.0));
  const Vec3d met = from - from.z / way.z * way;
  return std::abs(met.x) <= half_m && std::abs(met.y) <= half_m;
}

TEST(ParallelChain, pixel_with_an_edge_of_light_and_one_of_shadow_gets_what_both_leave) {
  constexpr double kHalfView_m = 0.01, kMirror_m = 0.2, kCard_m = 0.1;
  constexpr int kPixels = 8, kCells = 24;
  const Vec3d up(0, 1, 0), seen_along = glm::normalize(Vec3d(0.9, -0.3, 0.0));
  const Mat4d leaning = test::rotation({0, 0, 1}, 45.0) * test::rotation({0, 1, 0}, -90.0);
  const auto mirror_scene = [&](const Mat4d& mirror) {
    Scene scene = floor_scene({1, 0, 0}, {0.0, 0.0, 0.0});
    test::add_square(scene, test::add(scene, test::mirror("metal/Ag-Johnson")), kMirror_m, mirror);
    return scene;
  };
  RenderSettings settings = line_settings();
  settings.samples_per_pixel = 256;
  const float lit = radiance(mirror_scene(test::translation(up) * leaning), settings, kLine_d_nm);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  int pixels = 0;
  double sum = 0.0, expected_sum = 0.0;
  for (int number = 0; number < 32; ++number) {
    SCOPED_TRACE(number);
    // Edges of the mirror's light and of the card's shadow cross near the middle, at any angle.
    const Mat4d mirror = test::translation({0.004 * any(random), 1, 0}) * leaning *
                         test::rotation({0, 0, 1}, 180.0 * any(random)) *
                         test::translation({kMirror_m, 0, 0});
    const double height_m = number % 2 == 0 ? 0.4 : 0.004;
    const Mat4d card = test::translation({0.004 * any(random), height_m, 0}) *
                       test::rotation(up, 180.0 * any(random)) *
                       test::translation({kCard_m, 0, 0}) * test::rotation({1, 0, 0}, -90.0);
    Scene scene = mirror_scene(mirror);
    scene.cameras.front() =
        test::orthographic_camera(-3.0 * seen_along, {0, 0, 0}, kHalfView_m, kHalfView_m);
    Material paper = test::matte(Vec3f(0.0f));
    paper.double_sided = true;
    test::add_square(scene, test::add(scene, paper), kCard_m, card);
    const Image image = test::render(scene, settings).image;
    for (int y = 0; y < kPixels; ++y) {
      for (int x = 0; x < kPixels; ++x) {
        int light = 0, shadow = 0, left = 0, hidden = 0;
        for (int cell = 0; cell < kCells * kCells; ++cell) {
          const double column = x + (cell % kCells + 0.5) / kCells;
          const double row = y + (cell / kCells + 0.5) / kCells;
          const Vec3d eye(scene.cameras.front().to_world *
                          Vec4d(kHalfView_m * (2.0 * column / kPixels - 1.0),
                                kHalfView_m * (1.0 - 2.0 * row / kPixels), 0, 1));
          const Vec3d place = eye - eye.y / seen_along.y * seen_along;
          const bool is_lit = meets(place, up, mirror, kMirror_m);
          const bool is_shaded = meets(place, up, card, kCard_m);
          light += is_lit ? 1 : 0;
          shadow += is_shaded ? 1 : 0;
          left += is_lit && !is_shaded ? 1 : 0;
          hidden += meets(place, seen_along, card, kCard_m) ? 1 : 0;
        }
        constexpr int kAll = kCells * kCells;
        if (light == 0 || light == kAll || shadow == 0 || shadow == kAll || hidden > 0) continue;
        const double expected = static_cast<double>(left) / kAll;
        const double found = test::pixel(image, x, y, spectral_channel_name(kLine_d_nm)) / lit;
        // Samples find the shadow's edge: a sixteenth of them each way.
        EXPECT_NEAR(found, expected, 0.07) << x << ", " << y;
        sum += found;
        expected_sum += expected;
        ++pixels;
      }
    }
  }
  EXPECT_GT(pixels, 40);
  EXPECT_NEAR(sum / pixels, expected_sum / pixels, 0.005);  // Chance of so many samples.
}

// What a convex prism of glass sends to a place of light that goes along `sun`, where it has come
// along `arrival`: Fresnel's shares, 0 if none. Back along the ray, in double precision.
double share_through(const std::vector<Vec4d>& planes, double n, Vec3d at, const Vec3d& arrival,
                     const Vec3d& sun) {
  Vec3d back = -arrival;
  double share = 1.0;
  for (int face = 0; face < 12; ++face) {
    const bool is_inside = face > 0;
    // Into the prism over the last plane that is crossed from outside, out over the first.
    double t = is_inside ? 1e300 : 0.0;
    Vec3d normal(0.0);
    for (const Vec4d& plane : planes) {
      const double slope = glm::dot(Vec3d(plane), back);
      const double to_plane = (plane.w - glm::dot(Vec3d(plane), at)) / slope;
      const bool is_met = is_inside ? slope > 0.0 && to_plane < t : slope < 0.0 && to_plane > t;
      if (!is_met) continue;
      t = to_plane;
      normal = Vec3d(plane);
    }
    at += t * back;
    for (const Vec4d& plane : planes) {
      if (glm::dot(Vec3d(plane), at) > plane.w + 1e-9) return 0.0;
    }
    const double cosine = std::abs(glm::dot(normal, back));
    const double eta = is_inside ? n : 1.0 / n;
    const double square = 1.0 - eta * eta * (1.0 - cosine * cosine);
    if (square <= 0.0) {
      back -= 2.0 * glm::dot(normal, back) * normal;
      continue;
    }
    share *= fresnel_dielectric(cosine, 1.0 / eta).transmittance();
    const Vec3d ahead = is_inside ? normal : -normal;
    back = eta * back + (std::sqrt(square) - eta * cosine) * ahead;
    if (is_inside) return glm::dot(back, -sun) > 1.0 - 1e-9 ? share : 0.0;
  }
  return 0.0;
}

TEST(ParallelChain, turned_hexagonal_prism_lights_the_floor_straight_and_off_its_end) {
  const Vec3d sun = glm::normalize(Vec3d(0.3, -1.0, 0.2));
  RenderSettings settings = line_settings();
  const double open = radiance(floor_scene(sun, {0.15, 0.0, 0.17}), settings, kLine_d_nm);
  int straight = 0, off_end = 0;
  for (int turn_deg = -12; turn_deg <= 12; ++turn_deg) {
    const Mat4d placed =
        test::translation({0.02, 0.41, 0.03}) * test::rotation({0, 1, 0}, turn_deg);
    // Corners in single precision: its planes meet in them but for rounding.
    Mesh prism;
    std::vector<Vec4d> planes;
    for (std::uint32_t side = 0; side < 8; ++side) {
      const double angle = 0.13 + side * kPi / 3.0;
      const Vec3d normal = side < 6
                               ? Vec3d(std::cos(angle + kPi / 6.0), std::sin(angle + kPi / 6.0), 0)
                               : Vec3d(0, 0, side == 6 ? 1 : -1);
      const Vec3d turned(placed * Vec4d(normal, 0.0));
      const double distance_m = side < 6 ? 0.2 * std::cos(kPi / 6.0) : 0.25;
      planes.emplace_back(turned, distance_m + glm::dot(turned, Vec3d(placed[3])));
      if (side >= 6) continue;
      for (const double z : {-0.25, 0.25}) {
        prism.positions.emplace_back(placed *
                                     Vec4d(0.2 * std::cos(angle), 0.2 * std::sin(angle), z, 1.0));
      }
      const std::uint32_t back = 2 * side, next = (back + 2) % 12;
      prism.triangles.push_back({back, next, next + 1});
      prism.triangles.push_back({back, next + 1, back + 1});
      if (side == 0 || side == 5) continue;
      prism.triangles.push_back({0, next, back});
      prism.triangles.push_back({1, back + 1, next + 1});
    }
    const Vec3d end(placed * Vec4d(0.0, 0.0, 1.0, 0.0));
    const Vec3d off_the_end = sun - 2.0 * glm::dot(sun, end) * end;
    for (const double x : {0.11, 0.15, 0.19}) {
      for (const double z : {0.15, 0.16, 0.17, 0.18, 0.19}) {
        SCOPED_TRACE(std::to_string(turn_deg) + " deg, " + std::to_string(x) + ", " +
                     std::to_string(z));
        const Vec3d place(x, 0.0, z);
        const double first = share_through(planes, 1.5, place, sun, sun);
        const double second = share_through(planes, 1.5, place, off_the_end, sun);
        straight += first > 0.0 ? 1 : 0;
        off_end += second > 0.0 ? 1 : 0;
        Scene scene = floor_scene(sun, place);
        test::add_mesh(scene, prism, test::add(scene, test::glass(1.5)), Mat4d(1.0));
        // Paths with more reflections bring a few thousandths.
        EXPECT_NEAR(radiance(scene, settings, kLine_d_nm) / open, first + second, 0.02);
      }
    }
  }
  EXPECT_GT(straight, 100);
  EXPECT_GT(off_end, 100);
}

TEST(ParallelChain, caustics_off_gives_the_straight_ray_and_exact_nothing_twice) {
  const Vec3d direction = glm::normalize(Vec3d(0.3, -1.0, 0.0));
  Scene scene = floor_scene(direction, {-1.0, 0.0, 0.0});
  test::add_box(scene, test::add(scene, test::glass(1.5)), {1.0, 0.05, 1.0},
                test::translation({-1, 0.5, 0}));
  RenderSettings settings = line_settings();
  settings.inner_reflections = 0;
  const float exact = radiance(scene, settings, kLine_d_nm);
  settings.caustics = false;
  // Through parallel faces, far from their edges, both are the same light.
  EXPECT_NEAR(radiance(scene, settings, kLine_d_nm), exact, 1e-4f * exact);
}

TEST(ParallelChain, opaque_ball_before_behind_or_in_the_glass_blocks_the_light) {
  for (const double height : {0.9, 0.5, 0.2}) {
    Scene scene = floor_scene({0, -1, 0}, {-1.0, 0.0, 0.0});
    test::add_box(scene, test::add(scene, test::glass(1.5)), {1.0, 0.1, 1.0},
                  test::translation({-1, 0.5, 0}));
    test::add_sphere(scene, test::add(scene, test::matte(Vec3f(0.5f))), {-1, height, 0}, 0.05);
    EXPECT_EQ(radiance(scene, line_settings(), kLine_d_nm), 0.0f) << height;
  }
}

TEST(ParallelChain, mesh_and_exact_shape_send_the_same_light) {
  const Vec3d direction = glm::normalize(Vec3d(0.3, -1.0, 0.1));
  Scene shape = floor_scene(direction, {-1.0, 0.0, 0.0});
  Scene mesh = shape;
  const Mat4d place = test::translation({-1, 0.8, 0}) * test::rotation({0, 0, 1}, 20.0);
  test::add_box(shape, test::add(shape, test::glass(1.5)), {0.6, 0.2, 1.0}, place);
  test::add_box_mesh(mesh, test::add(mesh, test::glass(1.5)), {0.6, 0.2, 1.0}, place);
  const float expected = radiance(shape, line_settings(), kLine_d_nm);
  EXPECT_GT(expected, 0.0f);
  // Corners of the mesh are in single precision.
  EXPECT_NEAR(radiance(mesh, line_settings(), kLine_d_nm), expected, 1e-5f * expected);
}

TEST(ParallelChain, matte_ground_under_water_gets_refracted_light) {
  const Vec3d direction = glm::normalize(Vec3d(0.6, -0.8, 0.0));
  Scene scene = floor_scene(direction, {0.0, 0.0, 0.0});
  scene.cameras.front() = spot_camera({0, 0, 0}, {0, -1, 0});
  RenderSettings settings = line_settings();
  const float open = radiance(scene, settings, kLine_d_nm);
  const double n = 4.0 / 3.0;
  // A floor of the water's own index does not shine in it.
  scene.materials.front().index = ConstantIndex{n};
  test::add_box(scene, test::add(scene, test::glass(n)), {10.0, 0.5, 10.0},
                test::translation({0, 0.45, 0}));
  settings.inner_reflections = 0;
  // Per area of floor the flux is that of the surface: τ·E·cosθ_i; then out to the camera, τ/n².
  const double expected = fresnel_dielectric(0.8, n).transmittance() *
                          fresnel_dielectric(1.0, n).transmittance() / (n * n);
  EXPECT_NEAR(radiance(scene, settings, kLine_d_nm) / open, expected, 3e-5);  // Single precision.
}

}  // namespace
}  // namespace abbe
