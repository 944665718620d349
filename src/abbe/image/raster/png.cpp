#include "abbe/image/raster/png.h"

#include <png.h>
#include <zlib.h>

#include <cmath>
#include <new>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "abbe/math/vec.h"

namespace abbe {
namespace {

using Bytes = std::vector<std::uint8_t>;

void append_word(Bytes& out, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) {
    out.push_back(static_cast<std::uint8_t>(value >> shift));
  }
}

void append_chunk(Bytes& out, std::string_view type, std::span<const std::uint8_t> data) {
  append_word(out, static_cast<std::uint32_t>(data.size()));
  const std::size_t begin = out.size();
  out.insert(out.end(), type.begin(), type.end());
  out.insert(out.end(), data.begin(), data.end());
  append_word(out, png_crc(std::span<const std::uint8_t>(out).subspan(begin)));
}

// PNG keeps fractions as multiples of 1/100000.
void append_fraction(Bytes& out, double value) {
  append_word(out, static_cast<std::uint32_t>(std::lround(value * 100000.0)));
}

// What a reader knows best comes first: it stops at the first chunk that it understands.
void append_tags(Bytes& out, const PngTags& tags) {
  append_chunk(out, "cICP", tags.cicp);
  if (tags.is_srgb) append_chunk(out, "sRGB", std::array<std::uint8_t, 1>{1});
  if (tags.gamma) {
    Bytes gamma;
    append_fraction(gamma, *tags.gamma);
    append_chunk(out, "gAMA", gamma);
  }
  Bytes chromaticities;
  for (const double value : tags.chromaticities) append_fraction(chromaticities, value);
  append_chunk(out, "cHRM", chromaticities);
}

// Of a PNG that is being written.
struct Sink {
  Bytes bytes;
  std::string fault;
};

void append_to(png_structp png, png_bytep data, std::size_t size) {
  Bytes& bytes = static_cast<Sink*>(png_get_io_ptr(png))->bytes;
  bytes.insert(bytes.end(), data, data + size);
}

[[noreturn]] void give_up(png_structp png, png_const_charp reason) {
  static_cast<Sink*>(png_get_error_ptr(png))->fault = reason;
  png_longjmp(png, 1);
}

void ignore(png_structp /*png*/, png_const_charp /*reason*/) {}

struct Writer {
  png_structp png = nullptr;
  png_infop info = nullptr;

  ~Writer() { png_destroy_write_struct(&png, &info); }
};

// libpng leaves by longjmp: what has a destructor belongs to the caller. Whether it came to its
// end.
bool write_all(const Writer& writer, const Vec2i& size, int bits, const Bytes& tags,
               std::vector<png_bytep>& rows) {
  png_structp png = writer.png;
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_IHDR(png, writer.info, static_cast<png_uint_32>(size.x), static_cast<png_uint_32>(size.y),
               bits, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, writer.info);
  // libpng 1.6 knows no cICP, and the others go with it.
  append_to(png, const_cast<png_bytep>(tags.data()), tags.size());
  if (bits == 16) png_set_swap(png);
  png_write_image(png, rows.data());
  png_write_end(png, nullptr);
  return true;
}

template <typename Code>
Bytes encode(int width, int height, std::span<const Code> codes,
             const std::optional<PngTags>& tags) {
  Sink sink;
  Writer writer;
  writer.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &sink, give_up, ignore);
  writer.info = writer.png != nullptr ? png_create_info_struct(writer.png) : nullptr;
  if (writer.info == nullptr) throw std::bad_alloc();
  png_set_write_fn(writer.png, &sink, append_to, nullptr);
  Bytes chunks;
  if (tags) append_tags(chunks, *tags);
  std::vector<png_bytep> rows;
  rows.reserve(static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y) {
    const Code* const row =
        codes.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width) * 3;
    rows.push_back(const_cast<png_bytep>(reinterpret_cast<png_const_bytep>(row)));
  }
  if (!write_all(writer, {width, height}, 8 * static_cast<int>(sizeof(Code)), chunks, rows)) {
    throw std::runtime_error("libpng: " + sink.fault);
  }
  return std::move(sink.bytes);
}

}  // namespace

std::uint32_t png_crc(std::span<const std::uint8_t> bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, bytes.data(), bytes.size()));
}

std::optional<PngTags> png_tags_of_display(const std::string& display) {
  // White D65, then red, green and blue of BT.709, P3 and BT.2020. Transfer functions of H.273:
  // 13 is sRGB's, 16 ST 2084's, 1 that of BT.709, which BT.1886 displays decode.
  constexpr std::array<double, 8> kRec709{0.3127, 0.3290, 0.64, 0.33, 0.30, 0.60, 0.15, 0.06};
  constexpr std::array<double, 8> kP3{0.3127, 0.3290, 0.68, 0.32, 0.265, 0.69, 0.15, 0.06};
  constexpr std::array<double, 8> kRec2020{0.3127, 0.3290, 0.708, 0.292, 0.17, 0.797, 0.131, 0.046};
  constexpr double kSrgbGamma = 0.45455;  // As the specification asks beside sRGB.
  // Other configurations name it otherwise.
  if (display.starts_with("sRGB")) return PngTags{true, kSrgbGamma, kRec709, {1, 13, 0, 1}};
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

Bytes encode_png(int width, int height, std::span<const std::uint8_t> codes,
                 const std::optional<PngTags>& tags) {
  return encode(width, height, codes, tags);
}

Bytes encode_png(int width, int height, std::span<const std::uint16_t> codes,
                 const std::optional<PngTags>& tags) {
  return encode(width, height, codes, tags);
}

}  // namespace abbe
