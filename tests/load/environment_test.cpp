// Light from all around, and lamps with an extent, as files state them.

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "abbe/base/constants.h"
#include "abbe/image/exr/exr.h"
#include "abbe/load/cube_map.h"
#include "abbe/load/environment.h"
#include "image/png_bytes.h"
#include "load/gltf_builder.h"

namespace abbe {
namespace {

using testing::HasSubstr;

class GltfEnvironment : public GltfTest {
 protected:
  Json& abbe_scene() { return document["scenes"][0]["extensions"]["ABBE_scene"]; }

  // Four texels by two; the first is `first`, all others are grey of 0.5.
  void write_sky(const std::vector<std::string>& channels, const std::vector<float>& first,
                 const ExrOptions& options = {}) const {
    Image image;
    image.width = 4;
    image.height = 2;
    image.channels = channels;
    image.pixels.assign(8 * channels.size(), 0.5f);
    std::copy(first.begin(), first.end(), image.pixels.begin());
    write_exr(folder / "sky.exr", image, options);
  }

  EnvironmentImage read(const std::string& name) {
    notes = Notes();
    return read_environment_image(folder / name, "here", notes);
  }

  Light light(const char* type, const Json& shape) {
    document["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", type}, {"extensions", {{"ABBE_light", {{"shape", shape}}}}}}};
    node()["extensions"]["KHR_lights_punctual"]["light"] = 0;
    return load().lights.at(0);
  }
};

TEST_F(GltfEnvironment, scene_states_an_environment_and_its_exposure) {
  write_sky({"R", "G", "B"}, {1.0f, 2.0f, 3.0f});
  abbe_scene() = {{"exposure", -1.5},
                  {"environment",
                   {{"uri", "sky.exr"},
                    {"scale", 2.0},
                    {"rotation_deg", 30.0},
                    {"visible", false},
                    {"spectrum", "illuminant/A"}}}};
  const Scene scene = load();
  ASSERT_TRUE(scene.environment);
  const Environment& sky = *scene.environment;
  EXPECT_EQ(sky.name, "sky.exr");
  EXPECT_EQ(sky.image.width, 4);
  EXPECT_EQ(sky.image.height, 2);
  EXPECT_EQ(sky.image.rgb_rec709.at(0), Vec3f(1.0f, 2.0f, 3.0f));
  EXPECT_EQ(sky.image.rgb_rec709.at(7), Vec3f(0.5f));
  EXPECT_EQ(sky.scale, 2.0);
  EXPECT_EQ(sky.rotation_deg, 30.0);
  EXPECT_FALSE(sky.visible);
  ASSERT_TRUE(sky.spectrum);
  EXPECT_EQ(sky.spectrum->id, "illuminant/A");
  EXPECT_EQ(scene.exposure_ev, -1.5);
}

TEST_F(GltfEnvironment, hash_of_the_scene_is_that_of_its_sky_too) {
  abbe_scene() = {{"environment", {{"uri", "sky.exr"}}}};
  write_sky({"R", "G", "B"}, {1.0f, 2.0f, 3.0f});
  const std::string before = load().content_hash;
  write_sky({"R", "G", "B"}, {1.0f, 2.0f, 4.0f});
  EXPECT_NE(load().content_hash, before);
}

TEST_F(GltfEnvironment, sky_outside_of_the_folder_is_an_error) {
  for (const char* uri : {"../sky.exr", "/tmp/sky.exr", "https://a/sky.exr", "none.exr"}) {
    abbe_scene() = {{"environment", {{"uri", uri}}}};
    EXPECT_THAT(error(), HasSubstr("/scenes/0/extensions/ABBE_scene/environment/uri")) << uri;
  }
}

TEST_F(GltfEnvironment, spectral_image_keeps_its_bands) {
  write_sky({spectral_channel_name(500.0), spectral_channel_name(400.0)}, {2.0f, -1.0f});
  const EnvironmentImage image = read("sky.exr");
  EXPECT_EQ(image.band_nm, (std::vector<float>{400.0f, 500.0f}));
  EXPECT_TRUE(image.rgb_rec709.empty());
  EXPECT_EQ(image.bands.at(0), 0.0f);  // There is no negative radiance.
  EXPECT_EQ(image.bands.at(1), 2.0f);
  EXPECT_THAT(notes_text(), HasSubstr("1 texels of the environment have negative light"));
}

