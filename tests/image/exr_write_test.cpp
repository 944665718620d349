#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "abbe/base/error.h"
#include "abbe/image/exr/exr.h"
#include "image/temporary_folder.h"

namespace abbe {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Values that differ in every place, negative ones among them.
Image patterned(int width, int height, std::vector<std::string> channels) {
  Image image;
  image.width = width;
  image.height = height;
  image.channels = std::move(channels);
  image.pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                      image.channel_count());
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] = std::sin(static_cast<float>(i)) * 3.0f;
  }
  return image;
}

TEST(Exr, write_then_read_returns_every_float) {
  const TemporaryFolder folder;
  const Image image = patterned(37, 19, {"R", "G", "B", "Z"});
  write_exr(folder / "a.exr", image, {});
  const Image read = read_exr(folder / "a.exr");
  EXPECT_EQ(read.width, 37);
  EXPECT_EQ(read.height, 19);
  EXPECT_EQ(read.channels, image.channels);
  EXPECT_EQ(read.pixels, image.pixels);
  EXPECT_EQ(read.full_size, Vec2i(0));
}

TEST(Exr, write_of_more_rows_than_one_block_keeps_their_order) {
  const TemporaryFolder folder;
  const Image image = patterned(3, 1200, {"R", "G", "B"});
  write_exr(folder / "a.exr", image, {});
  EXPECT_EQ(read_exr(folder / "a.exr").pixels, image.pixels);
}

TEST(Exr, write_twice_gives_the_same_bytes) {
  const TemporaryFolder folder;
  Image image = patterned(64, 64, {"R", "G", "B", spectral_channel_name(550.0)});
  image.attributes["abbe:version"] = std::string("0.1.0");
  write_exr(folder / "a.exr", image, {});
  write_exr(folder / "b.exr", image, {});
  EXPECT_EQ(bytes_of(folder / "a.exr"), bytes_of(folder / "b.exr"));
}

TEST(Exr, attributes_keep_their_types) {
  const TemporaryFolder folder;
  Image image = patterned(4, 4, {"R", "G", "B"});
  image.attributes = {{"abbe:mode", std::string("spectral")},
                      {"abbe:samples", 16},
                      {"EV", 0.5f},
                      {"abbe:cutoff", 1e-4}};
  write_exr(folder / "a.exr", image, {});
  const auto read = read_exr(folder / "a.exr").attributes;
  EXPECT_EQ(std::get<std::string>(read.at("abbe:mode")), "spectral");
  EXPECT_EQ(std::get<int>(read.at("abbe:samples")), 16);
  EXPECT_EQ(std::get<float>(read.at("EV")), 0.5f);
  EXPECT_EQ(std::get<double>(read.at("abbe:cutoff")), 1e-4);
}

TEST(Exr, copy_of_a_read_image_can_be_written) {
  const TemporaryFolder folder;
  write_exr(folder / "a.exr", patterned(4, 4, {"R", "G", "B"}), {});
  write_exr(folder / "b.exr", read_exr(folder / "a.exr"), {});
  EXPECT_EQ(bytes_of(folder / "a.exr"), bytes_of(folder / "b.exr"));
}

TEST(Exr, crop_keeps_the_full_image_as_its_display_window) {
  const TemporaryFolder folder;
  Image image = patterned(10, 5, {"R", "G", "B"});
  image.data_origin = {20, 30};
  image.full_size = {100, 80};
  write_exr(folder / "a.exr", image, {});
  const Image read = read_exr(folder / "a.exr");
  EXPECT_EQ(read.data_origin, image.data_origin);
  EXPECT_EQ(read.full_size, image.full_size);
  EXPECT_EQ(read.pixels, image.pixels);
}

TEST(Exr, header_tells_types_compression_and_chromaticities) {
  const TemporaryFolder folder;
  const Image image =
      patterned(8, 8, {"R", "G", "B", spectral_channel_name(362.5), "N.X", "Z", "objectId"});
  const std::array<float, 8> rec709{0.64f, 0.33f, 0.30f, 0.60f, 0.15f, 0.06f, 0.3127f, 0.3290f};
  write_exr(folder / "a.exr", image, {.half = true, .chromaticities = rec709});
  const ExrHeader header = read_exr_header(folder / "a.exr");
  EXPECT_EQ(header.width, 8);
  EXPECT_EQ(header.compression, "zip");
  EXPECT_EQ(header.chromaticities, rec709);
  std::vector<std::string> types;
  for (const auto& channel : header.channels) types.push_back(channel.name + " " + channel.type);
  EXPECT_THAT(types, ElementsAre("R half", "G half", "B half", "S0.362,500000nm float", "N.X half",
                                 "Z float", "objectId float"));
}

