#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "abbe/base/error.h"
#include "abbe/image/raster/raster.h"
#include "image/png_bytes.h"
#include "image/temporary_folder.h"

namespace abbe {
namespace {

using ::testing::ElementsAre;
using ::testing::FloatEq;
using ::testing::HasSubstr;

void expect_rejected(std::span<const std::uint8_t> bytes, const std::string& part) {
  try {
    decode_texture(bytes, "a.gltf: /images/0");
    ADD_FAILURE() << "no error, expected " << part;
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().kind, ErrorKind::Input);
    EXPECT_THAT(error.what(), HasSubstr(part));
    EXPECT_THAT(error.what(), HasSubstr("a.gltf: /images/0"));
  }
}

TEST(Texture, first_row_is_the_top_row) {
  const auto bytes = png_bytes(1, 2, 8, PngRgb, {{1, 2, 3}, {4, 5, 6}});
  EXPECT_THAT(decode_texture(bytes, "").rgba8, ElementsAre(1, 2, 3, 255, 4, 5, 6, 255));
}

TEST(Texture, every_8_bit_colour_type_becomes_rgba) {
  EXPECT_THAT(decode_texture(png_bytes(2, 1, 8, PngGrey, {{10, 200}}), "").rgba8,
              ElementsAre(10, 10, 10, 255, 200, 200, 200, 255));
  EXPECT_THAT(decode_texture(png_bytes(2, 1, 8, PngGreyAlpha, {{10, 0, 200, 128}}), "").rgba8,
              ElementsAre(10, 10, 10, 0, 200, 200, 200, 128));
  EXPECT_THAT(
      decode_texture(png_bytes(2, 1, 8, PngPalette, {{1, 0}}, {{"PLTE", {9, 8, 7, 1, 2, 3}}}), "")
          .rgba8,
      ElementsAre(1, 2, 3, 255, 9, 8, 7, 255));
}

TEST(Texture, colour_is_not_multiplied_by_alpha) {
  const auto bytes = png_bytes(2, 1, 8, PngRgba, {{200, 100, 50, 0, 200, 100, 50, 128}});
  EXPECT_THAT(decode_texture(bytes, "").rgba8, ElementsAre(200, 100, 50, 0, 200, 100, 50, 128));
}

TEST(Texture, transparent_palette_entries_and_keys_become_alpha) {
  const auto palette =
      png_bytes(2, 1, 8, PngPalette, {{1, 0}}, {{"PLTE", {9, 8, 7, 1, 2, 3}}, {"tRNS", {0, 77}}});
  EXPECT_THAT(decode_texture(palette, "").rgba8, ElementsAre(1, 2, 3, 77, 9, 8, 7, 0));
  const auto key = png_bytes(2, 1, 8, PngRgb, {{1, 2, 3, 4, 5, 6}}, {{"tRNS", {0, 1, 0, 2, 0, 3}}});
  EXPECT_THAT(decode_texture(key, "").rgba8, ElementsAre(1, 2, 3, 0, 4, 5, 6, 255));
}

TEST(Texture, depths_below_8_bits_span_the_whole_range) {
  EXPECT_THAT(decode_texture(png_bytes(2, 1, 1, PngGrey, {{0x40}}), "").rgba8,
              ElementsAre(0, 0, 0, 255, 255, 255, 255, 255));
  EXPECT_THAT(decode_texture(png_bytes(2, 1, 2, PngGrey, {{0x60}}), "").rgba8,
              ElementsAre(85, 85, 85, 255, 170, 170, 170, 255));
}

TEST(Texture, sixteen_bits_stay_sixteen) {
  const auto bytes = png_bytes(1, 1, 16, PngRgba, {{0x80, 0, 0xff, 0xff, 0, 1, 0x40, 0}});
  const DecodedTexture texture = decode_texture(bytes, "");
  EXPECT_TRUE(texture.rgba8.empty());
  EXPECT_THAT(texture.rgba16, ElementsAre(32768, 65535, 1, 16384));
}

TEST(Texture, gamma_chunk_does_not_change_codes) {
  const auto bytes =
      png_bytes(1, 1, 8, PngRgb, {{100, 150, 200}}, {{"gAMA", {0, 0x01, 0x86, 0xa0}}});
  EXPECT_THAT(decode_texture(bytes, "").rgba8, ElementsAre(100, 150, 200, 255));
}

TEST(Texture, jpeg_is_decoded_within_its_loss) {
  const TemporaryFolder folder;
  Image image;
  image.width = 16;
  image.height = 16;
  image.channels = {"R", "G", "B"};
  for (int i = 0; i < 256; ++i) image.pixels.insert(image.pixels.end(), {0.8f, 0.4f, 0.2f});
  write_raster(folder / "a.jpg", image);
  const DecodedTexture texture = decode_texture(bytes_of(folder / "a.jpg"), "");
  ASSERT_EQ(texture.rgba8.size(), 1024u);
  EXPECT_NEAR(texture.rgba8[0], 204, 3);  // quality 95 and the rounding of YCbCr
  EXPECT_NEAR(texture.rgba8[1], 102, 3);  // the same
  EXPECT_NEAR(texture.rgba8[2], 51, 3);   // the same
  EXPECT_EQ(texture.rgba8[3], 255);
}

// 200 100 50 128, 10 20 30 255 above 7 8 9 3, 255 0 128 64, lossless, by libwebp.
const std::vector<std::uint8_t> kWebP{
    0x52, 0x49, 0x46, 0x46, 0x46, 0x00, 0x00, 0x00, 0x57, 0x45, 0x42, 0x50, 0x56, 0x50, 0x38, 0x4c,
    0x39, 0x00, 0x00, 0x00, 0x2f, 0x01, 0x40, 0x00, 0x10, 0x1f, 0xa0, 0xa6, 0x6d, 0x03, 0xe6, 0x4d,
    0x07, 0xcc, 0xc2, 0x2f, 0x20, 0x45, 0x6d, 0xa4, 0x40, 0x7b, 0x82, 0x7f, 0x59, 0x08, 0xe2, 0x2f,
    0x24, 0x20, 0xb2, 0x01, 0x0e, 0x9a, 0x68, 0x21, 0x99, 0x80, 0xc5, 0x50, 0x8c, 0xfe, 0x95, 0x1c,
    0xc1, 0x92, 0xda, 0xff, 0xdb, 0xee, 0xe2, 0x07, 0x08, 0x11, 0xfd, 0x0f, 0x01, 0x00};

TEST(Texture, webp_has_its_codes_to_half_a_code_over_alpha) {
  const DecodedTexture texture = decode_texture(kWebP, "");
  EXPECT_EQ(texture.width, 2);
  EXPECT_EQ(texture.height, 2);
  const std::vector<int> codes{200, 100, 50, 128, 10, 20, 30, 255, 7, 8, 9, 3, 255, 0, 128, 64};
  ASSERT_EQ(texture.rgba8.size(), codes.size());
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const int alpha = codes[i / 4 * 4 + 3];
    const double step = i % 4 == 3 || alpha == 255 ? 0.0 : 255.0 / alpha;
    EXPECT_NEAR(texture.rgba8[i], codes[i], 0.5 * step + (step > 0.0 ? 0.5 : 0.0)) << i;
  }
}

