#include "abbe/load/gltf/variants.h"

#include <algorithm>

#include "abbe/base/error.h"
#include "abbe/base/text.h"
#include "abbe/load/gltf/document/check.h"

namespace abbe::gltf {

std::vector<std::string> variant_names(const Document& document) {
  std::vector<std::string> names;
  if (const Json* extension = find_extension(document.json(), "KHR_materials_variants")) {
    for (const Json& variant : (*extension)["variants"]) {
      names.push_back(variant["name"].get<std::string>());
    }
  }
  return names;
}

std::optional<std::size_t> chosen_variant(const Document& document, const std::string& name) {
  if (name.empty()) return std::nullopt;
  const std::vector<std::string> names = variant_names(document);
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    throw_usage_error("variant", in_quotes(name), "a variant of " + document.file_name(), names);
  }
  return static_cast<std::size_t>(found - names.begin());
}

int material_of(const Document& document, int mesh, std::size_t primitive,
                std::optional<std::size_t> variant) {
  const Json* extension =
      variant ? find_extension(document, mesh, primitive, "KHR_materials_variants") : nullptr;
  if (extension != nullptr) {
    for (const Json& mapping : (*extension)["mappings"]) {
      const Json& variants = mapping["variants"];
      if (std::find(variants.begin(), variants.end(), Json(*variant)) != variants.end()) {
        return mapping["material"].get<int>();
      }
    }
  }
  return document.model().meshes[at(mesh)].primitives[primitive].material;
}

}  // namespace abbe::gltf
