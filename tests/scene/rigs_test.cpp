#include "abbe/scene/rigs.h"

#include <gmock/gmock.h>

#include <cmath>

#include "abbe/base/constants.h"
#include "abbe/base/error.h"
#include "abbe/scene/lamps.h"
#include "abbe/scene/surface_finder.h"
#include "abbe/scene/validation.h"

namespace abbe {
namespace {

using testing::HasSubstr;

const NamedSpectrum kEven{"illuminant/D65", Spectrum::constant(1.0)};

// A ball of some material about the origin, and a camera that stands somewhere on Z and looks along
// it to the origin.
Scene ball_scene(double camera_z_m, double radius_m = 1.0) {
  Scene scene;
  scene.materials.emplace_back();
  scene.instances.push_back({"ball", Shape{"ball", SphereShape{radius_m}, 0}, Mat4d(1.0)});
  Camera camera;
  camera.projection = PerspectiveCamera{0.9};
  camera.to_world[3] = Vec4d(0.0, 0.0, camera_z_m, 1.0);
  scene.cameras.push_back(camera);
  return scene;
}

// A mesh of the six faces of a cube about the origin, their fronts inside.
Scene room_scene(bool double_sided = false) {
  Scene scene = ball_scene(0.0);
  scene.instances.clear();
  scene.materials[0].double_sided = double_sided;
  Mesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    mesh.positions.emplace_back((corner & 1) != 0 ? 2.0f : -2.0f, (corner & 2) != 0 ? 2.0f : -2.0f,
                                (corner & 4) != 0 ? 2.0f : -2.0f);
  }
  const std::array<std::array<std::uint32_t, 4>, 6> faces{
      {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}}};
  for (const auto& f : faces) {
    mesh.triangles.push_back({f[0], f[1], f[2]});
    mesh.triangles.push_back({f[0], f[2], f[3]});
  }
  scene.meshes.push_back(mesh);
  scene.instances.push_back({"room", 0u, Mat4d(1.0)});
  return scene;
}

Light lamp(LightType type, double intensity) {
  Light light;
  light.type = type;
  light.intensity = intensity;
  return light;
}

// Illuminance of a surface by an environment of colours, by its texels: of the world's direction.
double illuminance(const Environment& environment, const Vec3d& normal) {
  const EnvironmentImage& image = environment.image;
  const double turn = environment.rotation_deg * kPi / 180.0;
  double lux = 0.0;
  for (int y = 0; y < image.height; ++y) {
    const double theta = kPi * (y + 0.5) / image.height;
    for (int x = 0; x < image.width; ++x) {
      const double phi = 2.0 * kPi * ((x + 0.5) / image.width - 0.5);
      const Vec3d there(std::cos(phi) * std::sin(theta), std::cos(theta),
                        std::sin(phi) * std::sin(theta));
      // Counterclockwise about +Y, seen from above.
      const Vec3d direction(std::cos(turn) * there.x + std::sin(turn) * there.z, there.y,
                            std::cos(turn) * there.z - std::sin(turn) * there.x);
      const double cosine = glm::dot(direction, normal);
      if (!(cosine > 0.0)) continue;
      const std::size_t texel = static_cast<std::size_t>(y * image.width + x);
      lux += environment.scale * luminance_of(Vec3d(image.rgb_rec709[texel])) * cosine *
             std::sin(theta) * 2.0 * kPi * kPi / (image.width * image.height);
    }
  }
  return lux;
}

TEST(rigs, scene_without_lamps_gets_a_studio_and_only_once) {
  Scene scene = ball_scene(5.0);
  scene.materials[0].emissive_rec709 = {0, 1, 0};  // Emission does not count.
  const AddedRig rig = add_rig(scene, Rig::Auto, 0, kEven);
  EXPECT_EQ(rig.rig, Rig::Studio);
  EXPECT_THAT(rig.line, HasSubstr("studio"));
  ASSERT_TRUE(scene.environment);
  EXPECT_TRUE(scene.environment->visible);
  EXPECT_TRUE(scene.lights.empty());
  EXPECT_NO_THROW(validate(scene, "test"));
  EXPECT_EQ(add_rig(scene, Rig::Auto, 0, kEven).rig, Rig::None);
}

TEST(rigs, scene_that_states_its_light_gets_none) {
  Scene dark = ball_scene(5.0);
  dark.ambient = Ambient{0.0, kEven};
  EXPECT_EQ(add_rig(dark, Rig::Auto, 0, kEven).rig, Rig::None);
  EXPECT_FALSE(dark.environment);
  Scene lamps = ball_scene(5.0);
  lamps.lights.push_back(lamp(LightType::Directional, 100.0));
  lamps.uses_abbe = true;
  EXPECT_EQ(add_rig(lamps, Rig::Auto, 0, kEven).rig, Rig::None);
  Scene unwanted = ball_scene(5.0);
  EXPECT_EQ(add_rig(unwanted, Rig::None, 0, kEven).rig, Rig::None);
  EXPECT_FALSE(unwanted.environment);
}

