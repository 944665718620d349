/// Settings to what a file says, and back.
#include "abbe/session/provenance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "abbe/base/error.h"
#include "abbe/session/picture.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

using testing::HasSubstr;

PreparedScene prepared() {
  PreparedScene scene;
  scene.scene.cameras.emplace_back();
  scene.scene.cameras.front().name = "eye";
  scene.scene.name = "stage";
  scene.lamp_id = "illuminant/A";
  return scene;
}

// The header of a whole file with these attributes.
ExrHeader header_of(const RenderSettings& settings) {
  ExrHeader header;
  header.width = settings.size.x;
  header.height = settings.size.y;
  if (settings.crop) {
    header.width = settings.crop->width();
    header.height = settings.crop->height();
    header.data_origin = {settings.crop->x0, settings.crop->y0};
    header.full_size = settings.size;
  }
  header.compression = "piz";
  header.tile_size = 64;
  header.attributes = provenance(prepared(), settings, {}, read_standards(test::catalogue()));
  return header;
}

TEST(Recipe, of_a_file_has_the_settings_that_made_it) {
  RenderSettings settings;
  settings.size = {64, 36};
  settings.crop = PixelRect{3, 4, 20, 30};
  settings.samples_per_pixel = 7;
  settings.wavelengths.count = 12;
  settings.wavelengths.range_min_nm = 400.5;
  settings.bands = parse_bands("400.5:700.5:2.5");
  settings.filter = "mitchell";
  settings.max_depth = 3;
  settings.cutoff = 0.1;
  settings.drop = true;
  settings.multiple_scattering = true;
  settings.uplift = Uplift::MallettYuksel;
  settings.caustics = false;
  settings.inner_reflections = 4;
  settings.seed = 4294967295u;
  settings.aovs = {"Z", "albedo"};
  settings.frozen.insert(Cause::Lamps);
  const std::optional<Recipe> recipe = recipe_of(header_of(settings));
  ASSERT_TRUE(recipe);
  const RenderSettings& read = recipe->settings;
  EXPECT_EQ(read.size, settings.size);
  EXPECT_EQ(read.crop->x0, 3);
  EXPECT_EQ(read.crop->y1, 30);
  EXPECT_EQ(read.samples_per_pixel, 7);
  EXPECT_EQ(read.wavelengths.count, 12);
  EXPECT_EQ(read.wavelengths.range_min_nm, 400.5);
  EXPECT_EQ(read.wavelengths.range_max_nm, settings.wavelengths.range_max_nm);
  EXPECT_EQ(bands_text(*read.bands), "400.5:700.5:2.5");
  EXPECT_EQ(read.filter, "mitchell");
  EXPECT_EQ(read.max_depth, 3);
  EXPECT_EQ(read.cutoff, 0.1);
  EXPECT_TRUE(read.drop);
  EXPECT_TRUE(read.multiple_scattering);
  EXPECT_EQ(read.uplift, Uplift::MallettYuksel);
  EXPECT_FALSE(read.caustics);
  EXPECT_EQ(read.inner_reflections, 4);
  EXPECT_EQ(read.seed, settings.seed);
  EXPECT_EQ(read.aovs, settings.aovs);
  EXPECT_EQ(read.frozen, settings.frozen);
  EXPECT_EQ(recipe->scene.scene, "stage");
  EXPECT_EQ(recipe->scene.camera, "eye");
  EXPECT_EQ(recipe->scene.lamp, "illuminant/A");
  EXPECT_EQ(recipe->development.white, "illuminant/D65");
  EXPECT_EQ(recipe->development.adaptation, "cat16");
  EXPECT_EQ(recipe->color_space, kRenderSpace);
  EXPECT_EQ(recipe->form.compression, "piz");
  EXPECT_EQ(recipe->form.tile_size, 64);
  // The same recipe gives the same attributes.
  EXPECT_EQ(header_of(read).attributes, header_of(settings).attributes);
}

TEST(Recipe, of_a_posed_scene_says_when) {
  PreparedScene posed = prepared();
  const RenderSettings settings;
  posed.time_s = 1.0 / 3.0;
  posed.animation = "walk";
  posed.variant = "sea";
  posed.rig_time_s = 0.25;
  ExrHeader header = header_of(settings);
  EXPECT_FALSE(header.attributes.contains("abbe:time"));
  EXPECT_FALSE(header.attributes.contains("abbe:rigTime"));
  header.attributes = provenance(posed, settings, {}, read_standards(test::catalogue()));
  const std::optional<Recipe> recipe = recipe_of(header);
  ASSERT_TRUE(recipe);
  EXPECT_EQ(recipe->scene.time_s, 1.0 / 3.0);
  EXPECT_EQ(recipe->scene.animation, "walk");
  EXPECT_EQ(recipe->scene.variant, "sea");
  EXPECT_EQ(recipe->scene.rig_time_s, 0.25);
}

