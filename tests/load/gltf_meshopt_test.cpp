// EXT_meshopt_compression: what meshoptimizer encodes is read as it was.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "abbe/load/gltf/codec/meshopt.h"
#include "load/gltf_builder.h"
#include "load/random_mesh.h"

#ifdef ABBE_HAS_MESHOPTIMIZER
#include <meshoptimizer.h>
#endif

namespace abbe {
namespace {

using testing::HasSubstr;
constexpr const char* kName = "EXT_meshopt_compression";

class Meshopt : public GltfTest {
 protected:
  Meshopt() {
    document["extensionsUsed"] = {kName, "KHR_mesh_quantization"};
    document["extensionsRequired"] = {kName, "KHR_mesh_quantization"};
    document["accessors"] = Json::array();
    document["bufferViews"] = Json::array();
    binary.clear();
  }

  /// A view of the placeholder buffer, its content compressed in the first.
  std::size_t add_compressed(const std::vector<std::uint8_t>& bytes, std::size_t count,
                             std::size_t stride, const std::string& mode,
                             const std::string& filter = "NONE") {
    binary.resize((binary.size() + 3) / 4 * 4);
    document["bufferViews"].push_back({{"buffer", 1},
                                       {"byteOffset", placeholder},
                                       {"byteLength", count * stride},
                                       {"extensions",
                                        {{kName,
                                          {{"buffer", 0},
                                           {"byteOffset", binary.size()},
                                           {"byteLength", bytes.size()},
                                           {"byteStride", stride},
                                           {"count", count},
                                           {"mode", mode},
                                           {"filter", filter}}}}}});
    if (mode == "ATTRIBUTES") document["bufferViews"].back()["byteStride"] = stride;
    binary.insert(binary.end(), bytes.begin(), bytes.end());
    placeholder += count * stride;
    document["buffers"] = {{{"byteLength", binary.size()}, {"uri", "data.bin"}},
                           {{"byteLength", placeholder}}};
    return document["bufferViews"].size() - 1;
  }

  std::size_t add_compressed_accessor(std::size_t view, int component_type, std::size_t count,
                                      const std::string& type, bool normalized = false) {
    document["accessors"].push_back({{"bufferView", view},
                                     {"componentType", component_type},
                                     {"count", count},
                                     {"type", type},
                                     {"normalized", normalized}});
    return document["accessors"].size() - 1;
  }

  Json& extension(std::size_t view) { return document["bufferViews"][view]["extensions"][kName]; }

  std::size_t placeholder = 0;
};

#ifdef ABBE_HAS_MESHOPTIMIZER

std::vector<std::uint8_t> encoded(const void* values, std::size_t count, std::size_t stride) {
  std::vector<std::uint8_t> bytes(meshopt_encodeVertexBufferBound(count, stride));
  bytes.resize(meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), values, count, stride));
  return bytes;
}

std::vector<std::uint8_t> encoded_triangles(const RandomMesh& mesh) {
  const auto& indices = mesh.indices;
  std::vector<std::uint8_t> bytes(
      meshopt_encodeIndexBufferBound(indices.size(), mesh.positions.size()));
  bytes.resize(
      meshopt_encodeIndexBuffer(bytes.data(), bytes.size(), indices.data(), indices.size()));
  return bytes;
}

std::vector<std::uint8_t> encoded_sequence(const RandomMesh& mesh) {
  const auto& indices = mesh.indices;
  std::vector<std::uint8_t> bytes(
      meshopt_encodeIndexSequenceBound(indices.size(), mesh.positions.size()));
  bytes.resize(
      meshopt_encodeIndexSequence(bytes.data(), bytes.size(), indices.data(), indices.size()));
  return bytes;
}

TEST_F(Meshopt, mesh_of_chance_is_what_it_was) {
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    for (const bool is_triangles : {true, false}) {
      const RandomMesh mesh(seed);
      const std::size_t count = mesh.positions.size();
      document["accessors"] = document["bufferViews"] = Json::array();
      binary.clear();
      placeholder = 0;
      const std::size_t positions =
          add_compressed(encoded(mesh.positions.data(), count, 12), count, 12, "ATTRIBUTES");
      const std::size_t uv =
          add_compressed(encoded(mesh.uv.data(), count, 8), count, 8, "ATTRIBUTES");
      const std::size_t indices =
          add_compressed(is_triangles ? encoded_triangles(mesh) : encoded_sequence(mesh),
                         mesh.indices.size(), 4, is_triangles ? "TRIANGLES" : "INDICES");
      primitive()["attributes"]["POSITION"] =
          add_compressed_accessor(positions, 5126, count, "VEC3");
      primitive()["attributes"]["TEXCOORD_0"] = add_compressed_accessor(uv, 5126, count, "VEC2");
      primitive()["indices"] =
          add_compressed_accessor(indices, 5125, mesh.indices.size(), "SCALAR");
      const Mesh read = load().meshes.at(0);
      EXPECT_EQ(read.positions, mesh.positions);
      Mesh expected;
      expected.positions = mesh.positions;
      expected.uv[0] = mesh.uv;
      for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        expected.triangles.push_back({mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]});
      }
      EXPECT_EQ(shown(read), shown(expected));
    }
  }
}

