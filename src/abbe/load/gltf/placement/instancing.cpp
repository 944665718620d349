#include "abbe/load/gltf/placement/instancing.h"

#include <fmt/format.h>

#include <optional>
#include <string>

#include "abbe/base/error.h"
#include "abbe/load/gltf/document/check.h"
#include "abbe/load/gltf/placement/transform.h"

namespace abbe::gltf {

std::vector<Mat4d> instance_places(Document& document, Accessors& accessors, int node) {
  const Json* extension = find_extension(document, "nodes", node, "EXT_mesh_gpu_instancing");
  if (extension == nullptr) return {Mat4d(1.0)};
  const Json& attributes = (*extension)["attributes"];
  const std::string pointer =
      fmt::format("/nodes/{}/extensions/EXT_mesh_gpu_instancing/attributes", node);
  std::optional<std::size_t> count;
  for (const auto& [name, accessor] : attributes.items()) {
    const std::size_t found = accessors.count(accessor.get<int>());
    if (count && *count != found) {
      throw_input_error(document.where(pointer + "/" + name), fmt::format("{} elements", found),
                        fmt::format("as many as the others have, {}", *count));
    }
    count = found;
  }
  const std::size_t places = count.value_or(0);
  if (places == 0) {
    document.fault(pointer, "no place", "at least one", "its mesh is not rendered");
  }
  accessors.spend(places, pointer);
  const auto accessor_of = [&](const char* name) -> std::optional<int> {
    const Json* accessor = find(&attributes, name);
    return accessor == nullptr ? std::nullopt : std::optional(accessor->get<int>());
  };
  std::vector<Transform> transforms(places);
  if (const auto accessor = accessor_of("TRANSLATION")) {
    const auto values =
        accessors.vec3(*accessor, pointer + "/TRANSLATION", Components::FloatOrNormalized);
    for (std::size_t i = 0; i < places; ++i) transforms[i].translation = Vec3d(values[i]);
  }
  if (const auto accessor = accessor_of("ROTATION")) {
    const auto values =
        accessors.vec4(*accessor, pointer + "/ROTATION", Components::FloatOrNormalized);
    for (std::size_t i = 0; i < places; ++i) transforms[i].rotation = Vec4d(values[i]);
  }
  if (const auto accessor = accessor_of("SCALE")) {
    const auto values =
        accessors.vec3(*accessor, pointer + "/SCALE", Components::FloatOrNormalized);
    for (std::size_t i = 0; i < places; ++i) transforms[i].scale = Vec3d(values[i]);
  }
  std::vector<Mat4d> matrices;
  matrices.reserve(places);
  for (const Transform& transform : transforms) {
    matrices.push_back(matrix_of(transform, document.where(pointer), document.notes()));
  }
  return matrices;
}

}  // namespace abbe::gltf
