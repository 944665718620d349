#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "abbe/base/constants.h"
#include "abbe/caustics/flat/bodies.h"
#include "abbe/cli/describe/describe.h"
#include "abbe/render/settings.h"
#include "abbe/scene/colors.h"

namespace abbe {
namespace {

constexpr double kDegrees = 180.0 / kPi;

// A name, or the number of a nameless thing.
std::string name_or_number(const std::string& name, std::size_t number) {
  return name.empty() ? fmt::format("#{}", number) : name;
}

Description describe_camera(const Camera& camera, std::size_t number,
                            const PreparedScene& prepared) {
  Description out;
  out["name"] = prepared.has_default_camera ? "default" : name_or_number(camera.name, number);
  if (const auto* perspective = std::get_if<PerspectiveCamera>(&camera.projection)) {
    out["projection"] = "perspective";
    out["yfov_deg"] = perspective->yfov_rad * kDegrees;
  } else {
    const auto& orthographic = std::get<OrthographicCamera>(camera.projection);
    out["projection"] = "orthographic";
    out["xmag_m"] = orthographic.xmag;
    out["ymag_m"] = orthographic.ymag;
  }
  const Vec2i size = default_size(camera);
  out["position_m"] = triple(prepared.scene.origin_m + Vec3d(camera.to_world[3]));
  out["looks_along"] = triple(-glm::normalize(Vec3d(camera.to_world[2])));
  out["default_size"] = fmt::format("{}x{}", size.x, size.y);
  out["chosen"] = number == prepared.camera;
  return out;
}

Description describe_mesh(const Mesh& mesh, std::size_t number, const Scene& scene) {
  Description out;
  out["name"] = name_or_number(mesh.name, number);
  out["triangles"] = mesh.triangles.size();
  out["vertices"] = mesh.positions.size();
  Description attributes = Description::array();
  if (!mesh.normals.empty()) attributes.push_back("normals");
  if (!mesh.tangents.empty()) attributes.push_back("tangents");
  if (!mesh.uv[0].empty()) attributes.push_back("UV 0");
  if (!mesh.uv[1].empty()) attributes.push_back("UV 1");
  if (!mesh.colors_rec709.empty()) attributes.push_back("colours");
  if (!attributes.empty()) out["attributes"] = std::move(attributes);
  if (mesh.morph_targets > 0) out["morph_targets"] = mesh.morph_targets;
  if (mesh.joints > 0) out["joints"] = mesh.joints;
  out["material"] = name_or_number(scene.materials[mesh.material].name, mesh.material);
  return out;
}

Description describe_shape(const Instance& instance, const Shape& shape, const Scene& scene) {
  Description out;
  out["name"] = instance.name.empty() ? shape.name : instance.name;
  if (const auto* sphere = std::get_if<SphereShape>(&shape.geometry)) {
    out["shape"] = "sphere";
    out["radius_m"] = sphere->radius_m;
  } else {
    out["shape"] = "convex";
    out["planes"] = std::get<ConvexShape>(shape.geometry).planes.size();
  }
  out["material"] = name_or_number(scene.materials[shape.material].name, shape.material);
  return out;
}

std::set<std::uint32_t> placed_materials(const Scene& scene) {
  std::set<std::uint32_t> placed;
  for (const Instance& instance : scene.instances) {
    if (const auto* mesh = std::get_if<std::uint32_t>(&instance.what)) {
      placed.insert(scene.meshes[*mesh].material);
    } else {
      placed.insert(std::get<Shape>(instance.what).material);
    }
  }
  return placed;
}

// What shines, whether it lights others, and why.
Description describe_emitters(const PreparedScene& prepared) {
  const Scene& scene = prepared.scene;
  Description out = Description::array();
  for (const std::uint32_t number : placed_materials(scene)) {
    const Material& material = scene.materials[number];
    if (!material.emission && material.emissive_rec709 == Vec3f(0.0f)) continue;
    const bool is_open = material.lights_others == LightsOthers::Auto;
    bool lights = is_open ? scene.emissive_light : material.lights_others == LightsOthers::Yes;
    std::string because = !is_open               ? "its material says so"
                          : scene.emissive_light ? "the file has no lamps"
                                                 : "the file has lamps of its own";
    if (prepared.emissive_light != LightsOthers::Auto) {
      because = "--emissive-light " + emissive_light_name(prepared.emissive_light);
    }
    if (material.unlit) {
      lights = false;
      because = "an unlit surface is a picture, not a light";
    }
    out.push_back({{"name", name_or_number(material.name, number)},
                   {"lights_others", lights},
                   {"because", because}});
  }
  return out;
}

Description describe_environment(const Environment& environment) {
  const EnvironmentImage& image = environment.image;
  Description out;
  out["name"] = environment.name;
  out["size"] = fmt::format("{}x{}", image.width, image.height);
  out["spectrum"] = !image.bands.empty()
                        ? fmt::format("its own {} bands", image.band_nm.size())
                        : "RGB, as a metamer under " + (!environment.spectrum ? "illuminant/D65"
                                                        : environment.spectrum->id.empty()
                                                            ? "its own spectrum"
                                                            : environment.spectrum->id);
  out["scale"] = environment.scale;
  out["rotation_deg"] = environment.rotation_deg;
  out["visible"] = environment.visible;
  return out;
}

Description describe_texture(const Texture& texture, std::size_t number, const Scene& scene) {
  const TextureImage& image = scene.images[texture.image];
  Description out;
  out["name"] = name_or_number(image.name, number);
  out["size"] = fmt::format("{}x{}", image.width, image.height);
  out["values"] = image.rgba16.empty() ? "8 bit" : "16 bit";
  return out;
}

Description describe_bounds(const Box3d& bounds, const Vec3d& origin_m) {
  if (bounds.is_empty()) return nullptr;
  Description out;
  out["low_m"] = triple(origin_m + bounds.low);
  out["high_m"] = triple(origin_m + bounds.high);
  return out;
}

// What is said of several places is one entry with all of them.
Description describe_notes(const Notes& notes) {
  Description out = Description::array();
  std::map<std::string, std::size_t> entry_of;
  for (const Note& note : notes.all()) {
    const auto [known, is_new] = entry_of.emplace(note.text, out.size());
    if (is_new) {
      Description entry;
      entry["text"] = note.text;
      entry["kind"] = note.kind == NoteKind::Warning ? "warning" : "note";
      entry["where"] = Description::array();
      out.push_back(std::move(entry));
    }
    Description& places = out[known->second]["where"];
    if (note.where.empty()) continue;
    if (std::find(places.begin(), places.end(), note.where) == places.end()) {
      places.push_back(note.where);
    }
  }
  return out;
}

}  // namespace

Description describe_scene(const PreparedScene& prepared, Notes& notes) {
  const Scene& scene = prepared.scene;
  Description out;
  if (!scene.name.empty()) out["scene"] = scene.name;
  out["hash"] = scene.content_hash;
  out["rig"] = rig_name(prepared.rig.rig);
  out["default_camera"] = prepared.has_default_camera;
  out["bounds"] = describe_bounds(prepared.bounds, scene.origin_m);

  out["animations"] = Description::array();
  for (const Animation& animation : scene.animations) {
    out["animations"].push_back({{"name", animation.name}, {"length_s", animation.length_s}});
  }
  if (!scene.variants.empty()) out["variants"] = scene.variants;
  if (prepared.time_s) out["time_s"] = *prepared.time_s;

  out["cameras"] = Description::array();
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
    out["cameras"].push_back(describe_camera(scene.cameras[i], i, prepared));
  }
  out["lights"] = Description::array();
  for (const Light& light : scene.lights)
    out["lights"].push_back(describe_light(light, scene.origin_m));
  out["emitters"] = describe_emitters(prepared);
  if (scene.environment) out["environment"] = describe_environment(*scene.environment);
  if (scene.ambient) {
    out["ambient"] = {{"luminance_cd_per_m2", scene.ambient->luminance_cd_per_m2},
                      {"spectrum", scene.ambient->spectrum.id}};
  }
  const ColorCount colors = count_colors(scene);
  out["colors"] = {{"space", rgb_space_name(scene.color_space)},
                   {"outside_rec709", colors.outside_rec709},
                   {"impossible", colors.impossible}};
  if (colors.impossible > 0) {
    notes.warn("colors", fmt::format("{} of a kind that no reflectance has: the nearest is taken",
                                     colors.impossible));
  }
  out["materials"] = Description::array();
  for (const Material& material : scene.materials) {
    out["materials"].push_back(describe_material(material, notes));
  }

