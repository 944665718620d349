#include "abbe/load/gltf/document/accessors.h"

#include <fmt/format.h>

#include <algorithm>

#include "abbe/base/error.h"
#include "abbe/load/gltf/document/check.h"
#include "abbe/load/gltf/document/components.h"
#include "abbe/load/gltf/document/compressed.h"

namespace abbe::gltf {

Accessors::Accessors(Document& document) : document_(document), model_(document.model()) {
  const Json* buffers = find(&document.json(), "buffers");
  buffers_.resize(buffers == nullptr ? 0 : buffers->size());
}

Bytes Accessors::buffer(int index) {
  std::optional<Bytes>& known = buffers_[at(index)];
  if (known) return *known;
  const std::string pointer = fmt::format("/buffers/{}", index);
  const Json& json = document_.json()["buffers"][at(index)];
  const auto length = json["byteLength"].get<std::uint64_t>();
  Bytes bytes;
  if (const Json* uri = find(&json, "uri")) {
    bytes = document_.read_uri(uri->get_ref<const std::string&>(), pointer + "/uri");
  } else if (index == 0 && document_.binary_chunk()) {
    bytes = *document_.binary_chunk();
  } else {
    throw_input_error(document_.where(pointer), "no uri", "a uri, or the BIN chunk of a .glb file");
  }
  if (length > bytes.size()) {
    throw_input_error(document_.where(pointer + "/byteLength"), fmt::format("{}", length),
                      fmt::format("at most the {} bytes that are there", bytes.size()));
  }
  known = bytes.first(static_cast<std::size_t>(length));
  return *known;
}

Bytes Accessors::part(int index, std::uint64_t offset, std::uint64_t length,
                      const std::string& pointer, const std::string& user) {
  const Bytes bytes = buffer(index);
  if (offset > bytes.size() || length > bytes.size() - offset) {
    throw_input_error(document_.where(pointer),
                      fmt::format("{} bytes from byte {} (used by {})", length, offset, user),
                      fmt::format("a part of the {} bytes of buffer {}", bytes.size(), index));
  }
  return bytes.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
}

Bytes Accessors::view(int buffer_view, const std::string& user) {
  const auto known = decompressed_.find(buffer_view);
  if (known != decompressed_.end()) return known->second;
  const std::string pointer = fmt::format("/bufferViews/{}", buffer_view);
  const auto compressed = compressed_view(document_, buffer_view);
  if (!compressed) {
    const tinygltf::BufferView& view = model_.bufferViews[at(buffer_view)];
    return part(view.buffer, view.byteOffset, view.byteLength, pointer, user);
  }
  const std::string place = pointer + "/extensions/EXT_meshopt_compression";
  const Bytes bytes = part(compressed->buffer, compressed->offset, compressed->length, place, user);
  std::vector<std::uint8_t> values =
      decode_meshopt(bytes, compressed->array, document_.where(place));
  count_decompressed(values.size(), place);
  return decompressed_.emplace(buffer_view, std::move(values)).first->second;
}

void Accessors::count_decompressed(std::size_t bytes, const std::string& user) {
  // Compressed data may be shared, too: a small file must not fill the memory.
  constexpr std::uint64_t kFree = std::uint64_t{1} << 24;
  constexpr std::uint64_t kPerByte = 64;
  const std::uint64_t allowed = kFree + kPerByte * document_.bytes_read();
  decompressed_bytes_ += bytes;
  if (decompressed_bytes_ > allowed) {
    throw_input_error(document_.where(user),
                      fmt::format("more than {} bytes decompressed from files of {} bytes", allowed,
                                  document_.bytes_read()),
                      "a scene in proportion to its files");
  }
}

void Accessors::supply(int accessor, std::size_t count, std::vector<std::uint8_t> elements) {
  supplied_.insert_or_assign(accessor, Supplied{count, std::move(elements)});
}

void Accessors::spend(std::size_t elements, const std::string& user) {
  // Sharing arrays among primitives is usual, so a scene may be larger than its file; but a file of
  // a few lines must not fill the memory.
  constexpr std::uint64_t kFree = std::uint64_t{1} << 22;
  constexpr std::uint64_t kPerByte = 8;
  const std::uint64_t allowed = kFree + kPerByte * document_.bytes_read() + decompressed_bytes_;
  spent_ += elements;
  if (spent_ > allowed) {
    throw_input_error(document_.where(user),
                      fmt::format("more than {} vertices and triangles in files of {} bytes",
                                  allowed, document_.bytes_read()),
                      "a scene in proportion to its files");
  }
}

Accessors::Run Accessors::run_of(int accessor) {
  const tinygltf::Accessor& a = model_.accessors[at(accessor)];
  const std::string pointer = fmt::format("/accessors/{}", accessor);
  const std::size_t size = component_of(a.componentType).size;
  if (size == 0) {
    throw_input_error(document_.where(pointer + "/componentType"), std::to_string(a.componentType),
                      "a component type", {"5120", "5121", "5122", "5123", "5125", "5126"});
  }
  Run run{nullptr,
          a.count,
          0,
          a.componentType,
          tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(a.type)),
          a.normalized};
  const std::size_t element = size * static_cast<std::size_t>(run.components);
  const auto supplied = supplied_.find(accessor);
  if (supplied != supplied_.end()) {
    run.data = supplied->second.elements.data();
    run.count = supplied->second.count;
    run.stride = element;
    return run;
  }
  if (a.count == 0) return run;
  if (a.bufferView < 0) {
    // Zeros cost nothing in the file, so the file does not bound their number.
    constexpr std::size_t kMaxZeros = std::size_t{1} << 22;
    if (a.count > kMaxZeros) {
      throw_input_error(document_.where(pointer + "/count"), std::to_string(a.count),
                        fmt::format("at most {} without a bufferView", kMaxZeros));
    }
    return run;
  }
  const tinygltf::BufferView& v = model_.bufferViews[at(a.bufferView)];
  const Bytes bytes = view(a.bufferView, pointer);
  run.stride = v.byteStride == 0 ? element : v.byteStride;
  if (run.stride < element) {
    throw_input_error(
        document_.where(fmt::format("/bufferViews/{}/byteStride", a.bufferView)),
        std::to_string(run.stride),
        fmt::format("at least {}, the size of an element of accessor {}", element, accessor));
  }
  // The last element ends at offset + (count − 1)·stride + element; division cannot overflow.
  const bool fits = a.byteOffset <= bytes.size() && bytes.size() - a.byteOffset >= element &&
                    (a.count - 1) <= (bytes.size() - a.byteOffset - element) / run.stride;
  if (!fits) {
    throw_input_error(
        document_.where(pointer),
        fmt::format("{} elements of {} bytes, {} apart, from byte {}", a.count, element, run.stride,
                    a.byteOffset),
        fmt::format("at most the {} bytes of bufferView {}", bytes.size(), a.bufferView));
  }
  if ((v.byteOffset + a.byteOffset) % size != 0 || run.stride % size != 0) {
    document_.notes().warn(document_.where(pointer),
                           fmt::format("its data are not aligned to {} bytes", size));
  }
  run.data = bytes.data() + a.byteOffset;
  return run;
}

