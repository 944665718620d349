#include "abbe/image/raster/png_tags.h"

#include <algorithm>
#include <cmath>

namespace abbe {
namespace {

constexpr std::size_t kSignatureBytes = 8;
constexpr std::size_t kHeaderChunkBytes = 4 + 4 + 13 + 4;

constexpr std::array<std::uint32_t, 256> crc_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t c = i;
    for (int bit = 0; bit < 8; ++bit) c = (c & 1u) != 0 ? 0xedb88320u ^ (c >> 1) : c >> 1;
    table[i] = c;
  }
  return table;
}

void append_word(std::vector<std::uint8_t>& out, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) {
    out.push_back(static_cast<std::uint8_t>(value >> shift));
  }
}

void append_chunk(std::vector<std::uint8_t>& out, const std::string& type,
                  const std::vector<std::uint8_t>& data) {
  append_word(out, static_cast<std::uint32_t>(data.size()));
  const std::size_t begin = out.size();
  out.insert(out.end(), type.begin(), type.end());
  out.insert(out.end(), data.begin(), data.end());
  append_word(out, png_crc(std::span<const std::uint8_t>(out).subspan(begin)));
}

// PNG keeps fractions as multiples of 1/100000.
void append_fraction(std::vector<std::uint8_t>& out, double value) {
  append_word(out, static_cast<std::uint32_t>(std::lround(value * 100000.0)));
}

bool is_color_chunk(const std::string& type) {
  constexpr std::array<const char*, 5> kTypes{"sRGB", "gAMA", "cHRM", "cICP", "iCCP"};
  return std::any_of(kTypes.begin(), kTypes.end(),
                     [&](const char* known) { return type == known; });
}

}  // namespace

std::uint32_t png_crc(std::span<const std::uint8_t> bytes) {
  static constexpr std::array<std::uint32_t, 256> kTable = crc_table();
  std::uint32_t c = 0xffffffffu;
  for (const std::uint8_t byte : bytes) c = kTable[(c ^ byte) & 0xffu] ^ (c >> 8);
  return c ^ 0xffffffffu;
}

std::optional<PngTags> png_tags_of_display(const std::string& display) {
  // White D65, then red, green and blue of BT.709, P3 and BT.2020. Transfer functions of H.273:
  // 13 is sRGB's, 16 ST 2084's, 1 that of BT.709, which BT.1886 displays decode.
  constexpr std::array<double, 8> kRec709{0.3127, 0.3290, 0.64, 0.33, 0.30, 0.60, 0.15, 0.06};
  constexpr std::array<double, 8> kP3{0.3127, 0.3290, 0.68, 0.32, 0.265, 0.69, 0.15, 0.06};
  constexpr std::array<double, 8> kRec2020{0.3127, 0.3290, 0.708, 0.292, 0.17, 0.797, 0.131, 0.046};
  constexpr double kSrgbGamma = 0.45455;  // As the specification asks beside sRGB.
  if (display == "sRGB - Display") return PngTags{true, kSrgbGamma, kRec709, {1, 13, 0, 1}};
  if (display == "Display P3 - Display") return PngTags{false, kSrgbGamma, kP3, {12, 13, 0, 1}};
  if (display == "Rec.1886 Rec.709 - Display") {
    return PngTags{false, 1.0 / 2.4, kRec709, {1, 1, 0, 1}};
  }
  // No power stands for the perceptual quantiser.
  if (display == "Rec.2100-PQ - Display") {
    return PngTags{false, std::nullopt, kRec2020, {9, 16, 0, 1}};
  }
  return std::nullopt;
}

std::vector<std::uint8_t> with_tags(std::span<const std::uint8_t> png, const PngTags& tags) {
  const auto header_end =
      png.begin() + static_cast<std::ptrdiff_t>(kSignatureBytes + kHeaderChunkBytes);
  std::vector<std::uint8_t> out(png.begin(), header_end);
  // What a reader knows best comes first: it stops at the first chunk that it understands.
  append_chunk(out, "cICP", {tags.cicp.begin(), tags.cicp.end()});
  if (tags.is_srgb) append_chunk(out, "sRGB", {1});
  if (tags.gamma) {
    std::vector<std::uint8_t> gamma;
    append_fraction(gamma, *tags.gamma);
    append_chunk(out, "gAMA", gamma);
  }
  std::vector<std::uint8_t> chromaticities;
  for (const double value : tags.chromaticities) append_fraction(chromaticities, value);
  append_chunk(out, "cHRM", chromaticities);

  std::span<const std::uint8_t> rest = png.subspan(kSignatureBytes + kHeaderChunkBytes);
  while (rest.size() >= 12) {
    std::uint32_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) length = length << 8 | rest[i];
    const std::size_t chunk = std::min<std::size_t>(std::size_t{length} + 12, rest.size());
    const std::string type(rest.begin() + 4, rest.begin() + 8);
    if (!is_color_chunk(type)) {
      out.insert(out.end(), rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(chunk));
    }
    rest = rest.subspan(chunk);
  }
  return out;
}

}  // namespace abbe
