#include "abbe/load/gltf/codec/draco.h"

#include <fmt/format.h>

#include <array>
#include <cstring>
#include <memory>

#include "abbe/base/error.h"

#ifdef ABBE_HAS_DRACO
#include <draco/compression/config/decoder_options.h>
#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/mesh/mesh.h>
#endif

namespace abbe::gltf {

#ifdef ABBE_HAS_DRACO

namespace {

constexpr const char* kExpected = "a mesh of Draco's bitstream 2.2";

/// How much a stream may claim to hold before memory is taken for it: an even grid of triangles
/// takes a few bits each, but a stream of a few bytes must not fill the memory.
struct Bound {
  std::uint64_t elements;
  std::string exceeded = {};  // What was claimed, where it was too much.

  bool allows(std::uint64_t claimed, std::uint64_t factor, const char* what) {
    if (claimed <= factor * elements) return true;
    exceeded = fmt::format("{} {}", claimed, what);
    return false;
  }
};

/// A decoder that looks at the numbers in the stream before the library takes memory for them.
template <class Decoder>
class Bounded : public Decoder {
 public:
  explicit Bounded(Bound& bound) : bound_(bound) {}

 protected:
  // Both connectivities begin with the numbers of faces and of vertices.
  bool DecodeConnectivity() override {
    draco::DecoderBuffer ahead = *this->buffer();
    std::uint32_t first = 0, second = 0;
    if (!draco::DecodeVarint(&first, &ahead) || !draco::DecodeVarint(&second, &ahead)) return false;
    return bound_.allows(first, 1, "vertices or faces") &&
           bound_.allows(second, 1, "vertices or faces") && Decoder::DecodeConnectivity();
  }

  bool DecodeAllAttributes() override {
    constexpr std::uint64_t kComponents = 32;  // Of a vertex, as a rule.
    std::uint64_t components = 0;
    for (int i = 0; i < this->point_cloud()->num_attributes(); ++i) {
      components += this->point_cloud()->attribute(i)->num_components();
    }
    const std::uint64_t points = this->point_cloud()->num_points();
    return bound_.allows(points, 1, "vertices") &&
           bound_.allows(points * components, kComponents, "components of vertices") &&
           Decoder::DecodeAllAttributes();
  }

