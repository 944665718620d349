#include "image/texture_structure.h"

#include <algorithm>
#include <array>
#include <string_view>

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

constexpr std::array<std::uint32_t, 256> crc_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t c = i;
    for (int bit = 0; bit < 8; ++bit) c = (c & 1u) != 0 ? 0xedb88320u ^ (c >> 1) : c >> 1;
    table[i] = c;
  }
  return table;
}

std::uint32_t crc_of(Bytes bytes) {
  static constexpr std::array<std::uint32_t, 256> kTable = crc_table();
  std::uint32_t c = 0xffffffffu;
  for (const std::uint8_t byte : bytes) c = kTable[(c ^ byte) & 0xffu] ^ (c >> 8);
  return c ^ 0xffffffffu;
}

std::string png_header_error(Bytes header) {
  if (header.size() != 13) return "a PNG whose header is not 13 bytes long";
  const std::uint32_t width = big_endian(header);
  const std::uint32_t height = big_endian(header.subspan(4));
  // libpng refuses sides beyond a million by its own limits.
  if (width < 1 || height < 1 || width > 1000000 || height > 1000000) {
    return "a PNG of " + std::to_string(width) + "x" + std::to_string(height) + " pixels";
  }
  return "";
}

std::string png_error(Bytes bytes) {
  bytes = bytes.subspan(kPngMagic.size());
  bool has_header = false;
  bool has_data = false;
  while (bytes.size() >= 12) {
    const std::uint32_t size = big_endian(bytes);
    if (size > bytes.size() - 12) return "a truncated PNG";
    const std::string type(bytes.begin() + 4, bytes.begin() + 8);
    const Bytes data = bytes.subspan(8, size);
    if (crc_of(bytes.subspan(4, size + 4)) != big_endian(bytes.subspan(8 + size))) {
      return "a PNG with a damaged chunk";
    }
    if (!has_header) {
      if (type != "IHDR") return "a PNG that does not begin with its header";
      const std::string error = png_header_error(data);
      if (!error.empty()) return error;
      has_header = true;
    }
    has_data = has_data || (type == "IDAT" && size > 0);
    if (type == "IEND") return has_data ? "" : "a PNG without image data";
    bytes = bytes.subspan(12 + size);
  }
  return "a truncated PNG";
}

std::string jpeg_error(Bytes bytes) {
  constexpr std::uint8_t kStartOfScan = 0xda;
  constexpr std::array<std::uint8_t, 2> kEndOfImage{0xff, 0xd9};
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
  return TextureFormat::Other;
}

std::string texture_structure_error(Bytes bytes) {
  if (bytes.empty()) return "an empty image";
  switch (texture_format(bytes)) {
    case TextureFormat::Png:
      return png_error(bytes);
    case TextureFormat::Jpeg:
      return jpeg_error(bytes);
    case TextureFormat::Other:
      break;
  }
  return "bytes that begin neither as PNG nor as JPEG";
}

}  // namespace abbe
