// Textures: wrapping, filtering, mipmaps, encodings.

#include "abbe/world/texture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "abbe/color/color.h"

namespace abbe {
namespace {

// A row of grey texels.
TextureImage row_of(const std::vector<std::uint8_t>& codes) {
  TextureImage image;
  image.width = static_cast<int>(codes.size());
  image.height = 1;
  for (const std::uint8_t code : codes) image.rgba8.append({code, code, code, 255});
  return image;
}

float red_at(const WorldTexture& texture, float u, float footprint_uv = 0.0f) {
  return texture.value({u, 0.5f}, footprint_uv).x;
}

TEST(WorldTexture, srgb_codes_are_decoded_and_data_are_not) {
  const TextureImage image = row_of({128});
  EXPECT_NEAR(red_at(WorldTexture(image, {}, TextureEncoding::Srgb), 0.5f),
              srgb_decode(128.0 / 255.0), 1e-7);
  EXPECT_EQ(red_at(WorldTexture(image, {}, TextureEncoding::Data), 0.5f), 128.0f / 255.0f);
}

TEST(WorldTexture, colours_of_a_wider_gamut_become_rec709_and_data_stay) {
  TextureImage image;
  image.width = image.height = 1;
  image.rgba8 = {0, 255, 0, 255};
  const Vec4f color =
      WorldTexture(image, {}, TextureEncoding::Srgb, RgbSpace::Rec2020).value({0.5f, 0.5f}, 0.0f);
  // ITU-R BT.2087's middle column, four digits.
  EXPECT_NEAR(color.x, -0.5876f, 5e-5f);
  EXPECT_NEAR(color.y, 1.1329f, 5e-5f);
  EXPECT_NEAR(color.z, -0.1006f, 5e-5f);
  const Vec4f data =
      WorldTexture(image, {}, TextureEncoding::Data, RgbSpace::Rec2020).value({0.5f, 0.5f}, 0.0f);
  EXPECT_EQ(data, Vec4f(0.0f, 1.0f, 0.0f, 1.0f));
}

TEST(WorldTexture, texel_centres_have_the_texels_values) {
  const WorldTexture texture(row_of({0, 255, 51, 102}), {}, TextureEncoding::Data);
  // Interpolation at a centre has weights 1 and 0 up to the rounding of u·4 − 0.5.
  EXPECT_NEAR(red_at(texture, 0.125f), 0.0f, 1e-6f);
  EXPECT_NEAR(red_at(texture, 0.375f), 1.0f, 1e-6f);
  EXPECT_NEAR(red_at(texture, 0.625f), 0.2f, 1e-6f);
  EXPECT_NEAR(red_at(texture, 0.5f), 0.6f, 1e-6f);
}

TEST(WorldTexture, flat_image_keeps_its_value_to_the_bit_wherever_and_however_wide_it_is_seen) {
  const WorldTexture texture(row_of({77, 77, 77, 77, 77}), {}, TextureEncoding::Srgb);
  const float value = red_at(texture, 0.1f);
  for (int i = 0; i < 1000; ++i) {
    const float u = 0.00137f * static_cast<float>(i);
    ASSERT_EQ(red_at(texture, u), value);
    ASSERT_EQ(red_at(texture, u, 0.0007f * static_cast<float>(i)), value);
  }
}

TEST(WorldTexture, wrapping_follows_the_sampler) {
  Texture sampler;
  sampler.filter = TextureFilter::Nearest;
  const TextureImage image = row_of({0, 255});
  EXPECT_EQ(red_at(WorldTexture(image, sampler, TextureEncoding::Data), 1.25f), 0.0f);
  EXPECT_EQ(red_at(WorldTexture(image, sampler, TextureEncoding::Data), -0.25f), 1.0f);
  sampler.wrap_s = TextureWrap::MirroredRepeat;
  EXPECT_EQ(red_at(WorldTexture(image, sampler, TextureEncoding::Data), 1.25f), 1.0f);
  EXPECT_EQ(red_at(WorldTexture(image, sampler, TextureEncoding::Data), -0.25f), 0.0f);
  sampler.wrap_s = TextureWrap::ClampToEdge;
  EXPECT_EQ(red_at(WorldTexture(image, sampler, TextureEncoding::Data), 7.0f), 1.0f);
  EXPECT_EQ(red_at(WorldTexture(image, sampler, TextureEncoding::Data), -7.0f), 0.0f);
}

TEST(WorldTexture, wide_footprint_sees_the_mean_of_any_size) {
  for (const int size : {8, 7, 13}) {
    std::vector<std::uint8_t> codes(static_cast<std::size_t>(size));
    double mean = 0.0;
    for (int i = 0; i < size; ++i) {
      codes[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(i * 17);
      mean += i * 17 / 255.0 / size;
    }
    const WorldTexture texture(row_of(codes), {}, TextureEncoding::Data);
    // Three levels, each rounded to 16 bits, are off by 2^-17 each. Odd sizes are halved unevenly:
    // within 5 % of full scale.
    EXPECT_NEAR(red_at(texture, 0.3f, 100.0f), mean, size == 8 ? 3.0 * 0x1p-17 : 0.05) << size;
  }
}

TEST(WorldTexture, footprint_is_as_much_wider_as_the_transform_makes_it) {
  TextureUse use;
  use.uv_linear = {0.0f, 0.25f, -1.0f, 0.0f};  // A quarter turn; a quarter of the area.
  EXPECT_EQ(uv_scale(use), 0.5f);
  const std::vector<std::uint8_t> codes{0, 255, 0, 255, 255, 0, 0, 0};
  const auto pyramid =
      std::make_shared<const TexturePyramid>(row_of(codes), TextureEncoding::Data, true);
  const WorldTexture texture(pyramid, {}, TextureEncoding::Data, RgbSpace::Rec709, 0.5f);
  const WorldTexture plain(pyramid, {}, TextureEncoding::Data, RgbSpace::Rec709);
  for (const float footprint : {0.1f, 0.3f, 0.6f, 2.0f}) {
    EXPECT_EQ(red_at(texture, 0.3f, footprint), red_at(plain, 0.3f, 0.5f * footprint));
  }
}

TEST(WorldTexture, codes_are_shared_with_the_scene_and_mipmaps_take_half_as_much) {
  std::vector<std::uint8_t> codes(std::size_t{4} * 64 * 64);
  for (std::size_t i = 0; i < codes.size(); ++i) {
    codes[i] = i % 4 == 3 ? 255 : static_cast<std::uint8_t>(i * 31 % 251);
  }
  TextureImage image;
  image.width = image.height = 64;
  image.rgba8 = codes;
  const WorldTexture texture(image, {}, TextureEncoding::Srgb);
  // Four bytes a texel, and six for each of the 4095 / 3 of smaller levels of an opaque image.
  EXPECT_EQ(texture.bytes(), 64u * 64 * 4 + 1365u * 6);
  const TextureImage copy = image;
  EXPECT_EQ(copy.rgba8.data(), image.rgba8.data());
}

TEST(WorldTexture, texels_in_a_store_are_those_in_memory_of_8_and_16_bits) {
  const auto store = PageStore::open(0);
  std::vector<std::uint8_t> codes(std::size_t{4} * 50 * 30);
  for (std::size_t i = 0; i < codes.size(); ++i) {
    codes[i] = static_cast<std::uint8_t>(i * 37 % 251);
  }
  std::vector<std::uint16_t> deep(codes.begin(), codes.end());
  for (std::uint16_t& code : deep) code = static_cast<std::uint16_t>(257 * code);
  TextureImage in_memory, in_store, of_16_bits;
  for (TextureImage* image : {&in_memory, &in_store, &of_16_bits}) {
    image->width = 50;
    image->height = 30;
  }
  in_memory.rgba8 = codes;
  in_store.rgba8 = SharedValues<std::uint8_t>(codes, store);
  of_16_bits.rgba16 = SharedValues<std::uint16_t>(deep, store);
  for (const TextureEncoding encoding : {TextureEncoding::Srgb, TextureEncoding::Data}) {
    const WorldTexture expected(in_memory, {}, encoding), found(in_store, {}, encoding),
        deeper(of_16_bits, {}, encoding);
    for (int i = 0; i < 200; ++i) {
      const Vec2f uv(0.37f * static_cast<float>(i), 0.11f * static_cast<float>(i));
      const float footprint = 0.002f * static_cast<float>(i);
      if (i % 50 == 0) store->let_go();
      EXPECT_EQ(found.value(uv, footprint), expected.value(uv, footprint));
      // 257 c / 65535 is c / 255 but for a rounding.
      EXPECT_LT(glm::distance(deeper.value(uv, footprint), expected.value(uv, footprint)), 1e-6f);
    }
  }
}

TEST(WorldTexture, image_of_one_color_takes_one_texel) {
  TextureImage image;
  image.width = image.height = 256;
  image.rgba8 = std::vector<std::uint8_t>(std::size_t{4} * 256 * 256, std::uint8_t{51});
  const WorldTexture texture(image, {}, TextureEncoding::Data);
  EXPECT_EQ(texture.bytes(), 4u);
  EXPECT_EQ(texture.value({0.7f, 0.2f}, 0.1f), Vec4f(0.2f));
}

TEST(WorldTexture, senseless_coordinates_give_a_texel) {
  const WorldTexture texture(row_of({51, 51}), {}, TextureEncoding::Data);
  for (const float u : {std::numeric_limits<float>::quiet_NaN(), 1e30f, -1e30f,
                        std::numeric_limits<float>::infinity()}) {
    EXPECT_NEAR(red_at(texture, u), 0.2f, 1e-6f);
  }
}

TEST(transformed_uv, use_applies_linear_part_and_offset) {
  TextureUse use;
  use.uv_linear = {0.0f, 2.0f, -3.0f, 0.0f};
  use.uv_offset = {0.5f, 0.25f};
  const Vec2f uv = transformed_uv(use, {1.0f, 10.0f});
  EXPECT_EQ(uv.x, 20.5f);
  EXPECT_EQ(uv.y, -2.75f);
}

}  // namespace
}  // namespace abbe
