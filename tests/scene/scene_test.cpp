#include "abbe/scene/scene.h"

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/base/error.h"
#include "abbe/scene/validation.h"

namespace abbe {
namespace {

Mat4d translation(const Vec3d& t) {
  Mat4d m(1.0);
  m[3] = Vec4d(t, 1.0);
  return m;
}

// One triangle in the plane z = 0.
Scene triangle_scene() {
  Scene scene;
  scene.materials.emplace_back();
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  scene.meshes.push_back(mesh);
  scene.instances.push_back({"triangle", 0u, Mat4d(1.0)});
  return scene;
}

Scene shape_scene(const std::variant<SphereShape, ConvexShape>& geometry, const Mat4d& to_world) {
  Scene scene;
  scene.materials.emplace_back();
  scene.instances.push_back({"shape", Shape{"shape", geometry, 0}, to_world});
  return scene;
}

void expect_box(const Box3d& box, const Vec3d& low, const Vec3d& high) {
  for (int c = 0; c < 3; ++c) {
    // Of a mesh exact in single precision, through a few roundings of double around 10.
    EXPECT_NEAR(box.low[c], low[c], 1e-14);
    EXPECT_NEAR(box.high[c], high[c], 1e-14);
  }
}

TEST(bounds_of, empty_scene_is_empty) {
  EXPECT_TRUE(bounds_of(Scene{}).is_empty());
}

TEST(bounds_of, instances_of_one_mesh_are_all_counted) {
  Scene scene = triangle_scene();
  scene.instances.push_back({"second", 0u, translation({10, 0, 5})});
  expect_box(bounds_of(scene), {0, 0, 0}, {11, 1, 5});
}

TEST(bounds_of, sphere_under_rotation_keeps_its_box) {
  Mat4d rotation(1.0);
  rotation[0] = Vec4d(std::sqrt(0.5), std::sqrt(0.5), 0, 0);
  rotation[1] = Vec4d(-std::sqrt(0.5), std::sqrt(0.5), 0, 0);
  expect_box(bounds_of(shape_scene(SphereShape{2.0}, translation({1, 2, 3}) * rotation)),
             {-1, 0, 1}, {3, 4, 5});
}

TEST(bounds_of, sheared_sphere_has_the_box_of_the_ellipsoid) {
  Mat4d shear(1.0);
  shear[1] = Vec4d(1, 1, 0, 0);
  // x + y over the unit sphere reaches √2.
  const double reach = std::sqrt(2.0);
  expect_box(bounds_of(shape_scene(SphereShape{1.0}, shear)), {-reach, -1, -1}, {reach, 1, 1});
}

TEST(bounds_of, convex_prism_is_bounded_by_its_corners) {
  // A 60° prism with unnormalised planes: x-extent ±√3/3·... from its corners (±1, 0) and (0, √3).
  const double r3 = std::sqrt(3.0);
  ConvexShape prism{{{0, -2, 0, 0}, {r3, 1, 0, r3}, {-r3, 1, 0, r3}, {0, 0, 1, 3}, {0, 0, -1, 3}}};
  expect_box(bounds_of(shape_scene(prism, Mat4d(1.0))), {-1, 0, -3}, {1, r3, 3});
}

TEST(add_default_camera, every_corner_is_in_the_picture) {
  Scene scene = triangle_scene();
  scene.instances[0].to_world = translation({100, -20, 7});
  scene.instances.push_back({"far", 0u, translation({103, -20, 9})});
  ASSERT_TRUE(add_default_camera(scene));
  EXPECT_FALSE(add_default_camera(scene));
  const Camera& camera = scene.cameras[0];
  const double half = 0.5 * std::get<PerspectiveCamera>(camera.projection).yfov_rad;
  const Mat4d to_camera = glm::inverse(camera.to_world);
  double largest_rad = 0.0;
  for (const Instance& instance : scene.instances) {
    for (const Vec3f& p : scene.meshes[0].positions) {
      const Vec4d in_camera = to_camera * instance.to_world * Vec4d(Vec3d(p), 1.0);
      ASSERT_LT(in_camera.z, 0.0);
      largest_rad =
          std::max(largest_rad, std::atan2(std::hypot(in_camera.x, in_camera.y), -in_camera.z));
    }
  }
  EXPECT_LT(largest_rad, half);
  EXPECT_GT(largest_rad, 0.5 * half);
  EXPECT_NO_THROW(validate(scene, "test"));
}

TEST(add_default_camera, empty_scene_gets_a_finite_camera) {
  Scene scene;
  EXPECT_TRUE(add_default_camera(scene));
  EXPECT_NO_THROW(validate(scene, "test"));
}

TEST(validate, each_broken_promise_is_named_with_its_element) {
  const auto message = [](const Scene& scene) -> std::string {
    try {
      validate(scene, "test");
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message(triangle_scene()), "");
  Scene scene = triangle_scene();
  scene.meshes[0].triangles[0][2] = 3;
  EXPECT_NE(message(scene).find("meshes[0]"), std::string::npos);
  scene = triangle_scene();
  scene.meshes[0].normals.resize(2);
  EXPECT_NE(message(scene).find("attributes"), std::string::npos);
  scene = triangle_scene();
  scene.materials.emplace_back().index = ConstantIndex{0.5};
  EXPECT_NE(message(scene).find("materials[1]"), std::string::npos);
  scene = triangle_scene();
  scene.materials[0].base_color_texture = TextureUse{};
  EXPECT_NE(message(scene).find("texture"), std::string::npos);
  scene = triangle_scene();
  scene.instances[0].to_world[3].x = std::nan("");
  EXPECT_NE(message(scene).find("instances[0]"), std::string::npos);
  scene = triangle_scene();
  scene.lights.emplace_back().intensity = -1.0;
  EXPECT_NE(message(scene).find("lights[0]"), std::string::npos);
  scene = triangle_scene();
  scene.cameras.emplace_back().projection = OrthographicCamera{0.0, 1.0};
  EXPECT_NE(message(scene).find("cameras[0]"), std::string::npos);
  scene = triangle_scene();
  scene.meshes[0].positions[1].y = std::nanf("");
  EXPECT_NE(message(scene).find("vertex"), std::string::npos);
  scene = triangle_scene();
  scene.meshes[0].uv[0].assign(3, Vec2f(std::nanf("")));
  EXPECT_NE(message(scene).find("attribute"), std::string::npos);
  scene = triangle_scene();
  scene.instances[0].what = 77u;
  EXPECT_NE(message(scene).find("mesh"), std::string::npos);
  scene = triangle_scene();
  scene.instances[0].to_world[1] = Vec4d(0.0);
  EXPECT_NE(message(scene).find("flattens"), std::string::npos);
  scene = triangle_scene();
  scene.instances[0].what = Shape{"open", ConvexShape{{Vec4d(1.0, 0.0, 0.0, 1.0)}}, 0};
  EXPECT_NE(message(scene).find("open"), std::string::npos);
}

TEST(validate, camera_alone_is_checked_like_those_of_a_scene) {
  Camera camera;
  EXPECT_NO_THROW(validate(camera, "camera"));
  camera.projection = PerspectiveCamera{std::nan("")};
  EXPECT_THROW(validate(camera, "camera"), Error);
  camera = {};
  camera.to_world[0] = Vec4d(0.0);
  EXPECT_THROW(validate(camera, "camera"), Error);
}

}  // namespace
}  // namespace abbe
