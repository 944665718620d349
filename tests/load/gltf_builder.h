// Small glTF files, made by tests in a folder of their own.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "abbe/base/error.h"
#include "abbe/load/gltf.h"

namespace abbe {

using Json = nlohmann::json;

/// A fixture with a temporary folder and a document that begins as one triangle in one scene.
class GltfTest : public testing::Test {
 protected:
  GltfTest() {
    std::string name = (std::filesystem::temp_directory_path() / "abbe-gltf-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) std::abort();
    folder = name;
    document = Json::parse(R"({
      "asset": {"version": "2.0"},
      "scene": 0,
      "scenes": [{"nodes": [0]}],
      "nodes": [{"mesh": 0}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}]
    })");
    add_accessor(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  }
  ~GltfTest() override { std::filesystem::remove_all(folder); }

  /// Appends an array to the buffer, with a view and an accessor of its own; returns its index.
  template <typename T>
  std::size_t add_accessor(const std::vector<T>& values, const std::string& type,
                           bool normalized = false) {
    const std::size_t view = add_view(values);
    const std::map<std::string, std::size_t> components = {
        {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}};
    Json accessor = {{"bufferView", view},
                     {"componentType", component_type(T{})},
                     {"count", values.size() / components.at(type)},
                     {"type", type}};
    if (normalized) accessor["normalized"] = true;
    document["accessors"].push_back(accessor);
    return document["accessors"].size() - 1;
  }

  template <typename T>
  std::size_t add_view(const std::vector<T>& values) {
    binary.resize((binary.size() + 3) / 4 * 4);
    const std::size_t offset = binary.size();
    const std::size_t bytes = values.size() * sizeof(T);
    binary.resize(offset + bytes);
    std::memcpy(binary.data() + offset, values.data(), bytes);
    document["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes}});
    return document["bufferViews"].size() - 1;
  }

  Json& primitive() { return document["meshes"][0]["primitives"][0]; }
  Json& node() { return document["nodes"][0]; }

  /// The first material, made when first asked for and given to the triangle.
  Json& material() {
    if (!document.contains("materials")) {
      document["materials"] = Json::array({Json::object()});
      primitive()["material"] = 0;
    }
    return document["materials"][0];
  }
  Json& abbe_material() { return material()["extensions"]["ABBE_material"]; }

  void write(const std::string& name, const std::string& content) const {
    std::filesystem::create_directories((folder / name).parent_path());
    std::ofstream(folder / name, std::ios::binary) << content;
  }

  /// Writes the document with its buffer beside it, and loads it.
  Scene load() {
    if (!document.contains("buffers")) {
      document["buffers"] = {{{"byteLength", binary.size()}, {"uri", "data.bin"}}};
    }
    write("data.bin", {binary.begin(), binary.end()});
    return load_text(document.dump());
  }
  Scene load_text(const std::string& text) {
    write("scene.gltf", text);
    notes = Notes();
    return load_gltf(folder / "scene.gltf", Catalogue::standard(), {}, notes);
  }
  /// The same as a .glb.
  Scene load_glb() {
    document["buffers"] = {{{"byteLength", binary.size()}}};
    std::string json = document.dump();
    json.resize((json.size() + 3) / 4 * 4, ' ');
    std::string chunk(binary.begin(), binary.end());
    chunk.resize((chunk.size() + 3) / 4 * 4, '\0');
    const auto u32 = [](std::size_t value) {
      std::string bytes(4, '\0');
      for (std::size_t i = 0; i < 4; ++i) bytes[i] = static_cast<char>(value >> (8 * i));
      return bytes;
    };
    write("scene.glb", "glTF" + u32(2) + u32(28 + json.size() + chunk.size()) + u32(json.size()) +
                           "JSON" + json + u32(chunk.size()) + std::string("BIN\0", 4) + chunk);
    notes = Notes();
    return load_gltf(folder / "scene.glb", Catalogue::standard(), {}, notes);
  }

  /// The message of the error that loading gives, or nothing.
  std::string error() {
    try {
      load();
    } catch (const Error& caught) {
      EXPECT_EQ(caught.detail().kind, ErrorKind::Input);
      return caught.what();
    }
    return "";
  }

  std::string notes_text() const {
    std::string text;
    for (const Note& note : notes.all()) text += note.where + ": " + note.text + "\n";
    return text;
  }

  std::filesystem::path folder;
  Json document;
  std::vector<char> binary;
  Notes notes;

 private:
  static int component_type(std::int8_t) { return 5120; }
  static int component_type(std::uint8_t) { return 5121; }
  static int component_type(std::int16_t) { return 5122; }
  static int component_type(std::uint16_t) { return 5123; }
  static int component_type(std::uint32_t) { return 5125; }
  static int component_type(float) { return 5126; }
};

}  // namespace abbe