TEST_F(Meshopt, normals_through_the_octahedral_filter_are_within_its_steps) {
  const RandomMesh mesh(4);
  const std::size_t count = mesh.positions.size();
  std::vector<float> four;
  for (const Vec3f& n : mesh.normals) four.insert(four.end(), {n.x, n.y, n.z, 0.0f});
  std::vector<std::uint8_t> filtered(4 * count);
  meshopt_encodeFilterOct(filtered.data(), count, 4, 8, four.data());
  const std::size_t positions =
      add_compressed(encoded(mesh.positions.data(), count, 12), count, 12, "ATTRIBUTES");
  const std::size_t normals =
      add_compressed(encoded(filtered.data(), count, 4), count, 4, "ATTRIBUTES", "OCTAHEDRAL");
  const std::size_t indices =
      add_compressed(encoded_sequence(mesh), mesh.indices.size(), 4, "INDICES");
  primitive()["attributes"]["POSITION"] = add_compressed_accessor(positions, 5126, count, "VEC3");
  primitive()["attributes"]["NORMAL"] = add_compressed_accessor(normals, 5120, count, "VEC3", true);
  primitive()["indices"] = add_compressed_accessor(indices, 5125, mesh.indices.size(), "SCALAR");
  const Mesh read = load().meshes.at(0);
  ASSERT_EQ(read.normals.size(), count);
  for (std::size_t i = 0; i < count; ++i) {
    // Half a step of 1/127 along two axes, before and after the filter.
    EXPECT_LT(glm::length(read.normals[i] - mesh.normals[i]), 2.0f * 1.5f / 127.0f);
  }
}

TEST(MeshoptCodec, exponents_and_quaternions_are_within_their_bits) {
  std::mt19937 chance(5);
  std::uniform_real_distribution<float> real(-1.0f, 1.0f);
  std::vector<float> numbers(3 * 200);
  for (float& x : numbers) x = 100.0f * real(chance);
  std::vector<std::uint8_t> filtered(numbers.size() * 4);
  meshopt_encodeFilterExp(filtered.data(), 200, 12, 15, numbers.data());
  gltf::MeshoptArray array{200, 12, gltf::MeshoptMode::Attributes,
                           gltf::MeshoptFilter::Exponential};
  auto bytes = gltf::decode_meshopt(encoded(filtered.data(), 200, 12), array, "here");
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    float decoded = 0.0f;
    std::memcpy(&decoded, bytes.data() + 4 * i, 4);
    EXPECT_NEAR(decoded, numbers[i],
                100.0f / (1 << 13));  // One exponent a vector, 15 bits, signed.
  }

  std::vector<float> rotations;
  for (int i = 0; i < 200; ++i) {
    const Vec4f q = glm::normalize(Vec4f(real(chance), real(chance), real(chance), real(chance)));
    rotations.insert(rotations.end(), {q.x, q.y, q.z, q.w});
  }
  filtered.resize(200 * 8);
  meshopt_encodeFilterQuat(filtered.data(), 200, 8, 12, rotations.data());
  array = {200, 8, gltf::MeshoptMode::Attributes, gltf::MeshoptFilter::Quaternion};
  bytes = gltf::decode_meshopt(encoded(filtered.data(), 200, 8), array, "here");
  for (std::size_t i = 0; i < 200; ++i) {
    Vec4f decoded, original;
    for (int c = 0; c < 4; ++c) {
      std::int16_t value = 0;
      std::memcpy(&value, bytes.data() + 8 * i + 2 * static_cast<std::size_t>(c), 2);
      decoded[c] = static_cast<float>(value);
      original[c] = rotations[4 * i + static_cast<std::size_t>(c)];
    }
    // Three components in steps of sqrt(1/2) / 2047, half of that off each, and the largest by as
    // much again: at most 6e-4 from the original, the square of which is halved in the product.
    EXPECT_GT(std::abs(glm::dot(glm::normalize(decoded), original)), 1.0f - 5e-7f);
  }
}

