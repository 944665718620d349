// KHR_draco_mesh_compression: what Draco encodes is read as it was, within its quantisation.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "abbe/load/gltf/codec/draco.h"
#include "load/gltf_builder.h"
#include "load/random_mesh.h"

#ifdef ABBE_HAS_DRACO
#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>
#endif

namespace abbe {
namespace {

using testing::HasSubstr;
constexpr const char* kName = "KHR_draco_mesh_compression";

class Draco : public GltfTest {
 protected:
  Draco() { document["extensionsUsed"] = document["extensionsRequired"] = {kName}; }

  std::size_t add_plain(std::size_t count, const std::string& type, int component_type = 5126) {
    document["accessors"].push_back(
        {{"componentType", component_type}, {"count", count}, {"type", type}});
    return document["accessors"].size() - 1;
  }

  Json& extension() { return primitive()["extensions"][kName]; }

  /// Makes the primitive one that is compressed as `bytes`.
  void compress(const std::vector<std::uint8_t>& bytes, const RandomMesh& mesh) {
    const std::size_t count = mesh.positions.size();
    primitive()["attributes"] = {{"POSITION", add_plain(count, "VEC3")},
                                 {"NORMAL", add_plain(count, "VEC3")},
                                 {"TEXCOORD_0", add_plain(count, "VEC2")}};
    primitive()["indices"] = add_plain(mesh.indices.size(), "SCALAR", 5125);
    extension() = {{"bufferView", add_view(bytes)},
                   {"attributes", {{"POSITION", 0}, {"NORMAL", 1}, {"TEXCOORD_0", 2}}}};
  }
};

#ifdef ABBE_HAS_DRACO

template <int N>
void add(draco::Mesh& mesh, draco::GeometryAttribute::Type type,
         const std::vector<glm::vec<N, float>>& values) {
  draco::GeometryAttribute attribute;
  attribute.Init(type, nullptr, N, draco::DT_FLOAT32, false, sizeof(float) * N, 0);
  const int id = mesh.AddAttribute(attribute, true, static_cast<std::uint32_t>(values.size()));
  for (std::uint32_t i = 0; i < values.size(); ++i) {
    mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), &values[i]);
  }
}

struct Coding {
  int method = draco::MESH_EDGEBREAKER_ENCODING;
  int bits = 0;  // Of positions; 0: as they are.
  int speed = 5;
};

std::vector<std::uint8_t> encoded(const RandomMesh& source, const Coding& coding) {
  draco::Mesh mesh;
  mesh.set_num_points(static_cast<std::uint32_t>(source.positions.size()));
  for (std::size_t i = 0; i < source.indices.size(); i += 3) {
    draco::Mesh::Face face;
    for (std::size_t c = 0; c < 3; ++c) face[c] = draco::PointIndex(source.indices[i + c]);
    mesh.AddFace(face);
  }
  add(mesh, draco::GeometryAttribute::POSITION, source.positions);
  add(mesh, draco::GeometryAttribute::NORMAL, source.normals);
  add(mesh, draco::GeometryAttribute::TEX_COORD, source.uv);
  draco::ExpertEncoder encoder(mesh);
  encoder.SetEncodingMethod(coding.method);
  encoder.SetSpeedOptions(coding.speed, coding.speed);
  if (coding.bits > 0) encoder.SetAttributeQuantization(0, coding.bits);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeToBuffer(&buffer).ok());
  return {buffer.data(), buffer.data() + buffer.size()};
}

Mesh plain(const RandomMesh& source) {
  Mesh mesh;
  mesh.positions = source.positions;
  mesh.normals = source.normals;
  mesh.uv[0] = source.uv;
  for (std::size_t i = 0; i < source.indices.size(); i += 3) {
    mesh.triangles.push_back({source.indices[i], source.indices[i + 1], source.indices[i + 2]});
  }
  return mesh;
}

TEST_F(Draco, mesh_of_chance_is_what_it_was) {
  for (const std::uint32_t seed : {1u, 2u}) {
    for (const Coding coding : {Coding{draco::MESH_EDGEBREAKER_ENCODING, 0, 0},
                                Coding{draco::MESH_EDGEBREAKER_ENCODING, 0, 10},
                                Coding{draco::MESH_SEQUENTIAL_ENCODING, 0, 5}}) {
      const RandomMesh mesh(seed);
      compress(encoded(mesh, coding), mesh);
      document.erase("buffers");
      const Mesh read = load().meshes.at(0);
      ASSERT_EQ(read.triangles.size(), mesh.indices.size() / 3);
      // The reader makes normals unit again: a rounding.
      const auto found = shown(read), expected = shown(plain(mesh));
      for (std::size_t i = 0; i < found.size(); ++i) {
        for (std::size_t k = 0; k < 24; ++k) ASSERT_NEAR(found[i][k], expected[i][k], 2e-7f);
      }
      EXPECT_EQ(notes_text(), "");
    }
  }
}

