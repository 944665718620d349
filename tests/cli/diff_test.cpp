/// `abbe diff`: numbers, thresholds and maps of two images.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "abbe/image/exr/exr.h"
#include "abbe/image/raster/raster.h"
#include "program.h"

namespace abbe::test {
namespace {

using ::testing::HasSubstr;

class DiffTest : public ProgramTest {
 protected:
  static Image flat(float r, float g, float b) {
    Image image;
    image.width = 16;
    image.height = 8;
    image.channels = {"R", "G", "B"};
    for (int i = 0; i < 16 * 8; ++i) image.pixels.insert(image.pixels.end(), {r, g, b});
    return image;
  }
  void write_image(const std::string& name, const Image& image) const {
    name.ends_with(".exr") ? write_exr(file(name), image, {}) : write_raster(file(name), image);
  }
  nlohmann::json diff(Arguments arguments) const {
    arguments.insert(arguments.begin(), "diff");
    arguments.emplace_back("--json");
    const Outcome run = abbe(arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return nlohmann::json::parse(run.out);
  }
};

TEST_F(DiffTest, numbers_of_an_offset_are_the_closed_forms) {
  write_image("a.exr", flat(0.6f, 0.5f, 0.5f));
  write_image("b.exr", flat(0.5f, 0.5f, 0.5f));
  const auto json = diff({"a.exr", "b.exr"});
  EXPECT_NEAR(json["channels"]["R"]["rmse"].get<double>(), 0.1, 1e-7);      // 0.6 as a float
  EXPECT_NEAR(json["channels"]["R"]["psnr_db"].get<double>(), 20.0, 1e-5);  // the same
  EXPECT_TRUE(json["channels"]["G"]["psnr_db"].is_null());
  EXPECT_NEAR(json["all"]["rmse"].get<double>(), 0.1 / std::sqrt(3.0), 1e-7);  // the same
  EXPECT_NEAR(json["all"]["max"].get<double>(), 0.1, 1e-7);                    // the same
}

TEST_F(DiffTest, equal_images_differ_by_nothing) {
  write_image("a.exr", flat(0.6f, 0.5f, -0.5f));
  const auto json = diff({"a.exr", "a.exr", "--fail", "max=0", "--fail", "de2000.max=0", "--fail",
                          "deitp.max=0", "--fail", "flip.max=0", "--fail", "psnr=100"});
  EXPECT_EQ(json["all"]["rmse"], 0.0);
  EXPECT_EQ(json["flip"]["max"], 0.0);
  for (const auto& threshold : json["thresholds"]) EXPECT_EQ(threshold["exceeded"], false);
}

TEST_F(DiffTest, delta_e_itp_of_greys_is_that_of_their_signals) {
  write_image("a.exr", flat(10.0f, 10.0f, 10.0f));
  write_image("b.exr", flat(1.0f, 1.0f, 1.0f));
  const auto json = diff({"a.exr", "b.exr"});
  // 1000 and 100 cd/m² in the quantiser of ST 2084; its printed digits times 720.
  EXPECT_NEAR(json["delta_e_itp"]["mean"].get<double>(), 720.0 * (0.751827 - 0.508078), 1e-3);
}

TEST_F(DiffTest, space_of_a_file_is_taken_out_before_colours_are_compared) {
  for (const char* space : {"Linear Rec.709 (sRGB)", "ACEScg"}) {
    const Outcome run = abbe({"render", "scene.gltf", "-o", std::string(space) + ".exr", "--size",
                              "16x12", "--spp", "1", "--colorspace", space});
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  const auto json = diff({"ACEScg.exr", "Linear Rec.709 (sRGB).exr"});
  EXPECT_GT(json["all"]["max"].get<double>(), 0.01);
  EXPECT_LT(json["delta_e2000"]["max"].get<double>(), 0.01);  // matrices of single precision
}

TEST_F(DiffTest, threshold_passed_exits_with_1_and_says_which) {
  write_image("a.exr", flat(0.6f, 0.5f, 0.5f));
  write_image("b.exr", flat(0.5f, 0.5f, 0.5f));
  for (const char* limit : {"rmse=0.05", "max@R=0.09", "psnr@color=40", "flip=0", "de2000=1"}) {
    const Outcome run = abbe({"diff", "a.exr", "b.exr", "--fail", limit});
    EXPECT_EQ(run.exit_code, 1) << limit;
    EXPECT_THAT(run.out, HasSubstr("FAIL"));
  }
  for (const char* limit : {"rmse=0.1", "max@G=0", "psnr@color=20", "nonfinite=0"}) {
    EXPECT_EQ(abbe({"diff", "a.exr", "b.exr", "--fail", limit}).exit_code, 0) << limit;
  }
}

TEST_F(DiffTest, value_that_is_not_finite_is_counted_and_can_fail) {
  Image broken = flat(0.5f, 0.5f, 0.5f);
  broken.pixels[7] = std::nanf("");
  write_image("a.exr", broken);
  write_image("b.exr", flat(0.5f, 0.5f, 0.5f));
  EXPECT_EQ(abbe({"diff", "a.exr", "b.exr", "--fail", "nonfinite=0"}).exit_code, 1);
}

TEST_F(DiffTest, images_of_different_sizes_are_an_error_that_names_both) {
  Image small = flat(0.5f, 0.5f, 0.5f);
  write_image("a.exr", small);
  --small.height;
  small.pixels.resize(small.pixels.size() - 3 * static_cast<std::size_t>(small.width));
  write_image("b.exr", small);
  const Outcome run = abbe({"diff", "a.exr", "b.exr"});
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_THAT(run.err, HasSubstr("a.exr against b.exr: found"));
}

TEST_F(DiffTest, bands_are_compared_each_and_together) {
  for (const char* seed : {"1", "2"}) {
    const Outcome run = abbe({"render", "scene.gltf", "-o", std::string(seed) + ".exr", "--seed",
                              seed, "--size", "16x12", "--spp", "2", "--bands", "400:700:100"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  const auto json = diff({"1.exr", "2.exr", "--fail", "rmse@S0.450,000000nm=1"});
  EXPECT_EQ(json["channels"].size(), 6u);
  double squares = 0.0;
  for (const char* band : {"S0.450,000000nm", "S0.550,000000nm", "S0.650,000000nm"}) {
    squares += std::pow(json["channels"][band]["rmse"].get<double>(), 2.0);
  }
  EXPECT_GT(squares, 0.0);
  const double spectral = json["spectral"]["rmse"].get<double>();
  EXPECT_NEAR(spectral * spectral / (squares / 3.0), 1.0, 1e-12);  // rounding
}

TEST_F(DiffTest, map_shows_where_the_difference_is) {
  Image image = flat(0.5f, 0.5f, 0.5f);
  image.at(3, 2, 1) = 0.9f;
  write_image("a.exr", image);
  write_image("b.exr", flat(0.5f, 0.5f, 0.5f));
  for (const char* map : {"flip", "de2000", "deitp", "max"}) {
    ASSERT_EQ(
        abbe({"diff", "a.exr", "b.exr", "-o", "map.png", "-o", "map.exr", "--map", map}).exit_code,
        0);
    const Image values = read_exr(file("map.exr"));
    EXPECT_EQ(std::max_element(values.pixels.begin(), values.pixels.end()) - values.pixels.begin(),
              2 * 16 + 3)
        << map;
    const Image picture = read_raster(file("map.png"));
    EXPECT_EQ(picture.at(15, 7, 0), 0.0f) << map;
    EXPECT_GT(picture.at(3, 2, 0), 0.1f) << map;
  }
}

TEST_F(DiffTest, images_that_do_not_match_are_an_error) {
  write_image("a.exr", flat(0.5f, 0.5f, 0.5f));
  Image other = flat(0.5f, 0.5f, 0.5f);
  other.channels = {"R", "G", "Z"};
  write_image("channels.exr", other);
  other = flat(0.5f, 0.5f, 0.5f);
  other.width = 8;
  other.height = 16;
  write_image("size.exr", other);
  other = flat(0.5f, 0.5f, 0.5f);
  other.data_origin = {2, 2};
  other.full_size = {32, 32};
  write_image("crop.exr", other);
  for (const char* name : {"channels.exr", "size.exr", "crop.exr", "none.exr"}) {
    for (const bool swapped : {false, true}) {
      const Outcome run = swapped ? abbe({"diff", name, "a.exr"}) : abbe({"diff", "a.exr", name});
      EXPECT_EQ(run.exit_code, 3) << name;
      EXPECT_TRUE(is_one_error_line(run.err));
      EXPECT_EQ(run.out, "");
    }
  }
  EXPECT_EQ(abbe({"diff", "a.exr", "channels.exr", "--channels", "R,G"}).exit_code, 0);
}

TEST_F(DiffTest, wrong_options_are_usage_errors_that_list_the_right_ones) {
  write_image("a.exr", flat(0.5f, 0.5f, 0.5f));
  write_image("a.png", flat(0.5f, 0.5f, 0.5f));
  const std::vector<std::pair<Arguments, std::string>> mistakes{
      {{"--fail", "ssim=1"}, "rmse, relmse, psnr"},
      {{"--fail", "rmse=small"}, "METRIC=VALUE"},
      {{"--fail", "rmse"}, "METRIC=VALUE"},
      {{"--fail", "rmse@Z=1"}, "R, G, B, color"},
      {{"--fail", "flip@R=1"}, "without a channel"},
      {{"--map", "rainbow"}, "flip, de2000, deitp, max"},
      {{"--channels", "R,Q"}, "R, G, B"},
      {{"--ppd", "0"}, "above 0"},
      {{"--white", "-1"}, "above 0"},
  };
  for (const auto& [options, text] : mistakes) {
    Arguments arguments{"diff", "a.exr", "a.exr"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome run = abbe(arguments);
    EXPECT_EQ(run.exit_code, 2) << options.back();
    EXPECT_THAT(run.err, HasSubstr(text));
  }
  EXPECT_EQ(abbe({"diff", "a.exr", "a.png"}).exit_code, 2);
}

TEST_F(DiffTest, rms_and_largest_error_are_those_of_idiff) {
  for (const char* mode : {"spectral", "rgb"}) {
    const Outcome run = abbe({"render", "scene.gltf", "-o", std::string(mode) + ".exr", "--mode",
                              mode, "--size", "24x16", "--spp", "1"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  const auto json = diff({"spectral.exr", "rgb.exr"});
  const std::string command =
      "cd '" + folder().string() + "' && idiff spectral.exr rgb.exr > idiff.txt";
  (void)std::system(command.c_str());
  const std::string text = bytes("idiff.txt");
  const auto number_after = [&text](const std::string& label) {
    const std::size_t at = text.find(label);
    EXPECT_NE(at, std::string::npos) << text;
    return std::stod(text.substr(at + label.size()));
  };
  const double rms = number_after("RMS error = ");
  EXPECT_NEAR(json["all"]["rmse"].get<double>() / rms, 1.0, 1e-5);  // six printed digits
  EXPECT_NEAR(json["all"]["psnr_db"].get<double>(), number_after("Peak SNR = "), 1e-3);
  EXPECT_NEAR(json["all"]["max"].get<double>() / number_after("Max error  = "), 1.0, 1e-5);
}

}  // namespace
}  // namespace abbe::test
