#include "load/gltf_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace abbe::gltf {
namespace {

enum class Is {
  Object,
  Array,    // low to high elements
  Number,   // low to high
  Integer,  // low to high
  Index,    // into the array at `target`
  Text,
  Boolean,
};

// One fact about a document. `path` is a JSON pointer in which * stands for every element or
// member.
struct Rule {
  const char* path;
  Is type;
  bool required = false;
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  const char* target = "";
};

constexpr double kMany = 4294967296.0;         // Elements of an array, at most.
constexpr double kLarge = 9007199254740992.0;  // Integers up to here are exact: 2^53.
constexpr double kInf = std::numeric_limits<double>::infinity();

Rule object(const char* path, bool required = false) {
  return {path, Is::Object, required};
}
Rule array(const char* path, double low = 0, double high = kMany, bool required = false) {
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

// In this order: what a later rule walks through, an earlier one has checked.
const std::vector<Rule>& rules() {
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
      integer("/buffers/*/byteLength", 1, kLarge, true),
      text("/buffers/*/uri"),
      array("/bufferViews"),
      object("/bufferViews/*"),
      index("/bufferViews/*/buffer", "/buffers", true),
      integer("/bufferViews/*/byteOffset", 0, kLarge),
      integer("/bufferViews/*/byteLength", 1, kLarge, true),
      integer("/bufferViews/*/byteStride", 4, 252),
      array("/accessors"),
      object("/accessors/*"),
      index("/accessors/*/bufferView", "/bufferViews"),
      integer("/accessors/*/byteOffset", 0, kLarge),
      integer("/accessors/*/componentType", 5120, 5126, true),
      integer("/accessors/*/count", 1, kLarge, true),
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
      array("/meshes/*/primitives", 1, kMany, true),
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

// Elements whose optional name is used in messages.
constexpr std::array kNamed = {"scenes", "nodes",    "meshes",   "materials", "cameras",
                               "images", "textures", "samplers", "accessors"};

class Checker {
 public:
  explicit Checker(Document& document) : document_(document) {}

  void check(const Rule& rule) {
    if (rule.type == Is::Index) {
      const Json::json_pointer target{std::string(rule.target)};
      target_size_ = document_.json().contains(target) ? document_.json().at(target).size() : 0;
    }
    visit(document_.json(), rule, std::string_view(rule.path).substr(1));
  }

 private:
  // The pointer is built only on the way out of an error: a vector of steps costs nothing else.
  std::string where() const {
    std::string pointer;
    for (const Step& step : steps_) {
      pointer += '/';
      pointer += step.name.empty() ? std::to_string(step.index) : std::string(step.name);
    }
    return document_.where(pointer);
  }

  void visit(Json& value, const Rule& rule, std::string_view path) {
    const std::size_t slash = path.find('/');
    const std::string_view head = path.substr(0, slash);
    const bool is_last = slash == std::string_view::npos;
    const auto step_into = [&](Json& child, Step step) {
      steps_.push_back(step);
      if (is_last) {
        check_value(child, rule);
      } else {
        visit(child, rule, path.substr(slash + 1));
      }
      steps_.pop_back();
    };
    if (head == "*") {
      std::size_t i = 0;
      for (auto it = value.begin(); it != value.end(); ++it, ++i) {
        step_into(*it, {value.is_object() ? std::string_view(it.key()) : std::string_view(), i});
      }
      return;
    }
    const auto member = value.find(head);
    if (member != value.end()) {
      step_into(*member, {head, 0});
    } else if (is_last && rule.required) {
      throw_input_error(where(), fmt::format("no \"{}\"", head), expectation(rule));
    }
  }

  void check_value(Json& value, const Rule& rule) {
    // 3.0 is an integer to JSON Schema, though not to tinygltf.
    if ((rule.type == Is::Integer || rule.type == Is::Index) && value.is_number_float()) {
      const auto number = value.get<double>();
      if (std::trunc(number) == number && std::abs(number) <= kLarge) {
        value = static_cast<std::int64_t>(number);
      }
    }
    if (!fits(value, rule)) throw_input_error(where(), describe(value), expectation(rule));
  }

  bool fits(const Json& value, const Rule& rule) const {
    const auto in_range = [&rule](double x) { return x >= rule.low && x <= rule.high; };
    switch (rule.type) {
      case Is::Object:
        return value.is_object();
      case Is::Array:
        return value.is_array() && in_range(static_cast<double>(value.size()));
      case Is::Number:
        return value.is_number() && std::isfinite(value.get<double>()) &&
               in_range(value.get<double>());
      case Is::Integer:
        return value.is_number_integer() && in_range(value.get<double>());
      case Is::Index:
        return value.is_number_integer() && value.get<double>() >= 0 &&
               value.get<double>() < static_cast<double>(target_size_);
      case Is::Text:
        return value.is_string();
      case Is::Boolean:
        return value.is_boolean();
    }
    return false;
  }

  std::string expectation(const Rule& rule) const {
    const auto range = [&rule]() -> std::string {
      if (rule.low == rule.high) return fmt::format(" {}", rule.low);
      if (std::isinf(rule.low) && std::isinf(rule.high)) return "";
      if (rule.high >= kMany) return fmt::format(" of at least {}", rule.low);
      return fmt::format(" from {} to {}", rule.low, rule.high);
    };
    switch (rule.type) {
      case Is::Object:
        return "an object";
      case Is::Array:
        if (rule.low == rule.high) return fmt::format("an array of {}", rule.low);
        return rule.low > 0 ? fmt::format("an array of at least {}", rule.low) : "an array";
      case Is::Number:
        return "a number" + range();
      case Is::Integer:
        return "an integer" + range();
      case Is::Index:
        return target_size_ == 0
                   ? fmt::format("no index: {} is empty", rule.target)
                   : fmt::format("an index into {}, 0 to {}", rule.target, target_size_ - 1);
      case Is::Text:
        return "a string";
      case Is::Boolean:
        return "true or false";
    }
    return "";
  }

  struct Step {
    std::string_view name;  // A member, or empty for an element of an array.
    std::size_t index;
  };

  Document& document_;
  std::vector<Step> steps_;
  std::size_t target_size_ = 0;
};

// Understood; what of them is approximated is said where it is read.
constexpr std::array kUnderstood = {
    "ABBE_light",
    "ABBE_material",
    "ABBE_scene",
    "ABBE_shape",
    "KHR_lights_punctual",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
};

bool is_understood(const std::string& name) {
  return std::find(kUnderstood.begin(), kUnderstood.end(), name) != kUnderstood.end();
}

}  // namespace

std::string describe(const Json& value) {
  if (value.is_string()) {
    const auto& string = value.get_ref<const std::string&>();
    return "\"" + (string.size() > 100 ? string.substr(0, 100) + "..." : string) + "\"";
  }
  if (value.is_array()) return fmt::format("an array of {}", value.size());
  if (value.is_object()) return "an object";
  if (value.is_null()) return "null";
  return value.dump();
}

const Json* find(const Json* object, const char* name) {
  if (object == nullptr || !object->is_object()) return nullptr;
  const auto member = object->find(name);
  return member == object->end() ? nullptr : &*member;
}

const Json* find_extension(const Json& element, const char* name) {
  return find(find(&element, "extensions"), name);
}

void check_structure(Document& document) {
  Json& json = document.json();
  if (!json.is_object()) {
    throw_input_error(document.file_name(), describe(json) + " as the outermost value",
                      "an object with \"asset\"");
  }
  Checker checker(document);
  for (const Rule& rule : rules()) checker.check(rule);
  for (const char* collection : kNamed) {
    const std::string path = fmt::format("/{}/*/name", collection);
    checker.check(text(path.c_str()));
  }
  const auto version = json["asset"]["version"].get<std::string>();
  const auto min_version = json["asset"].value("minVersion", Json("2.0"));
  if (version.rfind("2.", 0) != 0) {
    throw_input_error(document.where("/asset/version"), describe(json["asset"]["version"]),
                      "\"2.0\"");
  }
  if (min_version != "2.0") {
    throw_input_error(document.where("/asset/minVersion"), describe(min_version), "\"2.0\"");
  }
}

bool uses_extension(const Document& document, const std::string& name) {
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
    const Json* names = find(&document.json(), list);
    if (names != nullptr && std::find(names->begin(), names->end(), Json(name)) != names->end()) {
      return true;
    }
  }
  return false;
}

void check_extensions(Document& document) {
  if (const Json* required = find(&document.json(), "extensionsRequired")) {
    for (std::size_t i = 0; i < required->size(); ++i) {
      const auto name = (*required)[i].get<std::string>();
      if (!is_understood(name)) {
        throw_input_error(document.where(fmt::format("/extensionsRequired/{}", i)),
                          "the required extension " + name, "a known one",
                          {kUnderstood.begin(), kUnderstood.end()});
      }
    }
  }
  if (const Json* used = find(&document.json(), "extensionsUsed")) {
    for (std::size_t i = 0; i < used->size(); ++i) {
      const auto name = (*used)[i].get<std::string>();
      if (!is_understood(name)) {
        document.notes().warn(document.where(fmt::format("/extensionsUsed/{}", i)),
                              "extension " + name + " is not supported; ignored");
      }
    }
  }
}

}  // namespace abbe::gltf