TEST(Texture, truncated_or_broken_webp_is_an_input_error) {
  for (std::size_t size = 16; size < kWebP.size(); ++size) {
    expect_rejected(std::span(kWebP).first(size), "truncated");
  }
  auto broken = kWebP;
  broken[20] ^= 0xff;  // The signature of its stream.
  expect_rejected(broken, "broken webp");
}

TEST(Texture, other_formats_are_an_input_error) {
  const auto text = [](const std::string& s) {
    return std::vector<std::uint8_t>(s.begin(), s.end());
  };
  expect_rejected({}, "empty");
  expect_rejected(text("8BPS and so on"), "neither as PNG nor as JPEG");
  expect_rejected(text("GIF89a..........."), "neither as PNG nor as JPEG");
  expect_rejected(text("II*\0............"), "neither as PNG nor as JPEG");
}

TEST(Texture, impossible_or_enormous_size_is_an_input_error) {
  expect_rejected(png_bytes(0, 0, 8, PngRgba, {{}}), "0x0");
  expect_rejected(png_bytes(0x7fffffff, 1, 8, PngRgba, {{}}), "2147483647x1");
  expect_rejected(png_bytes(0x80000001, 1, 8, PngRgba, {{}}), "2147483649x1");
  expect_rejected(png_bytes(65000, 65000, 8, PngRgba, {{}}), "65000x65000");
}

