/// Arrays compressed by meshoptimizer, as EXT_meshopt_compression has them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace abbe::gltf {

/// Which of the codecs, and what is undone after it.
enum class MeshoptMode : std::uint8_t { Attributes, Triangles, Indices };
enum class MeshoptFilter : std::uint8_t { None, Octahedral, Quaternion, Exponential };

/// What a compressed array becomes.
/// Domain: count and stride > 0; the stride is 2 or 4 bytes of indices, else a multiple of 4 up to
///         256, of octahedral elements 4 or 8, of quaternions 8; triangles have a count that is a
///         multiple of 3; indices have no filter.
struct MeshoptArray {
  std::size_t count = 0;
  std::size_t stride = 0;  ///< Bytes.
  MeshoptMode mode = MeshoptMode::Attributes;
  MeshoptFilter filter = MeshoptFilter::None;
};

/// Whether this build has meshoptimizer.
bool has_meshopt();

/// The array, count times stride bytes. Memory is taken only for what so many bytes may hold.
/// Errors: input Error at `where` for data that are no such array, or where !has_meshopt().
/// Source: EXT_meshopt_compression, appendices A and B.
std::vector<std::uint8_t> decode_meshopt(std::span<const std::uint8_t> bytes,
                                         const MeshoptArray& array, const std::string& where);

}  // namespace abbe::gltf