TEST_F(Meshopt, plain_data_are_not_needed_and_not_read_where_compressed_ones_are) {
  const RandomMesh mesh(6);
  const std::size_t count = mesh.positions.size();
  const std::size_t view =
      add_compressed(encoded(mesh.positions.data(), count, 12), count, 12, "ATTRIBUTES");
  primitive()["attributes"]["POSITION"] = add_compressed_accessor(view, 5126, count - 1, "VEC3");
  document["buffers"][1]["uri"] = "fallback.bin";  // Not there.
  document["buffers"][1]["extensions"][kName]["fallback"] = true;
  EXPECT_EQ(load().meshes.at(0).triangles.size(), (count - 1) / 3);
  EXPECT_EQ(notes_text(), "");
}

TEST_F(Meshopt, hostile_streams_are_errors_at_their_place) {
  const RandomMesh mesh(7);
  const std::size_t count = mesh.positions.size();
  const std::size_t view =
      add_compressed(encoded(mesh.positions.data(), count, 12), count, 12, "ATTRIBUTES");
  primitive()["attributes"]["POSITION"] = add_compressed_accessor(view, 5126, count, "VEC3");
  ASSERT_EQ(error(), "");
  const Json good = document;
  const auto with = [&](const char* member, const Json& value) {
    document = good;
    extension(view)[member] = value;
    const std::string said = error();
    EXPECT_THAT(said, HasSubstr("/bufferViews/0")) << member;
    return said;
  };
  const auto length = extension(view)["byteLength"].get<std::size_t>();
  EXPECT_THAT(with("byteLength", length - 40), HasSubstr("found"));
  EXPECT_THAT(with("byteLength", 1), HasSubstr("end too early"));
  EXPECT_THAT(with("byteLength", 1e15), HasSubstr("a part of the"));
  EXPECT_THAT(with("byteOffset", 1e15), HasSubstr("a part of the"));
  EXPECT_THAT(with("byteOffset", 4), HasSubstr("a part of the"));
  EXPECT_THAT(with("count", count - 1), HasSubstr("bytes of its buffer view"));
  EXPECT_THAT(with("byteStride", 10), HasSubstr("a multiple of 4"));
  EXPECT_THAT(with("byteStride", 0), HasSubstr("from 1 to 256"));
  EXPECT_THAT(with("mode", "POINTS"), HasSubstr("TRIANGLES"));
  EXPECT_THAT(with("mode", "TRIANGLES"), HasSubstr("the size of an index"));
  EXPECT_THAT(with("filter", "COLOR"), HasSubstr("OCTAHEDRAL"));
  EXPECT_THAT(with("filter", "QUATERNION"), HasSubstr("8 with the filter"));
  EXPECT_THAT(with("buffer", 7), HasSubstr("/buffers"));
  document = good;
  extension(view)["buffer"] = 1;
  EXPECT_THAT(error(), HasSubstr("/buffers/1: found no uri"));
  document = good;
  extension(view)["byteOffset"] = 4;
  extension(view)["byteLength"] = length - 4;
  EXPECT_THAT(error(), HasSubstr("another codec"));
  document = good;
  extension(view)["count"] = 1ull << 40;
  document["bufferViews"][view]["byteLength"] = 12 * (1ull << 40);
  EXPECT_THAT(error(), HasSubstr("compressed ones can hold"));
}

TEST(MeshoptCodec, damaged_streams_never_reach_beyond_their_bytes) {
  const RandomMesh mesh(8, 12);
  std::mt19937 chance(9);
  const auto attributes = encoded(mesh.positions.data(), mesh.positions.size(), 12);
  const auto triangles = encoded_triangles(mesh);
  for (int i = 0; i < 400; ++i) {
    auto bytes = i % 2 == 0 ? attributes : triangles;
    bytes[1 + chance() % (bytes.size() - 1)] = static_cast<std::uint8_t>(chance());
    bytes.resize(bytes.size() - chance() % 8);
    const gltf::MeshoptArray array =
        i % 2 == 0 ? gltf::MeshoptArray{mesh.positions.size(), 12}
                   : gltf::MeshoptArray{mesh.indices.size(), 4, gltf::MeshoptMode::Triangles};
    try {
      EXPECT_EQ(gltf::decode_meshopt(bytes, array, "here").size(), array.count * array.stride);
    } catch (const Error& caught) {
      EXPECT_EQ(caught.detail().where, "here");
    }
  }
}

#else

TEST_F(Meshopt, without_the_library_an_error_names_extension_and_package) {
  EXPECT_THAT(error(), HasSubstr("EXT_meshopt_compression"));
  EXPECT_THAT(error(), HasSubstr("libmeshoptimizer-dev"));
}

#endif

}  // namespace
}  // namespace abbe
