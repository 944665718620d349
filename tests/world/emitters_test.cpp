// Surfaces that shine: what is drawn for a place, against its density and brute force.
#include "abbe/world/emitters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "abbe/base/constants.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

Scene lit(bool two_sided = false) {
  Scene scene;
  scene.emissive_light = true;
  Material material = test::emitter(Vec3f(3.0f));
  material.double_sided = two_sided;
  test::add(scene, material);
  return scene;
}

LitWorld world_of(Scene scene) {
  scene.cameras.push_back(test::orthographic_camera({0, 0, 5}, {0, 0, 0}, 1.0, 1.0));
  return test::make_world(scene, test::small_settings());
}

struct Sum {
  double solid_angle_sr = 0.0;  ///< By the draws: of all that shines on the place.
  double squares = 0.0;
  double worst_ratio = 1.0;  ///< Of the density asked for and the one drawn with.
};

Sum drawn(const World& world, const Vec3f& from, int count = 200) {
  Sum sum;
  std::mt19937 engine(11);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) {
      const auto n = static_cast<float>(count);
      const float x = (static_cast<float>(i) + unit(engine)) / n;
      const auto spot = world.emitters->draw(
          {.position = from}, {std::min(x, 0.999999f), (static_cast<float>(j) + 0.5f) / n});
      if (!spot) continue;
      const Vec3d way = Vec3d(spot->position) - Vec3d(from);
      const double cosine = -glm::dot(glm::normalize(way), Vec3d(spot->normal));
      const double shown = spot->two_sided ? std::abs(cosine) : std::max(cosine, 0.0);
      const double share = shown / glm::dot(way, way) / static_cast<double>(spot->per_m2);
      sum.solid_angle_sr += share / (1.0 * count * count);
      sum.squares += share * share / (1.0 * count * count);
      const double again = static_cast<double>(
          world.emitters->density({.position = from}, spot->primitive, spot->position));
      const double ratio = again / static_cast<double>(spot->per_m2);
      if (std::abs(ratio - 1.0) > std::abs(sum.worst_ratio - 1.0)) sum.worst_ratio = ratio;
    }
  }
  return sum;
}

TEST(Emitters, of_materials_that_light_others_only) {
  Scene scene = lit();
  test::add_square(scene, 0, 0.5, Mat4d(1.0));
  EXPECT_NE(world_of(scene).emitters, nullptr);
  scene.emissive_light = false;
  EXPECT_EQ(world_of(scene).emitters, nullptr);
  scene.materials[0].lights_others = LightsOthers::Yes;
  EXPECT_NE(world_of(scene).emitters, nullptr);
  scene.materials[0].emissive_rec709 = Vec3f(0.0f);
  EXPECT_EQ(world_of(scene).emitters, nullptr);
}

TEST(Emitters, square_is_seen_from_its_front_unless_it_is_two_sided) {
  Scene scene = lit();
  test::add_square(scene, 0, 0.5, Mat4d(1.0));
  const LitWorld one_sided = world_of(scene);
  // A cube's face from its middle is a sixth of the sphere.
  EXPECT_NEAR(drawn(one_sided, {0, 0, 0.5f}).solid_angle_sr, 4.0 * kPi / 6.0, 1e-5);
  EXPECT_EQ(drawn(one_sided, {0, 0, -0.5f}).solid_angle_sr, 0.0);
  scene.materials[0].double_sided = true;
  EXPECT_NEAR(drawn(world_of(scene), {0, 0, -0.5f}).solid_angle_sr, 4.0 * kPi / 6.0, 1e-5);
}

