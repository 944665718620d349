// EXR files that others wrote, and files that only claim to be.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepScanLineOutputFile.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstring>
#include <random>

#include "abbe/base/error.h"
#include "abbe/image/exr/exr.h"
#include "image/temporary_folder.h"

namespace abbe {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

void expect_input_error(const std::filesystem::path& file, const std::string& part) {
  try {
    read_exr(file);
    FAIL() << "no error for " << file;
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().kind, ErrorKind::Input);
    EXPECT_THAT(error.what(), HasSubstr(part));
    EXPECT_THAT(error.what(), HasSubstr(file.filename().string()));
  }
}

// A 24×20 file of one half and one uint channel, tiled or not.
void write_foreign(const std::filesystem::path& file, Imf::Compression compression, bool tiled) {
  constexpr int kWidth = 24;
  constexpr int kHeight = 20;
  std::vector<Imath::half> halves(kWidth * kHeight);
  std::vector<unsigned> ids(kWidth * kHeight);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    halves[i] = Imath::half(static_cast<float>(i) / 8.0f);
    ids[i] = static_cast<unsigned>(i * 3);
  }
  Imf::Header header(kWidth, kHeight, 1.0f, Imath::V2f(0, 0), 1.0f, Imf::INCREASING_Y, compression);
  header.channels().insert("Y", Imf::Channel(Imf::HALF));
  header.channels().insert("id", Imf::Channel(Imf::UINT));
  Imf::FrameBuffer buffer;
  buffer.insert("Y", Imf::Slice(Imf::HALF, reinterpret_cast<char*>(halves.data()),
                                sizeof(Imath::half), kWidth * sizeof(Imath::half)));
  buffer.insert("id", Imf::Slice(Imf::UINT, reinterpret_cast<char*>(ids.data()), sizeof(unsigned),
                                 kWidth * sizeof(unsigned)));
  if (tiled) {
    header.setTileDescription(Imf::TileDescription(8, 8, Imf::ONE_LEVEL));
    Imf::TiledOutputFile out(file.c_str(), header);
    out.setFrameBuffer(buffer);
    out.writeTiles(0, out.numXTiles() - 1, 0, out.numYTiles() - 1);
  } else {
    Imf::OutputFile out(file.c_str(), header);
    out.setFrameBuffer(buffer);
    out.writePixels(kHeight);
  }
}

TEST(ExrRead, tiled_half_and_uint_channels_become_floats) {
  const TemporaryFolder folder;
  for (const bool tiled : {false, true}) {
    write_foreign(folder / "a.exr", Imf::PIZ_COMPRESSION, tiled);
    const Image image = read_exr(folder / "a.exr");
    EXPECT_THAT(image.channels, ElementsAre("Y", "id"));
    EXPECT_EQ(image.at(5, 3, 0), (3 * 24 + 5) / 8.0f);
    EXPECT_EQ(image.at(5, 3, 1), (3 * 24 + 5) * 3.0f);
    EXPECT_EQ(image.at(23, 19, 1), 479 * 3.0f);
  }
}

TEST(ExrRead, file_that_is_not_there_or_not_a_file_is_an_input_error) {
  const TemporaryFolder folder;
  expect_input_error(folder / "missing.exr", "no such file");
  std::filesystem::create_directory(folder / "folder.exr");
  expect_input_error(folder / "folder.exr", "not a regular file");
  ASSERT_EQ(::mkfifo((folder / "pipe.exr").c_str(), 0600), 0);
  expect_input_error(folder / "pipe.exr", "not a regular file");
}

TEST(ExrRead, other_bytes_are_an_input_error) {
  const TemporaryFolder folder;
  write_bytes(folder / "empty.exr", {});
  expect_input_error(folder / "empty.exr", "not an EXR");
  write_bytes(folder / "text.exr", std::vector<std::uint8_t>(1000, 'a'));
  expect_input_error(folder / "text.exr", "not an EXR");
}

TEST(ExrRead, subsampled_channels_are_an_input_error) {
  const TemporaryFolder folder;
  Imf::Header header(8, 8);
  header.channels().insert("RY", Imf::Channel(Imf::HALF, 2, 2));
  std::vector<Imath::half> halves(16);
  Imf::FrameBuffer buffer;
  buffer.insert("RY", Imf::Slice(Imf::HALF, reinterpret_cast<char*>(halves.data()),
                                 sizeof(Imath::half), 4 * sizeof(Imath::half), 2, 2));
  {
    Imf::OutputFile out((folder / "a.exr").c_str(), header);
    out.setFrameBuffer(buffer);
    out.writePixels(8);
  }
  expect_input_error(folder / "a.exr", "subsampled");
}