TEST(PreparedScene, name_of_a_camera_is_what_finds_it_again) {
  PreparedScene scene;
  const auto names = [&scene](const std::vector<std::string>& cameras) {
    scene.scene.cameras.clear();
    std::vector<std::string> found;
    for (const std::string& name : cameras) scene.scene.cameras.emplace_back().name = name;
    for (scene.camera = 0; scene.camera < cameras.size(); ++scene.camera) {
      found.push_back(scene.camera_name());
    }
    return found;
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(names({"a", "b", ""}), (Names{"a", "b", "2"}));
  EXPECT_EQ(names({"a", "a"}), (Names{"0", "1"}));
  EXPECT_EQ(names({"a", "default"}), (Names{"a", "1"}));
  EXPECT_EQ(names({"1", ""}), (Names{"1", "#1"}));
  EXPECT_EQ(names({"#1", "x"}), (Names{"0", "x"}));
  scene.scene.cameras.clear();
  scene.camera = 0;
  scene.has_default_camera = add_default_camera(scene.scene);
  EXPECT_EQ(scene.camera_name(), "default");
}

TEST(Recipe, of_lines_has_no_range) {
  RenderSettings settings;
  settings.wavelengths.exact_nm = {486.13, 587.56};
  const std::optional<Recipe> recipe = recipe_of(header_of(settings));
  ASSERT_TRUE(recipe);
  EXPECT_EQ(recipe->settings.wavelengths.exact_nm, settings.wavelengths.exact_nm);
}

TEST(Recipe, of_a_file_that_no_render_made_is_absent) {
  EXPECT_FALSE(recipe_of(ExrHeader{}));
  const RenderSettings settings;
  ExrHeader developed = header_of(settings);
  developed.attributes["abbe:developed"] = std::string("anew");
  EXPECT_FALSE(recipe_of(developed));
}

TEST(Recipe, of_hostile_attributes_is_an_input_error) {
  const std::pair<const char*, Attribute> wrong[] = {
      {"abbe:mode", std::string("cmyk")},      {"abbe:mode", 3},
      {"abbe:samples", std::string("many")},   {"abbe:samples", -1},
      {"abbe:range", std::string("1:2:3 nm")}, {"abbe:bands", std::string("x")},
      {"abbe:lines", std::string("1,,2 nm")},  {"abbe:filter", std::string("sinc")},
      {"abbe:freeze", std::string("noise")},   {"abbe:aov", std::string("depth")},
      {"abbe:seed", std::string("-5")},        {"abbe:seed", std::string("1e300")},
      {"abbe:seed", std::string("1.5")},       {"abbe:seed", std::string("4294967296")},
      {"abbe:caustics", std::string("maybe")}, {"abbe:caustics", std::string()},
      {"abbe:multipleScattering", 2},          {"abbe:drop", 7},
      {"abbe:uplift", std::string("zzz")},     {"abbe:adaptation", std::string("zzz")}};
  for (const auto& [name, value] : wrong) {
    ExrHeader header = header_of({});
    header.attributes[name] = value;
    try {
      (void)recipe_of(header);
      ADD_FAILURE() << "no error for " << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.detail().kind, ErrorKind::Input) << name;
      EXPECT_THAT(error.what(), HasSubstr("another version"));
    }
  }
}

TEST(Picture, of_a_camera_that_is_none_is_a_usage_error) {
  const Standards standards = read_standards(test::catalogue());
  Notes notes;
  const RenderSettings settings;
  EXPECT_THROW((void)render_picture(PreparedScene(), settings, standards, notes), Error);
  PreparedScene scene = prepared();
  scene.camera = 1;
  EXPECT_THROW((void)render_picture(scene, settings, standards, notes), Error);
}

TEST(Picture, error_of_a_setting_names_its_field) {
  const Standards standards = read_standards(test::catalogue());
  Notes notes;
  const auto rejects = [&](const char* field, const auto& change) {
    RenderSettings settings;
    change(settings);
    try {
      (void)render_picture(prepared(), settings, standards, notes);
      ADD_FAILURE() << "no error for " << field;
    } catch (const Error& error) {
      EXPECT_EQ(error.detail().kind, ErrorKind::Usage);
      EXPECT_EQ(error.detail().where, field);
      EXPECT_EQ(std::string(error.what()).find("--"), std::string::npos) << error.what();
    }
  };
  rejects("samples_per_pixel", [](RenderSettings& settings) { settings.samples_per_pixel = 0; });
  rejects("wavelengths.count", [](RenderSettings& settings) { settings.wavelengths.count = 65; });
  rejects("aovs", [](RenderSettings& settings) { settings.aovs = {"spectralAlbedo"}; });
  rejects("bands", [](RenderSettings& settings) {
    settings.bands = BandOptions{400.0, 700.0, 0.0};
  });
  rejects("mode", [](RenderSettings& settings) { settings.mode = static_cast<Mode>(7); });
  rejects("uplift", [](RenderSettings& settings) { settings.uplift = static_cast<Uplift>(2); });
  rejects("cluster_lanes", [](RenderSettings& settings) { settings.cluster_lanes = -1; });
  rejects("aovs", [](RenderSettings& settings) { settings.aovs = {"Z", "P", "Z"}; });
  rejects("wavelengths.exact_nm", [](RenderSettings& settings) {
    settings.wavelengths.exact_nm = {500.0, 500.0000001};  // One name of a channel.
  });
  rejects("crop", [](RenderSettings& settings) { settings.crop = PixelRect{0, 0, 961, 1}; });
  rejects("size", [](RenderSettings& settings) { settings.size = {65536, 65536}; });
  rejects("bands", [](RenderSettings& settings) {
    settings.mode = Mode::Rgb;
    settings.bands = parse_bands("400:700:10");
  });
}

}  // namespace
}  // namespace abbe
