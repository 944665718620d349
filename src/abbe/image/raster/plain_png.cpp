#include "abbe/image/raster/plain_png.h"

#include <zlib.h>

#include <array>
#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

#include "abbe/image/raster/png_filter.h"
#include "abbe/image/raster/rgba.h"

namespace abbe {
namespace {

using Bytes = std::span<const std::uint8_t>;

std::uint32_t word_at(Bytes bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = at; i < at + 4; ++i) value = value << 8 | bytes[i];
  return value;
}

struct Plain {
  std::size_t width = 0;
  std::size_t height = 0;
  std::size_t channels = 0;
  std::vector<Bytes> data;  ///< Of the IDAT chunks, which make one stream.
};

std::size_t channels_of(std::uint8_t color_type) {
  switch (color_type) {
    case 0:
      return 1;
    case 2:
      return 3;
    case 4:
      return 2;
    case 6:
      return 4;
    default:
      return 0;
  }
}

bool take_header(Bytes header, Plain& png) {
  png.width = word_at(header, 0);
  png.height = word_at(header, 4);
  png.channels = channels_of(header[9]);
  const bool is_in_one_pass = header[10] == 0 && header[11] == 0 && header[12] == 0;
  return header[8] == 8 && png.channels > 0 && is_in_one_pass;
}

// None where there is a chunk that decides anything else.
std::optional<Plain> plain(Bytes bytes) {
  constexpr std::size_t kSignatureBytes = 8;
  constexpr std::size_t kHeaderBytes = 13;
  Plain png;
  bool is_data_over = false;
  for (std::size_t at = kSignatureBytes; at + 12 <= bytes.size();) {
    const std::size_t size = word_at(bytes, at);
    if (size > bytes.size() - at - 12) return std::nullopt;
    const Bytes data = bytes.subspan(at + 8, size);
    const std::string_view type(reinterpret_cast<const char*>(bytes.data()) + at + 4, 4);
    const bool is_first = at == kSignatureBytes;
    at += size + 12;
    if (is_first != (type == "IHDR")) return std::nullopt;
    if (is_first) {
      if (size != kHeaderBytes || !take_header(data, png)) return std::nullopt;
    } else if (type == "IDAT") {
      if (is_data_over) return std::nullopt;
      png.data.push_back(data);
    } else if (type == "IEND") {
      return png;
    } else {
      is_data_over = !png.data.empty();
      const bool must_be_understood = type[0] >= 'A' && type[0] <= 'Z';
      if (must_be_understood || type == "tRNS") return std::nullopt;
    }
  }
  return std::nullopt;
}

// Inflates a stream that lies in pieces.
class Inflater {
 public:
  explicit Inflater(const std::vector<Bytes>& pieces) : pieces_(pieces) {
    is_good_ = inflateInit(&stream_) == Z_OK;
  }
  ~Inflater() { inflateEnd(&stream_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  // Fills `out`; false where the stream is broken or ends before.
  bool read(std::span<std::uint8_t> out) {
    stream_.next_out = out.data();
    stream_.avail_out = static_cast<uInt>(out.size());
    while (is_good_ && !is_at_end_ && stream_.avail_out > 0) step();
    return is_good_ && stream_.avail_out == 0;
  }

  // Whether nothing but the check sum is left, and is right.
  bool ends_here() {
    std::uint8_t more = 0;
    stream_.next_out = &more;
    stream_.avail_out = 1;
    while (is_good_ && !is_at_end_ && stream_.avail_out > 0) step();
    return is_good_ && is_at_end_ && stream_.avail_out == 1 && stream_.avail_in == 0 &&
           next_ == pieces_.size();
  }

 private:
  void step() {
    if (stream_.avail_in == 0) {
      is_good_ = next_ < pieces_.size();
      if (!is_good_) return;
      stream_.next_in = const_cast<Bytef*>(pieces_[next_].data());
      stream_.avail_in = static_cast<uInt>(pieces_[next_].size());
      ++next_;
    }
    const int status = inflate(&stream_, Z_NO_FLUSH);
    is_at_end_ = status == Z_STREAM_END;
    // No progress is no fault where a piece was empty.
    is_good_ = is_at_end_ || status == Z_OK || status == Z_BUF_ERROR;
  }

  const std::vector<Bytes>& pieces_;
  std::size_t next_ = 0;
  z_stream stream_{};
  bool is_good_ = false;
  bool is_at_end_ = false;
};

// A row whose first `pixel` bytes, like those of the row above, are the 0 that is left of it.
template <int kFilter>
void restore(std::vector<std::uint8_t>& row, const std::vector<std::uint8_t>& above,
             std::size_t pixel) {
  for (std::size_t x = pixel; x < row.size(); ++x) {
    const int predicted = png_prediction<kFilter>(row[x - pixel], above[x], above[x - pixel]);
    row[x] = static_cast<std::uint8_t>(row[x] + predicted);
  }
}

}  // namespace

std::optional<DecodedTexture> decode_plain_png(Bytes bytes, std::int64_t max_pixels) {
  constexpr std::array kRestore{restore<0>, restore<1>, restore<2>, restore<3>, restore<4>};
  const std::optional<Plain> png = plain(bytes);
  if (!png || png->width * png->height > static_cast<std::uint64_t>(max_pixels)) {
    return std::nullopt;
  }
  DecodedTexture texture;
  texture.width = static_cast<int>(png->width);
  texture.height = static_cast<int>(png->height);
  texture.rgba8.resize(png->width * png->height * 4);
  const std::size_t pixel = png->channels;
  std::vector<std::uint8_t> row(pixel + png->width * pixel);
  std::vector<std::uint8_t> above(row.size());
  Inflater data(png->data);
  for (std::size_t y = 0; y < png->height; ++y) {
    std::uint8_t filter = 0;
    if (!data.read({&filter, 1}) || filter >= kRestore.size()) return std::nullopt;
    if (!data.read(std::span(row).subspan(pixel))) return std::nullopt;
    kRestore[filter](row, above, pixel);
    to_rgba(row.data() + pixel, png->width, pixel, std::uint8_t{255},
            texture.rgba8.data() + y * png->width * 4);
    std::swap(row, above);
  }
  if (!data.ends_here()) return std::nullopt;
  return texture;
}

}  // namespace abbe
