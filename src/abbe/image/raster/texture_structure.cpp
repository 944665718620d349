#include "abbe/image/raster/texture_structure.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "abbe/image/raster/png.h"

namespace abbe {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::string_view kPngMagic = "\x89PNG\r\n\x1a\n";
constexpr std::string_view kJpegMagic = "\xff\xd8\xff";

bool starts_with(Bytes bytes, std::string_view magic) {
  return bytes.size() >= magic.size() &&
         std::equal(magic.begin(), magic.end(), bytes.begin(),
                    [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
}

std::uint32_t big_endian(Bytes bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | bytes[i];
  return value;
}

// RFC 9649, 2.4: RIFF, the size of what follows, WEBP, chunks.
std::string webp_error(Bytes bytes) {
  std::uint64_t size = 0;
  for (std::size_t i = 8; i-- > 4;) size = size << 8 | bytes[i];
  return size + 8 > bytes.size() ? "a truncated WebP" : "";
}

struct PngHeader {
  std::uint64_t width = 0;
  std::uint64_t height = 0;
  std::uint64_t raw_bytes = 0;  ///< What the data must inflate to, at least.

  std::string size() const { return std::to_string(width) + "x" + std::to_string(height); }
};

// Empty when fine.
std::string png_header_error(Bytes data, PngHeader& header) {
  if (data.size() != 13) return "a PNG whose header is not 13 bytes long";
  header.width = big_endian(data);
  header.height = big_endian(data.subspan(4));
  // libpng refuses sides beyond a million by its own limits.
  constexpr std::uint64_t kLongestSide_px = 1000000;
  if (header.width < 1 || header.height < 1 || header.width > kLongestSide_px ||
      header.height > kLongestSide_px) {
    return "a PNG of " + header.size() + " pixels";
  }
  const std::uint64_t depth = data[8];
  const std::uint8_t color = data[9];
  const std::uint64_t channels = color == 2 ? 3 : color == 4 ? 2 : color == 6 ? 4 : 1;
  header.raw_bytes = header.height * (header.width * channels * depth / 8);
  return "";
}

std::string png_error(Bytes bytes) {
  bytes = bytes.subspan(kPngMagic.size());
  bool has_header = false;
  PngHeader header;
  std::uint64_t data_bytes = 0;
  while (bytes.size() >= 12) {
    const std::uint32_t size = big_endian(bytes);
    if (size > bytes.size() - 12) return "a truncated PNG";
    const std::string type(bytes.begin() + 4, bytes.begin() + 8);
    if (png_crc(bytes.subspan(4, size + 4)) != big_endian(bytes.subspan(8 + size))) {
      return "a PNG with a damaged chunk";
    }
    if (!has_header) {
      if (type != "IHDR") return "a PNG that does not begin with its header";
      std::string error = png_header_error(bytes.subspan(8, size), header);
      if (!error.empty()) return error;
      has_header = true;
    }
    if (type == "IDAT") data_bytes += size;
    if (type == "IEND") {
      if (data_bytes == 0) return "a PNG without image data";
      // A match of deflate costs two bits at least and yields 258 bytes at most.
      constexpr std::uint64_t kMaxPerByte = 1032;
      if (header.raw_bytes > data_bytes * kMaxPerByte) {
        return "a PNG of " + header.size() + " pixels with too little image data";
      }
      return "";
    }
    bytes = bytes.subspan(12 + size);
  }
  return "a truncated PNG";
}

std::string jpeg_error(Bytes bytes) {
  constexpr std::uint8_t kStartOfScan = 0xda;
  constexpr std::array<std::uint8_t, 2> kEndOfImage{0xff, 0xd9};
  // With Huffman coding a block of 64 values takes a bit at least; twice that is let through.
  constexpr std::uint64_t kMaxPixelsPerByte = 1024;
  const std::uint64_t most_pixels = bytes.size() * kMaxPixelsPerByte;
  bytes = bytes.subspan(2);
  while (bytes.size() >= 4 && bytes[0] == 0xff) {
    const std::uint8_t marker = bytes[1];
    if (marker == 0xff) {  // A fill byte.
      bytes = bytes.subspan(1);
      continue;
    }
    const std::size_t size = static_cast<std::size_t>(bytes[2]) << 8 | bytes[3];
    if (size < 2) return "a JPEG with a damaged segment";
    if (size + 2 > bytes.size()) return "a truncated JPEG";
    const bool is_huffman_frame = marker >= 0xc0 && marker <= 0xc2;
    if (is_huffman_frame && size >= 7) {
      const std::uint64_t height = static_cast<std::uint64_t>(bytes[5]) << 8 | bytes[6];
      const std::uint64_t width = static_cast<std::uint64_t>(bytes[7]) << 8 | bytes[8];
      if (width * height > most_pixels) {
        return "a JPEG of " + std::to_string(width) + "x" + std::to_string(height) +
               " pixels with too little image data";
      }
    }
    bytes = bytes.subspan(size + 2);
    if (marker == kStartOfScan) {
      // In coded data 0xff is followed by 0 or a restart mark: this pair is the end and no other.
      const auto end =
          std::search(bytes.begin(), bytes.end(), kEndOfImage.begin(), kEndOfImage.end());
      return end == bytes.end() ? "a truncated JPEG" : "";
    }
  }
  return "a JPEG without image data";
}

}  // namespace

TextureFormat texture_format(Bytes bytes) {
  if (starts_with(bytes, kPngMagic)) return TextureFormat::Png;
  if (starts_with(bytes, kJpegMagic)) return TextureFormat::Jpeg;
  // Between the two stands the size.
  const bool is_webp =
      starts_with(bytes, "RIFF") && bytes.size() >= 16 && starts_with(bytes.subspan(8), "WEBP");
  return is_webp ? TextureFormat::WebP : TextureFormat::Other;
}

std::string texture_structure_error(Bytes bytes) {
  if (bytes.empty()) return "an empty image";
  switch (texture_format(bytes)) {
    case TextureFormat::Png:
      return png_error(bytes);
    case TextureFormat::Jpeg:
      return jpeg_error(bytes);
    case TextureFormat::WebP:
      return webp_error(bytes);
    case TextureFormat::Other:
      break;
  }
  return "bytes that begin neither as PNG nor as JPEG nor as WebP";
}

}  // namespace abbe
