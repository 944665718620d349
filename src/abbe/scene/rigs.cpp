#include "abbe/scene/rigs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "abbe/base/constants.h"
#include "abbe/base/error.h"
#include "abbe/base/parallel.h"
#include "abbe/scene/lamps.h"
#include "abbe/scene/surface_finder.h"

namespace abbe {
namespace {

// A soft box: a rectangle on the plane that touches the sphere of directions at its middle.
struct SoftBox {
  double azimuth_deg;  // From the camera's back to its right.
  double elevation_deg;
  double half_width, half_height;  // On that plane, at distance 1.
  double edge;                     // Over which it fades.
  double illuminance;              // Of what faces it, over π.
};

// The key light and the grey around it make π lx together on what faces the key.
constexpr SoftBox kKey{40.0, 45.0, 0.28, 0.28, 0.06, 0.76};
constexpr SoftBox kFill{-60.0, 20.0, 0.45, 0.6, 0.25, 0.12};
constexpr SoftBox kRim{200.0, 30.0, 0.5, 0.2, 0.08, 0.2};
constexpr double kGreyBelow = 0.18, kGreyAbove = 0.24;  // cd/m²
// What is left of it ahead of the camera: a rough white metal is as bright as the grey that it sees
// behind the camera, and would not be told from the same grey behind it.
constexpr double kLeftAhead = 0.6;

double smooth_step(double x) {
  const double t = std::clamp(x, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

// 1 inside, 0 outside.
double coverage(const SoftBox& box, const Vec3d& direction) {
  const double a = box.azimuth_deg * kPi / 180.0, e = box.elevation_deg * kPi / 180.0;
  const Vec3d middle(std::sin(a) * std::cos(e), std::sin(e), std::cos(a) * std::cos(e));
  const Vec3d right = glm::normalize(glm::cross(Vec3d(0.0, 1.0, 0.0), middle));
  const Vec3d up = glm::cross(middle, right);
  const double along = glm::dot(direction, middle);
  if (!(along > 0.05)) return 0.0;
  const auto within = [&](const Vec3d& axis, double half) {
    const double off = std::abs(glm::dot(direction, axis)) / along;
    return 1.0 - smooth_step((off - half + box.edge) / (2.0 * box.edge));
  };
  return within(right, box.half_width) * within(up, box.half_height);
}

// The direction of a texel's middle: see EnvironmentImage.
Vec3d direction_of_texel(int x, int y, int width, int height) {
  const double phi = 2.0 * kPi * ((x + 0.5) / width - 0.5);
  const double theta = kPi * (y + 0.5) / height;
  return {std::cos(phi) * std::sin(theta), std::cos(theta), std::sin(phi) * std::sin(theta)};
}

std::shared_ptr<const Environment> even_environment(std::string name, double luminance_cd_per_m2) {
  auto result = std::make_shared<Environment>();
  result->name = std::move(name);
  result->image.width = 4;
  result->image.height = 2;
  result->image.rgb_rec709.assign(8, Vec3f(1.0f));
  result->scale = luminance_cd_per_m2;
  return result;
}

bool lets_light_through(const Material& material) {
  return material.transmission > 0.0f || material.alpha_mode != AlphaMode::Opaque;
}

bool stops_light(const Material& material, bool is_front) {
  return !lets_light_through(material) && (is_front || material.double_sided);
}

// Rays through the middles of a camera's image, cut in cells, in the order of rows.
std::vector<std::pair<Vec3d, Vec3d>> camera_rays(const Camera& camera, int columns, int rows) {
  const Vec3d x = glm::normalize(Vec3d(camera.to_world[0])),
              y = glm::normalize(Vec3d(camera.to_world[1])),
              z = glm::normalize(Vec3d(camera.to_world[2])), position(camera.to_world[3]);
  std::vector<std::pair<Vec3d, Vec3d>> rays;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double right = 2.0 * (column + 0.5) / columns - 1.0;
      const double up = 1.0 - 2.0 * (row + 0.5) / rows;
      if (const auto* lens = std::get_if<PerspectiveCamera>(&camera.projection)) {
        const double height = std::tan(0.5 * lens->yfov_rad);
        rays.emplace_back(position, glm::normalize(right * camera.aspect_ratio * height * x +
                                                   up * height * y - z));
      } else {
        const auto& flat = std::get<OrthographicCamera>(camera.projection);
        rays.emplace_back(position + right * flat.xmag * x + up * flat.ymag * y, -z);
      }
    }
  }
  return rays;
}

// A direction over a surface, dense as the cosine, and its mirror image through the normal.
Vec3d over_surface(const Vec3d& normal, double u, double v) {
  const Vec3d aside = std::abs(normal.x) < 0.7 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
  const Vec3d s = glm::normalize(glm::cross(aside, normal)), t = glm::cross(normal, s);
  const double radius = std::sqrt(u), phi = 2.0 * kPi * v;
  return glm::normalize(radius * std::cos(phi) * s + radius * std::sin(phi) * t +
                        std::sqrt(1.0 - u) * normal);
}

// What a camera sees, by some rays.
struct View {
  std::size_t rays = 0, outside = 0;  // Outside: what meets nothing, or what sees the outside.
  std::vector<double> distances_m;
};

// Rays by which a camera's view is judged, of which each is asked twice.
std::vector<std::pair<Vec3d, Vec3d>> judging_rays(const SurfaceFinder& finder,
                                                  const Camera& camera) {
  // Bounded: a second or so for the largest scenes.
  constexpr std::uint64_t kMaxTests = std::uint64_t{1} << 28;
  constexpr int kMaxColumns = 20, kMinColumns = 6;
  const double share =
      static_cast<double>(kMaxTests) / std::max(1.0, 2.0 * static_cast<double>(finder.size()));
  const int columns =
      std::clamp(static_cast<int>(std::sqrt(share / 0.6)), kMinColumns, kMaxColumns);
  return camera_rays(camera, columns, (3 * columns + 4) / 5);
}

View look_through(const Scene& scene, const Camera& camera) {
  const SurfaceFinder finder(scene);
  const auto rays = judging_rays(finder, camera);
  struct Answer {
    bool is_outside = true;
    double distance_m = -1.0;
  };
  std::vector<Answer> answers(rays.size());
  parallel_for(0, rays.size(), 1, [&](std::size_t i) {
    const auto& [origin, direction] = rays[i];
    const auto seen = finder.first(origin, direction, 0.0, stops_light);
    if (!seen) return;
    answers[i].distance_m = seen->distance_m;
    const Vec3d normal = seen->is_front ? seen->normal : -seen->normal;
    // Kronecker's sequence of the plastic number (Roberts 2018): the same rays for everyone.
    const double u = std::fmod(0.5 + 0.7548776662466927 * static_cast<double>(i), 1.0);
    const double v = std::fmod(0.5 + 0.5698402909980532 * static_cast<double>(i), 1.0);
    const Vec3d place = origin + seen->distance_m * direction;
    answers[i].is_outside =
        !finder.first(place, over_surface(normal, u, v), 1e-6 * seen->distance_m, stops_light);
  });
  View view;
  view.rays = rays.size();
  for (const Answer& answer : answers) {
    view.outside += answer.is_outside ? 1 : 0;
    if (answer.distance_m > 0.0) view.distances_m.push_back(answer.distance_m);
  }
  std::sort(view.distances_m.begin(), view.distances_m.end());
  return view;
}

bool is_closed(const View& view) {
  constexpr double kOpen = 0.03;
  return static_cast<double>(view.outside) < kOpen * static_cast<double>(view.rays);
}

// Counterclockwise seen from above, from a camera that looks along −Z to this one.
double heading_deg(const Camera& camera) {
  Vec3d forward = -Vec3d(camera.to_world[2]);
  // Straight up or down: what is up in the image is ahead, or behind.
  if (std::hypot(forward.x, forward.z) < 1e-3 * std::abs(forward.y)) {
    forward = (forward.y < 0.0 ? 1.0 : -1.0) * Vec3d(camera.to_world[1]);
  }
  return std::atan2(-forward.x, -forward.z) * 180.0 / kPi;
}

void light_closed_scene(const Camera& camera, const View& view, const NamedSpectrum& d65,
                        AddedRig& rig) {
  constexpr double kAmbient = 0.25;  // cd/m²
  const double near_m = view.distances_m.front();
  const double middle_m = view.distances_m[view.distances_m.size() / 2];
  Light lamp;
  lamp.name = "studio lamp";
  lamp.type = LightType::Point;
  // What is as far as the middle of what is seen gets as much as from the key light.
  lamp.intensity = kKey.illuminance * kPi * middle_m * middle_m;
  lamp.to_world = camera.to_world;
  // Beside the camera, nearer than anything seen: right and above.
  const Vec3d right = glm::normalize(Vec3d(camera.to_world[0])),
              up = glm::normalize(Vec3d(camera.to_world[1]));
  lamp.to_world = Mat4d(1.0);
  lamp.to_world[3] = camera.to_world[3] + Vec4d(0.1 * near_m * (right + up), 0.0);
  rig.lamp = std::move(lamp);
  rig.ambient = Ambient{kAmbient, d65};
}

AddedRig studio(const Scene& scene, std::size_t camera, const NamedSpectrum& d65,
                const std::string& why) {
  AddedRig rig;
  rig.rig = Rig::Studio;
  const Camera& seen_through = scene.cameras[camera];
  const View view = look_through(scene, seen_through);
  if (is_closed(view)) {
    light_closed_scene(seen_through, view, d65, rig);
    rig.lamp->to_world[3] += Vec4d(scene.origin_m, 0.0);
    rig.line = why +
               ", and the camera stands in a closed room: lit by ambient light of 0.25 cd/m2 and a "
               "lamp beside the camera";
    return rig;
  }
  rig.environment = studio_environment(heading_deg(seen_through));
  rig.line = why + ": lit by a studio, soft boxes on grey with the key light at the camera's right";
  return rig;
}

AddedRig surround(const Scene& scene, const std::string& why) {
  constexpr double kFaint = 0.1;  // Of a white that faces all lamps.
  constexpr double kOfNoLamps = 0.2;
  const Box3d bounds = bounds_of(scene);
  const double radius_m = bounds.is_empty() ? 1.0 : 0.5 * glm::distance(bounds.low, bounds.high);
  const Vec3d center = bounds.is_empty() ? Vec3d(0.0) : bounds.center();
  double lux = 0.0;
  for (const Light& light : scene.lights) lux += illuminance_lux(light, center, radius_m);
  const double luminance = lux > 0.0 ? kFaint * lux / kPi : kOfNoLamps;
  AddedRig rig;
  rig.rig = Rig::Surround;
  rig.line = fmt::format("{}: an even grey of {:.3g} cd/m2 is around it", why, luminance);
  rig.environment = even_environment("surround", luminance);
  return rig;
}

}  // namespace

const std::vector<std::string>& rig_names() {
  static const std::vector<std::string> names{"auto", "studio", "surround", "none"};
  return names;
}

std::string rig_name(Rig rig) {
  return rig_names()[static_cast<std::size_t>(rig)];
}

Rig rig_from_name(const std::string& name) {
  return static_cast<Rig>(check_choice("rig", name, "a rig", rig_names()));
}

std::shared_ptr<const Environment> studio_environment(double rotation_deg) {
  auto result = std::make_shared<Environment>();
  result->name = "studio";
  result->rotation_deg = rotation_deg;
  EnvironmentImage& image = result->image;
  image.width = 512;
  image.height = 256;
  const auto width = static_cast<std::size_t>(image.width);
  const std::size_t texels = width * static_cast<std::size_t>(image.height);
  std::vector<double> luminance(texels);
  const auto for_each = [&image, width](const auto& body) {
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        body(direction_of_texel(x, y, image.width, image.height),
             static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x),
             2.0 * kPi * kPi / (image.width * image.height) *
                 std::sin(kPi * (y + 0.5) / image.height));
      }
    }
  };
  for_each([&](const Vec3d& direction, std::size_t texel, double) {
    const double ahead = smooth_step((-direction.z - 0.2) / 0.6);
    luminance[texel] = (1.0 - (1.0 - kLeftAhead) * ahead) *
                       (kGreyBelow + (kGreyAbove - kGreyBelow) * 0.5 * (1.0 + direction.y));
  });
  for (const SoftBox& box : {kKey, kFill, kRim}) {
    const double a = box.azimuth_deg * kPi / 180.0, e = box.elevation_deg * kPi / 180.0;
    const Vec3d middle(std::sin(a) * std::cos(e), std::sin(e), std::cos(a) * std::cos(e));
    double of_one = 0.0;  // Illuminance of what faces a box of 1 cd/m².
    for_each([&](const Vec3d& direction, std::size_t, double solid_angle) {
      const double cosine = glm::dot(direction, middle);
      if (cosine > 0.0) of_one += coverage(box, direction) * cosine * solid_angle;
    });
    for_each([&](const Vec3d& direction, std::size_t texel, double) {
      luminance[texel] += box.illuminance * kPi / of_one * coverage(box, direction);
    });
  }
  image.rgb_rec709.resize(texels);
  for (std::size_t t = 0; t < texels; ++t) {
    image.rgb_rec709[t] = Vec3f(static_cast<float>(luminance[t]));
  }
  return result;
}