 private:
  Bound& bound_;
};

template <typename T>
bool convert(const draco::PointAttribute& attribute, std::size_t points, int components,
             std::vector<std::uint8_t>& out) {
  const std::size_t element = sizeof(T) * static_cast<std::size_t>(components);
  out.resize(points * element);
  for (std::size_t p = 0; p < points; ++p) {
    const auto value = attribute.mapped_index(draco::PointIndex(static_cast<std::uint32_t>(p)));
    std::array<T, 4> converted{};
    if (value.value() >= attribute.size() ||
        !attribute.ConvertValue<T>(value, static_cast<std::int8_t>(components), converted.data())) {
      return false;
    }
    std::memcpy(out.data() + p * element, converted.data(), element);
  }
  return true;
}

std::vector<std::uint8_t> values_of(const draco::Mesh& mesh, const DracoAttribute& wanted) {
  const draco::PointAttribute* const attribute = mesh.GetAttributeByUniqueId(wanted.id);
  if (attribute == nullptr) {
    throw_input_error(wanted.where, fmt::format("attribute {}", wanted.id),
                      fmt::format("one of the {} in the compressed mesh", mesh.num_attributes()));
  }
  if (attribute->num_components() != wanted.components) {
    throw_input_error(
        wanted.where,
        fmt::format("{} components in the compressed mesh", int{attribute->num_components()}),
        fmt::format("the {} of its accessor", wanted.components));
  }
  std::vector<std::uint8_t> values;
  const auto convert_to = [&](auto component) {
    return convert<decltype(component)>(*attribute, mesh.num_points(), wanted.components, values);
  };
  bool is_good = false;
  switch (wanted.component_type) {
    case 5120:
      is_good = convert_to(std::int8_t{});
      break;
    case 5121:
      is_good = convert_to(std::uint8_t{});
      break;
    case 5122:
      is_good = convert_to(std::int16_t{});
      break;
    case 5123:
      is_good = convert_to(std::uint16_t{});
      break;
    case 5125:
      is_good = convert_to(std::uint32_t{});
      break;
    case 5126:
      is_good = convert_to(float{});
      break;
    default:
      break;
  }
  if (!is_good) {
    throw_input_error(wanted.where, "values in the compressed mesh beyond its accessor's type",
                      fmt::format("values of component type {}", wanted.component_type));
  }
  return values;
}

void decode(std::span<const std::uint8_t> bytes, draco::Mesh& mesh, const std::string& where) {
  draco::DecoderBuffer buffer, header_buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  header_buffer = buffer;
  draco::DracoHeader header{};
  if (!draco::PointCloudDecoder::DecodeHeader(&header_buffer, &header).ok()) {
    throw_input_error(where, "data without Draco's header", kExpected);
  }
  if (header.version_major != 2 || header.version_minor != 2) {
    throw_input_error(
        where, fmt::format("Draco's bitstream {}.{}", header.version_major, header.version_minor),
        "2.2, which glTF has");
  }
  if (header.encoder_type != draco::TRIANGULAR_MESH) {
    throw_input_error(where, "a cloud of points", kExpected);
  }
  constexpr std::uint64_t kFree = std::uint64_t{1} << 20;
  constexpr std::uint64_t kPerByte = 64;
  Bound bound{kFree + kPerByte * bytes.size()};
  std::unique_ptr<draco::MeshDecoder> decoder;
  if (header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING) {
    decoder = std::make_unique<Bounded<draco::MeshEdgebreakerDecoder>>(bound);
  } else if (header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING) {
    decoder = std::make_unique<Bounded<draco::MeshSequentialDecoder>>(bound);
  } else {
    throw_input_error(where, fmt::format("Draco's method {}", header.encoder_method), "0 or 1");
  }
  const draco::Status status = decoder->Decode(draco::DecoderOptions(), &buffer, &mesh);
  if (!bound.exceeded.empty()) {
    throw_input_error(where, fmt::format("{} in {} bytes", bound.exceeded, bytes.size()),
                      "a mesh in proportion to its bytes");
  }
  if (!status.ok()) {
    const char* const said = status.error_msg();
    throw_input_error(where, fmt::format("broken data ({})", said), kExpected);
  }
}

}  // namespace

bool has_draco() {
  return true;
}

DracoMesh decode_draco(std::span<const std::uint8_t> bytes, std::span<const DracoAttribute> wanted,
                       const std::string& where) {
  draco::Mesh mesh;
  decode(bytes, mesh, where);
  DracoMesh result;
  result.points = mesh.num_points();
  result.indices.reserve(std::size_t{3} * mesh.num_faces());
  for (draco::FaceIndex face(0); face < mesh.num_faces(); ++face) {
    for (const draco::PointIndex& corner : mesh.face(face)) {
      if (corner.value() >= result.points) {
        throw_input_error(where, fmt::format("vertex {} in face {}", corner.value(), face.value()),
                          fmt::format("below the number of vertices, {}", result.points));
      }
      result.indices.push_back(corner.value());
    }
  }
  for (const DracoAttribute& attribute : wanted) {
    result.attributes.push_back(values_of(mesh, attribute));
  }
  return result;
}

#else

bool has_draco() {
  return false;
}

DracoMesh decode_draco(std::span<const std::uint8_t>, std::span<const DracoAttribute>,
                       const std::string& where) {
  throw_input_error(where, "a mesh compressed by KHR_draco_mesh_compression",
                    "a build of abbe with Draco (Debian: libdraco-dev)");
}

#endif

}  // namespace abbe::gltf