TEST(Exr, half_rounds_colour_and_keeps_it_finite) {
  const TemporaryFolder folder;
  Image image = patterned(2, 1, {"R", "G", "B", "Z"});
  image.pixels = {0.1f, 1e9f, -1e9f, 12345.678f, std::numeric_limits<float>::infinity(),
                  0.0f, 1.0f, 0.1f};
  write_exr(folder / "a.exr", image, {.half = true, .chromaticities = {}});
  const Image read = read_exr(folder / "a.exr");
  EXPECT_NEAR(read.pixels[0], 0.1f, 0.1f / 2048.0f);  // half a unit of 11 bits
  EXPECT_EQ(read.pixels[1], 65504.0f);
  EXPECT_EQ(read.pixels[2], -65504.0f);
  EXPECT_EQ(read.pixels[3], 12345.678f);
  EXPECT_TRUE(std::isinf(read.pixels[4]));
  EXPECT_EQ(read.pixels[7], 0.1f);
}

TEST(Exr, lossless_compressions_keep_every_float_in_scan_lines_and_tiles) {
  const TemporaryFolder folder;
  const Image image = patterned(37, 600, {"R", "G", "B", "Z"});
  for (const char* compression : {"none", "rle", "zips", "zip", "piz"}) {
    for (const int tile_size : {0, 8, 64, 1024}) {
      write_exr(folder / "a.exr", image, {.compression = compression, .tile_size = tile_size});
      EXPECT_EQ(read_exr(folder / "a.exr").pixels, image.pixels) << compression << " " << tile_size;
      const ExrHeader header = read_exr_header(folder / "a.exr");
      EXPECT_EQ(header.compression, compression);
      EXPECT_EQ(header.tile_size, tile_size);
    }
  }
}

TEST(Exr, lossy_compressions_keep_colours_close) {
  const TemporaryFolder folder;
  Image image = patterned(64, 64, {"R", "G", "B"});
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] = 0.5f + 0.4f * std::sin(static_cast<float>(i / 3) * 0.01f);
  }
  for (const char* compression : {"pxr24", "b44", "b44a", "dwaa", "dwab"}) {
    write_exr(folder / "a.exr", image, {.half = true, .compression = compression});
    const Image read = read_exr(folder / "a.exr");
    EXPECT_EQ(read_exr_header(folder / "a.exr").compression, compression);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
      // B44 keeps six bits of a block of 4×4, DWA discards what the eye does not see.
      ASSERT_NEAR(read.pixels[i], image.pixels[i], 0.03f) << compression;
    }
  }
}

TEST(Exr, parts_hold_colour_spectrum_and_layers_apart_and_read_as_one_image) {
  const TemporaryFolder folder;
  Image image =
      patterned(20, 10,
                {"R", "G", "B", spectral_channel_name(450.0), spectral_channel_name(550.0),
                 reflective_channel_name(450.0), "Z", "albedo.B", "albedo.R"});
  image.attributes["abbe:mode"] = std::string("spectral");
  for (const int tile_size : {0, 16}) {
    write_exr(folder / "a.exr", image, {.tile_size = tile_size, .multi_part = true});
    EXPECT_EQ(read_exr_header(folder / "a.exr").part_count, 4);
    const Image read = read_exr(folder / "a.exr");
    EXPECT_EQ(read.channels, image.channels);
    EXPECT_EQ(read.pixels, image.pixels);
    EXPECT_EQ(read.attributes.at("abbe:mode"), image.attributes.at("abbe:mode"));
  }
}

TEST(Exr, parts_have_names_even_where_colour_is_all) {
  const TemporaryFolder folder;
  const Image image = patterned(4, 4, {"R", "G", "B"});
  for (const bool multi_part : {false, true}) {
    write_exr(folder / "a.exr", image, {.multi_part = multi_part});
    EXPECT_EQ(read_exr_header(folder / "a.exr").has_named_parts, multi_part);
  }
}

TEST(Exr, ids_are_whole_numbers_with_names) {
  const TemporaryFolder folder;
  Image image = patterned(2, 2, {"R", "G", "B", "objectId"});
  for (int i = 0; i < 4; ++i) image.at(i % 2, i / 2, 3) = static_cast<float>(i);
  image.id_names = {{"objectId", {{1, "prism"}, {2, "a name, with: marks"}}}};
  for (const bool multi_part : {false, true}) {
    write_exr(folder / "a.exr", image, {.multi_part = multi_part});
    const Image read = read_exr(folder / "a.exr");
    EXPECT_EQ(read.pixels, image.pixels);
    ASSERT_EQ(read.id_names.size(), 1u);
    EXPECT_EQ(read.id_names[0].channel, "objectId");
    EXPECT_EQ(read.id_names[0].names, image.id_names[0].names);
    EXPECT_EQ(read_exr_header(folder / "a.exr").channels.back().type, "uint");
  }
}

