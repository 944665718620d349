#include "abbe/load/gltf/document/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

#include "abbe/base/error.h"
#include "abbe/load/gltf/codec/draco.h"
#include "abbe/load/gltf/codec/meshopt.h"
#include "abbe/load/gltf/document/rules.h"

namespace abbe::gltf {
namespace {

// Elements whose optional name is used in messages.
constexpr std::array kNamed = {"scenes", "nodes",    "meshes",   "materials", "cameras",
                               "images", "textures", "samplers", "accessors", "animations"};

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
  // Null, or bounds with a NaN: writers of JSON make null of it.
  static bool is_nothing(const Json& value, const Rule& rule) {
    const bool is_bound = rule.path.ends_with("/min") || rule.path.ends_with("/max");
    return value.is_null() ||
           (is_bound && value.is_array() &&
            std::any_of(value.begin(), value.end(), [](const Json& v) { return v.is_null(); }));
  }

  // The pointer is built only on the way out of an error: a vector of steps costs nothing else.
  std::string where() const { return document_.where(pointer()); }
  std::string pointer() const {
    std::string pointer;
    for (const Step& step : steps_) {
      pointer += '/';
      if (step.name.empty()) pointer += std::to_string(step.index);
      for (const char c : step.name) {
        // RFC 6901, 3.
        if (c == '~' || c == '/') {
          pointer += c == '~' ? "~0" : "~1";
        } else {
          pointer += c;
        }
      }
    }
    return pointer;
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
    auto member = value.find(head);
    if (is_last && member != value.end() && !rule.required && is_nothing(*member, rule)) {
      steps_.push_back({head, 0});
      document_.fault(pointer(), "null", expectation(rule), "it is taken as absent");
      steps_.pop_back();
      value.erase(member);
      member = value.end();
    }
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
      if (std::trunc(number) == number && std::abs(number) <= kLargestInteger) {
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
      if (rule.high >= kMaxElements) return fmt::format(" of at least {}", rule.low);
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

// glTF 2.0, 3.6.2.4: strides are multiples of 4; 0, as some write for "none", is the default.
void check_strides(Document& document) {
  if (find(&document.json(), "bufferViews") == nullptr) return;
  std::size_t i = 0;
  for (Json& view : document.json()["bufferViews"]) {
    const std::string pointer = fmt::format("/bufferViews/{}/byteStride", i++);
    const Json* stride = find(&view, "byteStride");
    if (stride == nullptr) continue;
    const auto bytes = stride->get<int>();
    if (bytes % 4 != 0) {
      throw_input_error(document.where(pointer), std::to_string(bytes),
                        "a multiple of 4 from 4 to 252");
    }
    if (bytes != 0) continue;
    document.fault(pointer, "0", "a multiple of 4 from 4 to 252", "its elements are dense");
    view.erase("byteStride");
  }
}

// Understood; what of them is approximated is said where it is read.
constexpr std::array kUnderstood = {
    "ABBE_light",
    "ABBE_material",
    "ABBE_scene",
    "ABBE_shape",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_node_visibility",
    "KHR_texture_transform",
    "EXT_lights_image_based",
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
};

// What a file may do without by its nature, even where it is listed as required: the shape and the
// placement of everything is right without it. What only tells programs something (metadata,
// behaviour, choices for a user) changes no picture.
bool is_optional(const std::string& name) {
  constexpr std::array kOthers = {"AGI_articulations",
                                  "AGI_stk_metadata",
                                  "EXT_instance_features",
                                  "EXT_mesh_features",
                                  "EXT_structural_metadata",
                                  "KHR_interactivity",
                                  "KHR_node_hoverability",
                                  "KHR_node_selectability",
                                  "KHR_xmp",
                                  "KHR_xmp_json_ld",
                                  "MSFT_lod"};
  return name.starts_with("KHR_materials_") ||
         std::find(kOthers.begin(), kOthers.end(), name) != kOthers.end();
}

// What our own extensions belong to, as a pointer with * for a number.
constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kHomes{
    {{"ABBE_light", "/extensions/KHR_lights_punctual/lights/*"},
     {"ABBE_material", "/materials/*"},
     {"ABBE_scene", "/scenes/*"},
     {"ABBE_shape", "/meshes/*"}}};

// Warns of our own extensions where nothing reads them. `pattern` is the pointer with * for
// numbers; the depth of a document is bounded.
void warn_of_misplaced(const Json& json, const std::string& pointer, const std::string& pattern,
                       Document& document) {
  if (json.is_array()) {
    for (std::size_t i = 0; i < json.size(); ++i) {
      if (!json[i].is_structured()) return;
      warn_of_misplaced(json[i], fmt::format("{}/{}", pointer, i), pattern + "/*", document);
    }
    return;
  }
  for (const auto& [name, value] : json.items()) {
    if (name == "extensions" && value.is_object()) {
      for (const auto& [extension, content] : value.items()) {
        if (!extension.starts_with("ABBE_")) continue;
        const auto* home =
            std::find_if(kHomes.begin(), kHomes.end(),
                         [&name = extension](const auto& known) { return known.first == name; });
        if (home != kHomes.end() && home->second == pattern) continue;
        document.notes().warn(
            document.where(fmt::format("{}/extensions/{}", pointer, extension)),
            home == kHomes.end()
                ? "no such extension; ignored"
                : fmt::format("ignored: it belongs into {}/extensions", home->second));
      }
    }
    if (name != "extras" && value.is_structured()) {
      warn_of_misplaced(value, pointer + "/" + name, pattern + "/" + name, document);
    }
  }
}

// Extensions that this build may lack a library for, and what then stands for a known one.
const char* missing_library(const std::string& name) {
  if (name == "KHR_draco_mesh_compression" && !has_draco()) {
    return "a build of abbe with Draco (Debian: libdraco-dev)";
  }
  if (name == "EXT_meshopt_compression" && !has_meshopt()) {
    return "a build of abbe with meshoptimizer (Debian: libmeshoptimizer-dev)";
  }
  return nullptr;
}

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

const Json* find_extension(const Document& document, const char* array, int index,
                           const char* name) {
  return find_extension(document.json()[array][at(index)], name);
}

const Json* find_extension(const Document& document, int mesh, std::size_t primitive,
                           const char* name) {
  return find_extension(document.json()["meshes"][at(mesh)]["primitives"][primitive], name);
}

void check_structure(Document& document) {
  Json& json = document.json();
  if (!json.is_object()) {
    throw_input_error(document.file_name(), describe(json) + " as the outermost value",
                      "an object with \"asset\"");
  }
  Checker checker(document);
  for (const Rule& rule : structure_rules()) checker.check(rule);
  for (const char* collection : kNamed) {
    const std::string path = fmt::format("/{}/*/name", collection);
    checker.check({path, Is::Text});
  }
  check_strides(document);
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
  const tinygltf::Model& model = document.model();
  const auto lists = [&name](const std::vector<std::string>& names) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  return lists(model.extensionsUsed) || lists(model.extensionsRequired);
}

void check_extensions(Document& document) {
  warn_of_misplaced(document.json(), "", "", document);
  const Json* required = find(&document.json(), "extensionsRequired");
  if (required != nullptr) {
    for (std::size_t i = 0; i < required->size(); ++i) {
      const auto name = (*required)[i].get<std::string>();
      const char* const missing = missing_library(name);
      if (missing != nullptr) {
        throw_input_error(document.where(fmt::format("/extensionsRequired/{}", i)),
                          "the required extension " + name, missing);
      }
      if (is_understood(name)) continue;
      if (is_optional(name)) {
        document.fault(fmt::format("/extensionsRequired/{}", i), "the required extension " + name,
                       "a known one", "it is ignored");
      } else {
        throw_input_error(document.where(fmt::format("/extensionsRequired/{}", i)),
                          "the required extension " + name, "a known one",
                          {kUnderstood.begin(), kUnderstood.end()});
      }
    }
  }
  if (const Json* used = find(&document.json(), "extensionsUsed")) {
    for (std::size_t i = 0; i < used->size(); ++i) {
      const auto name = (*used)[i].get<std::string>();
      const bool is_said = required != nullptr && std::find(required->begin(), required->end(),
                                                            Json(name)) != required->end();
      if (!is_understood(name) && !is_said) {
        document.notes().warn(document.where(fmt::format("/extensionsUsed/{}", i)),
                              "extension " + name + " is not supported; ignored");
      }
    }
  }
}

}  // namespace abbe::gltf