Accessors::Run Accessors::sparse_run(int accessor, int view_index, std::size_t byte_offset,
                                     int component_type, int components, const char* part) {
  const auto count = static_cast<std::size_t>(model_.accessors[at(accessor)].sparse.count);
  const std::string pointer = fmt::format("/accessors/{}/sparse/{}", accessor, part);
  const Bytes bytes = view(view_index, pointer);
  const std::size_t element =
      component_of(component_type).size * static_cast<std::size_t>(components);
  if (byte_offset > bytes.size() || count > (bytes.size() - byte_offset) / element) {
    throw_input_error(
        document_.where(pointer),
        fmt::format("{} elements of {} bytes from byte {}", count, element, byte_offset),
        fmt::format("at most the {} bytes of bufferView {}", bytes.size(), view_index));
  }
  return {bytes.data() + byte_offset, count, element, component_type, components, false};
}

std::vector<std::uint32_t> Accessors::read_integers(const Run& run) const {
  std::vector<std::uint32_t> values(run.count);
  if (run.data == nullptr) return values;
  for (std::size_t i = 0; i < run.count; ++i) {
    const std::uint8_t* element = run.data + i * run.stride;
    switch (run.component_type) {
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        values[i] = *element;
        break;
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        values[i] = load<std::uint16_t>(element);
        break;
      default:
        values[i] = load<std::uint32_t>(element);
    }
  }
  return values;
}

