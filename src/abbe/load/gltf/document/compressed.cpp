#include "abbe/load/gltf/document/compressed.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "abbe/base/error.h"
#include "abbe/load/gltf/codec/draco.h"
#include "abbe/load/gltf/document/check.h"

namespace abbe::gltf {
namespace {

template <typename T, std::size_t N>
T choice(Document& document, const Json& extension, const char* name, const std::string& pointer,
         const std::array<std::pair<const char*, T>, N>& known) {
  const Json* value = find(&extension, name);
  if (value == nullptr) return known[0].second;
  std::vector<std::string> names;
  for (const auto& [text, meaning] : known) {
    if (*value == text) return meaning;
    names.emplace_back(text);
  }
  throw_input_error(document.where(pointer + "/" + name), describe(*value),
                    "a known " + std::string(name), names);
}

// Source: EXT_meshopt_compression, "JSON schema updates".
void check_stride(Document& document, const MeshoptArray& array, const std::string& pointer) {
  const std::size_t stride = array.stride;
  const bool is_index = array.mode != MeshoptMode::Attributes;
  const auto require = [&](bool is_met, const char* expected) {
    if (is_met) return;
    throw_input_error(document.where(pointer + "/byteStride"), std::to_string(stride), expected);
  };
  if (is_index) {
    require(stride == 2 || stride == 4, "2 or 4, the size of an index");
    if (array.filter != MeshoptFilter::None) {
      throw_input_error(document.where(pointer + "/filter"), "a filter of indices", "NONE");
    }
    if (array.mode == MeshoptMode::Triangles && array.count % 3 != 0) {
      throw_input_error(document.where(pointer + "/count"), std::to_string(array.count),
                        "a multiple of 3, the corners of a triangle");
    }
    return;
  }
  require(stride % 4 == 0, "a multiple of 4 up to 256");
  if (array.filter == MeshoptFilter::Octahedral) {
    require(stride == 4 || stride == 8, "4 or 8 with the filter OCTAHEDRAL");
  }
  if (array.filter == MeshoptFilter::Quaternion)
    require(stride == 8, "8 with the filter QUATERNION");
}

bool is_required(const Document& document, const char* name) {
  const auto& required = document.model().extensionsRequired;
  return std::find(required.begin(), required.end(), name) != required.end();
}

// Whether plain data stand beside the compressed ones of a view.
bool has_plain_data(const Document& document, const tinygltf::BufferView& view) {
  const std::size_t index = at(view.buffer);
  const Json& buffer = document.json()["buffers"][index];
  const Json* extension = find_extension(buffer, "EXT_meshopt_compression");
  const Json* fallback = find(extension, "fallback");
  const bool is_placeholder = fallback != nullptr && *fallback == true;
  return buffer.contains("uri") || (index == 0 && document.binary_chunk() && !is_placeholder);
}

}  // namespace

std::optional<CompressedView> compressed_view(Document& document, int buffer_view) {
  const tinygltf::BufferView& view = document.model().bufferViews[at(buffer_view)];
  const Json* extension =
      find_extension(document, "bufferViews", buffer_view, "EXT_meshopt_compression");
  if (extension == nullptr) return std::nullopt;
  const std::string home = fmt::format("/bufferViews/{}", buffer_view);
  const std::string pointer = home + "/extensions/EXT_meshopt_compression";
  if (!has_meshopt() && has_plain_data(document, view)) {
    document.notes().warn(document.where(pointer),
                          "this build has no meshoptimizer (Debian: libmeshoptimizer-dev); the "
                          "plain data beside it are used");
    return std::nullopt;
  }
  CompressedView result;
  result.buffer = (*extension)["buffer"].get<int>();
  result.offset = extension->value("byteOffset", std::uint64_t{0});
  result.length = (*extension)["byteLength"].get<std::uint64_t>();
  result.array.count = (*extension)["count"].get<std::size_t>();
  result.array.stride = (*extension)["byteStride"].get<std::size_t>();
  constexpr std::array<std::pair<const char*, MeshoptMode>, 3> kModes{
      {{"ATTRIBUTES", MeshoptMode::Attributes},
       {"TRIANGLES", MeshoptMode::Triangles},
       {"INDICES", MeshoptMode::Indices}}};
  constexpr std::array<std::pair<const char*, MeshoptFilter>, 4> kFilters{
      {{"NONE", MeshoptFilter::None},
       {"OCTAHEDRAL", MeshoptFilter::Octahedral},
       {"QUATERNION", MeshoptFilter::Quaternion},
       {"EXPONENTIAL", MeshoptFilter::Exponential}}};
  result.array.mode = choice(document, *extension, "mode", pointer, kModes);
  result.array.filter = choice(document, *extension, "filter", pointer, kFilters);
  check_stride(document, result.array, pointer);
  const std::size_t length = view.byteLength;
  if (length % result.array.stride != 0 || length / result.array.stride != result.array.count) {
    throw_input_error(
        document.where(pointer),
        fmt::format("{} elements of {} bytes", result.array.count, result.array.stride),
        fmt::format("the {} bytes of its buffer view", length));
  }
  if (view.byteStride != 0 && view.byteStride != result.array.stride) {
    throw_input_error(document.where(pointer + "/byteStride"), std::to_string(result.array.stride),
                      fmt::format("{}, as its buffer view has", view.byteStride));
  }
  return result;
}

std::optional<std::vector<std::uint32_t>> decode_primitive(Document& document, Accessors& accessors,
                                                           int mesh, std::size_t primitive) {
  const std::string pointer = fmt::format("/meshes/{}/primitives/{}", mesh, primitive);
  const std::string place = pointer + "/extensions/KHR_draco_mesh_compression";
  const tinygltf::Model& model = document.model();
  const Json* extension = find_extension(document, mesh, primitive, "KHR_draco_mesh_compression");
  if (extension == nullptr) return std::nullopt;
  const tinygltf::Primitive& source = model.meshes[at(mesh)].primitives[primitive];

  std::vector<int> used;
  std::vector<DracoAttribute> wanted;
  bool has_plain = true;
  for (const auto& [name, id] : (*extension)["attributes"].items()) {
    const std::string where = document.where(place + "/attributes/" + name);
    const auto attribute = source.attributes.find(name);
    if (attribute == source.attributes.end()) {
      throw_input_error(where, "an attribute that the primitive lacks", "one of the primitive's");
    }
    const tinygltf::Accessor& accessor = model.accessors[at(attribute->second)];
    const int components =
        tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
    if (components < 1 || components > 4) {
      throw_input_error(where, "an accessor of a matrix", "a scalar or vector");
    }
    used.push_back(attribute->second);
    wanted.push_back({id.get<std::uint32_t>(), accessor.componentType, components, where});
    has_plain = has_plain && (accessor.bufferView >= 0 || accessor.sparse.isSparse);
  }
  if (!has_draco() && has_plain && !is_required(document, "KHR_draco_mesh_compression")) {
    document.notes().warn(document.where(place),
                          "this build has no Draco (Debian: libdraco-dev); the plain data beside "
                          "it are used");
    return std::nullopt;
  }
  DracoMesh decoded = decode_draco(accessors.view((*extension)["bufferView"].get<int>(), place),
                                   wanted, document.where(place));

  // Encoders merge and split vertices: the counts beside the data are often those before.
  const auto check_count = [&](int accessor, std::size_t count) {
    const std::size_t stated = model.accessors[at(accessor)].count;
    if (stated == count) return;
    document.fault(fmt::format("/accessors/{}/count", accessor), std::to_string(stated),
                   fmt::format("the {} in the compressed mesh", count), "those are used");
  };
  std::size_t bytes = decoded.indices.size() * sizeof(std::uint32_t);
  for (const auto& elements : decoded.attributes) bytes += elements.size();
  accessors.count_decompressed(bytes, place);
  for (std::size_t i = 0; i < used.size(); ++i) {
    check_count(used[i], decoded.points);
    accessors.supply(used[i], decoded.points, std::move(decoded.attributes[i]));
  }
  const bool is_list = source.mode == TINYGLTF_MODE_TRIANGLES;
  if (source.indices >= 0 && is_list) check_count(source.indices, decoded.indices.size());
  return std::move(decoded.indices);
}

}  // namespace abbe::gltf