TEST_F(GltfEnvironment, chromaticities_of_a_wider_gamut_are_converted) {
  // Rec.2020 of ITU-R BT.2020-2.
  write_sky({"R", "G", "B"}, {0.0f, 1.0f, 0.0f},
            {.chromaticities = std::array<float, 8>{0.708f, 0.292f, 0.170f, 0.797f, 0.131f, 0.046f,
                                                    0.3127f, 0.3290f}});
  const EnvironmentImage image = read("sky.exr");
  // Green of Rec.2020 in Rec.709: the middle column of the matrix of ITU-R BT.2087, inverted.
  const Vec3f green = image.rgb_rec709.at(0);
  EXPECT_NEAR(green.x, -0.5876, 2e-4);  // Four digits are printed there.
  EXPECT_NEAR(green.y, 1.1329, 2e-4);
  EXPECT_NEAR(green.z, -0.1006, 2e-4);
  EXPECT_NEAR(image.rgb_rec709.at(1).x, 0.5, 1e-5);  // White stays, to the rounding of floats.
  EXPECT_THAT(notes_text(), HasSubstr("1 texels of the environment have a negative red"));
}

TEST_F(GltfEnvironment, texels_that_are_no_light_are_counted) {
  write_sky({"R", "G", "B"}, {std::numeric_limits<float>::quiet_NaN(), 1.0f, 1.0f, -1.0f, -1.0f,
                              -1.0f, 1.0f, 1.0f, std::numeric_limits<float>::infinity()});
  const EnvironmentImage image = read("sky.exr");
  for (std::size_t t = 0; t < 3; ++t) EXPECT_EQ(image.rgb_rec709.at(t), Vec3f(0.0f));
  EXPECT_THAT(notes_text(), HasSubstr("2 texels of the environment are not finite"));
  EXPECT_THAT(notes_text(), HasSubstr("1 texels of the environment have negative light"));
}

TEST_F(GltfEnvironment, radiance_hdr_is_read_with_its_first_row_on_top) {
  // 2x1 texels in flat RGBE: 1, 0.5, 0.25 and 8, 8, 8 (G. Ward, Graphics Gems II).
  write("sky.hdr", std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n") +
                       std::string("\x80\x40\x20\x81\x80\x80\x80\x84", 8));
  const EnvironmentImage image = read("sky.hdr");
  ASSERT_EQ(image.rgb_rec709.size(), 2u);
  // RGBE has 8 bits: half a step of its mantissa of 128.
  EXPECT_NEAR(image.rgb_rec709[0].x, 1.0, 1.0 / 128);
  EXPECT_NEAR(image.rgb_rec709[0].z, 0.25, 1.0 / 128);
  EXPECT_NEAR(image.rgb_rec709[1].x, 8.0, 8.0 / 128);
}

TEST_F(GltfEnvironment, what_is_no_image_is_an_error_at_its_place) {
  write("sky.exr", "nothing");
  abbe_scene() = {{"environment", {{"uri", "sky.exr"}}}};
  EXPECT_THAT(error(), HasSubstr("/environment/uri: found a file that is not an EXR"));
}

TEST_F(GltfEnvironment, lamps_take_the_shapes_of_their_kind) {
  const Light panel = light("point", {{"rectangle", {{"width", 2}, {"height", 0.5}}}});
  EXPECT_EQ(std::get<RectangleLamp>(panel.shape.value()).width_m, 2.0);
  EXPECT_EQ(std::get<RectangleLamp>(panel.shape.value()).height_m, 0.5);
  const Light disk = light("spot", {{"disk", {{"radius", 0.3}}}});
  EXPECT_EQ(std::get<DiskLamp>(disk.shape.value()).radius_m, 0.3);
  const Light ball = light("point", {{"sphere", {{"radius", 0.2}}}});
  EXPECT_EQ(std::get<SphereLamp>(ball.shape.value()).radius_m, 0.2);
  const Light sun = light("directional", {{"angle_deg", 0.53}});
  EXPECT_EQ(std::get<SkyDisc>(sun.shape.value()).angle_deg, 0.53);
}

