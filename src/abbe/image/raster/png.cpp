#include "abbe/image/raster/png.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <string_view>

#include "abbe/base/parallel.h"
#include "abbe/image/raster/png_filter.h"

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

// One row and the one above it; to the left of both stands a pixel of zeros.
struct RowPair {
  std::span<const std::uint8_t> row;
  std::span<const std::uint8_t> above;
  std::size_t pixel_bytes;
};

// Filters the row; the sum of the magnitudes.
template <int kFilter>
std::uint64_t filter_row(const RowPair& rows, std::span<std::uint8_t> out) {
  const std::uint8_t* const row = rows.row.data() + rows.pixel_bytes;
  const std::uint8_t* const above = rows.above.data() + rows.pixel_bytes;
  const auto pixel = static_cast<std::ptrdiff_t>(rows.pixel_bytes);
  std::uint64_t sum = 0;
  for (std::ptrdiff_t x = 0; x < static_cast<std::ptrdiff_t>(out.size()); ++x) {
    const int predicted = png_prediction<kFilter>(row[x - pixel], above[x], above[x - pixel]);
    const auto value = static_cast<std::uint8_t>(row[x] - predicted);
    out[static_cast<std::size_t>(x)] = value;
    sum += value < 128 ? value : 256u - value;
  }
  return sum;
}

// The filter's number and the filtered bytes.
void filter_best(const RowPair& rows, std::span<std::uint8_t> out) {
  constexpr std::array kFilters{filter_row<0>, filter_row<1>, filter_row<2>, filter_row<3>,
                                filter_row<4>};
  Bytes filtered(out.size() - 1);
  std::uint64_t smallest = ~std::uint64_t{0};
  for (std::size_t filter = 0; filter < kFilters.size(); ++filter) {
    const std::uint64_t sum = kFilters[filter](rows, filtered);
    if (sum >= smallest) continue;
    smallest = sum;
    out[0] = static_cast<std::uint8_t>(filter);
    std::copy(filtered.begin(), filtered.end(), out.begin() + 1);
  }
}

// The rows of an image as they lie in a PNG, filtered one by one.
Bytes filtered_rows(std::span<const std::uint8_t> raw, std::size_t rows, std::size_t pixel_bytes) {
  const std::size_t row_bytes = raw.size() / rows;
  Bytes filtered(rows * (row_bytes + 1));
  parallel_for(0, rows, 16, [&](std::size_t y) {
    Bytes row(pixel_bytes + row_bytes);
    Bytes above(pixel_bytes + row_bytes);
    const auto copy = [&](std::size_t from, Bytes& to) {
      const auto bytes = raw.subspan(from * row_bytes, row_bytes);
      std::copy(bytes.begin(), bytes.end(), to.begin() + static_cast<std::ptrdiff_t>(pixel_bytes));
    };
    copy(y, row);
    if (y > 0) copy(y - 1, above);  // Above the image all bytes are 0.
    filter_best({row, above, pixel_bytes},
                std::span(filtered).subspan(y * (row_bytes + 1), row_bytes + 1));
  });
  return filtered;
}

// As one stream of zlib in IDAT chunks.
void append_compressed(Bytes& out, const Bytes& filtered) {
  constexpr std::size_t kLongestInput = std::size_t{1} << 30;
  constexpr std::size_t kChunkBytes = std::size_t{1} << 20;
  z_stream stream{};
  if (deflateInit2(&stream, 6, Z_DEFLATED, 15, 8, Z_FILTERED) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, int (*)(z_stream*)> guard(&stream, deflateEnd);
  Bytes chunk(std::min(kChunkBytes, filtered.size() + 1024));
  std::size_t begin = 0;
  for (int status = Z_OK; status != Z_STREAM_END;) {
    if (stream.avail_in == 0) {
      const std::size_t more = std::min(kLongestInput, filtered.size() - begin);
      stream.next_in = const_cast<Bytef*>(filtered.data() + begin);
      stream.avail_in = static_cast<uInt>(more);
      begin += more;
    }
    stream.next_out = chunk.data();
    stream.avail_out = static_cast<uInt>(chunk.size());
    status = deflate(&stream, begin == filtered.size() ? Z_FINISH : Z_NO_FLUSH);
    const std::size_t size = chunk.size() - stream.avail_out;
    if (size > 0) append_chunk(out, "IDAT", std::span(chunk).first(size));
  }
}

// Of codes as they lie in a file, the high byte first.
Bytes encode(int width, int height, std::uint8_t bits, std::span<const std::uint8_t> raw,
             const std::optional<PngTags>& tags) {
  constexpr std::array<std::uint8_t, 8> kSignature{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  constexpr std::uint8_t kRgb = 2;
  Bytes out(kSignature.begin(), kSignature.end());
  Bytes header;
  append_word(header, static_cast<std::uint32_t>(width));
  append_word(header, static_cast<std::uint32_t>(height));
  header.insert(header.end(), {bits, kRgb, 0, 0, 0});
  append_chunk(out, "IHDR", header);
  if (tags) append_tags(out, *tags);

  append_compressed(
      out, filtered_rows(raw, static_cast<std::size_t>(height), std::size_t{3} * bits / 8));
  append_chunk(out, "IEND", {});
  return out;
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
  return encode(width, height, 8, codes, tags);
}

Bytes encode_png(int width, int height, std::span<const std::uint16_t> codes,
                 const std::optional<PngTags>& tags) {
  Bytes raw(codes.size() * 2);
  for (std::size_t i = 0; i < codes.size(); ++i) {
    raw[2 * i] = static_cast<std::uint8_t>(codes[i] >> 8);
    raw[2 * i + 1] = static_cast<std::uint8_t>(codes[i]);
  }
  return encode(width, height, 16, raw, tags);
}

}  // namespace abbe