TEST(rigs, lamps_alone_get_a_surround_in_proportion) {
  Scene scene = ball_scene(5.0);
  scene.lights.push_back(lamp(LightType::Directional, 1000.0));
  Light point = lamp(LightType::Point, 400.0);
  point.to_world[3] = Vec4d(0.0, 2.0, 0.0, 1.0);  // 100 lx in the middle.
  scene.lights.push_back(point);
  EXPECT_EQ(add_rig(scene, Rig::Auto, 0, kEven).rig, Rig::Surround);
  ASSERT_TRUE(scene.environment);
  // A tenth of the 1100 lx that the lamps give; an even sky of L gives π L.
  EXPECT_NEAR(scene.environment->scale, 110.0 / kPi, 1e-9);
  EXPECT_NO_THROW(validate(scene, "test"));
}

TEST(rigs, white_that_faces_the_key_light_has_1_cd_per_m2) {
  const auto studio = studio_environment(0.0);
  double brightest = 0.0, darkest = 1e9;
  Vec3d key(0.0);
  for (int i = 0; i < 500; ++i) {  // Fibonacci's spiral over the sphere.
    const double y = 1.0 - 2.0 * (i + 0.5) / 500, r = std::sqrt(1.0 - y * y), a = 2.39996323 * i;
    const Vec3d normal(r * std::cos(a), y, r * std::sin(a));
    const double luminance = illuminance(*studio, normal) / kPi;
    if (luminance > brightest) key = normal;
    brightest = std::max(brightest, luminance);
    darkest = std::min(darkest, luminance);
  }
  EXPECT_NEAR(brightest, 1.0, 0.05);  // "Near 1", and the spiral's 5° from the best normal.
  EXPECT_LT(darkest, 0.3);            // Not flat.
  // Seen along −Z: right, above, in front.
  EXPECT_GT(key.x, 0.3);
  EXPECT_GT(key.y, 0.3);
  EXPECT_GT(key.z, 0.3);
}

// glTF's default material, a white metal of roughness 1, on what faces the camera.
TEST(rigs, default_material_stands_out_before_what_is_behind_it) {
  const auto studio = studio_environment(0.0);
  const EnvironmentImage& image = studio->image;
  double reflected = 0.0, brightest = 0.0;
  for (int row = 0; row < image.height; ++row) {
    for (int column = 0; column < image.width; ++column) {
      const double theta = kPi * (row + 0.5) / image.height;
      const double phi = 2.0 * kPi * ((column + 0.5) / image.width - 0.5);
      const double y = std::cos(theta), z = std::sin(phi) * std::sin(theta);
      const auto texel = static_cast<std::size_t>(row * image.width + column);
      const auto luminance = static_cast<double>(image.rgb_rec709[texel].y);
      // As the default camera looks: down on it, in a view of 40° and 16:9.
      if (z < -0.75 && y < 0.05) brightest = std::max(brightest, luminance);
      if (!(z > 0.0)) continue;
      // GGX of α = 1 seen along its normal: D = 1/π, and Smith's G is 2c/(1 + c).
      const double solid_angle = 2.0 * kPi * kPi / (image.width * image.height) * std::sin(theta);
      reflected += luminance * 2.0 * z / (1.0 + z) / (4.0 * kPi) * solid_angle;
    }
  }
  EXPECT_GT(reflected / brightest, 1.25);  // A third of an EV: told from it at a glance.
}

TEST(rigs, key_light_stands_at_the_right_of_the_camera_that_is_used) {
  for (const double angle : {0.0, 1.0, 2.5, -2.0}) {
    Scene scene = ball_scene(0.0);
    const Vec3d forward(std::sin(angle), 0.0, -std::cos(angle));
    const Vec3d right(std::cos(angle), 0.0, std::sin(angle));
    scene.cameras[0].to_world = {Vec4d(right, 0.0), Vec4d(0, 1, 0, 0), Vec4d(-forward, 0.0),
                                 Vec4d(-5.0 * forward, 1.0)};
    add_rig(scene, Rig::Auto, 0, kEven);
    const auto lux = [&](double side) {
      return illuminance(*scene.environment, glm::normalize(side * right - forward));
    };
    EXPECT_GT(lux(1.0), 1.5 * lux(-1.0)) << angle;
  }
}

TEST(rigs, closed_room_is_lit_from_within) {
  Scene scene = room_scene();
  EXPECT_TRUE(is_closed_around(scene, scene.cameras[0]));
  const AddedRig rig = add_rig(scene, Rig::Auto, 0, kEven);
  EXPECT_EQ(rig.rig, Rig::Studio);
  EXPECT_THAT(rig.line, HasSubstr("closed"));
  EXPECT_FALSE(scene.environment);
  ASSERT_TRUE(scene.ambient);
  ASSERT_EQ(scene.lights.size(), 1u);
  EXPECT_LT(glm::length(Vec3d(scene.lights[0].to_world[3])), 1.0);  // Beside the camera.
}

