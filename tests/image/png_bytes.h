/// PNG files made by hand, of any colour type and depth, for decoders to be tested on.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace abbe {

using PngBytes = std::vector<std::uint8_t>;

inline void append_big_endian(PngBytes& bytes, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) {
    bytes.push_back(static_cast<std::uint8_t>(value >> shift));
  }
}

/// Bit by bit: slow, and independent of the table in image/.
inline std::uint32_t png_crc(const PngBytes& bytes, std::size_t begin) {
  std::uint32_t c = 0xffffffffu;
  for (std::size_t i = begin; i < bytes.size(); ++i) {
    c ^= bytes[i];
    for (int bit = 0; bit < 8; ++bit) c = (c & 1u) != 0 ? 0xedb88320u ^ (c >> 1) : c >> 1;
  }
  return ~c;
}

inline void append_chunk(PngBytes& bytes, const std::string& type, const PngBytes& data) {
  append_big_endian(bytes, static_cast<std::uint32_t>(data.size()));
  const std::size_t begin = bytes.size();
  bytes.insert(bytes.end(), type.begin(), type.end());
  bytes.insert(bytes.end(), data.begin(), data.end());
  append_big_endian(bytes, png_crc(bytes, begin));
}

/// A zlib stream of one stored block.
inline PngBytes stored_zlib(const PngBytes& data) {
  const auto size = static_cast<std::uint16_t>(data.size());
  const auto low = [](int v) { return static_cast<std::uint8_t>(v & 0xff); };
  PngBytes bytes{0x78, 0x01, 0x01, low(size), low(size >> 8), low(~size), low(~size >> 8)};
  std::uint32_t a = 1;
  std::uint32_t b = 0;
  for (const std::uint8_t byte : data) {
    a = (a + byte) % 65521u;
    b = (b + a) % 65521u;
  }
  bytes.insert(bytes.end(), data.begin(), data.end());
  append_big_endian(bytes, b << 16 | a);
  return bytes;
}

enum PngColour : std::uint8_t {
  PngGrey = 0,
  PngRgb = 2,
  PngPalette = 3,
  PngGreyAlpha = 4,
  PngRgba = 6
};

struct PngChunk {
  std::string type;
  PngBytes data;
};

/// `rows` are the packed bytes of each row; `before_data` go between header and data.
inline PngBytes png_bytes(std::uint32_t width, std::uint32_t height, std::uint8_t depth,
                          PngColour colour, const std::vector<PngBytes>& rows,
                          const std::vector<PngChunk>& before_data = {}) {
  PngBytes bytes{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  PngBytes header;
  append_big_endian(header, width);
  append_big_endian(header, height);
  header.insert(header.end(), {depth, colour, 0, 0, 0});
  append_chunk(bytes, "IHDR", header);
  for (const PngChunk& chunk : before_data) append_chunk(bytes, chunk.type, chunk.data);
  PngBytes data;
  for (const PngBytes& row : rows) {
    data.push_back(0);  // No prediction.
    data.insert(data.end(), row.begin(), row.end());
  }
  if (!rows.empty()) append_chunk(bytes, "IDAT", stored_zlib(data));
  append_chunk(bytes, "IEND", {});
  return bytes;
}

}  // namespace abbe