std::vector<std::uint32_t> Accessors::sparse_indices(int accessor) {
  const tinygltf::Accessor& a = model_.accessors[at(accessor)];
  const auto& sparse = a.sparse;
  const std::string pointer = fmt::format("/accessors/{}/sparse", accessor);
  const int type = sparse.indices.componentType;
  if (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
      type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
    throw_input_error(document_.where(pointer + "/indices/componentType"), component_of(type).name,
                      "an unsigned type", {"5121", "5123", "5125"});
  }
  if (static_cast<std::size_t>(sparse.count) > a.count) {
    throw_input_error(document_.where(pointer + "/count"), std::to_string(sparse.count),
                      fmt::format("at most the {} elements of the accessor", a.count));
  }
  std::vector<std::uint32_t> indices = read_integers(
      sparse_run(accessor, sparse.indices.bufferView,
                 static_cast<std::size_t>(sparse.indices.byteOffset), type, 1, "indices"));
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (indices[i] >= a.count) {
      throw_input_error(document_.where(pointer + "/indices"),
                        fmt::format("index {} at place {}", indices[i], i),
                        fmt::format("below the accessor's count, {}", a.count));
    }
  }
  return indices;
}

template <int N>
void Accessors::apply_sparse(int accessor, const Selection& selected, float fill,
                             std::vector<glm::vec<N, float>>& elements) {
  const tinygltf::Accessor& a = model_.accessors[at(accessor)];
  const std::vector<std::uint32_t> indices = sparse_indices(accessor);
  const int components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(a.type));
  const Run values = sparse_run(accessor, a.sparse.values.bufferView,
                                static_cast<std::size_t>(a.sparse.values.byteOffset),
                                a.componentType, components, "values");
  std::vector<glm::vec<N, float>> replacements(values.count, glm::vec<N, float>(fill));
  const Selection all;
  decode<N>({values.data, values.stride, a.componentType, components, a.normalized, all},
            replacements);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    std::size_t place = indices[i];
    if (selected) {
      const auto found = std::lower_bound(selected->begin(), selected->end(), indices[i]);
      if (found == selected->end() || *found != indices[i]) continue;
      place = static_cast<std::size_t>(found - selected->begin());
    }
    elements[place] = replacements[i];
  }
}

template <int N>
std::vector<glm::vec<N, float>> Accessors::read(int accessor, const Selection& selected,
                                                float fill) {
  const Run run = run_of(accessor);
  std::vector<glm::vec<N, float>> elements(selected ? selected->size() : run.count,
                                           glm::vec<N, float>(fill));
  if (run.data != nullptr) {
    decode<N>({run.data, run.stride, run.component_type, run.components, run.normalized, selected},
              elements);
  } else {
    for (auto& element : elements) {
      for (int c = 0; c < run.components; ++c) element[c] = 0.0f;
    }
  }
  if (model_.accessors[at(accessor)].sparse.isSparse && !supplied_.contains(accessor)) {
    apply_sparse<N>(accessor, selected, fill, elements);
  }
  return elements;
}

void Accessors::require_type(int accessor, const std::string& user,
                             std::initializer_list<int> types) const {
  const int type = model_.accessors[at(accessor)].type;
  if (std::find(types.begin(), types.end(), type) != types.end()) return;
  std::string expected;
  for (const int allowed : types) {
    expected += (expected.empty() ? "" : " or ") + std::string(type_name(allowed));
  }
  throw_input_error(document_.where(user),
                    fmt::format("accessor {} of type {}", accessor, type_name(type)), expected);
}

void Accessors::check(int accessor, const std::string& user, std::initializer_list<int> types,
                      Components allowed) const {
  require_type(accessor, user, types);
  const tinygltf::Accessor& a = model_.accessors[at(accessor)];
  const int type = a.componentType;
  bool good = type == TINYGLTF_COMPONENT_TYPE_FLOAT;
  const bool is_unsigned = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                           type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
  const bool is_signed =
      type == TINYGLTF_COMPONENT_TYPE_BYTE || type == TINYGLTF_COMPONENT_TYPE_SHORT;
  if (allowed != Components::FloatOnly && is_unsigned && a.normalized) good = true;
  if (allowed == Components::AnyQuantized && (is_unsigned || is_signed)) good = true;
  if (allowed == Components::FloatOrNormalized && is_signed && a.normalized) good = true;
  if (!good) {
    throw_input_error(document_.where(user),
                      fmt::format("accessor {} of component type {} ({}){}", accessor, type,
                                  component_of(type).name, a.normalized ? ", normalized" : ""),
                      allowed == Components::FloatOnly ? "FLOAT, or KHR_mesh_quantization"
                      : allowed == Components::FloatOrNormalized
                          ? "FLOAT or a normalized type"
                          : "FLOAT or a normalized unsigned type");
  }
}

