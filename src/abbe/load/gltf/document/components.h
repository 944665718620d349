/// Component types of accessors, and elements decoded out of bytes.
#pragma once

#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <type_traits>
#include <vector>

#include "abbe/math/vec.h"

namespace abbe::gltf {

/// A component type: its number in the file, bytes and name.
struct Component {
  int type;
  std::size_t size;
  const char* name;
};
inline constexpr std::array<Component, 6> kComponents{
    {{TINYGLTF_COMPONENT_TYPE_BYTE, 1, "BYTE"},
     {TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, 1, "UNSIGNED_BYTE"},
     {TINYGLTF_COMPONENT_TYPE_SHORT, 2, "SHORT"},
     {TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, 2, "UNSIGNED_SHORT"},
     {TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, 4, "UNSIGNED_INT"},
     {TINYGLTF_COMPONENT_TYPE_FLOAT, 4, "FLOAT"}}};

/// Of 0 bytes for a number that is none.
inline Component component_of(int type) {
  for (const Component& known : kComponents) {
    if (known.type == type) return known;
  }
  return {type, 0, "an unknown component type"};
}

inline const char* type_name(int type) {
  switch (type) {
    case TINYGLTF_TYPE_SCALAR:
      return "SCALAR";
    case TINYGLTF_TYPE_VEC2:
      return "VEC2";
    case TINYGLTF_TYPE_VEC3:
      return "VEC3";
    case TINYGLTF_TYPE_VEC4:
      return "VEC4";
    default:
      return "a matrix";
  }
}

/// One component.
template <typename T>
T load(const std::uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));  // Files may be unaligned.
  return value;
}

/// Normalized signed integers map to max(c / max, −1). Source: glTF 2.0, 3.11.
template <typename T>
float to_float(const std::uint8_t* bytes, bool normalized) {
  const T value = load<T>(bytes);
  if constexpr (std::is_same_v<T, float>) return value;
  if (!normalized) return static_cast<float>(value);
  return std::max(static_cast<float>(value) / static_cast<float>(std::numeric_limits<T>::max()),
                  -1.0f);
}

/// A run of elements in memory, and those wanted of it.
struct Source {
  const std::uint8_t* data;
  std::size_t stride;
  int component_type;
  int components;
  bool normalized;
  const std::optional<std::vector<std::uint32_t>>& selected;  ///< Rising; absent: all.
};

/// Fills the first components of each of `out`, one for each element selected.
template <typename T, int N>
void decode_as(const Source& source, std::vector<glm::vec<N, float>>& out) {
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::size_t at = source.selected ? (*source.selected)[i] : i;
    const std::uint8_t* element = source.data + at * source.stride;
    for (int c = 0; c < source.components; ++c) {
      out[i][c] = to_float<T>(element + static_cast<std::size_t>(c) * sizeof(T), source.normalized);
    }
  }
}

template <int N>
void decode(const Source& source, std::vector<glm::vec<N, float>>& out) {
  switch (source.component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return decode_as<std::int8_t, N>(source, out);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return decode_as<std::uint8_t, N>(source, out);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return decode_as<std::int16_t, N>(source, out);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return decode_as<std::uint16_t, N>(source, out);
    default:
      return decode_as<float, N>(source, out);
  }
}

}  // namespace abbe::gltf
