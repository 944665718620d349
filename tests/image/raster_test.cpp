#include "abbe/image/raster/raster.h"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>

#include "abbe/base/error.h"
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

// The chunks of a PNG before its data, by type.
std::map<std::string, std::vector<std::uint32_t>> words_of_chunks(
    const std::vector<std::uint8_t>& png) {
  std::map<std::string, std::vector<std::uint32_t>> chunks;
  const auto word = [&png](std::size_t at) {
    return static_cast<std::uint32_t>(png[at]) << 24 |
           static_cast<std::uint32_t>(png[at + 1]) << 16 |
           static_cast<std::uint32_t>(png[at + 2]) << 8 | png[at + 3];
  };
  for (std::size_t at = 8;;) {
    const std::uint32_t size = word(at);
    const std::string type(png.begin() + static_cast<std::ptrdiff_t>(at) + 4,
                           png.begin() + static_cast<std::ptrdiff_t>(at) + 8);
    if (type == "IDAT") return chunks;
    EXPECT_FALSE(chunks.contains(type)) << type << " twice";
    std::vector<std::uint32_t>& words = chunks[type];
    for (std::size_t i = 0; i + 4 <= size; i += 4) words.push_back(word(at + 8 + i));
    at += size + 12;
  }
}

TEST(Raster, png_says_what_display_its_codes_are_for) {
  const TemporaryFolder folder;
  Image image = row_of({0.1f, 0.2f, 0.3f});
  const auto chunks_for = [&](const char* display) {
    if (display != nullptr) image.attributes[kDisplayAttribute] = std::string(display);
    write_raster(folder / "a.png", image);
    return words_of_chunks(bytes_of(folder / "a.png"));
  };
  // Hundred thousandths: white, red, green, blue. The four bytes of cICP as one number.
  const std::vector<std::uint32_t> rec709{31270, 32900, 64000, 33000, 30000, 60000, 15000, 6000};
  for (const char* display : {static_cast<const char*>(nullptr), "sRGB - Display"}) {
    auto chunks = chunks_for(display);
    EXPECT_TRUE(chunks.contains("sRGB"));
    EXPECT_THAT(chunks["gAMA"], ElementsAre(45455));
    EXPECT_EQ(chunks["cHRM"], rec709);
    EXPECT_THAT(chunks["cICP"], ElementsAre(0x010d0001));
  }
  auto chunks = chunks_for("Display P3 - Display");
  EXPECT_FALSE(chunks.contains("sRGB"));
  EXPECT_THAT(chunks["cHRM"], ElementsAre(31270, 32900, 68000, 32000, 26500, 69000, 15000, 6000));
  EXPECT_THAT(chunks["cICP"], ElementsAre(0x0c0d0001));
  chunks = chunks_for("Rec.1886 Rec.709 - Display");
  EXPECT_THAT(chunks["gAMA"], ElementsAre(41667));
  EXPECT_EQ(chunks["cHRM"], rec709);
  chunks = chunks_for("Rec.2100-PQ - Display");
  EXPECT_FALSE(chunks.contains("gAMA"));
  EXPECT_THAT(chunks["cHRM"], ElementsAre(31270, 32900, 70800, 29200, 17000, 79700, 13100, 4600));
  EXPECT_THAT(chunks["cICP"], ElementsAre(0x09100001));
  chunks = chunks_for("A television");
  for (const char* type : {"sRGB", "cHRM", "cICP"}) EXPECT_FALSE(chunks.contains(type)) << type;
}

TEST(Raster, sixteen_bits_keep_what_eight_round_away) {
  const TemporaryFolder folder;
  const Image image = row_of({0.123456f, 0.5f, 0.999f});
  for (const char* name : {"a.png", "a.tif"}) {
    write_raster(folder / name, image, {.bits = 16});
    const Image read = read_raster(folder / name);
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(read.pixels[c], image.pixels[c], 0.51f / 65535.0f) << name;  // half a code
    }
  }
  // JPEG has eight bits whatever is asked for; its codes are those of a colour that it keeps
  // nearly.
  write_raster(folder / "a.jpg", image, {.bits = 16});
  EXPECT_NEAR(read_raster(folder / "a.jpg").pixels[1], 0.5f, 4.0f / 255.0f);
}

