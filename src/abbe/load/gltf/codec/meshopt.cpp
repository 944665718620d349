#include "abbe/load/gltf/codec/meshopt.h"

#include <fmt/format.h>

#include "abbe/base/error.h"

#ifdef ABBE_HAS_MESHOPTIMIZER
#include <meshoptimizer.h>
#endif

namespace abbe::gltf {

#ifdef ABBE_HAS_MESHOPTIMIZER

namespace {

// Sixteen bytes that are as the ones before take two bits; what of a block is less than that.
constexpr std::size_t kMostPerByte = 64;
constexpr std::size_t kBlockBytes = 8192;

void undo(MeshoptFilter filter, const MeshoptArray& array, std::uint8_t* values) {
  switch (filter) {
    case MeshoptFilter::None:
      return;
    case MeshoptFilter::Octahedral:
      return meshopt_decodeFilterOct(values, array.count, array.stride);
    case MeshoptFilter::Quaternion:
      return meshopt_decodeFilterQuat(values, array.count, array.stride);
    case MeshoptFilter::Exponential:
      return meshopt_decodeFilterExp(values, array.count, array.stride);
  }
}

}  // namespace

bool has_meshopt() {
  return true;
}

std::vector<std::uint8_t> decode_meshopt(std::span<const std::uint8_t> bytes,
                                         const MeshoptArray& array, const std::string& where) {
  const std::size_t most = kMostPerByte * bytes.size() + kBlockBytes;
  if (array.count > most / array.stride) {
    throw_input_error(
        where, fmt::format("{} elements of {} bytes", array.count, array.stride),
        fmt::format("at most the {} bytes that {} compressed ones can hold", most, bytes.size()));
  }
  std::vector<std::uint8_t> values(array.count * array.stride);
  int failure = 0;
  switch (array.mode) {
    case MeshoptMode::Attributes:
      failure = meshopt_decodeVertexBuffer(values.data(), array.count, array.stride, bytes.data(),
                                           bytes.size());
      break;
    case MeshoptMode::Triangles:
      failure = meshopt_decodeIndexBuffer(values.data(), array.count, array.stride, bytes.data(),
                                          bytes.size());
      break;
    case MeshoptMode::Indices:
      failure = meshopt_decodeIndexSequence(values.data(), array.count, array.stride, bytes.data(),
                                            bytes.size());
      break;
  }
  if (failure != 0) {
    // -1 a header of another codec or version, -2 too few bytes, -3 bytes left over or no sense.
    throw_input_error(where,
                      failure == -1   ? "data of another codec or version"
                      : failure == -2 ? "data that end too early"
                                      : "broken data",
                      fmt::format("{} elements of {} bytes as meshoptimizer encodes them",
                                  array.count, array.stride));
  }
  undo(array.filter, array, values.data());
  return values;
}

#else

bool has_meshopt() {
  return false;
}

std::vector<std::uint8_t> decode_meshopt(std::span<const std::uint8_t>, const MeshoptArray&,
                                         const std::string& where) {
  throw_input_error(where, "data compressed by EXT_meshopt_compression",
                    "a build of abbe with meshoptimizer (Debian: libmeshoptimizer-dev)");
}

#endif

}  // namespace abbe::gltf
