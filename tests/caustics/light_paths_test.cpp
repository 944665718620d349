// The ways of light that are named one by one, against the lanes of a render and closed forms.

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/base/constants.h"
#include "abbe/image/exr/exr.h"
#include "abbe/integrate/light/light_paths.h"
#include "abbe/optics/dispersion.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

Scene slab_scene() {
  Scene scene;
  test::add_square(scene, test::add(scene, test::matte(Vec3f(1.0f))), 20.0,
                   test::rotation({1, 0, 0}, -90.0));
  test::add_box(scene, test::add(scene, test::glass("glass/schott/N-SF11")), {5.0, 0.2, 5.0},
                test::translation({0, 1.0, 0}));
  scene.lights.push_back(test::point_light({0, 2, 0}, 1.0));
  return scene;
}

TEST(LightPaths, way_through_a_slab_obeys_snell_at_both_faces) {
  RenderSettings settings = test::small_settings();
  settings.inner_reflections = 0;
  const Scene scene = slab_scene();
  const LitWorld world = test::make_world(scene, settings);
  const std::vector<LightChain> chains = chains_to_light(world, 0, {-2.0, 0.0, 0.3}, 0);
  ASSERT_EQ(chains.size(), 1u);
  EXPECT_EQ(chains[0].events, (std::vector<ChainEvent>{ChainEvent::Enter, ChainEvent::Leave}));
  ASSERT_EQ(chains[0].paths.size(), static_cast<std::size_t>(world.lanes.lane_count()));
  for (const LightPath& path : chains[0].paths) {
    EXPECT_FALSE(path.is_blocked);
    ASSERT_EQ(path.crossings.size(), 2u);
    for (const LightPathCrossing& crossing : path.crossings) {
      EXPECT_NEAR(crossing.n_before * std::sin(crossing.incidence_rad),
                  crossing.n_after * std::sin(crossing.exit_rad), 1e-8);  // Of the solver.
    }
    EXPECT_NEAR(path.crossings[0].position.y, 1.2, 1e-9);
    EXPECT_NEAR(path.crossings[1].position.y, 0.8, 1e-9);
    // Parallel faces: the light goes on in the direction that it came in.
    EXPECT_NEAR(glm::distance(path.arrival, path.crossings[0].direction_before), 0.0, 1e-8);
    const Vec3d end = path.crossings[1].position +
                      path.arrival * (path.crossings[1].position.y / -path.arrival.y);
    EXPECT_NEAR(glm::distance(end, Vec3d(-2.0, 0.0, 0.3)), 0.0, 1e-7);
  }
}

TEST(LightPaths, lanes_of_a_render_get_the_light_of_the_paths_one_by_one) {
  // Two derivations of the irradiance: the Hessian of the optical length, and ray differentials.
  RenderSettings settings = test::small_settings();
  settings.wavelengths.exact_nm = {kLineF_nm, kLine_d_nm, kLineC_nm};
  settings.inner_reflections = 2;
  Scene scene;
  test::add_square(scene, test::add(scene, test::matte(Vec3f(1.0f))), 20.0,
                   test::rotation({1, 0, 0}, -90.0));
  scene.lights.push_back(test::point_light({0.3, 2.5, 0.4}, 1.0));
  const Vec3d way = glm::normalize(Vec3d(0.9, -0.05, 0.1));
  int lit = 0;
  for (int i = 0; i < 12; ++i) {
    const Vec3d target(-1.1 + 0.2 * i, 0.0, 0.05 * i - 0.3);
    scene.cameras = {test::orthographic_camera(target - 4.0 * way, target, 1e-6, 1e-6)};
    Scene bare = scene;
    bare.lights.front().to_world = test::translation(target + Vec3d(0, 1, 0));
    const Image one_lux = test::render(bare, settings).image;
    Scene full = scene;
    test::add_box(full, test::add(full, test::glass("glass/schott/N-SF11")), {0.5, 0.3, 0.6},
                  test::translation({0, 1.0, 0}) * test::rotation({0.3, 0.2, 1}, 25.0));
    const LitWorld world = test::make_world(full, settings);
    const Image image = test::render(world, full.cameras.front(), settings).image;
    const std::vector<LightChain> chains = chains_to_light(world, 0, target, 0);
    for (int lane = 0; lane < 3; ++lane) {
      double expected = 0.0;
      for (const LightChain& chain : chains) {
        for (const LightPath& path : chain.paths) {
          if (path.lane == lane) expected -= path.irradiance * path.arrival.y;
        }
      }
      const std::string channel =
          spectral_channel_name(settings.wavelengths.exact_nm[static_cast<std::size_t>(lane)]);
      const auto measured = static_cast<double>(test::pixel(image, 4, 4, channel)) /
                            static_cast<double>(test::pixel(one_lux, 4, 4, channel));
      lit += expected > 0.0 ? 1 : 0;
      // Single precision, and a grazing exit that enlarges it.
      EXPECT_NEAR(measured, expected, 3e-4 * expected) << i << ", " << channel;
    }
  }
  EXPECT_GT(lit, 20);
}

}  // namespace
}  // namespace abbe