bool is_closed_around(const Scene& scene, const Camera& camera) {
  return is_closed(look_through(scene, camera));
}

bool sees_only_backs(const Scene& scene, const Camera& camera) {
  const SurfaceFinder finder(scene);
  const auto is_there = [](const Material& material, bool is_front) {
    return is_front || !material.is_front_only();
  };
  bool meets_back = false;
  for (const auto& [origin, direction] : judging_rays(finder, camera)) {
    const auto met =
        finder.first(origin, direction, 0.0, [](const Material&, bool) { return true; });
    if (!met) continue;
    if (finder.first(origin, direction, 0.0, is_there)) return false;
    meets_back = true;
  }
  return meets_back;
}

AddedRig choose_rig(const Scene& scene, Rig rig, std::size_t camera, const NamedSpectrum& d65) {
  if (rig == Rig::Studio) return studio(scene, camera, d65, "as asked for");
  if (rig == Rig::Surround) return surround(scene, "as asked for");
  if (rig == Rig::None || scene.environment || scene.ambient) return {};
  if (scene.lights.empty()) {
    return studio(scene, camera, d65, "the scene has no lamps and nothing around it");
  }
  if (scene.uses_abbe) return {};
  double brightest = 0.0;
  for (const Light& light : scene.lights) brightest = std::max(brightest, light.intensity);
  if (!(brightest > 0.0)) return {};
  return surround(scene, "the scene has lamps and nothing around it");
}

void add_rig(Scene& scene, const AddedRig& rig) {
  if (rig.rig == Rig::None) return;
  if (rig.lamp) {
    scene.lights.push_back(*rig.lamp);
    scene.lights.back().to_world[3] -= Vec4d(scene.origin_m, 0.0);
  }
  scene.environment = rig.environment;
  scene.ambient = rig.ambient;
}

AddedRig add_rig(Scene& scene, Rig rig, std::size_t camera, const NamedSpectrum& d65) {
  AddedRig chosen = choose_rig(scene, rig, camera, d65);
  add_rig(scene, chosen);
  return chosen;
}

}  // namespace abbe
