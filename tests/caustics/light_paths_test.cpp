// The ways of light that are named one by one, against the lanes of a render and closed forms.

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "abbe/base/constants.h"
#include "abbe/image/exr/exr.h"
#include "abbe/integrate/light/light_paths.h"
#include "abbe/optics/dispersion.h"
#include "support/forward/photons.h"
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

TEST(LightPaths, spot_narrower_than_rays_of_the_search_lie_lights_through_a_pane) {
  Scene scene = slab_scene();
  scene.materials.back() = test::glass(1.5);
  Light spot = test::point_light({0, 2, 0}, 1.0);
  spot.type = LightType::Spot;
  spot.to_world = test::translation({0, 2, 0}) * test::rotation({1, 0, 0}, -90.0);
  spot.inner_cone_rad = 0.001;
  spot.outer_cone_rad = 0.003;
  scene.lights = {spot};
  RenderSettings settings = test::small_settings();
  settings.inner_reflections = 0;
  const LitWorld world = test::make_world(scene, settings);
  const std::vector<LightChain> chains = chains_to_light(world, 0, {0.0, 0.0, 0.0}, 0);
  ASSERT_EQ(chains.size(), 1u);
  // 4 % are reflected at each face, and glass 0.4 m thick is as near as 0.4 m / 1.5.
  const double distance_m = 2.0 - 0.4 * (1.0 - 1.0 / 1.5);
  const LightPath& path = chains[0].paths.front();
  // glTF's cone falls off over a cosine of 0.001 at least; that of the rim has seven digits.
  const double window = std::pow((1.0 - std::cos(0.003)) / 0.001, 2.0);
  const double expected = window * 0.96 * 0.96 / (distance_m * distance_m);
  EXPECT_NEAR(path.irradiance, expected, 0.03 * expected);
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

// A lamp in a box of water over a block of glass, and a floor below.
Scene lamp_in_water(const Vec3d& lamp) {
  Scene scene;
  test::add_square(scene, test::add(scene, test::matte(Vec3f(1.0f))), 20.0,
                   test::translation({0, -0.6, 0}) * test::rotation({1, 0, 0}, -90.0));
  test::add_box_mesh(scene, test::add(scene, test::glass(1.333)), {0.4, 0.4, 0.4}, Mat4d(1.0));
  test::add_box_mesh(scene, test::add(scene, test::glass(1.5)), {0.2, 0.15, 0.2},
                     test::translation({0, -0.05, 0}));
  scene.lights.push_back(test::point_light(lamp, 1.0));
  return scene;
}

// Irradiance at a place of that floor, from a render that sees it from the side.
double rendered_irradiance(Scene scene, const Vec3d& place, const RenderSettings& settings) {
  const Vec3d way = glm::normalize(Vec3d(0.0, -0.01, 1.0));
  scene.cameras = {test::orthographic_camera(place - 2.0 * way, place, 1e-6, 1e-6)};
  Scene bare;
  bare.meshes = {scene.meshes.front()};
  bare.materials = {scene.materials.front()};
  bare.instances = {scene.instances.front()};
  bare.lights = {test::point_light(place + Vec3d(0, 1, 0), 1.0)};
  bare.cameras = scene.cameras;
  const std::string channel = spectral_channel_name(kLine_d_nm);
  const auto value = [&](const Scene& of) {
    return static_cast<double>(test::pixel(test::render(of, settings).image, 4, 4, channel));
  };
  return value(scene) / value(bare);
}

RenderSettings settings_of_line(int inner_reflections) {
  RenderSettings settings = test::small_settings();
  settings.wavelengths.exact_nm = {kLine_d_nm};
  settings.inner_reflections = inner_reflections;
  return settings;
}

TEST(LightPaths, small_bright_spot_under_a_prism_and_a_slab_is_found) {
  // Its light is 0.0007 of what falls on the glass, and half of what falls on that place.
  Scene scene;
  test::add_square(scene, test::add(scene, test::matte(Vec3f(1.0f))), 20.0,
                   test::translation({0, -1, 0}) * test::rotation({1, 0, 0}, -90.0));
  Shape prism;
  const double length = std::hypot(0.43, 0.25);
  const double x = 0.43 / length;
  const double y = 0.25 / length;
  prism.geometry = ConvexShape{{{0, -1, 0, 0},
                                {x, y, 0, 0.25 * x},
                                {-x, y, 0, 0.25 * x},
                                {0, 0, 1, 0.25},
                                {0, 0, -1, 0.25}}};
  test::add_shape(scene, prism, test::add(scene, test::glass(1.5)), Mat4d(1.0));
  test::add_box_mesh(scene, test::add(scene, test::glass(1.7)), {0.3, 0.05, 0.3},
                     test::translation({0, -0.15, 0}));
  scene.lights.push_back(test::point_light({0.1, 1.1, 0.2}, 1.0));
  RenderSettings settings = test::small_settings();
  settings.wavelengths.exact_nm = {kLine_d_nm};
  // By 6·10⁷ rays from the lamp in double precision; 0.11 without the spot.
  const double irradiance = rendered_irradiance(scene, {-0.025, -1.0, 0.04375}, settings);
  EXPECT_NEAR(irradiance, 0.320, 0.03 * 0.320);  // Twice the noise of 4000 rays.
}

TEST(LightPaths, light_over_a_lamp_in_the_middle_is_the_same_on_all_sides) {
  // The lamp's cones are wide on the block just below it, whose corners they share.
  const Scene scene = lamp_in_water({0, 0.3, 0});
  const RenderSettings settings = settings_of_line(0);
  for (const auto& [u, v] : {std::pair(0.35, 0.11), std::pair(0.42, 0.05), std::pair(0.13, 0.08)}) {
    const double first = rendered_irradiance(scene, {u, -0.6, v}, settings);
    EXPECT_GT(first, 0.0);
    for (const Vec3d& place : {Vec3d(-u, -0.6, v), Vec3d(u, -0.6, -v), Vec3d(-u, -0.6, -v),
                               Vec3d(v, -0.6, u), Vec3d(v, -0.6, -u), Vec3d(-v, -0.6, -u)}) {
      // Single precision, and a grazing exit that enlarges it.
      EXPECT_NEAR(rendered_irradiance(scene, place, settings), first, 3e-4 * first);
    }
  }
}

// A sun through panes of glass that disperses, whose wavelengths have tables of their own.
TEST(LightPaths, without_room_for_all_paths_of_a_sun_the_faintest_are_left_out) {
  Scene scene;
  const std::uint32_t material = test::add(scene, test::glass("glass/schott/N-BK7"));
  for (const double y : {0.0, 0.3}) {
    test::add_box_mesh(scene, material, {0.5, 0.05, 0.5}, test::translation({0, y, 0}));
  }
  scene.lights.push_back(test::directional_light({0.3, -1, 0.2}, 1.0));
  const auto report = [&](std::size_t table_floats, Notes& notes) {
    const RenderSettings settings = test::small_settings();
    CausticOptions options = caustic_options(settings);
    options.table_floats = table_floats;
    return make_lit_world(scene, world_options(settings), options, test::catalogue().observer(),
                          test::catalogue().illuminant("illuminant/D65"), notes)
        .caustics.report;
  };
  Notes none, notes;
  const CausticReport all = report(CausticOptions{}.table_floats, none);
  EXPECT_EQ(all.share_no_room, 0.0);
  // Room for about a quarter of them: each further pair of reflections takes less than a tenth of
  // what the last has left.
  const CausticReport few = report(CausticOptions{}.table_floats >> 3, notes);
  EXPECT_GT(few.chains, 0u);
  EXPECT_LT(few.chains, all.chains / 3);
  EXPECT_GT(few.share_no_room, 0.0);
  EXPECT_LT(few.share_no_room, 0.05);
  EXPECT_NEAR(few.share_cut - all.share_cut, few.share_no_room, 1e-9);
  EXPECT_NEAR(few.by_body[0].no_room + few.by_body[1].no_room, few.share_no_room, 1e-9);
}

// Light that comes off a facet does not meet its back, nor what lies behind it.
TEST(LightPaths, closed_mirror_is_as_closed_with_backs_as_without) {
  const auto chains = [](bool has_backs) {
    Scene scene;
    Mesh ball;
    constexpr std::uint32_t kRound = 24, kUp = 12;
    for (std::uint32_t j = 0; j <= kUp; ++j) {
      for (std::uint32_t i = 0; i < kRound; ++i) {
        const double polar = kPi * j / kUp, turn = 2.0 * kPi * i / kRound;
        ball.positions.emplace_back(0.3 * Vec3d(std::sin(polar) * std::cos(turn), std::cos(polar),
                                                -std::sin(polar) * std::sin(turn)));
        if (j == kUp) continue;
        const std::uint32_t here = j * kRound + i, next = j * kRound + (i + 1) % kRound;
        if (j > 0) ball.triangles.push_back({here, here + kRound, next});
        if (j + 1 < kUp) ball.triangles.push_back({next, here + kRound, next + kRound});
      }
    }
    Material silver = test::mirror("metal/Ag-Johnson");
    silver.double_sided = has_backs;
    test::add_mesh(scene, ball, test::add(scene, silver), Mat4d(1.0));
    scene.lights.push_back(test::point_light({0.6, 2, 0.5}, 1.0));
    const LitWorld world = test::make_world(scene, settings_of_line(16));
    EXPECT_LT(world.caustics.report.share_cut, 1e-3);
    return world.caustics.report.chains;
  };
  const std::size_t with_backs = chains(true), without = chains(false);
  EXPECT_GT(without, 100u);
  EXPECT_LE(with_backs, 2 * without);
}

// Two suns of which the paths of either would take all the room there is.
TEST(LightPaths, suns_share_the_room_of_the_tables) {
  Scene scene;
  const std::uint32_t material = test::add(scene, test::glass("glass/schott/N-BK7"));
  for (const double y : {0.0, 0.3}) {
    test::add_box_mesh(scene, material, {0.5, 0.05, 0.5}, test::translation({0, y, 0}));
  }
  const RenderSettings settings = test::small_settings();
  CausticOptions options = caustic_options(settings);
  options.table_floats >>= 3;
  const auto caustics = [&](int suns) {
    scene.lights.assign(static_cast<std::size_t>(suns),
                        test::directional_light({0.3, -1, 0.2}, 1.0));
    Notes notes;
    return make_lit_world(scene, world_options(settings), options, test::catalogue().observer(),
                          test::catalogue().illuminant("illuminant/D65"), notes)
        .caustics;
  };
  EXPECT_GT(caustics(1).report.share_no_room, 0.0);
  const FlatCaustics two = caustics(2);
  for (const std::size_t sun : {0, 1}) {
    ASSERT_NE(two.of_light(sun), nullptr);
    EXPECT_GT(two.of_light(sun)->parallel.size(), 0u);
  }
  const auto first = static_cast<double>(two.of_light(0)->parallel.size());
  EXPECT_NEAR(static_cast<double>(two.of_light(1)->parallel.size()) / first, 1.0, 0.5);
  EXPECT_LE(two.parallel.rows.size(), options.table_floats);
  EXPECT_LT(two.report.share_no_room, 0.1);
}

TEST(LightPaths, what_chains_leave_out_is_told_by_body_and_reason) {
  // A lamp in the middle of a cube of index 1.5. What is farther than the critical angle from all
  // normals never gets out, and does not count. Of the rest each face lets out a cone, but for what
  // it reflects: that is left out without inner reflections.
  Scene scene;
  test::add_box_mesh(scene, test::add(scene, test::glass(1.5)), {0.2, 0.2, 0.2}, Mat4d(1.0));
  scene.instances.back().name = "cube";
  scene.lights.push_back(test::point_light({0, 0, 0}, 1.0));
  const auto report = [&](int inner_reflections, Notes& notes) {
    const RenderSettings settings = settings_of_line(inner_reflections);
    return make_lit_world(scene, world_options(settings), caustic_options(settings),
                          test::catalogue().observer(),
                          test::catalogue().illuminant("illuminant/D65"), notes)
        .caustics.report;
  };
  Notes none;
  const CausticReport whole = report(16, none);
  EXPECT_TRUE(none.all().empty());
  EXPECT_LT(whole.share_cut, 0.01);
  Notes notes;
  const CausticReport cut = report(0, notes);
  ASSERT_EQ(cut.by_body.size(), 1u);
  EXPECT_NEAR(cut.by_body[0].started, 1.0, 1e-12);
  // Six cones of 2π·dμ each, over 4π.
  const double least = std::sqrt(1.0 - 1.0 / (1.5 * 1.5));
  double reflected = 0.0;
  constexpr int kSteps = 10000;
  for (int i = 0; i < kSteps; ++i) {
    const double mu = least + (1.0 - least) * (i + 0.5) / kSteps;
    reflected += 3.0 * test::interface_reflectance(mu, 1.5, 1.0) * (1.0 - least) / kSteps;
  }
  EXPECT_NEAR(cut.share_too_long, reflected, 0.03 * reflected);  // Of 8192 rays.
  EXPECT_NEAR(cut.share_cut, reflected, 0.03 * reflected);
  ASSERT_EQ(notes.all().size(), 1u);
  EXPECT_EQ(notes.all()[0].kind, NoteKind::Warning);
  EXPECT_NE(notes.all()[0].text.find("--chain"), std::string::npos);
}

TEST(LightPaths, light_of_a_lamp_in_water_is_that_of_the_paths_one_by_one) {
  // Paths that would have to come back through a plane that they left are none.
  const Scene scene = lamp_in_water({0.05, 0.3, 0.02});
  const RenderSettings settings = settings_of_line(1);
  const LitWorld world = test::make_world(scene, settings);
  for (int i = 0; i < 9; ++i) {
    const Vec3d place(-0.43 + 0.1 * i, -0.6, 0.04 * i - 0.17);
    double expected = 0.0;
    for (const LightChain& chain : chains_to_light(world, 0, place, 0)) {
      for (const LightPath& path : chain.paths) {
        if (path.lane == 0 && !path.is_blocked) expected -= path.irradiance * path.arrival.y;
      }
    }
    EXPECT_GT(expected, 0.5);
    // Single precision, and a grazing exit that enlarges it.
    EXPECT_NEAR(rendered_irradiance(scene, place, settings), expected, 3e-4 * expected) << i;
  }
}

}  // namespace
}  // namespace abbe
