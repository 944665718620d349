#include "scenes.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace abbe::test {
namespace {

using Json = nlohmann::json;

Json document() {
  return Json::parse(R"({
    "asset": {"version": "2.0"},
    "extensionsUsed": ["ABBE_material", "ABBE_shape", "KHR_lights_punctual"],
    "scene": 0,
    "scenes": [{"name": "stage", "nodes": []}],
    "nodes": [],
    "meshes": [],
    "accessors": [{"componentType": 5126, "count": 3, "type": "VEC3",
                   "min": [0, 0, 0], "max": [0, 0, 0]}],
    "materials": [
      {"name": "flint", "extensions": {"ABBE_material": {"dispersion": {"glass": "N-SF11"}}}},
      {"name": "red", "pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.1, 0.1, 1],
                                               "metallicFactor": 0, "roughnessFactor": 0.9}}]
  })");
}

void add_node(Json& document, const Json& node) {
  document["scenes"][0]["nodes"].push_back(document["nodes"].size());
  document["nodes"].push_back(node);
}

void add_shape(Json& document, const std::string& name, const Json& shape, int material,
               const Json& place) {
  const std::size_t mesh = document["meshes"].size();
  document["meshes"].push_back(
      {{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"material", material}}}},
       {"extensions", {{"ABBE_shape", shape}}}});
  add_node(document, {{"name", name}, {"mesh", mesh}, {"translation", place}});
}

Json sphere(double radius_m) {
  return {{"sphere", {{"radius", radius_m}}}};
}

void add_lamp(Json& document, double candela, const Json& place) {
  document["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"intensity", candela}}};
  add_node(document,
           {{"translation", place}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
}

void add_camera(Json& document, const Json& camera, const Json& place) {
  document["cameras"] = Json::array({camera});
  add_node(document, {{"name", "eye"}, {"camera", 0}, {"translation", place}});
}

// Planes that stand upright, seen by an orthographic camera from the front.
std::string prism(Json planes, double camera_x) {
  Json scene = document();
  planes.push_back({0, 1, 0, 1});
  planes.push_back({0, -1, 0, 1});
  add_shape(scene, "prism", {{"convex", {{"planes", planes}}}}, 0, {0, 0, 0});
  add_camera(scene,
             {{"type", "orthographic"},
              {"orthographic", {{"xmag", 0.01}, {"ymag", 0.01}, {"znear", 0.1}, {"zfar", 10}}}},
             {camera_x, 0, 4});
  add_lamp(scene, 1.0, {0, 5, 4});  // Without one the default rig would surround the prism.
  return scene.dump(1);
}

}  // namespace

std::string small_scene() {
  Json scene = document();
  add_shape(scene, "ball", sphere(1.0), 0, {0, 0, 0});
  add_shape(scene, "wall", sphere(3.0), 1, {1, 0.5, -6});
  add_camera(scene, {{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}},
             {0, 0, 6});
  add_lamp(scene, 100.0, {4, 5, 4});
  return scene.dump(1);
}

std::string dark_scene() {
  Json scene = document();
  add_shape(scene, "ball", sphere(1.0), 0, {0, 0, 0});
  return scene.dump(1);
}

std::string prism_scene() {
  constexpr double kRadians = 3.14159265358979323846 / 180.0;
  constexpr double kIncidence_deg = 63.1713;
  Json planes = Json::array();
  for (int face = 0; face < 3; ++face) {
    const double angle = (kIncidence_deg + 120.0 * face) * kRadians;
    planes.push_back({std::sin(angle), 0.0, std::cos(angle), 0.5});
  }
  return prism(planes, 0.5 * std::sin(kIncidence_deg * kRadians));
}

std::string mask_scene() {
  // Four positions, six indices, four colours 1, 1, 1, 0.3.
  const std::string bytes =
      "AAAQwQAAEMEAAADAAAAQQQAAEMEAAADAAAAQQQAAEEEAAADAAAAQwQAAEEEAAADAAAABAAIAAAACAAMA"
      "AACAPwAAgD8AAIA/mpmZPgAAgD8AAIA/AACAP5qZmT4AAIA/AACAPwAAgD+amZk+AACAPwAAgD8AAIA/"
      "mpmZPg==";
  Json scene = document();
  scene["buffers"] = {
      {{"byteLength", 124}, {"uri", "data:application/octet-stream;base64," + bytes}}};
  scene["bufferViews"] = {{{"buffer", 0}, {"byteLength", 48}},
                          {{"buffer", 0}, {"byteOffset", 48}, {"byteLength", 12}},
                          {{"buffer", 0}, {"byteOffset", 60}, {"byteLength", 64}}};
  scene["accessors"] = {
      {{"bufferView", 0},
       {"componentType", 5126},
       {"count", 4},
       {"type", "VEC3"},
       {"min", {-9, -9, -2}},
       {"max", {9, 9, -2}}},
      {{"bufferView", 1}, {"componentType", 5123}, {"count", 6}, {"type", "SCALAR"}},
      {{"bufferView", 2}, {"componentType", 5126}, {"count", 4}, {"type", "VEC4"}}};
  scene["materials"][1]["alphaMode"] = "MASK";
  scene["materials"][1]["alphaCutoff"] = 0.3;
  scene["materials"][1]["emissiveFactor"] = {1, 1, 1};
  scene["meshes"] = {
      {{"primitives",
        {{{"attributes", {{"POSITION", 0}, {"COLOR_0", 2}}}, {"indices", 1}, {"material", 1}}}}}};
  add_node(scene, {{"mesh", 0}});
  add_camera(scene, {{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}},
             {0, 0, 2});
  return scene.dump(1);
}

std::string right_angle_prism_scene() {
  return prism({{0, 0, 1, 0.5}, {1, 0, -1, 0}, {-1, 0, 0, 0.5}}, 0.0);
}

}  // namespace abbe::test
