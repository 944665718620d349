#include "support/scene_builder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <stdexcept>

namespace abbe::test {
namespace {

Mat4d look_at(const Vec3d& eye, const Vec3d& target) {
  const Vec3d forward = glm::normalize(target - eye);
  const Vec3d helper = std::abs(forward.y) < 0.99 ? Vec3d(0, 1, 0) : Vec3d(0, 0, -1);
  const Vec3d right = glm::normalize(glm::cross(forward, helper));
  const Vec3d up = glm::cross(right, forward);
  Mat4d m(1.0);
  m[0] = Vec4d(right, 0.0);
  m[1] = Vec4d(up, 0.0);
  m[2] = Vec4d(-forward, 0.0);
  m[3] = Vec4d(eye, 1.0);
  return m;
}

Material plain() {
  Material material;
  material.metallic = 0.0f;
  material.roughness = 1.0f;
  material.index = ConstantIndex{1.0};
  return material;
}

}  // namespace

const Catalogue& catalogue() {
  static const Catalogue kCatalogue({std::filesystem::path(ABBE_SOURCE_DIR) / "spectra"});
  return kCatalogue;
}

Mat4d translation(const Vec3d& t) {
  return glm::translate(Mat4d(1.0), t);
}

Mat4d rotation(const Vec3d& axis, double angle_deg) {
  return glm::rotate(Mat4d(1.0), glm::radians(angle_deg), axis);
}

Material emitter(const Vec3f& emissive_rec709) {
  Material material = plain();
  material.base_color_rec709 = Vec4f(0.0f, 0.0f, 0.0f, 1.0f);
  material.emissive_rec709 = emissive_rec709;
  return material;
}

Material matte(const Vec3f& base_color_rec709) {
  Material material = plain();
  material.base_color_rec709 = Vec4f(base_color_rec709, 1.0f);
  return material;
}

Material glass(const std::string& id) {
  Material material = glass(1.5);
  material.index = *catalogue().entry(id, "test").dispersion;
  material.index_id = id;
  return material;
}

Material glass(double index) {
  Material material = plain();
  material.roughness = 0.0f;
  material.transmission = 1.0f;
  material.has_volume = true;
  material.index = ConstantIndex{index};
  return material;
}

Material mirror(const std::string& conductor_id) {
  const CatalogueEntry entry = catalogue().entry(conductor_id, "test");
  Material material = plain();
  material.metallic = 1.0f;
  material.roughness = 0.0f;
  material.conductor = Conductor{entry.id, *entry.n, *entry.k};
  return material;
}

std::uint32_t add(Scene& scene, Material material) {
  scene.materials.push_back(std::move(material));
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

void add_shape(Scene& scene, Shape shape, std::uint32_t material, const Mat4d& to_world) {
  shape.material = material;
  Instance instance;
  instance.what = std::move(shape);
  instance.to_world = to_world;
  scene.instances.push_back(std::move(instance));
}

void add_sphere(Scene& scene, std::uint32_t material, const Vec3d& center, double radius_m) {
  add_shape(scene, {.name = "sphere", .geometry = SphereShape{radius_m}}, material,
            translation(center));
}

void add_box(Scene& scene, std::uint32_t material, const Vec3d& half_m, const Mat4d& to_world) {
  ConvexShape box;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      Vec4d plane(0.0);
      plane[axis] = sign;
      plane.w = half_m[axis];
      box.planes.push_back(plane);
    }
  }
  add_shape(scene, {.name = "box", .geometry = box}, material, to_world);
}

void add_mesh(Scene& scene, Mesh mesh, std::uint32_t material, const Mat4d& to_world) {
  mesh.material = material;
  scene.meshes.push_back(std::move(mesh));
  Instance instance;
  instance.what = static_cast<std::uint32_t>(scene.meshes.size() - 1);
  instance.to_world = to_world;
  scene.instances.push_back(std::move(instance));
}

void add_box_mesh(Scene& scene, std::uint32_t material, const Vec3d& half_m,
                  const Mat4d& to_world) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.positions.push_back(Vec3f(half_m) * Vec3f((i & 1) ? 1.0f : -1.0f, (i & 2) ? 1.0f : -1.0f,
                                                   (i & 4) ? 1.0f : -1.0f));
  }
  mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  add_mesh(scene, std::move(mesh), material, to_world);
}

void add_square(Scene& scene, std::uint32_t material, double half_m, const Mat4d& to_world) {
  const auto h = static_cast<float>(half_m);
  Mesh mesh;
  mesh.positions = {{-h, -h, 0}, {h, -h, 0}, {h, h, 0}, {-h, h, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  add_mesh(scene, std::move(mesh), material, to_world);
}

void add_prism(Scene& scene, std::uint32_t material, double apex_deg, double side_m,
               const Mat4d& to_world) {
  const double half = glm::radians(0.5 * apex_deg);
  ConvexShape prism;
  // Apex at the origin, the two faces opening towards −X.
  prism.planes.push_back(Vec4d(std::sin(half), 0.0, std::cos(half), 0.0));
  prism.planes.push_back(Vec4d(std::sin(half), 0.0, -std::cos(half), 0.0));
  prism.planes.push_back(Vec4d(-1.0, 0.0, 0.0, side_m * std::cos(half)));
  prism.planes.push_back(Vec4d(0.0, 1.0, 0.0, side_m));
  prism.planes.push_back(Vec4d(0.0, -1.0, 0.0, side_m));
  add_shape(scene, {.name = "prism", .geometry = prism}, material, to_world);
}

Light point_light(const Vec3d& position, double candela) {
  Light light;
  light.type = LightType::Point;
  light.intensity = candela;
  light.to_world = translation(position);
  return light;
}

Light directional_light(const Vec3d& towards, double lux) {
  Light light;
  light.type = LightType::Directional;
  light.intensity = lux;
  light.to_world = look_at(Vec3d(0.0), towards);
  return light;
}

Camera orthographic_camera(const Vec3d& eye, const Vec3d& target, double half_width_m,
                           double half_height_m) {
  Camera camera;
  camera.projection = OrthographicCamera{half_width_m, half_height_m};
  camera.to_world = look_at(eye, target);
  return camera;
}

Camera perspective_camera(const Vec3d& eye, const Vec3d& target, double yfov_deg) {
  Camera camera;
  camera.projection = PerspectiveCamera{glm::radians(yfov_deg)};
  camera.to_world = look_at(eye, target);
  return camera;
}

LitWorld make_world(const Scene& scene, const RenderSettings& settings) {
  Notes notes;
  return make_lit_world(scene, world_options(settings), caustic_options(settings),
                        catalogue().observer(), catalogue().illuminant("illuminant/D65"), notes);
}

Rendered render(const LitWorld& world, const Camera& camera, const RenderSettings& settings) {
  Film film(film_options(settings));
  Rendered rendered{abbe::render(world, camera, settings, film), {}};
  rendered.image = film.develop({.xyz_to_rec709 = world.lanes.film_to_rec709()});
  return rendered;
}

Rendered render(const Scene& scene, const RenderSettings& settings) {
  return render(make_world(scene, settings), scene.cameras.front(), settings);
}

float pixel(const Image& image, int x, int y, const std::string& channel) {
  const auto index = image.channel_index(channel);
  if (!index) throw std::runtime_error("the image has no channel " + channel);
  return image.at(x, y, *index);
}

RenderSettings small_settings() {
  RenderSettings settings;
  settings.size = {8, 8};
  settings.samples_per_pixel = 1;
  settings.filter = "box";
  settings.cutoff = 1e-4;  // What tests compare with has all of the light, without noise.
  return settings;
}

}  // namespace abbe::test