TEST_F(GltfEnvironment, shape_of_another_kind_of_lamp_is_an_error) {
  for (const auto& [type, shape] : std::vector<std::pair<const char*, Json>>{
           {"directional", {{"sphere", {{"radius", 1}}}}},
           {"point", {{"angle_deg", 1}}},
           {"point", {{"disk", {{"radius", 0}}}}},
           {"point", {{"disk", {{"radius", 1}}}, {"sphere", {{"radius", 1}}}}},
           {"directional", {{"angle_deg", 0}}},
           {"spot", Json::object()}}) {
    try {
      light(type, shape);
      ADD_FAILURE() << type << shape;
    } catch (const Error& caught) {
      EXPECT_THAT(caught.what(), HasSubstr("/extensions/ABBE_light/shape")) << type << shape;
    }
  }
}

TEST_F(GltfEnvironment, emission_says_whether_it_lights_others) {
  material()["emissiveFactor"] = {1, 1, 1};
  EXPECT_EQ(load().materials.at(0).lights_others, LightsOthers::Auto);
  abbe_material()["emission"] = {{"light", true}};
  EXPECT_EQ(load().materials.at(0).lights_others, LightsOthers::Yes);
  EXPECT_FALSE(load().materials.at(0).emission);
  abbe_material()["emission"] = {{"light", false}, {"luminance", 3}};
  EXPECT_EQ(load().materials.at(0).lights_others, LightsOthers::No);
  EXPECT_EQ(load().materials.at(0).emission.value().luminance_cd_per_m2, 3.0);
}