// Rows that each filter of PNG suits best: noise, ramps along, across and both, equal ones.
Image rows_for_filters(int width) {
  Image image;
  image.width = width;
  image.height = 60;
  image.channels = {"R", "G", "B"};
  std::uint32_t noise = 1;
  for (int y = 0; y < image.height; ++y) {
    for (int i = 0; i < 3 * width; ++i) {
      noise = noise * 1664525u + 1013904223u;
      const int along = y % 12 < 6 ? 37 * i : 0;
      const int across = y % 20 < 10 ? 4391 * y : 0;
      const int grain = y % 30 < 15 ? static_cast<int>(noise >> 16) : 0;
      image.pixels.push_back(static_cast<float>((along + across + grain) % 65536) / 65535.0f);
    }
  }
  return image;
}

std::vector<std::uint8_t> opaque_codes(const Image& rgb) {
  std::vector<std::uint8_t> codes;
  for (std::size_t i = 0; i < rgb.pixels.size(); ++i) {
    codes.push_back(static_cast<std::uint8_t>(std::lround(rgb.pixels[i] * 255.0f)));
    if (i % 3 == 2) codes.push_back(255);
  }
  return codes;
}

TEST(Raster, png_of_any_rows_holds_the_codes_that_a_tiff_holds) {
  const TemporaryFolder folder;
  for (const int width : {1, 2, 301}) {
    const Image image = rows_for_filters(width);
    for (const int bits : {8, 16}) {
      write_raster(folder / "a.png", image, {.bits = bits});
      write_raster(folder / "a.tif", image, {.bits = bits});
      EXPECT_EQ(read_raster(folder / "a.png").pixels, read_raster(folder / "a.tif").pixels)
          << width << " pixels of " << bits << " bits";
      const auto input = OIIO::ImageInput::open((folder / "a.png").string());
      ASSERT_TRUE(input);
      EXPECT_EQ(input->spec().format.size() * 8, bits);
    }
  }
}

TEST(Raster, png_as_a_texture_has_the_codes_that_were_written) {
  const TemporaryFolder folder;
  for (const int width : {1, 2, 301}) {
    write_raster(folder / "a.png", rows_for_filters(width));
    EXPECT_EQ(decode_texture(bytes_of(folder / "a.png"), "").rgba8,
              opaque_codes(read_raster(folder / "a.png")));
  }
}

TEST(Raster, png_of_a_megabyte_and_more_is_one_stream) {
  const TemporaryFolder folder;
  Image image = rows_for_filters(3);
  image.width = 600;
  image.height = 1200;
  image.pixels.clear();
  std::uint32_t noise = 1;
  for (std::size_t i = 0; i < std::size_t{3} * 600 * 1200; ++i) {
    noise = noise * 1664525u + 1013904223u;
    image.pixels.push_back(static_cast<float>(noise >> 24) / 255.0f);
  }
  write_raster(folder / "a.png", image);
  EXPECT_GT(bytes_of(folder / "a.png").size(), std::size_t{2} << 20);
  EXPECT_EQ(opaque_codes(read_raster(folder / "a.png")), opaque_codes(image));
  EXPECT_EQ(decode_texture(bytes_of(folder / "a.png"), "").rgba8, opaque_codes(image));
}

TEST(Raster, dither_keeps_the_mean_and_breaks_the_bands) {
  const TemporaryFolder folder;
  std::vector<float> values(3 * 4096, 100.3f / 255.0f);
  write_raster(folder / "a.png", row_of(values), {.dither = true});
  write_raster(folder / "b.png", row_of(values), {.dither = true});
  EXPECT_EQ(bytes_of(folder / "a.png"), bytes_of(folder / "b.png"));
  const Image read = read_raster(folder / "a.png");
  double sum = 0.0;
  std::map<int, int> codes;
  for (const float value : read.pixels) {
    sum += static_cast<double>(value) * 255.0;
    ++codes[static_cast<int>(std::lround(value * 255.0f))];
  }
  // Rounding and noise have a deviation of √(1/12 + 1/6) = 0.5 codes: 4.5 of the mean's 0.0045.
  EXPECT_NEAR(sum / static_cast<double>(read.pixels.size()), 100.3, 0.02);
  EXPECT_EQ(codes.begin()->first, 99);
  EXPECT_EQ(codes.rbegin()->first, 101);
}