TEST(rigs, room_is_open_through_glass_through_backs_and_from_outside) {
  Scene glass = room_scene();
  glass.materials[0].transmission = 1.0f;
  EXPECT_FALSE(is_closed_around(glass, glass.cameras[0]));
  Scene inside_out = room_scene();
  inside_out.instances[0].to_world[0][0] = -1.0;  // A mirror image keeps its fronts.
  EXPECT_TRUE(is_closed_around(inside_out, inside_out.cameras[0]));
  for (auto& triangle : inside_out.meshes[0].triangles) std::swap(triangle[1], triangle[2]);
  EXPECT_FALSE(is_closed_around(inside_out, inside_out.cameras[0]));
  inside_out.materials[0].double_sided = true;
  EXPECT_TRUE(is_closed_around(inside_out, inside_out.cameras[0]));
  const Scene ball = ball_scene(5.0);
  EXPECT_FALSE(is_closed_around(ball, ball.cameras[0]));
}

TEST(rigs, names_are_listed_where_one_is_unknown) {
  for (const Rig rig : {Rig::Auto, Rig::Studio, Rig::Surround, Rig::None}) {
    EXPECT_EQ(rig_from_name(rig_name(rig)), rig);
  }
  try {
    rig_from_name("stage");
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().kind, ErrorKind::Usage);
    EXPECT_THAT(error.what(), HasSubstr("auto, studio, surround, none"));
  }
}

TEST(surface_finder, finds_the_nearest_side_that_counts) {
  Scene scene = ball_scene(5.0, 2.0);
  scene.instances[0].to_world[0][0] = 0.5;  // An ellipsoid.
  const SurfaceFinder finder(scene);
  const auto all = [](const Material&, bool) { return true; };
  const auto backs = [](const Material&, bool is_front) { return !is_front; };
  const auto front = finder.first({-5, 0, 0}, {1, 0, 0}, 0.0, all);
  ASSERT_TRUE(front);
  EXPECT_NEAR(front->distance_m, 4.0, 1e-12);  // Rounding of a few doubles.
  EXPECT_TRUE(front->is_front);
  EXPECT_NEAR(front->normal.x, -1.0, 1e-12);
  const auto back = finder.first({-5, 0, 0}, {1, 0, 0}, 0.0, backs);
  ASSERT_TRUE(back);
  EXPECT_NEAR(back->distance_m, 6.0, 1e-12);
  EXPECT_FALSE(finder.first({-5, 3, 0}, {1, 0, 0}, 0.0, all));
}

TEST(Rig, that_was_chosen_lights_a_scene_that_moved_on) {
  Scene first = room_scene();
  first.origin_m = Vec3d(100.0, 0.0, 0.0);
  const AddedRig rig = add_rig(first, Rig::Auto, 0, kEven);
  // A ball outside, whose numbers have another zero, would get a studio.
  Scene later = ball_scene(5.0);
  later.origin_m = Vec3d(90.0, 0.0, 0.0);
  add_rig(later, rig);
  ASSERT_EQ(later.lights.size(), 1u);
  EXPECT_EQ(later.lights[0].to_world[3], first.lights[0].to_world[3] + Vec4d(10.0, 0.0, 0.0, 0.0));
  EXPECT_EQ(later.lights[0].intensity, first.lights[0].intensity);
  EXPECT_FALSE(later.environment);
  ASSERT_TRUE(later.ambient);
  EXPECT_EQ(later.ambient->luminance_cd_per_m2, first.ambient->luminance_cd_per_m2);
}

TEST(Camera, that_sees_only_backs_is_told_from_others) {
  Scene scene = room_scene();
  const Camera within = scene.cameras[0];
  Camera away = within, turned = within;
  away.to_world[3] = Vec4d(0.0, 0.0, -8.0, 1.0);
  turned.to_world[0] = Vec4d(-1.0, 0.0, 0.0, 0.0);
  turned.to_world[2] = Vec4d(0.0, 0.0, -1.0, 0.0);
  turned.to_world[3] = Vec4d(0.0, 0.0, -8.0, 1.0);
  // Through the back of one wall it sees the others' fronts; where nothing is, no backs.
  for (const Camera& camera : {within, away, turned}) EXPECT_FALSE(sees_only_backs(scene, camera));
  scene.meshes[0].triangles.resize(2);  // One wall alone.
  EXPECT_FALSE(sees_only_backs(scene, within));
  EXPECT_TRUE(sees_only_backs(scene, turned));
  scene.materials[0].double_sided = true;
  EXPECT_FALSE(sees_only_backs(scene, turned));
}

}  // namespace
}  // namespace abbe
