#include "abbe/load/gltf/document/document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <random>

#include "load/gltf_builder.h"

namespace abbe {
namespace {

using testing::HasSubstr;

class GltfDocument : public GltfTest {
 protected:
  std::string error_of_text(const std::string& text) {
    try {
      load_text(text);
    } catch (const Error& caught) {
      return caught.what();
    }
    return "";
  }
  std::string error_of_uri(const std::string& uri) {
    document["buffers"] = {{{"byteLength", binary.size()}, {"uri", uri}}};
    return error();
  }
};

TEST_F(GltfDocument, missing_file_is_an_error_that_names_it) {
  try {
    load_gltf(folder / "none.gltf", Catalogue::standard(), {}, notes);
    FAIL();
  } catch (const Error& caught) {
    EXPECT_EQ(caught.detail().kind, ErrorKind::Input);
    EXPECT_THAT(caught.what(), HasSubstr("none.gltf"));
  }
}

TEST_F(GltfDocument, pipe_and_folder_are_errors_and_do_not_wait) {
  ASSERT_EQ(mkfifo((folder / "pipe.gltf").c_str(), 0600), 0);
  EXPECT_THROW(load_gltf(folder / "pipe.gltf", Catalogue::standard(), {}, notes), Error);
  EXPECT_THROW(load_gltf(folder, Catalogue::standard(), {}, notes), Error);
}

TEST_F(GltfDocument, text_that_is_no_json_names_line_and_column) {
  EXPECT_THAT(error_of_text("{\n  \"asset\": oops\n}"), HasSubstr("line 2, column 12"));
  EXPECT_THAT(error_of_text("{\"asset\": {}"), HasSubstr("line 1"));
  EXPECT_THAT(error_of_text(""), HasSubstr("an empty file"));
  EXPECT_THAT(error_of_text("{\"asset\": \"\xff\"}"), HasSubstr("UTF-8"));
}

TEST_F(GltfDocument, nesting_is_limited_before_anything_recurses) {
  EXPECT_EQ(gltf::nesting_depth(R"({"a": [1, {"b": "[[[\"[["}], "c": []})"), 3u);
  EXPECT_EQ(gltf::nesting_depth("]]]}}["), 1u);
  EXPECT_THAT(error_of_text(std::string(1'000'000, '[')), HasSubstr("nested 1000000 deep"));
  document["extras"] = Json::parse(std::string(200, '[') + std::string(200, ']'));
  EXPECT_EQ(load().meshes.size(), 1u);
}

TEST_F(GltfDocument, other_versions_are_errors) {
  document["asset"]["version"] = "1.0";
  EXPECT_THAT(error(), HasSubstr("/asset/version"));
  document["asset"] = {{"version", "2.0"}, {"minVersion", "2.1"}};
  EXPECT_THAT(error(), HasSubstr("/asset/minVersion"));
}

TEST_F(GltfDocument, wrong_types_are_errors_with_a_pointer) {
  const std::vector<std::pair<const char*, Json>> cases = {
      {"/meshes", Json::object()},
      {"/meshes/0", 5},
      {"/meshes/0/primitives", "none"},
      {"/meshes/0/primitives/0/attributes", Json::array()},
      {"/meshes/0/primitives/0/attributes/POSITION", -1},
      {"/meshes/0/primitives/0/attributes/POSITION", 0.5},
      {"/nodes/0/mesh", "0"},
      {"/nodes/0/mesh", 1},
      {"/nodes/0/children", {{0}}},
      {"/nodes/0/scale", {1, 1}},
      {"/nodes/0/name", 7},
      {"/scene", 3},
      {"/scenes/0/nodes/0", nullptr},
      {"/accessors/0/count", "3"},
      {"/accessors/0/type", 3},
      {"/accessors/0/normalized", "no"},
      {"/bufferViews/0/byteLength", 0},
      {"/bufferViews/0/byteOffset", -4},
      {"/extensions", Json::array()},
  };
  const Json good = document;
  for (const auto& [pointer, value] : cases) {
    document = good;
    document[Json::json_pointer(pointer)] = value;
    EXPECT_THAT(error(), HasSubstr(pointer)) << value;
  }
}

TEST_F(GltfDocument, members_that_belong_elsewhere_are_ignored) {
  node()["primitives"] = 5;
  document["scenes"][0]["primitives"] = {5, "x"};
  EXPECT_EQ(load().instances.size(), 1u);
}

TEST_F(GltfDocument, integers_written_with_a_fraction_of_zero_are_integers) {
  document["nodes"][0]["mesh"] = 0.0;
  document["accessors"][0]["count"] = 3.0;
  EXPECT_EQ(load().meshes.size(), 1u);
}

TEST_F(GltfDocument, uri_inside_the_folder_is_read) {
  load();
  std::filesystem::create_directory(folder / "sub");
  std::filesystem::copy(folder / "data.bin", folder / "sub/b\xc3\xbc 1%.bin");
  std::filesystem::create_symlink("data.bin", folder / "link.bin");
  for (const char* uri : {"sub/b%C3%BC%201%25.bin", "sub/b\xc3\xbc 1%25.bin", "./data.bin",
                          "sub/../data.bin", "link.bin"}) {
    EXPECT_EQ(error_of_uri(uri), "") << uri;
  }
}

TEST_F(GltfDocument, uri_out_of_the_folder_is_an_error) {
  load();
  const auto outside = folder.string() + "-outside";
  std::filesystem::create_directory(outside);
  std::filesystem::copy(folder / "data.bin", outside + "/data.bin");
  std::filesystem::create_directory_symlink(outside, folder / "door");
  std::filesystem::create_symlink(outside + "/data.bin", folder / "link.bin");
  for (const std::string& uri :
       {"../" + folder.filename().string() + "-outside/data.bin", outside + "/data.bin",
        "%2e%2e/" + folder.filename().string() + "-outside/data.bin", std::string("door/data.bin"),
        std::string("link.bin"), std::string("..\\data.bin"), std::string("a/../../data.bin"),
        std::string("%2Fetc%2Fpasswd"), "file://" + outside + "/data.bin",
        "file:" + outside + "/data.bin", std::string("http://localhost/data.bin"),
        std::string("C:/data.bin"), std::string("%66ile:data.bin"), std::string(""),
        std::string("."), std::string(".."), std::string("data.bin%00.png"), std::string("data%2"),
        std::string("data%zz.bin")}) {
    const std::string message = error_of_uri(uri);
    EXPECT_THAT(message, HasSubstr("/buffers/0/uri")) << uri;
  }
  std::filesystem::remove_all(outside);
}

TEST_F(GltfDocument, uri_of_an_unused_image_is_checked_too) {
  document["images"] = {{{"uri", "../../secret.png"}}};
  EXPECT_THAT(error(), HasSubstr("/images/0/uri"));
  // Out and in again would tell the names of folders outside.
  document["images"] = {{{"uri", "a/../../" + folder.filename().string() + "/b.png"}}};
  EXPECT_THAT(error(), HasSubstr("leaves the folder"));
}

TEST_F(GltfDocument, data_uri_is_decoded_and_checked) {
  // The bytes 0 to 36 of the triangle: 36 bytes are 48 characters.
  const std::string triangle = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
  EXPECT_EQ(error_of_uri("data:application/octet-stream;base64," + triangle), "");
  EXPECT_EQ(error_of_uri("data:;base64," + triangle), "");
  EXPECT_EQ(error_of_uri("DATA:;base64, " + triangle.substr(0, 10) + "\r\n" + triangle.substr(10)),
            "");
  for (const std::string& tail :
       {std::string(";base64,") + triangle.substr(1), ";base64,*" + triangle.substr(1),
        std::string(";base64,"), std::string(";base64"), ";base64," + triangle.substr(0, 40)}) {
    EXPECT_THAT(error_of_uri("data:application/octet-stream" + tail), HasSubstr("/buffers/0"));
  }
}

TEST(base64_decoded, published_vectors_are_met) {
  // Source: RFC 4648, 10.
  const auto decoded = [](const char* text) {
    const auto bytes = gltf::base64_decoded(text, "test");
    return std::string(bytes.begin(), bytes.end());
  };
  EXPECT_EQ(decoded(""), "");
  EXPECT_EQ(decoded("Zg=="), "f");
  EXPECT_EQ(decoded("Zm8="), "fo");
  EXPECT_EQ(decoded("Zm9v"), "foo");
  EXPECT_EQ(decoded("Zm9vYg=="), "foob");
  EXPECT_EQ(decoded("Zm9vYmE="), "fooba");
  EXPECT_EQ(decoded("Zm9vYmFy"), "foobar");
  EXPECT_EQ(decoded("Zm9vYg"), "foob");
  for (const char* bad : {"Z", "Zg=", "=", "Zm9v=", "Zg===", "Z=g="}) {
    EXPECT_THROW(decoded(bad), Error) << bad;
  }
}

TEST_F(GltfDocument, accessor_beyond_its_view_is_an_error) {
  document["accessors"][0]["byteOffset"] = 4;
  EXPECT_THAT(error(), HasSubstr("/accessors/0"));
  document["accessors"][0]["byteOffset"] = 9007199254740992;
  EXPECT_THAT(error(), HasSubstr("/accessors/0"));
  document["accessors"][0] = {
      {"bufferView", 0}, {"componentType", 5126}, {"count", 9007199254740991}, {"type", "VEC3"}};
  EXPECT_THAT(error(), HasSubstr("/primitives/0"));
  document["accessors"][0]["count"] = 4;
  EXPECT_THAT(error(), HasSubstr("/accessors/0"));
}

TEST_F(GltfDocument, damaged_files_never_do_more_than_throw) {
  // Bytes of a good .glb changed at random: whatever happens is an Error or a valid scene.
  primitive()["attributes"]["NORMAL"] =
      add_accessor(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  primitive()["indices"] = add_accessor(std::vector<std::uint16_t>{0, 1, 2}, "SCALAR");
  const std::size_t indices = add_view(std::vector<std::uint16_t>{1});
  const std::size_t values = add_view(std::vector<float>{7, 8, 9});
  document["accessors"][0]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
      {"values", {{"bufferView", values}}}};
  abbe_material() = {{"dispersion", {{"abbe", {{"nd", 1.5}, {"vd", 50}}}}},
                     {"absorption", {{400, 1}, {700, 2}}}};
  load_glb();
  std::ifstream stream(folder / "scene.glb", std::ios::binary);
  const std::string good{std::istreambuf_iterator<char>(stream), {}};
  const Catalogue catalogue = Catalogue::standard();
  std::mt19937 random(1);  // The same damage every time.
  const std::string interesting = "0123456789-.eE\"[]{},:\\ \xff";
  for (int round = 0; round < 3000; ++round) {
    std::string text = good;
    for (int change = 0; change <= round % 4; ++change) {
      const std::size_t at = random() % text.size();
      text[at] =
          round % 3 == 0 ? static_cast<char>(random()) : interesting[random() % interesting.size()];
    }
    if (round % 7 == 0) text.resize(random() % text.size());
    write("scene.glb", text);
    Notes ignored;
    try {
      load_gltf(folder / "scene.glb", catalogue, {}, ignored);
    } catch (const Error& caught) {
      EXPECT_EQ(std::string(caught.what()).find('\n'), std::string::npos);
    }
  }
}

TEST_F(GltfDocument, values_of_any_kind_in_any_place_never_do_more_than_throw) {
  // A document with something of everything, whose values are exchanged, removed and replaced.
  primitive()["indices"] = add_accessor(std::vector<std::uint16_t>{0, 1, 2}, "SCALAR");
  abbe_material() = {{"dispersion", {{"sellmeier", {{"B", {1.0}}, {"C", {0.01}}}}}},
                     {"absorption", {{400, 1}, {700, 2}}},
                     {"emission", {{"spectrum", {{"blackbody", 3000}}}, {"luminance", 5}}}};
  material()["extensions"]["KHR_materials_volume"] = {{"thicknessFactor", 1},
                                                      {"attenuationColor", {1, 0.5, 0.1}}};
  document["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "spot"},
       {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.5}}},
       {"extensions", {{"ABBE_light", {{"spectrum", {{"lines", {{500, 1}, {600, 2}}}}}}}}}}};
  document["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}}}}};
  document["meshes"].push_back({{"primitives", document["meshes"][0]["primitives"]},
                                {"extensions", {{"ABBE_shape", {{"sphere", {{"radius", 1}}}}}}}});
  document["nodes"] = {{{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}},
                       {{"mesh", 1}, {"rotation", {0, 0, 0, 1}}, {"children", {2}}},
                       {{"camera", 0},
                        {"scale", {1, 2, 3}},
                        {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}}};
  document["scenes"] = {
      {{"nodes", {0, 1}}, {"extensions", {{"ABBE_scene", {{"ambient", {{"luminance", 2}}}}}}}}};
  ASSERT_EQ(error(), "");
  const std::vector<Json> values = {0,
                                    1,
                                    2,
                                    -1,
                                    255,
                                    5121,
                                    5123,
                                    5126,
                                    65536,
                                    0.5,
                                    1e30,
                                    4294967295u,
                                    1e-300,
                                    1e308,
                                    "VEC3",
                                    "",
                                    "..",
                                    "illuminant/A",
                                    true,
                                    {1, 2},
                                    {{1, 2}, {3, 4}},
                                    nullptr,
                                    Json::array(),
                                    Json::object(),
                                    9007199254740992};
  std::vector<Json::json_pointer> places;
  const Json flat = document.flatten();
  for (const auto& [pointer, value] : flat.items()) {
    for (Json::json_pointer place(pointer); !place.empty(); place = place.parent_pointer()) {
      places.push_back(place);
    }
  }
  const Catalogue catalogue = Catalogue::standard();
  const Json good = document;
  std::mt19937 random(2);  // The same changes every time.
  std::size_t loaded = 0;
  for (int round = 0; round < 3000; ++round) {
    Json changed = good;
    for (int change = 0; change <= round % 3; ++change) {
      const Json::json_pointer& place = places[random() % places.size()];
      const Json::json_pointer& other = places[random() % places.size()];
      if (!changed.contains(place)) continue;
      if (random() % 6 == 0 && changed.contains(other)) {
        changed[place] = Json(changed[other]);
      } else if (random() % 6 == 0 && changed[place.parent_pointer()].is_object()) {
        changed[place.parent_pointer()].erase(place.back());
      } else {
        changed[place] = values[random() % values.size()];
      }
    }
    write("changed.gltf", changed.dump());
    Notes ignored;
    try {
      load_gltf(folder / "changed.gltf", catalogue, {}, ignored);
      ++loaded;
    } catch (const Error& caught) {
      EXPECT_THAT(caught.what(), HasSubstr("changed.gltf"));
    }
  }
  EXPECT_GT(loaded, 100u);  // Some changes are harmless: the rest of the loader is reached.
}

}  // namespace
}  // namespace abbe