std::vector<Vec2f> Accessors::vec2(int accessor, const std::string& user, Components allowed,
                                   const Selection& selected) {
  check(accessor, user, {TINYGLTF_TYPE_VEC2}, allowed);
  return read<2>(accessor, selected, 0.0f);
}

std::vector<Vec3f> Accessors::vec3(int accessor, const std::string& user, Components allowed,
                                   const Selection& selected) {
  check(accessor, user, {TINYGLTF_TYPE_VEC3}, allowed);
  return read<3>(accessor, selected, 0.0f);
}

std::vector<Vec4f> Accessors::vec4(int accessor, const std::string& user, Components allowed,
                                   const Selection& selected) {
  check(accessor, user, {TINYGLTF_TYPE_VEC4}, allowed);
  return read<4>(accessor, selected, 0.0f);
}

std::vector<Vec4f> Accessors::color(int accessor, const std::string& user, Components allowed,
                                    const Selection& selected, float alpha) {
  check(accessor, user, {TINYGLTF_TYPE_VEC3, TINYGLTF_TYPE_VEC4}, allowed);
  return read<4>(accessor, selected, alpha);
}

std::vector<float> Accessors::scalars(int accessor, const std::string& user, Components allowed) {
  check(accessor, user, {TINYGLTF_TYPE_SCALAR}, allowed);
  const std::vector<glm::vec<1, float>> elements = read<1>(accessor, {}, 0.0f);
  std::vector<float> values(elements.size());
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = elements[i].x;
  return values;
}

std::vector<Vec4f> Accessors::joints(int accessor, const std::string& user,
                                     const Selection& selected) {
  require_type(accessor, user, {TINYGLTF_TYPE_VEC4});
  const tinygltf::Accessor& a = model_.accessors[at(accessor)];
  const bool is_index = a.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                        a.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
  if (!is_index || a.normalized) {
    throw_input_error(
        document_.where(user),
        fmt::format("accessor {} of component type {} ({}){}", accessor, a.componentType,
                    component_of(a.componentType).name, a.normalized ? ", normalized" : ""),
        "UNSIGNED_BYTE or UNSIGNED_SHORT");
  }
  return read<4>(accessor, selected, 0.0f);
}

std::vector<Mat4d> Accessors::matrices(int accessor, const std::string& user) {
  require_type(accessor, user, {TINYGLTF_TYPE_MAT4});
  const tinygltf::Accessor& a = model_.accessors[at(accessor)];
  if (a.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT || a.sparse.isSparse) {
    throw_input_error(document_.where(user),
                      fmt::format("{} {}", component_of(a.componentType).name,
                                  a.sparse.isSparse ? "with sparse values" : ""),
                      "FLOAT without sparse values");
  }
  const Run run = run_of(accessor);
  std::vector<Mat4d> values(run.count, Mat4d(0.0));
  for (std::size_t i = 0; run.data != nullptr && i < run.count; ++i) {
    for (int k = 0; k < 16; ++k) {
      values[i][k / 4][k % 4] = static_cast<double>(
          load<float>(run.data + i * run.stride + static_cast<std::size_t>(k) * sizeof(float)));
    }
  }
  return values;
}

std::uint32_t Accessors::largest_index(int accessor) const {
  const int type = model_.accessors[at(accessor)].componentType;
  return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE    ? 0xffu
         : type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ? 0xffffu
                                                          : 0xffffffffu;
}

std::vector<std::uint32_t> Accessors::indices(int accessor, const std::string& user) {
  require_type(accessor, user, {TINYGLTF_TYPE_SCALAR});
  const tinygltf::Accessor& a = model_.accessors[at(accessor)];
  if (a.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
      a.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      a.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
    throw_input_error(document_.where(user),
                      fmt::format("accessor {} of component type {} ({})", accessor,
                                  a.componentType, component_of(a.componentType).name),
                      "UNSIGNED_BYTE, UNSIGNED_SHORT or UNSIGNED_INT");
  }
  std::vector<std::uint32_t> values = read_integers(run_of(accessor));
  if (a.sparse.isSparse) {
    const std::vector<std::uint32_t> places = sparse_indices(accessor);
    const std::vector<std::uint32_t> replacements = read_integers(sparse_run(
        accessor, a.sparse.values.bufferView, static_cast<std::size_t>(a.sparse.values.byteOffset),
        a.componentType, 1, "values"));
    for (std::size_t i = 0; i < places.size(); ++i) values[places[i]] = replacements[i];
  }
  return values;
}

}  // namespace abbe::gltf
