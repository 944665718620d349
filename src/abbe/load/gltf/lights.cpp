#include "abbe/load/gltf/lights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "abbe/base/constants.h"
#include "abbe/base/error.h"
#include "abbe/load/environment.h"
#include "abbe/load/gltf/document/check.h"
#include "abbe/load/gltf/document/fields.h"
#include "abbe/scene/convex.h"

namespace abbe::gltf {
namespace {

constexpr double kBrightest = 1e15;  // Candela and lux.

std::string name_or(const Fields& fields, std::string otherwise) {
  return fields.has("name") ? fields.required_text("name") : std::move(otherwise);
}

// A number above 0.
double positive(const Fields& fields, const char* name) {
  const double value = fields.required_number(name, {0.0, 1e12});
  if (value == 0.0) throw_input_error(fields.where(name), "0", "a number above 0");
  return value;
}

double magnification(const Fields& orthographic, const char* name, Notes& notes) {
  const double value = orthographic.required_number(name, {-1e12, 1e12});
  if (value == 0.0) throw_input_error(orthographic.where(name), "0", "a number above 0");
  if (value < 0.0) notes.warn(orthographic.where(name), "negative; its magnitude is used");
  return std::abs(value);
}

// {rectangle}, {disk} or {sphere} of a lamp that stands somewhere, {angle_deg} of one that does
// not.
LampShape read_lamp_shape(const Fields& shape, const Light& light, const std::string& type) {
  const std::vector<std::string> choices =
      light.type == LightType::Directional
          ? std::vector<std::string>{"angle_deg"}
          : std::vector<std::string>{"rectangle", "disk", "sphere"};
  std::string chosen;
  for (const char* name : {"angle_deg", "rectangle", "disk", "sphere"}) {
    if (!shape.has(name)) continue;
    if (!chosen.empty() || std::find(choices.begin(), choices.end(), name) == choices.end()) {
      throw_input_error(
          shape.where(name),
          chosen.empty() ? std::string(name) + " of a " + type + " light" : chosen + " and " + name,
          "one shape of a " + type + " light", choices);
    }
    chosen = name;
  }
  if (chosen.empty()) {
    throw_input_error(shape.where(""), "no shape", "one of a " + type + " light", choices);
  }
  if (light.beam) throw_input_error(shape.where(chosen.c_str()), "a beam beside it", "one of them");
  shape.only({"angle_deg", "rectangle", "disk", "sphere"});
  if (const auto rectangle = shape.object("rectangle")) {
    rectangle->only({"width", "height"});
    return RectangleLamp{positive(*rectangle, "width"), positive(*rectangle, "height")};
  }
  if (const auto disk = shape.object("disk")) {
    disk->only({"radius"});
    return DiskLamp{positive(*disk, "radius")};
  }
  if (const auto sphere = shape.object("sphere")) {
    sphere->only({"radius"});
    return SphereLamp{positive(*sphere, "radius")};
  }
  const double angle_deg = shape.required_number("angle_deg", {0.0, 180.0});
  if (angle_deg == 0.0) throw_input_error(shape.where("angle_deg"), "0", "a number above 0");
  return SkyDisc{angle_deg};
}

std::shared_ptr<const Environment> read_environment(Document& document, const Fields& fields,
                                                    Spectra& spectra) {
  fields.only({"uri", "scale", "rotation_deg", "visible", "spectrum"});
  auto result = std::make_shared<Environment>();
  const std::string uri = fields.required_text("uri");
  if (is_data(uri)) {
    throw_input_error(fields.where("uri"), "a data: URI", "a file in the folder of the scene");
  }
  const std::filesystem::path file = document.resolve_uri(uri, fields.pointer("uri"));
  // Into the hash, and checked to be a regular file.
  (void)document.read_resolved(file, fields.pointer("uri"));
  result->name = file.filename().string();
  result->image = read_environment_image(file, fields.where("uri"), document.notes());
  result->scale = fields.number("scale", 1.0, {0.0, 1e12});
  result->rotation_deg = fields.number("rotation_deg", 0.0, {-1e6, 1e6});
  if (fields.has("visible")) {
    const Json& visible = fields.at("visible");
    if (!visible.is_boolean()) {
      throw_input_error(fields.where("visible"), describe(visible), "true or false");
    }
    result->visible = visible.get<bool>();
  }
  if (fields.has("spectrum")) {
    if (!result->image.band_nm.empty()) {
      throw_input_error(fields.where("spectrum"), "a spectrum beside a spectral image",
                        "one of them: the image has its own");
    }
    result->spectrum = spectra.read(fields, "spectrum", SpectrumUse::Emission);
  }
  return result;
}

std::vector<Vec4d> read_planes(const Fields& convex) {
  convex.only({"planes"});
  // Corners are found from all triples of planes.
  constexpr std::size_t kMinPlanes = 4, kMaxPlanes = 64;
  const Json* planes = convex.has("planes") ? &convex.at("planes") : nullptr;
  if (planes == nullptr || !planes->is_array() || planes->size() < kMinPlanes ||
      planes->size() > kMaxPlanes) {
    throw_input_error(convex.where("planes"), planes == nullptr ? "nothing" : describe(*planes),
                      fmt::format("{} to {} planes", kMinPlanes, kMaxPlanes));
  }
  std::vector<Vec4d> result;
  for (std::size_t i = 0; i < planes->size(); ++i) {
    const std::string where = convex.where("planes") + "/" + std::to_string(i);
    const Json& row = (*planes)[i];
    if (!row.is_array() || row.size() != 4) {
      throw_input_error(where, describe(row), "[nx, ny, nz, d]");
    }
    Vec4d plane;
    for (int c = 0; c < 4; ++c) {
      plane[c] = finite_number(row[static_cast<std::size_t>(c)], where + "/" + std::to_string(c),
                               {-1e9, 1e9});
    }
    if (!(glm::length(Vec3d(plane)) > 1e-9)) {
      throw_input_error(where, "a normal of length 0", "a direction");
    }
    result.push_back(plane);
  }
  return result;
}

}  // namespace

Camera read_camera(Document& document, int index) {
  const std::string pointer = fmt::format("/cameras/{}", index);
  const Fields fields(document, document.json()["cameras"][at(index)], pointer);
  Camera camera;
  camera.name = name_or(fields, "");
  const std::string type = fields.required_text("type");
  if (type != "perspective" && type != "orthographic") {
    throw_input_error(fields.where("type"), "\"" + type + "\"", "a camera",
                      {"perspective", "orthographic"});
  }
  const auto projection = fields.object(type.c_str());
  if (!projection) {
    throw_input_error(document.where(pointer), "no \"" + type + "\"", "the object its type names");
  }
  if (type == "perspective") {
    const double yfov_rad = positive(*projection, "yfov");
    if (yfov_rad >= kPi - 1e-6) {
      throw_input_error(projection->where("yfov"), fmt::format("{:g} rad", yfov_rad), "below pi");
    }
    camera.projection = PerspectiveCamera{yfov_rad};
    if (projection->has("aspectRatio")) camera.aspect_ratio = positive(*projection, "aspectRatio");
  } else {
    OrthographicCamera orthographic;
    orthographic.xmag = magnification(*projection, "xmag", document.notes());
    orthographic.ymag = magnification(*projection, "ymag", document.notes());
    camera.aspect_ratio = orthographic.xmag / orthographic.ymag;
    camera.projection = orthographic;
  }
  return camera;
}

Light read_light(Document& document, int index, Spectra& spectra) {
  const std::string pointer = fmt::format("/extensions/KHR_lights_punctual/lights/{}", index);
  const Json& json = document.json()["extensions"]["KHR_lights_punctual"]["lights"][at(index)];
  const Fields fields(document, json, pointer);
  Light light;
  light.name = name_or(fields, "");
  const std::string type = fields.required_text("type");
  if (type == "point") {
    light.type = LightType::Point;
  } else if (type == "spot") {
    light.type = LightType::Spot;
  } else if (type == "directional") {
    light.type = LightType::Directional;
  } else {
    throw_input_error(fields.where("type"), "\"" + type + "\"", "a light",
                      {"point", "spot", "directional"});
  }
  light.color_rec709 = fields.limited_triple("color", Vec3d(1.0), {0.0, kBrightest});
  light.intensity = fields.number("intensity", 1.0, {0.0, kBrightest});
  if (fields.has("range")) {
    light.range_m = fields.required_number("range", {0.0, 1e12});
    if (light.range_m == 0.0) {
      document.fault(fields.pointer("range"), "0", "a number above 0", "no range is used");
      light.range_m = Light{}.range_m;
    }
  }
  if (const auto spot = fields.object("spot")) {
    light.inner_cone_rad = spot->number("innerConeAngle", 0.0, {0.0, 0.5 * kPi});
    light.outer_cone_rad = spot->number("outerConeAngle", 0.25 * kPi, {0.0, 0.5 * kPi + 1e-6});
    if (light.inner_cone_rad >= light.outer_cone_rad) {
      const std::string found = fmt::format("{:.9g}", light.inner_cone_rad);
      const std::string expected =
          fmt::format("below outerConeAngle, {:.9g}", light.outer_cone_rad);
      // Angles that went through single precision, or degrees.
      constexpr double kRounding = 1e-5;
      if (light.inner_cone_rad > light.outer_cone_rad * (1.0 + kRounding) ||
          light.outer_cone_rad == 0.0) {
        throw_input_error(spot->where("innerConeAngle"), found, expected);
      }
      document.fault(spot->pointer("innerConeAngle"), found, expected, "the edge is sharp");
      light.inner_cone_rad = light.outer_cone_rad * (1.0 - kRounding);
    }
  }
  if (const Json* extension = find_extension(json, "ABBE_light")) {
    const Fields abbe(document, *extension, pointer + "/extensions/ABBE_light");
    abbe.only({"spectrum", "beam", "shape"});
    if (const auto beam = abbe.object("beam")) {
      if (light.type != LightType::Directional) {
        throw_input_error(document.where(beam->pointer()), "a beam of a " + type + " light",
                          "one of a directional light");
      }
      beam->only({"width", "height"});
      light.beam = BeamSize{positive(*beam, "width"), positive(*beam, "height")};
    }
    if (const auto shape = abbe.object("shape")) {
      light.shape = read_lamp_shape(*shape, light, type);
    }
    if (abbe.has("spectrum")) {
      light.spectrum = spectra.read(abbe, "spectrum", SpectrumUse::Emission);
    }
  }
  return light;
}

std::optional<Shape> read_shape(Document& document, int mesh) {
  const Json* extension = find_extension(document, "meshes", mesh, "ABBE_shape");
  if (extension == nullptr) return std::nullopt;
  const Fields fields(document, *extension, fmt::format("/meshes/{}/extensions/ABBE_shape", mesh));
  fields.only({"sphere", "convex"});
  if (fields.has("sphere") == fields.has("convex")) {
    throw_input_error(document.where(fields.pointer()),
                      fields.has("sphere") ? "sphere and convex" : "no shape", "exactly one",
                      {"sphere", "convex"});
  }
  Shape shape;
  if (const auto sphere = fields.object("sphere")) {
    sphere->only({"radius"});
    shape.geometry = SphereShape{positive(*sphere, "radius")};
  } else if (const auto convex = fields.object("convex")) {
    ConvexShape body{read_planes(*convex)};
    if (!is_bounded(body)) {
      throw_input_error(convex->where("planes"), "planes that leave the body open",
                        "planes all around it, their normals pointing out");
    }
    if (corners_of(body).empty()) {
      throw_input_error(convex->where("planes"), "planes that leave no body between them",
                        "planes with a body inside");
    }
    shape.geometry = std::move(body);
  }
  return shape;
}

void apply_abbe_scene(Document& document, int scene_index, Spectra& spectra, Scene& scene) {
  const Json* extension = find_extension(document, "scenes", scene_index, "ABBE_scene");
  if (extension == nullptr) return;
  const Fields fields(document, *extension,
                      fmt::format("/scenes/{}/extensions/ABBE_scene", scene_index));
  fields.only({"ambient", "environment", "exposure", "fog", "colorspace"});
  if (fields.has("exposure")) scene.exposure_ev = fields.required_number("exposure", {-64.0, 64.0});
  if (fields.has("colorspace")) {
    scene.color_space =
        rgb_space_from_name(fields.required_text("colorspace"), fields.where("colorspace"));
  }
  if (const auto fog = fields.object("fog")) {
    fog->only({"extinction", "albedo"});
    Fog result;
    result.extinction_per_m = fog->required_number("extinction", {0.0, 1e6});
    if (fog->has("albedo")) {
      result.albedo = spectra.read(*fog, "albedo", SpectrumUse::Reflectance).spectrum;
    }
    scene.fog = std::move(result);
  }
  if (const auto ambient = fields.object("ambient")) {
    ambient->only({"luminance", "spectrum"});
    Ambient result;
    result.luminance_cd_per_m2 = ambient->required_number("luminance", {0.0, 1e12});
    result.spectrum = spectra.lamp(*ambient);
    scene.ambient = std::move(result);
  }
  if (const auto environment = fields.object("environment")) {
    scene.environment = read_environment(document, *environment, spectra);
    if (scene.ambient) {
      document.notes().warn(fields.where("ambient"),
                            "not used: the environment beside it takes its place");
    }
  }
}

}  // namespace abbe::gltf