// A file of two parts, 8×8, each of one channel "Y" with a value of its own.
void write_two_parts(const std::filesystem::path& file, int second_width) {
  std::vector<Imf::Header> headers{Imf::Header(8, 8), Imf::Header(second_width, 8)};
  const std::array<const char*, 2> names{"left", "right"};
  for (std::size_t i = 0; i < 2; ++i) {
    headers[i].channels().insert("Y", Imf::Channel(Imf::FLOAT));
    headers[i].setName(names[i]);
    headers[i].setType(Imf::SCANLINEIMAGE);
    headers[i].displayWindow() = headers[0].displayWindow();
  }
  Imf::MultiPartOutputFile out(file.c_str(), headers.data(), 2);
  for (int i = 0; i < 2; ++i) {
    const int width = i == 0 ? 8 : second_width;
    std::vector<float> values(static_cast<std::size_t>(width) * 8, static_cast<float>(i + 1));
    Imf::FrameBuffer buffer;
    buffer.insert("Y", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), sizeof(float),
                                  static_cast<std::size_t>(width) * sizeof(float)));
    Imf::OutputPart part(out, i);
    part.setFrameBuffer(buffer);
    part.writePixels(8);
  }
}

TEST(ExrRead, parts_of_a_file_make_one_image) {
  const TemporaryFolder folder;
  write_two_parts(folder / "parts.exr", 8);
  const Image image = read_exr(folder / "parts.exr");
  EXPECT_THAT(image.channels, ElementsAre("Y", "right.Y"));
  EXPECT_EQ(image.at(3, 3, 0), 1.0f);
  EXPECT_EQ(image.at(3, 3, 1), 2.0f);
  EXPECT_EQ(read_exr_header(folder / "parts.exr").part_count, 2);
}

TEST(ExrRead, parts_of_different_sizes_and_deep_data_are_an_input_error) {
  const TemporaryFolder folder;
  write_two_parts(folder / "parts.exr", 6);
  expect_input_error(folder / "parts.exr", "parts of different sizes");

  Imf::Header header(8, 8);
  header.channels().insert("Y", Imf::Channel(Imf::HALF));
  header.setType(Imf::DEEPSCANLINE);
  header.compression() = Imf::ZIPS_COMPRESSION;
  { Imf::DeepScanLineOutputFile out((folder / "deep.exr").c_str(), header); }
  expect_input_error(folder / "deep.exr", "deep data");
}

// Finds the data window's box in the header and claims another size.
std::vector<std::uint8_t> with_data_window(std::vector<std::uint8_t> bytes, std::int32_t max_x,
                                           std::int32_t max_y) {
  const std::string key("dataWindow\0box2i", 16);
  const auto at = std::search(bytes.begin(), bytes.end(), key.begin(), key.end());
  const std::array<std::int32_t, 4> box{0, 0, max_x, max_y};
  std::memcpy(&*at + key.size() + 1 + 4, box.data(), sizeof(box));
  return bytes;
}

TEST(ExrRead, claimed_size_beyond_the_bounds_is_an_input_error) {
  const TemporaryFolder folder;
  write_foreign(folder / "a.exr", Imf::ZIP_COMPRESSION, false);
  const auto bytes = bytes_of(folder / "a.exr");
  const std::int32_t largest = std::numeric_limits<std::int32_t>::max();
  for (const auto& [x, y] : std::vector<std::pair<std::int32_t, std::int32_t>>{
           {largest, largest}, {70000, 10}, {60000, 60000}, {-5, 3}, {10, -1}, {65000, 4000}}) {
    write_bytes(folder / "b.exr", with_data_window(bytes, x, y));
    expect_input_error(folder / "b.exr", "b.exr");
  }
}

TEST(ExrRead, truncated_file_is_an_input_error_wherever_it_ends) {
  const TemporaryFolder folder;
  for (const bool tiled : {false, true}) {
    write_foreign(folder / "a.exr", Imf::ZIP_COMPRESSION, tiled);
    const auto bytes = bytes_of(folder / "a.exr");
    for (std::size_t size = 0; size < bytes.size(); size += 7) {
      write_bytes(folder / "b.exr", std::span(bytes).first(size));
      expect_input_error(folder / "b.exr", "b.exr");
    }
  }
}

TEST(ExrRead, damaged_bytes_give_an_image_or_an_input_error) {
  const TemporaryFolder folder;
  std::mt19937 random(1);
  for (const auto compression :
       {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION,
        Imf::PXR24_COMPRESSION, Imf::B44_COMPRESSION, Imf::DWAA_COMPRESSION}) {
    for (const bool tiled : {false, true}) {
      write_foreign(folder / "a.exr", compression, tiled);
      const auto bytes = bytes_of(folder / "a.exr");
      for (int round = 0; round < 150; ++round) {
        auto damaged = bytes;
        for (int i = 0; i < 1 + round % 4; ++i) {
          // Half of the hits go to the header, where they do most harm.
          const std::size_t range =
              round % 2 == 0 ? std::min<std::size_t>(400, bytes.size()) : bytes.size();
          damaged[random() % range] = static_cast<std::uint8_t>(random());
        }
        write_bytes(folder / "b.exr", damaged);
        try {
          const Image image = read_exr(folder / "b.exr");
          EXPECT_EQ(image.pixels.size(), static_cast<std::size_t>(image.width) *
                                             static_cast<std::size_t>(image.height) *
                                             image.channel_count());
        } catch (const Error& error) {
          EXPECT_EQ(error.detail().kind, ErrorKind::Input);
        }
      }
    }
  }
}

}  // namespace
}  // namespace abbe