  // What light of directional lamps is followed through exactly, and what had to be left out.
  Notes flat_notes;
  const FlatBodies flat = find_flat_bodies(scene, flat_notes);
  out["exact_light"] = Description::array();
  for (const FlatBody& body : flat.bodies) {
    out["exact_light"].push_back({{"name", body.name},
                                  {"kind", body.is_mirror ? "mirror" : "glass"},
                                  {"facets", body.facet_count}});
  }
  for (const std::string& reason : flat.fallbacks) {
    out["exact_light"].push_back({{"name", reason}, {"kind", "straight shadow rays"}});
  }
  if (scene.fog) out["fog"] = {{"extinction_per_m", scene.fog->extinction_per_m}};

  std::uint64_t triangles = 0;
  out["meshes"] = Description::array();
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    out["meshes"].push_back(describe_mesh(scene.meshes[i], i, scene));
  }
  out["shapes"] = Description::array();
  for (const Instance& instance : scene.instances) {
    if (const auto* mesh = std::get_if<std::uint32_t>(&instance.what)) {
      triangles += scene.meshes[*mesh].triangles.size();
    } else {
      out["shapes"].push_back(describe_shape(instance, std::get<Shape>(instance.what), scene));
    }
  }
  out["instances"] = scene.instances.size();
  out["placed_triangles"] = triangles;
  out["textures"] = Description::array();
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    out["textures"].push_back(describe_texture(scene.textures[i], i, scene));
  }
  out["notes"] = describe_notes(notes);
  return out;
}

}  // namespace abbe
