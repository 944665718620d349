// The core of a checked document, handed to tinygltf.
//
// tinygltf (2.7 and 2.9 alike) takes text only and has no word on what it drops: a member of a
// wrong type, 3.0 for 3 or -4 for an offset is as if it were not there. So the tree is judged
// first, and what tinygltf reads is moved out of it and written for it. Not handed over is what it
// reads otherwise than glTF or this reader does:
// - buffers: it reads them all at once, refuses a file longer than its byteLength (which glTF
//   3.6.1.1 allows), buffers without a uri (EXT_meshopt_compression has them for what is not there)
//   and media types it does not know, and of broken base64 takes what comes before the fault;
// - images: it takes their bytes from a buffer without looking at its size, and refuses a file for
//   one image that nothing uses;
// - cameras and KHR_lights_punctual: an unused one without znear or spot refuses the whole file;
// - extensions, and materials, which are read by the same code: a tinygltf::Value wraps integers
//   beyond 32 bits and drops null (in arrays, too: what follows moves up), [] and {}.
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "abbe/base/error.h"
#include "abbe/load/gltf/document/document.h"

namespace abbe::gltf {
namespace {

constexpr std::array kArrays = {"scenes",   "nodes",    "meshes", "accessors", "bufferViews",
                                "samplers", "textures", "skins",  "animations"};

// What is left in its place are its extensions, or nothing.
Json take_core(Json& element) {
  Json core = std::exchange(element, Json());
  core.erase("extras");
  if (const auto extensions = core.find("extensions"); extensions != core.end()) {
    element["extensions"] = std::move(*extensions);
    core.erase(extensions);
  }
  return core;
}

Json take_mesh(Json& mesh) {
  Json core = take_core(mesh);
  Json& left = mesh["primitives"] = std::exchange(core["primitives"], Json::array());
  for (Json& primitive : left) core["primitives"].push_back(take_core(primitive));
  return core;
}

}  // namespace

void Document::read_model() {
  Json core = {{"asset", {{"version", "2.0"}}}};
  for (const char* name : {"scene", "extensionsUsed", "extensionsRequired"}) {
    if (json_.contains(name)) core[name] = json_[name];
  }
  for (const char* name : kArrays) {
    Json& taken = core[name] = Json::array();
    if (!json_.contains(name)) continue;
    const auto take = std::string_view(name) == "meshes" ? take_mesh : take_core;
    for (Json& element : json_[name]) taken.push_back(take(element));
  }
  // tinygltf 2.7 drops channels that move no node of the core, and with that renumbers the others.
  for (Json& animation : core["animations"]) {
    for (Json& channel : animation["channels"]) channel["target"].emplace("node", -1);
  }
  // tinygltf 2.7 refuses indices without a bufferView, which are zeros, or sparse: accessors
  // without get one behind all others, and it is taken away again.
  const std::size_t views = core["bufferViews"].size();
  core["bufferViews"].push_back({{"buffer", 0}, {"byteLength", 1}});
  for (Json& accessor : core["accessors"]) accessor.emplace("bufferView", views);

  const std::string text = std::exchange(core, {}).dump();
  // Without buffers and images it sees no URI, and opens no file.
  tinygltf::TinyGLTF reader;
  std::string error;
  std::string warning;
  if (!reader.LoadASCIIFromString(&model_, &error, &warning, text.data(),
                                  static_cast<unsigned>(text.size()), "")) {
    while (!error.empty() && error.back() == '\n') error.pop_back();
    throw_input_error(file_name_, error, "glTF 2.0");
  }
  model_.bufferViews.pop_back();
  for (tinygltf::Accessor& accessor : model_.accessors) {
    if (accessor.bufferView == static_cast<int>(views)) accessor.bufferView = -1;
  }
}

}  // namespace abbe::gltf