TEST(Raster, dither_of_a_crop_is_that_of_the_whole) {
  const TemporaryFolder folder;
  write_raster(folder / "whole.png", row_of(std::vector<float>(3 * 64, 0.4f)), {.dither = true});
  Image crop = row_of(std::vector<float>(3 * 16, 0.4f));
  crop.data_origin = {20, 0};
  crop.full_size = {64, 1};
  write_raster(folder / "crop.png", crop, {.dither = true});
  const Image whole = read_raster(folder / "whole.png");
  const Image part = read_raster(folder / "crop.png");
  for (std::size_t i = 0; i < part.pixels.size(); ++i) {
    EXPECT_EQ(part.pixels[i], whole.pixels[60 + i]);
  }
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

// Two rows of three grey pixels, 2^-7 times 1 to 6, after lines of a header.
void write_radiance(const std::filesystem::path& file, const std::string& lines,
                    const std::string& resolution) {
  std::ofstream out(file, std::ios::binary);
  out << "#?RADIANCE\n" << lines << "FORMAT=32-bit_rle_rgbe\n\n" << resolution << "\n";
  for (int i = 1; i <= 6; ++i) {
    for (const int byte : {i, i, i, 129}) out.put(static_cast<char>(byte));
  }
}

TEST(Raster, radiance_header_says_how_rows_lie_and_what_was_multiplied) {
  const TemporaryFolder folder;
  const auto grey = [&](const std::string& lines, const std::string& resolution) {
    write_radiance(folder / "a.hdr", lines, resolution);
    const Image read = read_raster(folder / "a.hdr");
    std::vector<float> values;
    // Half a step is added to codes when they are read.
    for (std::size_t p = 0; p < 6; ++p) values.push_back(std::floor(128.0f * read.pixels[3 * p]));
    return values;
  };
  EXPECT_THAT(grey("", "-Y 2 +X 3"), ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_THAT(grey("", "+Y 2 +X 3"), ElementsAre(4, 5, 6, 1, 2, 3));
  EXPECT_THAT(grey("", "-Y 2 -X 3"), ElementsAre(3, 2, 1, 6, 5, 4));
  EXPECT_THAT(grey("", "+Y 2 -X 3"), ElementsAre(6, 5, 4, 3, 2, 1));
  EXPECT_THAT(grey("EXPOSURE=0.5\nEXPOSURE= 0.5\n", "-Y 2 +X 3")[0],
              testing::AllOf(testing::Ge(4.0f), testing::Lt(8.0f)));
  write_radiance(folder / "a.hdr", "EXPOSURE=0.5\n", "-Y 2 +X 3");
  write_radiance(folder / "b.hdr", "COLORCORR=0.5 1 2\n", "-Y 2 +X 3");
  const Image whole = read_raster(folder / "a.hdr"), colors = read_raster(folder / "b.hdr");
  EXPECT_EQ(colors.pixels[0], whole.pixels[0]);
  EXPECT_EQ(colors.pixels[1], 0.5f * whole.pixels[1]);
  EXPECT_EQ(colors.pixels[2], 0.25f * whole.pixels[2]);
  for (const auto& [lines, resolution, found] :
       {std::array{"", "+X 3 -Y 2", "in columns"},
        std::array{"EXPOSURE=0\n", "-Y 2 +X 3", "an exposure of 0"}}) {
    write_radiance(folder / "a.hdr", lines, resolution);
    try {
      read_raster(folder / "a.hdr");
      ADD_FAILURE() << lines << resolution;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr(found));
    }
  }
}

}  // namespace
}  // namespace abbe
