#include "abbe/load/gltf/document/rules.h"

namespace abbe::gltf {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

Rule object(const char* path, bool required = false) {
  return {path, Is::Object, required};
}
Rule array(const char* path, double low = 0, double high = kMaxElements, bool required = false) {
  return {path, Is::Array, required, low, high};
}
Rule number(const char* path, double low = -kInf, double high = kInf) {
  return {path, Is::Number, false, low, high};
}
Rule integer(const char* path, double low, double high, bool required = false) {
  return {path, Is::Integer, required, low, high};
}
Rule index(const char* path, const char* target, bool required = false) {
  return {path, Is::Index, required, 0, 0, target};
}
Rule text(const char* path, bool required = false) {
  return {path, Is::Text, required};
}
Rule boolean(const char* path) {
  return {path, Is::Boolean};
}

}  // namespace

const std::vector<Rule>& structure_rules() {
  static const std::vector<Rule> kRules = {
      object("/asset", true),
      text("/asset/version", true),
      array("/extensionsUsed"),
      text("/extensionsUsed/*"),
      array("/extensionsRequired"),
      text("/extensionsRequired/*"),
      object("/extensions"),
      object("/extensions/KHR_lights_punctual"),
      array("/extensions/KHR_lights_punctual/lights"),
      object("/extensions/KHR_lights_punctual/lights/*"),

      array("/buffers"),
      object("/buffers/*"),
      integer("/buffers/*/byteLength", 1, kLargestInteger, true),
      text("/buffers/*/uri"),
      array("/bufferViews"),
      object("/bufferViews/*"),
      index("/bufferViews/*/buffer", "/buffers", true),
      integer("/bufferViews/*/byteOffset", 0, kLargestInteger),
      integer("/bufferViews/*/byteLength", 1, kLargestInteger, true),
      integer("/bufferViews/*/byteStride", 4, 252),
      array("/accessors"),
      object("/accessors/*"),
      index("/accessors/*/bufferView", "/bufferViews"),
      integer("/accessors/*/byteOffset", 0, kLargestInteger),
      integer("/accessors/*/componentType", 5120, 5126, true),
      integer("/accessors/*/count", 1, kLargestInteger, true),
      text("/accessors/*/type", true),
      boolean("/accessors/*/normalized"),
      array("/accessors/*/min", 1, 16),
      number("/accessors/*/min/*"),
      array("/accessors/*/max", 1, 16),
      number("/accessors/*/max/*"),
      object("/accessors/*/sparse"),
      integer("/accessors/*/sparse/count", 1, 2147483647.0, true),
      object("/accessors/*/sparse/indices", true),
      index("/accessors/*/sparse/indices/bufferView", "/bufferViews", true),
      integer("/accessors/*/sparse/indices/byteOffset", 0, 2147483647.0),
      integer("/accessors/*/sparse/indices/componentType", 5120, 5126, true),
      object("/accessors/*/sparse/values", true),
      index("/accessors/*/sparse/values/bufferView", "/bufferViews", true),
      integer("/accessors/*/sparse/values/byteOffset", 0, 2147483647.0),

      array("/images"),
      object("/images/*"),
      text("/images/*/uri"),
      text("/images/*/mimeType"),
      index("/images/*/bufferView", "/bufferViews"),
      array("/samplers"),
      object("/samplers/*"),
      integer("/samplers/*/magFilter", 0, 65535),
      integer("/samplers/*/minFilter", 0, 65535),
      integer("/samplers/*/wrapS", 0, 65535),
      integer("/samplers/*/wrapT", 0, 65535),
      array("/textures"),
      object("/textures/*"),
      index("/textures/*/source", "/images"),
      index("/textures/*/sampler", "/samplers"),

      array("/materials"),
      object("/materials/*"),
      object("/materials/*/pbrMetallicRoughness"),
      array("/materials/*/pbrMetallicRoughness/baseColorFactor", 4, 4),
      number("/materials/*/pbrMetallicRoughness/baseColorFactor/*"),
      number("/materials/*/pbrMetallicRoughness/metallicFactor"),
      number("/materials/*/pbrMetallicRoughness/roughnessFactor"),
      object("/materials/*/pbrMetallicRoughness/baseColorTexture"),
      index("/materials/*/pbrMetallicRoughness/baseColorTexture/index", "/textures", true),
      object("/materials/*/pbrMetallicRoughness/metallicRoughnessTexture"),
      index("/materials/*/pbrMetallicRoughness/metallicRoughnessTexture/index", "/textures", true),
      object("/materials/*/normalTexture"),
      index("/materials/*/normalTexture/index", "/textures", true),
      number("/materials/*/normalTexture/scale"),
      object("/materials/*/occlusionTexture"),
      index("/materials/*/occlusionTexture/index", "/textures", true),
      object("/materials/*/emissiveTexture"),
      index("/materials/*/emissiveTexture/index", "/textures", true),
      array("/materials/*/emissiveFactor", 3, 3),
      number("/materials/*/emissiveFactor/*"),
      text("/materials/*/alphaMode"),
      number("/materials/*/alphaCutoff"),
      boolean("/materials/*/doubleSided"),
      object("/materials/*/extensions"),
      object("/materials/*/extensions/*"),

      array("/meshes"),
      object("/meshes/*"),
      array("/meshes/*/primitives", 1, kMaxElements, true),
      object("/meshes/*/primitives/*"),
      object("/meshes/*/primitives/*/attributes", true),
      index("/meshes/*/primitives/*/attributes/*", "/accessors"),
      index("/meshes/*/primitives/*/indices", "/accessors"),
      index("/meshes/*/primitives/*/material", "/materials"),
      integer("/meshes/*/primitives/*/mode", 0, 6),
      array("/meshes/*/primitives/*/targets"),
      object("/meshes/*/primitives/*/targets/*"),
      index("/meshes/*/primitives/*/targets/*/*", "/accessors"),
      array("/meshes/*/weights"),
      number("/meshes/*/weights/*"),
      object("/meshes/*/extensions"),
      object("/meshes/*/extensions/*"),

      array("/cameras"),
      object("/cameras/*"),
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

      array("/skins"),
      array("/nodes"),
      object("/nodes/*"),
      array("/nodes/*/children"),
      index("/nodes/*/children/*", "/nodes"),
      index("/nodes/*/mesh", "/meshes"),
      index("/nodes/*/camera", "/cameras"),
      index("/nodes/*/skin", "/skins"),
      array("/nodes/*/matrix", 16, 16),
      number("/nodes/*/matrix/*"),
      array("/nodes/*/translation", 3, 3),
      number("/nodes/*/translation/*"),
      array("/nodes/*/rotation", 4, 4),
      number("/nodes/*/rotation/*"),
      array("/nodes/*/scale", 3, 3),
      number("/nodes/*/scale/*"),
      array("/nodes/*/weights"),
      number("/nodes/*/weights/*"),
      object("/nodes/*/extensions"),
      object("/nodes/*/extensions/KHR_lights_punctual"),
      index("/nodes/*/extensions/KHR_lights_punctual/light",
            "/extensions/KHR_lights_punctual/lights", true),

      array("/scenes"),
      object("/scenes/*"),
      array("/scenes/*/nodes"),
      index("/scenes/*/nodes/*", "/nodes"),
      object("/scenes/*/extensions"),
      object("/scenes/*/extensions/*"),
      index("/scene", "/scenes"),
  };
  return kRules;
}

}  // namespace abbe::gltf