TEST(Exr, unknown_compression_or_tile_size_is_a_usage_error) {
  const TemporaryFolder folder;
  const Image image = patterned(4, 4, {"R", "G", "B"});
  for (const ExrOptions& options : {ExrOptions{.compression = "lzw"}, ExrOptions{.tile_size = 7},
                                    ExrOptions{.tile_size = 5000}, ExrOptions{.tile_size = -8}}) {
    try {
      write_exr(folder / "a.exr", image, options);
      FAIL() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.detail().kind, ErrorKind::Usage);
    }
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Exr, spectral_channels_are_read_by_wavelength_not_as_text) {
  const TemporaryFolder folder;
  const std::vector<std::string> channels{"R",
                                          "G",
                                          "B",
                                          spectral_channel_name(95.0),
                                          spectral_channel_name(362.5),
                                          spectral_channel_name(1000.0),
                                          "albedo.R",
                                          "objectId"};
  write_exr(folder / "a.exr", patterned(4, 4, channels), {});
  EXPECT_EQ(read_exr(folder / "a.exr").channels, channels);
}

TEST(Exr, unwritable_target_is_an_output_error) {
  const TemporaryFolder folder;
  const Image image = patterned(4, 4, {"R", "G", "B"});
  try {
    write_exr(folder / "missing/a.exr", image, {});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().kind, ErrorKind::Output);
  }
}

TEST(Exr, failed_write_leaves_the_old_file_and_no_other) {
  const TemporaryFolder folder;
  write_exr(folder / "a.exr", patterned(4, 4, {"R", "G", "B"}), {});
  const auto before = bytes_of(folder / "a.exr");
  Image broken = patterned(4, 4, {"R", "G", "B"});
  broken.attributes["channels"] = 1;  // EXR wants a list of channels there.
  try {
    write_exr(folder / "a.exr", broken, {});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().kind, ErrorKind::Output);
    EXPECT_THAT(error.what(), HasSubstr("a.exr"));
  }
  EXPECT_EQ(bytes_of(folder / "a.exr"), before);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(Exr, image_without_values_for_its_pixels_is_an_output_error) {
  const TemporaryFolder folder;
  Image image = patterned(4, 4, {"R", "G", "B"});
  image.pixels.pop_back();
  EXPECT_THROW(write_exr(folder / "a.exr", image, {}), Error);
  EXPECT_THROW(write_exr(folder / "b.exr", patterned(4, 4, {"R", "R"}), {}), Error);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(SpectralChannel, name_has_a_comma_and_six_decimals) {
  EXPECT_EQ(spectral_channel_name(362.5), "S0.362,500000nm");
  EXPECT_EQ(spectral_channel_name(550.0), "S0.550,000000nm");
  EXPECT_EQ(spectral_channel_name(486.1327), "S0.486,132700nm");
  EXPECT_EQ(spectral_channel_name(589.00000049), "S0.589,000000nm");
  EXPECT_EQ(spectral_channel_name(599.9999999), "S0.600,000000nm");
}

TEST(SpectralChannel, wavelength_is_read_back_from_a_name) {
  for (const double nm : {360.0, 362.5, 486.1327, 587.5618, 829.999999}) {
    EXPECT_DOUBLE_EQ(spectral_channel_wavelength_nm(spectral_channel_name(nm)).value(), nm);
  }
  EXPECT_EQ(spectral_channel_wavelength_nm("S0.550nm"), 550.0);
}

TEST(SpectralChannel, reflectance_has_a_name_of_its_own) {
  EXPECT_EQ(reflective_channel_name(362.5), "T.362,500000nm");
  EXPECT_EQ(reflective_channel_wavelength_nm("T.362,500000nm"), 362.5);
  EXPECT_FALSE(reflective_channel_wavelength_nm("S0.362,500000nm"));
  // Bispectral ones are something else.
  EXPECT_FALSE(reflective_channel_wavelength_nm("T.362,500000nm.400,000000nm"));
}

TEST(SpectralChannel, other_names_have_no_wavelength) {
  for (const char* name :
       {"", "R", "S0.", "S0.nm", "S0.550,0", "S0.-550,0nm", "S0.5,5,0nm", "S0.550.0nm", "S0.infnm",
        "S0.nannm", "S1.550,0nm", "T.550,0nm", "S0.1e999nm"}) {
    EXPECT_FALSE(spectral_channel_wavelength_nm(name)) << name;
  }
}

}  // namespace
}  // namespace abbe
