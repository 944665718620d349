#include "abbe/image/raster/plain_png.h"

#include <png.h>

#include <algorithm>
#include <cstddef>
#include <new>
#include <vector>

namespace abbe {
namespace {

using Bytes = std::span<const std::uint8_t>;

void read_from(png_structp png, png_bytep out, std::size_t size) {
  Bytes& left = *static_cast<Bytes*>(png_get_io_ptr(png));
  if (size > left.size()) png_error(png, "ends early");
  std::copy_n(left.begin(), size, out);
  left = left.subspan(size);
}

// What libpng only warns of is damage, too.
[[noreturn]] void give_up(png_structp png, png_const_charp /*reason*/) {
  png_longjmp(png, 1);
}

struct Reader {
  png_structp png = nullptr;
  png_infop info = nullptr;

  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
};

// libpng leaves by longjmp: what has a destructor belongs to the caller.

// Reads what stands before the pixels. Whether it is plain, and asks for R, G, B, A then.
bool take_header(const Reader& reader) {
  png_structp png = reader.png;
  png_infop info = reader.info;
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_read_info(png, info);
  const png_byte type = png_get_color_type(png, info);
  if (png_get_bit_depth(png, info) != 8 || type == PNG_COLOR_TYPE_PALETTE ||
      png_get_interlace_type(png, info) != PNG_INTERLACE_NONE ||
      png_get_valid(png, info, PNG_INFO_tRNS) != 0) {
    return false;
  }
  if ((type & PNG_COLOR_MASK_COLOR) == 0) png_set_gray_to_rgb(png);
  if ((type & PNG_COLOR_MASK_ALPHA) == 0) png_set_filler(png, 255, PNG_FILLER_AFTER);
  png_read_update_info(png, info);
  return true;
}

bool take_pixels(const Reader& reader, std::vector<png_bytep>& rows) {
  if (setjmp(png_jmpbuf(reader.png)) != 0) return false;
  png_read_image(reader.png, rows.data());
  png_read_end(reader.png, nullptr);
  return true;
}

}  // namespace

std::optional<DecodedTexture> decode_plain_png(Bytes bytes, std::int64_t max_pixels) {
  Reader reader;
  reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, give_up, give_up);
  reader.info = reader.png != nullptr ? png_create_info_struct(reader.png) : nullptr;
  if (reader.info == nullptr) throw std::bad_alloc();
  png_set_read_fn(reader.png, &bytes, read_from);
  if (!take_header(reader)) return std::nullopt;
  const std::size_t width = png_get_image_width(reader.png, reader.info);
  const std::size_t height = png_get_image_height(reader.png, reader.info);
  if (width * height > static_cast<std::uint64_t>(max_pixels)) return std::nullopt;
  DecodedTexture texture;
  texture.width = static_cast<int>(width);
  texture.height = static_cast<int>(height);
  texture.rgba8.resize(width * height * 4);
  std::vector<png_bytep> rows;
  rows.reserve(height);
  for (std::size_t y = 0; y < height; ++y) rows.push_back(texture.rgba8.data() + y * width * 4);
  if (!take_pixels(reader, rows)) return std::nullopt;
  return texture;
}

}  // namespace abbe
