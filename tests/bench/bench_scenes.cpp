#include "bench/bench_scenes.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <random>
#include <stdexcept>
#include <variant>

#include "abbe/load/gltf.h"
#include "abbe/scene/scene.h"

namespace abbe::bench {
namespace {

// A cube whose faces have cells × cells squares, blown up to a sphere; `wave` is the height of its
// displacement relative to the radius. Corners on the cube's edges are doubled but equal.
void add_sphere(BenchScene& scene, int cells, const Vec3d& center, double radius, double wave) {
  for (int face = 0; face < 6; ++face) {
    const auto first = static_cast<std::uint32_t>(scene.positions.size());
    const double side = face % 2 == 0 ? -1.0 : 1.0;
    for (int j = 0; j <= cells; ++j) {
      for (int i = 0; i <= cells; ++i) {
        Vec3d p;
        p[face / 2] = side;
        p[(face / 2 + 1) % 3] = std::tan(0.25 * kPi * (2.0 * i / cells - 1.0));
        p[(face / 2 + 2) % 3] = std::tan(0.25 * kPi * (2.0 * j / cells - 1.0)) * side;
        p = glm::normalize(p);
        const double height =
            std::sin(19.0 * p.x + 1.0) * std::sin(23.0 * p.y) * std::sin(17.0 * p.z + 2.0) +
            0.2 * std::sin(90.0 * p.x) * std::sin(80.0 * p.y + p.z);
        scene.positions.emplace_back(center + radius * (1.0 + wave * height) * p);
      }
    }
    const auto row = static_cast<std::uint32_t>(cells + 1);
    for (std::uint32_t j = 0; j + 1 < row; ++j) {
      for (std::uint32_t i = 0; i + 1 < row; ++i) {
        const std::uint32_t a = first + j * row + i;
        scene.triangles.push_back({a, a + 1, a + row + 1});
        scene.triangles.push_back({a, a + row + 1, a + row});
      }
    }
  }
}

// A box seen from inside, two triangles a wall.
void add_room(BenchScene& scene, const Vec3f& low, const Vec3f& high) {
  const auto first = static_cast<std::uint32_t>(scene.positions.size());
  for (int c = 0; c < 8; ++c) {
    scene.positions.emplace_back(c & 1 ? high.x : low.x, c & 2 ? high.y : low.y,
                                 c & 4 ? high.z : low.z);
  }
  constexpr std::uint32_t kWalls[6][4] = {{0, 2, 6, 4}, {1, 5, 7, 3}, {0, 4, 5, 1},
                                          {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 6, 7, 5}};
  for (const auto& w : kWalls) {
    scene.triangles.push_back({first + w[0], first + w[1], first + w[2]});
    scene.triangles.push_back({first + w[0], first + w[2], first + w[3]});
  }
}

void add_mesh(BenchScene& out, const Mesh& mesh, const Mat4d& to_world, std::size_t& dropped) {
  const auto first = static_cast<std::uint32_t>(out.positions.size());
  for (const Vec3f& position : mesh.positions) {
    out.positions.emplace_back(Vec3d(to_world * Vec4d(Vec3d(position), 1.0)));
  }
  for (const auto& corner : mesh.triangles) {
    const Triangle triangle{corner[0] + first, corner[1] + first, corner[2] + first};
    const Vec3d a(out.positions[triangle[0]]), b(out.positions[triangle[1]]),
        c(out.positions[triangle[2]]);
    const double area = glm::length(glm::cross(b - a, c - a));
    if (std::isfinite(area) && area > 0.0) {
      out.triangles.push_back(triangle);
    } else {
      ++dropped;
    }
  }
}

// Embree and the tree get the same triangles, so exact shapes are left out.
BenchScene load_scene(const std::filesystem::path& file) {
  Notes notes;
  Scene scene = load_gltf(file, Catalogue::standard(), {}, notes);
  add_default_camera(scene);
  BenchScene out;
  out.name = file.stem();
  std::size_t dropped = 0, shapes = 0;
  for (const Instance& instance : scene.instances) {
    if (const auto* mesh = std::get_if<std::uint32_t>(&instance.what)) {
      add_mesh(out, scene.meshes[*mesh], instance.to_world, dropped);
    } else {
      ++shapes;
    }
  }
  if (out.triangles.empty()) {
    throw std::invalid_argument(fmt::format("{} has no triangles", file.string()));
  }
  const Camera& camera = scene.cameras.front();
  const Vec3d eye(camera.to_world[3]);
  out.eye = Vec3f(eye);
  out.target = Vec3f(eye - Vec3d(camera.to_world[2]));
  if (const auto* lens = std::get_if<PerspectiveCamera>(&camera.projection)) {
    out.half_angle_tangent = static_cast<float>(std::tan(0.5 * lens->yfov_rad));
  }
  const Box3d bounds = bounds_of(scene);
  out.light =
      out.eye + Vec3f(0.0f, static_cast<float>(0.5 * glm::distance(bounds.low, bounds.high)), 0.0f);
  for (const Light& light : scene.lights) {
    if (light.type == LightType::Directional) continue;
    out.light = Vec3f(Vec3d(light.to_world[3]));
    break;
  }
  out.description = fmt::format("{} triangles of {}; {} dropped, {} exact shapes left out",
                                out.triangles.size(), file.filename().string(), dropped, shapes);
  return out;
}

}  // namespace

std::vector<std::string> scene_names() {
  return {"displaced", "inside", "room", "spheres"};
}

BenchScene make_scene(const std::string& name) {
  BenchScene scene;
  scene.name = name;
  if (name == "displaced" || name == "inside" || name == "huge") {
    add_sphere(scene, name == "huge" ? 913 : 289, Vec3d(0.0), 1.0, 0.06);
    scene.light = {2.0f, 3.0f, -4.0f};
    scene.eye = {0.3f, 0.5f, -2.6f};
    scene.half_angle_tangent = 0.45f;
    scene.description =
        fmt::format("cube-sphere of {} triangles with waves on it", scene.triangles.size());
    if (name == "inside") {
      scene.eye = {0.2f, 0.1f, -0.3f};
      scene.target = {0.1f, 0.2f, 1.0f};
      scene.half_angle_tangent = 0.6f;
      scene.light = {-0.2f, 0.3f, 0.1f};
      scene.description += ", from inside";
    }
  } else if (name == "room") {
    add_sphere(scene, 129, Vec3d(0.3, -1.0, 0.2), 0.8, 0.0);
    add_room(scene, Vec3f(-4.0f, -2.0f, -5.0f), Vec3f(4.0f, 3.0f, 4.0f));
    scene.eye = {-1.0f, 0.2f, -4.5f};
    scene.target = {0.1f, -0.6f, 0.0f};
    scene.light = {1.5f, 2.5f, -2.0f};
    scene.description = "dense sphere of 199 692 triangles in a room of 12";
  } else if (name == "spheres") {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (int i = 0; i < 80; ++i) {
      const Vec3d center(3.5 * uniform(random), 1.7 * uniform(random), 3.0 * uniform(random) + 0.5);
      add_sphere(scene, 17, center, 0.25 + 0.12 * uniform(random), i % 2 == 0 ? 0.0 : 0.08);
    }
    add_room(scene, Vec3f(-4.0f, -2.0f, -5.0f), Vec3f(4.0f, 2.5f, 4.0f));
    scene.eye = {0.2f, 0.3f, -4.6f};
    scene.light = {1.0f, 2.2f, -3.0f};
    scene.description = "80 spheres in a room, half displaced, 277 452 triangles";
  } else if (std::filesystem::exists(name)) {
    return load_scene(name);
  } else {
    throw std::invalid_argument("no scene and no file called " + name +
                                ", expected displaced, inside, room, spheres, huge or a glTF file");
  }
  return scene;
}

}  // namespace abbe::bench
