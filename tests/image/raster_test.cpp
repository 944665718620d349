#include "image/raster.h"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/error.h"
#include "image/temporary_folder.h"

namespace abbe {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Image row_of(std::vector<float> values) {
  Image image;
  image.width = static_cast<int>(values.size() / 3);
  image.height = 1;
  image.channels = {"R", "G", "B"};
  image.pixels = std::move(values);
  return image;
}

TEST(Raster, values_are_clamped_and_rounded_to_the_nearest_code) {
  const TemporaryFolder folder;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  const Image image = row_of({0.0f, 0.499f / 255.0f, 0.501f / 255.0f, 0.5f, 1.0f, 1.049f, -0.3f,
                              nan, infinity, -infinity, 254.499f / 255.0f, 254.501f / 255.0f});
  for (const char* name : {"a.png", "a.tif"}) {
    write_raster(folder / name, image);
    const Image read = read_raster(folder / name);
    std::vector<int> codes;
    for (const float value : read.pixels)
      codes.push_back(static_cast<int>(std::lround(value * 255.0f)));
    EXPECT_THAT(codes, ElementsAre(0, 0, 1, 128, 255, 255, 0, 0, 255, 0, 254, 255)) << name;
  }
}

TEST(Raster, same_pixels_give_the_same_bytes) {
  const TemporaryFolder folder;
  const Image image = row_of({0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f});
  for (const std::string suffix : {".png", ".jpg", ".tif"}) {
    write_raster(folder / ("a" + suffix), image);
    write_raster(folder / ("b" + suffix), image);
    EXPECT_EQ(bytes_of(folder / ("a" + suffix)), bytes_of(folder / ("b" + suffix)));
    const auto input = OIIO::ImageInput::open((folder / ("a" + suffix)).string());
    ASSERT_TRUE(input);
    EXPECT_EQ(input->spec().get_string_attribute("DateTime"), "") << suffix;
  }
}

TEST(Raster, srgb_is_tagged_and_other_displays_are_not) {
  const TemporaryFolder folder;
  const auto is_tagged_srgb = [&](const char* name) {
    const auto bytes = bytes_of(folder / name);
    const std::string key = "sRGB";
    return std::search(bytes.begin(), bytes.end(), key.begin(), key.end()) != bytes.end();
  };
  Image image = row_of({0.1f, 0.2f, 0.3f});
  write_raster(folder / "plain.png", image);
  image.attributes[kDisplayAttribute] = std::string("sRGB - Display");
  write_raster(folder / "srgb.png", image);
  image.attributes[kDisplayAttribute] = std::string("Display P3 - Display");
  write_raster(folder / "p3.png", image);
  EXPECT_TRUE(is_tagged_srgb("plain.png"));
  EXPECT_TRUE(is_tagged_srgb("srgb.png"));
  EXPECT_FALSE(is_tagged_srgb("p3.png"));
}

TEST(Raster, only_r_g_b_of_many_channels_are_written) {
  const TemporaryFolder folder;
  Image image;
  image.width = 1;
  image.height = 1;
  image.channels = {"Z", "B", "G", "R"};
  image.pixels = {9.0f, 0.2f, 0.4f, 0.6f};
  write_raster(folder / "a.png", image);
  const Image read = read_raster(folder / "a.png");
  EXPECT_THAT(read.channels, ElementsAre("R", "G", "B"));
  EXPECT_NEAR(read.pixels[0], 0.6f, 0.5f / 255.0f);  // half a code
  EXPECT_NEAR(read.pixels[2], 0.2f, 0.5f / 255.0f);  // half a code
}

TEST(Raster, unknown_suffix_folder_or_channels_are_an_output_error) {
  const TemporaryFolder folder;
  const auto rejects = [](const std::filesystem::path& file, const Image& image) {
    try {
      write_raster(file, image);
      ADD_FAILURE() << "no error for " << file;
    } catch (const Error& error) {
      EXPECT_EQ(error.detail().kind, ErrorKind::Output);
    }
  };
  const Image image = row_of({0.1f, 0.2f, 0.3f});
  rejects(folder / "a.bmp", image);
  rejects(folder / "a", image);
  rejects(folder / "missing/a.png", image);
  Image grey = image;
  grey.channels = {"X", "Y", "Z"};
  rejects(folder / "a.png", grey);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Raster, read_of_a_missing_or_broken_file_is_an_input_error) {
  const TemporaryFolder folder;
  write_bytes(folder / "a.png", std::vector<std::uint8_t>(100, 'x'));
  for (const char* name : {"a.png", "missing.png"}) {
    try {
      read_raster(folder / name);
      ADD_FAILURE() << "no error for " << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.detail().kind, ErrorKind::Input);
      EXPECT_THAT(error.what(), HasSubstr(name));
    }
  }
}

}  // namespace
}  // namespace abbe
