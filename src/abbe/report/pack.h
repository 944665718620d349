/// Numbers and pictures as text inside a page.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace abbe {

/// RFC 4648, with padding.
std::string base64(std::span<const std::uint8_t> bytes);

/// A file as a `data:` URI. Errors: as read_file.
std::string data_uri(const std::filesystem::path& file, const std::string& media_type);

/// A zlib stream (RFC 1950) as base64: what a browser's DecompressionStream("deflate") takes.
std::string deflated_base64(std::span<const std::uint8_t> bytes);

/// A map in 8 bits, finer near 0: value = sign · max · (|code|/127)², code from −127 to 127, for
/// maps without negative values max · (code/255)². Every code is stored as its difference to the
/// one on its left, modulo 256, the first of a row to 0.
struct PackedMap {
  int width = 0;
  int height = 0;
  bool is_signed = false;
  double max = 0.0;  ///< Largest magnitude.
  std::string data;  ///< deflated_base64 of the codes, row by row.
};

/// Means of block × block pixels; those at the right and lower edge are of fewer. What is not
/// finite counts as 0.
/// Shape: width × height values.
PackedMap packed_map(const std::vector<float>& map, int width, int height, int block);

/// Means over blocks, likewise, of every channel of an interleaved image.
struct Blocks {
  int width = 0;
  int height = 0;
  std::vector<float> values;
};
Blocks block_means(std::span<const float> pixels, int width, int height, std::size_t channels,
                   int block);

/// Spectra in 8 bits: of each the largest value as float32 (little endian), all of these first,
/// then value/largest · 255 of every band.
std::string packed_spectra(const Blocks& blocks, std::size_t bands);

/// Numbers in 16 bits, little endian, finer near 0: value = sign · max · (|code|/32767)².
struct PackedNumbers {
  double max = 0.0;
  std::string data;
};
PackedNumbers packed_numbers(std::span<const float> values);

}  // namespace abbe