TEST_F(GltfEnvironment, emission_lights_where_a_file_has_no_lamps) {
  EXPECT_TRUE(load().emissive_light);
  document["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  EXPECT_TRUE(load().emissive_light);  // None stands in the scene.
  node()["extensions"]["KHR_lights_punctual"]["light"] = 0;
  EXPECT_FALSE(load().emissive_light);
}

// By the definition of EnvironmentImage: +Y at the top, +X in the middle, -Z a quarter from the
// left.
Vec3f seen(const EnvironmentImage& image, const Vec3d& direction) {
  const Vec3d d = glm::normalize(direction);
  const double u = 0.5 + std::atan2(d.z, d.x) / (2.0 * kPi), v = std::acos(d.y) / kPi;
  const auto x = std::min(static_cast<int>(u * image.width), image.width - 1);
  const auto y = std::min(static_cast<int>(v * image.height), image.height - 1);
  return image.rgb_rec709[static_cast<std::size_t>(y * image.width + x)];
}

const std::array<Vec3d, 6> kAxes{
    {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};

TEST(CubeMap, faces_are_seen_from_inside_along_their_axes) {
  CubeMap cube{8, {}};
  for (std::size_t f = 0; f < 6; ++f) {
    cube.faces[f].assign(64, Vec3f(static_cast<float>(f)));
    cube.faces[f][7] = Vec3f(10.0f + static_cast<float>(f));  // At the top right.
  }
  const EnvironmentImage image = equirectangular(cube, Mat3d(1.0));
  EXPECT_EQ(image.width, 32);
  EXPECT_EQ(image.height, 16);
  // Where the top of each image is; right is then ahead x up.
  const std::array<Vec3d, 6> up{
      {{0, 1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}, {0, 1, 0}, {0, 1, 0}}};
  for (std::size_t f = 0; f < 6; ++f) {
    EXPECT_EQ(seen(image, kAxes[f] + Vec3d(1e-3)).x, static_cast<float>(f));
    const Vec3d right = glm::cross(kAxes[f], up[f]);
    const Vec3d corner = kAxes[f] + 0.875 * (right + up[f]);
    EXPECT_EQ(texel_along(cube, corner).x, 10.0f + static_cast<float>(f));
  }
}

TEST(CubeMap, light_of_all_directions_stays_what_it_was) {
  CubeMap cube{8, {}};
  std::mt19937 chance(1);
  double on_faces = 0.0;
  for (auto& face : cube.faces) {
    for (int t = 0; t < 64; ++t) {
      face.emplace_back(static_cast<float>(chance() % 1000));
      // The solid angle of a small square on the cube at x, y beside the middle: A / r^3.
      const double x = (t % 8 + 0.5) / 4.0 - 1.0, y = (t / 8 + 0.5) / 4.0 - 1.0;
      on_faces += face.back().x / 16.0 / std::pow(1.0 + x * x + y * y, 1.5);
    }
  }
  const EnvironmentImage image = equirectangular(cube, Mat3d(1.0));
  double around = 0.0;
  for (std::size_t i = 0; i < image.rgb_rec709.size(); ++i) {
    const double row = static_cast<double>(i / static_cast<std::size_t>(image.width));
    const double area =
        2.0 * kPi / image.width *
        (std::cos(kPi * row / image.height) - std::cos(kPi * (row + 1.0) / image.height));
    around += area * image.rgb_rec709[i].x;
  }
  // Sixteen directions a texel, the mid-point rule on the cube: each a few thousandths off.
  EXPECT_NEAR(around / on_faces, 1.0, 5e-3);
}

class ImageBasedLight : public GltfTest {
 protected:
  ImageBasedLight() { use_faces(51); }

  // Faces of one colour: the n-th has the code 40 n in red and, as RGBD, this divisor.
  void use_faces(std::uint8_t alpha) {
    document["images"] = Json::array();
    document["extensionsUsed"] = {"EXT_lights_image_based"};
    for (int f = 0; f < 6; ++f) {
      const auto red = static_cast<std::uint8_t>(40 * f);
      PngBytes row;
      for (int x = 0; x < 4; ++x) row.insert(row.end(), {red, 0, 255, alpha});
      const PngBytes bytes = png_bytes(4, 4, 8, PngRgba, {row, row, row, row});
      const std::string name = "face" + std::to_string(f) + ".png";
      write(name, {bytes.begin(), bytes.end()});
      document["images"].push_back({{"uri", name}});
    }
    light() = {{"intensity", 3.0},
               {"name", "dusk"},
               {"specularImages", {{0, 1, 2, 3, 4, 5}}},
               {"specularImageSize", 4},
               {"irradianceCoefficients", Json::array()}};
    document["scenes"][0]["extensions"]["EXT_lights_image_based"] = {{"light", 0}};
  }
  Json& light() { return document["extensions"]["EXT_lights_image_based"]["lights"][0]; }
};

TEST_F(ImageBasedLight, faces_are_luminances_around_the_scene) {
  const Scene scene = load();
  ASSERT_TRUE(scene.environment);
  EXPECT_EQ(scene.environment->name, "EXT_lights_image_based \"dusk\"");
  EXPECT_EQ(scene.environment->scale, 3.0);
  EXPECT_THAT(notes_text(), HasSubstr("six faces of 4x4 RGBD pixels"));
  const EnvironmentImage& image = scene.environment->image;
  for (std::size_t f = 0; f < 6; ++f) {
    const Vec3f found = seen(image, kAxes[f] + Vec3d(0.1));
    const float red = static_cast<float>(40 * f) / 255.0f;
    EXPECT_NEAR(found.x, 5.0f * std::pow(red, 2.2f), 1e-5f);  // A few roundings.
    EXPECT_NEAR(found.z, 5.0f, 1e-5f);
  }
}

TEST_F(ImageBasedLight, rotation_turns_it_and_opaque_images_are_srgb) {
  use_faces(255);
  const double h = std::sqrt(0.5);
  light()["rotation"] = {0, h, 0, h};  // 90 degrees about +Y: +Z comes to be at +X.
  const Scene scene = load();
  EXPECT_THAT(notes_text(), HasSubstr("4x4 sRGB pixels"));
  const EnvironmentImage& image = scene.environment->image;
  const std::array<std::size_t, 6> shown{4, 5, 2, 3, 1, 0};
  for (std::size_t f = 0; f < 6; ++f) {
    const double code = 40.0 * static_cast<double>(shown[f]) / 255.0;
    const double red = code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4);
    EXPECT_NEAR(seen(image, kAxes[f] + Vec3d(0.1)).x, red, 1e-5);
  }
}

TEST_F(ImageBasedLight, what_is_wrong_is_said_at_its_place) {
  const Json good = document;
  light()["specularImages"] = {{0, 1, 2}};
  EXPECT_THAT(error(), HasSubstr("specularImages/0: found an array of 3"));
  document = good;
  light()["specularImages"][0][3] = 9;
  EXPECT_THAT(error(), HasSubstr("specularImages/0/3"));
  document = good;
  light()["rotation"] = {0, 0, 0, 0};
  EXPECT_THAT(error(), HasSubstr("a quaternion of length 0"));
  document = good;
  document["scenes"][0]["extensions"]["EXT_lights_image_based"]["light"] = 1;
  EXPECT_THAT(error(), HasSubstr("/scenes/0/extensions/EXT_lights_image_based/light"));
  document = good;
  document["images"][2]["uri"] = "gone.png";
  EXPECT_FALSE(load().environment);
  EXPECT_THAT(notes_text(), HasSubstr("the environment /extensions/EXT_lights_image_based"));
}

}  // namespace
}  // namespace abbe
