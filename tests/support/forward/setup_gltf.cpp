#include "support/forward/setup_gltf.h"

#include <cstring>
#include <nlohmann/json.hpp>

namespace abbe::test {
namespace {

using nlohmann::json;

std::string base64(const std::string& bytes) {
  static const char* const kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k > bytes.size() ? '=' : kDigits[three >> (18 - 6 * k) & 63u];
  }
  return text;
}

/// Column by column, as glTF has it: a node's axes and place.
json matrix(const Vec3d& x, const Vec3d& y, const Vec3d& z, const Vec3d& at) {
  return {x.x, x.y, x.z, 0, y.x, y.y, y.z, 0, z.x, z.y, z.z, 0, at.x, at.y, at.z, 1};
}

json material_of(const std::string& name, const Wall&) {
  return {{"name", name},
          {"doubleSided", true},
          {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 1}}},
          {"extensions",
           {{"ABBE_material", {{"reflectance", 0.8}}}, {"KHR_materials_ior", {{"ior", 1}}}}}};
}

json material_of(const std::string& name, const Mirror& mirror) {
  json material = {{"name", name},
                   {"doubleSided", true},
                   {"pbrMetallicRoughness", {{"metallicFactor", 1}, {"roughnessFactor", 0}}}};
  if (mirror.index)
    material["extensions"]["ABBE_material"]["conductor"] = {{"n", mirror.index->real()},
                                                            {"k", mirror.index->imag()}};
  return material;
}

json material_of(const std::string& name, const Dielectric& glass) {
  json abbe;
  if (glass.index.B.empty())
    abbe["dispersion"]["cauchy"] = {{"A", glass.index.constant}, {"B", 0}};
  else
    abbe["dispersion"]["sellmeier"] = {{"B", glass.index.B}, {"C", glass.index.C}};
  if (glass.absorption_per_m > 0.0) abbe["absorption"] = glass.absorption_per_m;
  if (glass.priority != 0) abbe["priority"] = glass.priority;
  return {{"name", name},
          {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0}}},
          {"extensions", {{"ABBE_material", abbe}}}};
}

/// The document with its buffer while it grows.
struct Writer {
  json document;
  std::string buffer;

  template <typename T>
  std::size_t accessor(const std::vector<T>& values, int component, std::size_t per_element) {
    const std::size_t bytes = values.size() * sizeof(T);
    document["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", bytes}});
    buffer.resize(buffer.size() + bytes);
    std::memcpy(buffer.data() + buffer.size() - bytes, values.data(), bytes);
    document["accessors"].push_back({{"bufferView", document["bufferViews"].size() - 1},
                                     {"componentType", component},
                                     {"count", values.size() / per_element},
                                     {"type", per_element == 3 ? "VEC3" : "SCALAR"}});
    return document["accessors"].size() - 1;
  }

  void add_node(json node) {
    document["scenes"][0]["nodes"].push_back(document["nodes"].size());
    document["nodes"].push_back(std::move(node));
  }

  void add_body(const FlatBody& body) {
    std::vector<float> positions;
    std::vector<std::uint32_t> indices;
    Vec3f low(1e30f), high(-1e30f);
    for (const FlatFace& face : body.faces) {
      const auto first = static_cast<std::uint32_t>(positions.size() / 3);
      for (const Vec3d& corner : face) {
        const Vec3f p(corner);
        positions.insert(positions.end(), {p.x, p.y, p.z});
        low = glm::min(low, p);
        high = glm::max(high, p);
      }
      for (std::uint32_t i = 2; i < face.size(); ++i)
        indices.insert(indices.end(), {first, first + i - 1, first + i});
    }
    const std::size_t position = accessor(positions, 5126, 3);
    document["accessors"][position]["min"] = {low.x, low.y, low.z};
    document["accessors"][position]["max"] = {high.x, high.y, high.z};
    const std::size_t index = accessor(indices, 5125, 1);
    const json primitive = {{"attributes", {{"POSITION", position}}},
                            {"indices", index},
                            {"material", document["materials"].size()}};
    add_node({{"name", body.name}, {"mesh", document["meshes"].size()}});
    document["meshes"].push_back({{"name", body.name}, {"primitives", json::array({primitive})}});
    document["materials"].push_back(std::visit(
        [&](const auto& matter) { return material_of(body.name, matter); }, body.matter));
  }
};

json light_of(const SetupLamp& lamp) {
  json light = {{"name", "lamp"},
                {"intensity", 1},
                {"extensions", {{"ABBE_light", {{"spectrum", "illuminant/E"}}}}}};
  light["type"] = lamp.kind == LampKind::Point  ? "point"
                  : lamp.kind == LampKind::Spot ? "spot"
                                                : "directional";
  if (lamp.kind == LampKind::Spot)
    light["spot"] = {{"innerConeAngle", lamp.inner_cone_rad},
                     {"outerConeAngle", lamp.outer_cone_rad}};
  return light;
}

}  // namespace

std::string gltf_text(const OpticalSetup& setup) {
  Writer writer;
  for (const char* list : {"nodes", "meshes", "materials", "accessors", "bufferViews"})
    writer.document[list] = json::array();
  for (const FlatBody& body : setup.bodies) writer.add_body(body);
  const SetupLamp& lamp = setup.lamp;
  const Vec3d z = -glm::normalize(lamp.direction);
  const Vec3d helper = std::abs(z.y) < 0.9 ? Vec3d(0, 1, 0) : Vec3d(1, 0, 0);
  const Vec3d x = glm::normalize(glm::cross(helper, z));
  json& document = writer.document;
  writer.add_node({{"name", "lamp"},
                   {"matrix", matrix(x, glm::cross(z, x), z, lamp.position)},
                   {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  const Rectangle& seen = setup.receiver;
  writer.add_node({{"name", "camera"},
                   {"camera", 0},
                   {"matrix", matrix(glm::normalize(seen.x), glm::normalize(seen.y), seen.normal(),
                                     seen.center + setup.eye_m * seen.normal())}});
  document["asset"]["version"] = "2.0";
  document["scene"] = 0;
  const json camera = {{"type", "orthographic"},
                       {"orthographic",
                        {{"xmag", glm::length(seen.x)},
                         {"ymag", glm::length(seen.y)},
                         {"znear", 1e-6},
                         {"zfar", 1e3}}}};
  const json data = {{"byteLength", writer.buffer.size()},
                     {"uri", "data:application/octet-stream;base64," + base64(writer.buffer)}};
  document["cameras"] = json::array({camera});
  document["extensions"]["KHR_lights_punctual"]["lights"] = json::array({light_of(lamp)});
  document["extensionsUsed"] = {"ABBE_light", "ABBE_material", "KHR_lights_punctual",
                                "KHR_materials_ior"};
  document["buffers"] = json::array({data});
  return document.dump(1);
}

}  // namespace abbe::test