TEST_F(Draco, quantised_positions_are_within_half_a_step) {
  const RandomMesh mesh(3);
  compress(encoded(mesh, {draco::MESH_SEQUENTIAL_ENCODING, 12}), mesh);
  const Mesh read = load().meshes.at(0);
  ASSERT_EQ(read.positions.size(), mesh.positions.size());  // Sequential: in their order.
  const float step = 25.0f / 4095.0f;  // The longest side of the bounds, in 2^12 - 1 steps.
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(read.positions[i][c], mesh.positions[i][c], 0.51f * step);
    }
  }
}

TEST_F(Draco, compressed_data_go_before_plain_ones_that_are_optional) {
  const RandomMesh mesh(4);
  compress(encoded(mesh, {}), mesh);
  document.erase("extensionsRequired");
  document["accessors"][primitive()["attributes"]["POSITION"].get<std::size_t>()]["bufferView"] = 0;
  EXPECT_EQ(load().meshes.at(0).triangles.size(), mesh.indices.size() / 3);
}

TEST_F(Draco, counts_beside_the_data_that_differ_are_a_fault) {
  const RandomMesh mesh(5);
  compress(encoded(mesh, {}), mesh);
  for (const char* name : {"POSITION", "NORMAL", "TEXCOORD_0"}) {
    document["accessors"][primitive()["attributes"][name].get<std::size_t>()]["count"] = 7;
  }
  document["accessors"][primitive()["indices"].get<std::size_t>()]["count"] = 9;
  EXPECT_EQ(load().meshes.at(0).triangles.size(), mesh.indices.size() / 3);
  EXPECT_THAT(notes_text(), HasSubstr("7, expected the 625 in the compressed mesh"));
  EXPECT_EQ(notes.all().size(), 4u);
}

TEST_F(Draco, what_the_compressed_mesh_lacks_is_an_error) {
  const RandomMesh mesh(6);
  compress(encoded(mesh, {}), mesh);
  const Json good = document;
  const auto with = [&](const char* name, const Json& value) {
    document = good;
    extension()["attributes"][name] = value;
    return error();
  };
  EXPECT_THAT(with("NORMAL", 3), HasSubstr("attributes/NORMAL: found attribute 3"));
  EXPECT_THAT(with("NORMAL", 2), HasSubstr("2 components"));
  EXPECT_THAT(with("NORMAL", -1), HasSubstr("from 0 to 4294967295"));
  EXPECT_THAT(with("COLOR_0", 1), HasSubstr("an attribute that the primitive lacks"));
  document = good;
  extension()["bufferView"] = 99;
  EXPECT_THAT(error(), HasSubstr("/bufferViews"));
}

TEST(DracoCodec, damaged_streams_are_errors_or_meshes) {
  const RandomMesh mesh(7, 10);
  std::mt19937 chance(8);
  for (const int method : {draco::MESH_EDGEBREAKER_ENCODING, draco::MESH_SEQUENTIAL_ENCODING}) {
    const auto good = encoded(mesh, {method, 11});
    for (std::size_t length = 0; length < good.size(); length += 37) {
      EXPECT_THROW(gltf::decode_draco(std::span(good).first(length), {}, "here"), Error);
    }
    for (int i = 0; i < 300; ++i) {
      auto bytes = good;
      for (int k = 0; k < 3; ++k) {
        bytes[11 + chance() % (bytes.size() - 11)] = static_cast<std::uint8_t>(chance());
      }
      try {
        const auto read = gltf::decode_draco(bytes, {}, "here");
        for (const std::uint32_t index : read.indices) ASSERT_LT(index, read.points);
      } catch (const Error& caught) {
        EXPECT_EQ(caught.detail().where, "here");
      }
    }
  }
}

TEST(DracoCodec, stream_that_claims_too_much_is_an_error_before_memory_is_taken) {
  const RandomMesh mesh(9, 10);
  auto bytes = encoded(mesh, {});
  // Behind the header of 11 bytes and the kind of traversal, 2^31 vertices and faces.
  const std::vector<std::uint8_t> many{0x80, 0x80, 0x80, 0x80, 0x08};
  bytes.erase(bytes.begin() + 12, bytes.begin() + 15);
  for (int i = 0; i < 2; ++i) bytes.insert(bytes.begin() + 12, many.begin(), many.end());
  try {
    gltf::decode_draco(bytes, {}, "here");
    ADD_FAILURE() << "no error";
  } catch (const Error& caught) {
    EXPECT_THAT(caught.what(), HasSubstr("2147483648 vertices or faces"));
  }
}

#else

TEST_F(Draco, without_the_library_an_error_names_extension_and_package) {
  EXPECT_THAT(error(), HasSubstr("KHR_draco_mesh_compression"));
  EXPECT_THAT(error(), HasSubstr("libdraco-dev"));
}

#endif

}  // namespace
}  // namespace abbe