TEST(Texture, png_without_data_or_with_too_little_is_an_input_error) {
  expect_rejected(png_bytes(2, 2, 8, PngRgb, {}), "without image data");
  expect_rejected(png_bytes(2, 100, 8, PngRgb, {{1, 2, 3, 4, 5, 6}}), "broken png");
  expect_rejected(png_bytes(5000, 5000, 8, PngRgb, {{1, 2, 3, 4, 5, 6}}), "too little image data");
  auto damaged = png_bytes(1, 1, 8, PngRgb, {{1, 2, 3}});
  damaged[50] ^= 0x10;  // Inside the image data.
  expect_rejected(damaged, "damaged");
}

TEST(Texture, truncated_png_is_an_input_error_wherever_it_ends) {
  const auto bytes = png_bytes(4, 4, 8, PngGrey, std::vector<PngBytes>(4, {1, 2, 3, 4}));
  for (std::size_t size = 8; size < bytes.size(); ++size) {
    expect_rejected(std::span(bytes).first(size), "truncated");
  }
}

TEST(Texture, truncated_jpeg_is_an_input_error_wherever_it_ends) {
  const TemporaryFolder folder;
  Image image;
  image.width = 8;
  image.height = 8;
  image.channels = {"R", "G", "B"};
  image.pixels.assign(192, 0.3f);
  write_raster(folder / "a.jpg", image);
  const auto bytes = bytes_of(folder / "a.jpg");
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    expect_rejected(std::span(bytes).first(size), "expected a PNG, JPEG or WebP image");
  }
}

TEST(Texture, jpeg_that_claims_more_pixels_than_its_bytes_hold_is_an_input_error) {
  const TemporaryFolder folder;
  Image image;
  image.width = 8;
  image.height = 8;
  image.channels = {"R", "G", "B"};
  image.pixels.assign(192, 0.3f);
  write_raster(folder / "a.jpg", image);
  auto bytes = bytes_of(folder / "a.jpg");
  const std::vector<std::uint8_t> frame{0xff, 0xc0, 0, 17, 8};
  const auto at = std::search(bytes.begin(), bytes.end(), frame.begin(), frame.end());
  ASSERT_NE(at, bytes.end());
  *(at + 5) = 0x3f;  // The height's and the width's upper bytes.
  *(at + 7) = 0x3f;
  expect_rejected(bytes, "16136x16136 pixels with too little image data");
}

TEST(Texture, damaged_bytes_give_a_texture_or_an_input_error) {
  const TemporaryFolder folder;
  Image image;
  image.width = 24;
  image.height = 24;
  image.channels = {"R", "G", "B"};
  for (int i = 0; i < 24 * 24 * 3; ++i) image.pixels.push_back(static_cast<float>(i % 7) / 7.0f);
  write_raster(folder / "a.jpg", image);
  write_raster(folder / "a.png", image);
  std::mt19937 random(1);
  for (const char* name : {"a.jpg", "a.png"}) {
    const auto bytes = bytes_of(folder / name);
    for (int round = 0; round < 500; ++round) {
      auto damaged = bytes;
      damaged[random() % damaged.size()] = static_cast<std::uint8_t>(random());
      try {
        const DecodedTexture texture = decode_texture(damaged, "");
        EXPECT_EQ(
            texture.rgba8.size() + texture.rgba16.size(),
            static_cast<std::size_t>(texture.width) * static_cast<std::size_t>(texture.height) * 4);
      } catch (const Error& error) {
        EXPECT_EQ(error.detail().kind, ErrorKind::Input);
      }
    }
  }
}

}  // namespace
}  // namespace abbe
