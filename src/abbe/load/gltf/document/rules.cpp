#include "abbe/load/gltf/document/rules.h"

namespace abbe::gltf {
namespace {

using Rules = std::vector<Rule>;

Rules object(const char* path, bool required = false) {
  return {{path, Is::Object, required}};
}
Rules array(const char* path) {
  return {{path, Is::Array, false, 0, kMaxElements}};
}
// An array, and what each of its elements is.
Rules array_of(Is element, const std::string& path, double low = 0, double high = kMaxElements,
               bool required = false) {
  return {{path, Is::Array, required, low, high}, {path + "/*", element}};
}
Rules number(const char* path) {
  return {{path, Is::Number}};
}
Rules integer(const char* path, double low, double high, bool required = false) {
  return {{path, Is::Integer, required, low, high}};
}
Rules index(const char* path, const char* target, bool required = false) {
  return {{path, Is::Index, required, 0, 0, target}};
}
Rules texture(const std::string& path) {
  return {{path, Is::Object}, {path + "/index", Is::Index, true, 0, 0, "/textures"}};
}
Rules text(const char* path, bool required = false) {
  return {{path, Is::Text, required}};
}
Rules boolean(const char* path) {
  return {{path, Is::Boolean}};
}

Rules flattened(const std::vector<Rules>& parts) {
  Rules all;
  for (const Rules& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace

const std::vector<Rule>& structure_rules() {
  static const std::vector<Rule> kRules = flattened({
      object("/asset", true),
      text("/asset/version", true),
      array_of(Is::Text, "/extensionsUsed"),
      array_of(Is::Text, "/extensionsRequired"),
      object("/extensions"),
      object("/extensions/KHR_lights_punctual"),
      array_of(Is::Object, "/extensions/KHR_lights_punctual/lights"),
      object("/extensions/EXT_lights_image_based"),
      array_of(Is::Object, "/extensions/EXT_lights_image_based/lights", 0, kMaxElements, true),
      array_of(Is::Array, "/extensions/EXT_lights_image_based/lights/*/specularImages", 1,
               kMaxElements, true),
      object("/extensions/KHR_materials_variants"),
      array_of(Is::Object, "/extensions/KHR_materials_variants/variants", 0, kMaxElements, true),
      text("/extensions/KHR_materials_variants/variants/*/name", true),

      array_of(Is::Object, "/buffers"),
      integer("/buffers/*/byteLength", 1, kLargestInteger, true),
      text("/buffers/*/uri"),
      array_of(Is::Object, "/bufferViews"),
      index("/bufferViews/*/buffer", "/buffers", true),
      integer("/bufferViews/*/byteOffset", 0, kLargestInteger),
      integer("/bufferViews/*/byteLength", 1, kLargestInteger, true),
      integer("/bufferViews/*/byteStride", 0, 252),
      object("/bufferViews/*/extensions"),
      object("/bufferViews/*/extensions/*"),
      index("/bufferViews/*/extensions/EXT_meshopt_compression/buffer", "/buffers", true),
      integer("/bufferViews/*/extensions/EXT_meshopt_compression/byteOffset", 0, kLargestInteger),
      integer("/bufferViews/*/extensions/EXT_meshopt_compression/byteLength", 1, kLargestInteger,
              true),
      integer("/bufferViews/*/extensions/EXT_meshopt_compression/byteStride", 1, 256, true),
      integer("/bufferViews/*/extensions/EXT_meshopt_compression/count", 1, kLargestInteger, true),
      text("/bufferViews/*/extensions/EXT_meshopt_compression/mode", true),
      text("/bufferViews/*/extensions/EXT_meshopt_compression/filter"),
      array_of(Is::Object, "/accessors"),
      index("/accessors/*/bufferView", "/bufferViews"),
      integer("/accessors/*/byteOffset", 0, kLargestInteger),
      integer("/accessors/*/componentType", 5120, 5126, true),
      integer("/accessors/*/count", 0, kLargestInteger, true),
      text("/accessors/*/type", true),
      boolean("/accessors/*/normalized"),
      array_of(Is::Number, "/accessors/*/min", 1, 16),
      array_of(Is::Number, "/accessors/*/max", 1, 16),
      object("/accessors/*/sparse"),
      integer("/accessors/*/sparse/count", 1, 2147483647.0, true),
      object("/accessors/*/sparse/indices", true),
      index("/accessors/*/sparse/indices/bufferView", "/bufferViews", true),
      integer("/accessors/*/sparse/indices/byteOffset", 0, 2147483647.0),
      integer("/accessors/*/sparse/indices/componentType", 5120, 5126, true),
      object("/accessors/*/sparse/values", true),
      index("/accessors/*/sparse/values/bufferView", "/bufferViews", true),
      integer("/accessors/*/sparse/values/byteOffset", 0, 2147483647.0),

      array_of(Is::Object, "/images"),
      text("/images/*/uri"),
      text("/images/*/mimeType"),
      index("/images/*/bufferView", "/bufferViews"),
      index("/extensions/EXT_lights_image_based/lights/*/specularImages/*/*", "/images"),
      array_of(Is::Object, "/samplers"),
      integer("/samplers/*/magFilter", 0, 65535),
      integer("/samplers/*/minFilter", 0, 65535),
      integer("/samplers/*/wrapS", 0, 65535),
      integer("/samplers/*/wrapT", 0, 65535),
      array_of(Is::Object, "/textures"),
      index("/textures/*/source", "/images"),
      object("/textures/*/extensions"),
      object("/textures/*/extensions/*"),
      index("/textures/*/extensions/EXT_texture_webp/source", "/images", true),
      index("/textures/*/sampler", "/samplers"),

      array_of(Is::Object, "/materials"),
      object("/materials/*/pbrMetallicRoughness"),
      array_of(Is::Number, "/materials/*/pbrMetallicRoughness/baseColorFactor", 4, 4),
      number("/materials/*/pbrMetallicRoughness/metallicFactor"),
      number("/materials/*/pbrMetallicRoughness/roughnessFactor"),
      texture("/materials/*/pbrMetallicRoughness/baseColorTexture"),
      texture("/materials/*/pbrMetallicRoughness/metallicRoughnessTexture"),
      texture("/materials/*/normalTexture"),
      number("/materials/*/normalTexture/scale"),
      texture("/materials/*/occlusionTexture"),
      texture("/materials/*/emissiveTexture"),
      array_of(Is::Number, "/materials/*/emissiveFactor", 3, 3),
      text("/materials/*/alphaMode"),
      number("/materials/*/alphaCutoff"),
      boolean("/materials/*/doubleSided"),
      object("/materials/*/extensions"),
      object("/materials/*/extensions/*"),

      array_of(Is::Object, "/meshes"),
      array_of(Is::Object, "/meshes/*/primitives", 0, kMaxElements, true),
      object("/meshes/*/primitives/*/attributes", true),
      index("/meshes/*/primitives/*/attributes/*", "/accessors"),
      index("/meshes/*/primitives/*/indices", "/accessors"),
      index("/meshes/*/primitives/*/material", "/materials"),
      integer("/meshes/*/primitives/*/mode", 0, 6),
      array_of(Is::Object, "/meshes/*/primitives/*/targets"),
      index("/meshes/*/primitives/*/targets/*/*", "/accessors"),
      array_of(Is::Number, "/meshes/*/weights"),
      object("/meshes/*/primitives/*/extensions"),
      object("/meshes/*/primitives/*/extensions/*"),
      array_of(Is::Object, "/meshes/*/primitives/*/extensions/KHR_materials_variants/mappings", 0,
               kMaxElements, true),
      index("/meshes/*/primitives/*/extensions/KHR_materials_variants/mappings/*/material",
            "/materials", true),
      array_of(Is::Integer,
               "/meshes/*/primitives/*/extensions/KHR_materials_variants/mappings/*/variants", 0,
               kMaxElements, true),
      index("/meshes/*/primitives/*/extensions/KHR_draco_mesh_compression/bufferView",
            "/bufferViews", true),
      object("/meshes/*/primitives/*/extensions/KHR_draco_mesh_compression/attributes", true),
      integer("/meshes/*/primitives/*/extensions/KHR_draco_mesh_compression/attributes/*", 0,
              4294967295.0),
      object("/meshes/*/extensions"),
      object("/meshes/*/extensions/*"),

      array_of(Is::Object, "/cameras"),
      text("/cameras/*/type", true),
      object("/cameras/*/perspective"),
      number("/cameras/*/perspective/yfov"),
      number("/cameras/*/perspective/aspectRatio"),
      number("/cameras/*/perspective/znear"),
      number("/cameras/*/perspective/zfar"),
      object("/cameras/*/orthographic"),
      number("/cameras/*/orthographic/xmag"),
      number("/cameras/*/orthographic/ymag"),
      number("/cameras/*/orthographic/znear"),
      number("/cameras/*/orthographic/zfar"),

      array_of(Is::Object, "/skins"),
      array_of(Is::Integer, "/skins/*/joints", 1, kMaxElements, true),
      index("/skins/*/inverseBindMatrices", "/accessors"),
      array_of(Is::Object, "/animations"),
      array_of(Is::Object, "/animations/*/channels", 0, kMaxElements, true),
      array_of(Is::Object, "/animations/*/samplers", 0, kMaxElements, true),
      integer("/animations/*/channels/*/sampler", 0, 2147483647.0, true),
      object("/animations/*/channels/*/target", true),
      text("/animations/*/channels/*/target/path", true),
      index("/animations/*/samplers/*/input", "/accessors", true),
      index("/animations/*/samplers/*/output", "/accessors", true),
      text("/animations/*/samplers/*/interpolation"),
      array_of(Is::Object, "/nodes"),
      index("/skins/*/joints/*", "/nodes"),
      index("/animations/*/channels/*/target/node", "/nodes"),
      array("/nodes/*/children"),
      index("/nodes/*/children/*", "/nodes"),
      index("/nodes/*/mesh", "/meshes"),
      index("/nodes/*/camera", "/cameras"),
      index("/nodes/*/skin", "/skins"),
      array_of(Is::Number, "/nodes/*/matrix", 16, 16),
      array_of(Is::Number, "/nodes/*/translation", 3, 3),
      array_of(Is::Number, "/nodes/*/rotation", 4, 4),
      array_of(Is::Number, "/nodes/*/scale", 3, 3),
      array_of(Is::Number, "/nodes/*/weights"),
      object("/nodes/*/extensions"),
      object("/nodes/*/extensions/KHR_lights_punctual"),
      object("/nodes/*/extensions/KHR_node_visibility"),
      boolean("/nodes/*/extensions/KHR_node_visibility/visible"),
      object("/nodes/*/extensions/EXT_mesh_gpu_instancing"),
      object("/nodes/*/extensions/EXT_mesh_gpu_instancing/attributes", true),
      index("/nodes/*/extensions/EXT_mesh_gpu_instancing/attributes/*", "/accessors"),
      index("/nodes/*/extensions/KHR_lights_punctual/light",
            "/extensions/KHR_lights_punctual/lights", true),

      array_of(Is::Object, "/scenes"),
      array("/scenes/*/nodes"),
      index("/scenes/*/nodes/*", "/nodes"),
      object("/scenes/*/extensions"),
      object("/scenes/*/extensions/*"),
      index("/scenes/*/extensions/EXT_lights_image_based/light",
            "/extensions/EXT_lights_image_based/lights", true),
      index("/scene", "/scenes"),
  });
  return kRules;
}

}  // namespace abbe::gltf