TEST(Emitters, balls_are_seen_as_cones_and_ellipsoids_as_the_ball_they_are) {
  Scene scene = lit();
  test::add_sphere(scene, 0, {0, 0, 0}, 0.5);
  const double sphere = 2.0 * kPi * (1.0 - std::sqrt(1.0 - 0.25 / 4.0));
  const Sum sum = drawn(world_of(scene), {0, 2, 0});
  // Midpoints over a cap whose edge is seen at a slope.
  EXPECT_NEAR(sum.solid_angle_sr / sphere, 1.0, 1e-3);
  EXPECT_NEAR(sum.worst_ratio, 1.0, 1e-4);
  // Seen along its long axis, an ellipsoid of half axes 1, .5, .5 at distance 3 is a cone whose
  // tangent touches where x = 1/3: tan² = .25·(1 − 1/9)/(3 − 1/3)².
  Scene stretched = lit();
  test::add_shape(stretched, {.name = "", .geometry = SphereShape{0.5}}, 0,
                  Mat4d(glm::dmat4(2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1)));
  const double tan2 = 0.25 * (1.0 - 1.0 / 9.0) / std::pow(3.0 - 1.0 / 3.0, 2);
  const double cone = 2.0 * kPi * (1.0 - 1.0 / std::sqrt(1.0 + tan2));
  EXPECT_NEAR(drawn(world_of(stretched), {3, 0, 0}).solid_angle_sr / cone, 1.0, 1e-3);
}

TEST(Emitters, a_box_of_planes_is_its_faces) {
  Scene scene = lit();
  test::add_box(scene, 0, {0.5, 0.25, 1.0}, Mat4d(1.0));
  Scene mesh = lit(true);  // Exact shapes have both sides.
  test::add_box_mesh(mesh, 0, {0.5, 0.25, 1.0}, Mat4d(1.0));
  const Sum of_planes = drawn(world_of(scene), {2, 1, 0.5f});
  EXPECT_NEAR(of_planes.solid_angle_sr / drawn(world_of(mesh), {2, 1, 0.5f}).solid_angle_sr, 1.0,
              1e-3);
  EXPECT_NEAR(of_planes.worst_ratio, 1.0, 1e-3);
}

TEST(Emitters, hundreds_at_random_are_all_found_and_the_density_is_that_of_the_draw) {
  std::mt19937 engine(3);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  Scene scene = lit(true);
  Mesh mesh;
  for (std::uint32_t i = 0; i < 300; ++i) {
    const Vec3f at(unit(engine), unit(engine), unit(engine));
    for (int k = 0; k < 3; ++k) {
      mesh.positions.push_back(at + 0.1f * Vec3f(unit(engine), unit(engine), unit(engine)));
    }
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const std::vector<Vec3f> corners = mesh.positions;
  scene.meshes.push_back(mesh);
  scene.instances.push_back({.name = "many", .what = std::uint32_t{0}});
  const LitWorld world = world_of(scene);
  for (const Vec3f& from : {Vec3f(0, 0, 0), Vec3f(3, 1, 0), Vec3f(-1, 1, 0.3f)}) {
    double all_sr = 0.0;
    for (std::size_t i = 0; i < corners.size(); i += 3) {
      const Vec3d p(from);
      const Vec3d a = Vec3d(corners[i]) - p, b = Vec3d(corners[i + 1]) - p,
                  c = Vec3d(corners[i + 2]) - p;
      const double volume = glm::dot(a, glm::cross(b, c));
      const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
      all_sr += 2.0 * std::atan2(std::abs(volume), la * lb * lc + glm::dot(a, b) * lc +
                                                       glm::dot(a, c) * lb + glm::dot(b, c) * la);
    }
    const Sum sum = drawn(world, from, 400);
    // Three standard errors, as if the draws were not stratified.
    const double variance = sum.squares - sum.solid_angle_sr * sum.solid_angle_sr;
    EXPECT_NEAR(sum.solid_angle_sr, all_sr, 3.0 * std::sqrt(variance) / 400.0);
    EXPECT_LT(std::sqrt(variance), 4.0 * all_sr);
    EXPECT_NEAR(sum.worst_ratio, 1.0, 2e-3);
  }
}

}  // namespace
}  // namespace abbe
