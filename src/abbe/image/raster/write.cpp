#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <optional>
#include <stdexcept>

#include "abbe/base/error.h"
#include "abbe/base/file.h"
#include "abbe/base/parallel.h"
#include "abbe/base/text.h"
#include "abbe/image/channels.h"
#include "abbe/image/raster/codec.h"
#include "abbe/image/raster/png.h"
#include "abbe/image/raster/raster.h"
#include "abbe/math/random.h"

namespace abbe {
namespace {

std::string format_of(const std::filesystem::path& file) {
  const std::string suffix = lower_case(file.extension().string());
  if (suffix == ".png") return "png";
  if (suffix == ".jpg" || suffix == ".jpeg") return "jpeg";
  if (suffix == ".tif" || suffix == ".tiff") return "tiff";
  throw_output_error(file.string(), "suffix '" + suffix + "'", ".png, .jpg, .jpeg, .tif or .tiff");
}

// The nearest code of `largest` + 1. NaN fails the comparison and becomes black.
template <typename Code>
Code code_of(float value, float noise) {
  constexpr auto kLargest = static_cast<float>(std::numeric_limits<Code>::max());
  const float scaled = value * kLargest + noise;
  if (!(scaled > 0.0f)) return 0;
  return static_cast<Code>(std::lround(std::min(scaled, kLargest)));
}

template <typename Code>
std::vector<Code> codes_of(const Image& image, const std::array<std::size_t, 3>& rgb, bool dither) {
  const auto width = static_cast<std::size_t>(image.width);
  const auto height = static_cast<std::size_t>(image.height);
  const std::size_t channels = image.channel_count();
  std::vector<Code> codes(width * height * 3);
  parallel_for(0, height, 16, [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t p = y * width + x;
      const Vec2i place = image.data_origin + Vec2i(static_cast<int>(x), static_cast<int>(y));
      for (std::size_t c = 0; c < 3; ++c) {
        const float noise = dither ? dither_noise(place, static_cast<std::uint32_t>(c)) : 0.0f;
        codes[p * 3 + c] = code_of<Code>(image.pixels[p * channels + rgb[c]], noise);
      }
    }
  });
  return codes;
}

std::array<std::size_t, 3> checked_rgb(const std::filesystem::path& file, const Image& image) {
  const auto rgb = rgb_channels(image);
  if (!rgb || image.width < 1 || image.height < 1) {
    throw_output_error(file.string(), "an image without pixels or without channels R, G, B",
                       "R, G, B");
  }
  return *rgb;
}

std::string display_of(const Image& image) {
  const auto display = image.attributes.find(kDisplayAttribute);
  if (display == image.attributes.end()) return "sRGB - Display";
  const auto* name = std::get_if<std::string>(&display->second);
  return name != nullptr ? *name : "";
}

void write_bytes(const std::filesystem::path& file, const std::vector<std::uint8_t>& bytes) {
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out.write(reinterpret_cast<const char*>(bytes.data()),
            static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out) {
    throw_output_error(file.string(), "a file that could not be written to its end",
                       "a place with room for the image");
  }
}

}  // namespace

void write_raster(const std::filesystem::path& file, const Image& rgb_encoded,
                  const RasterOptions& options) {
  const std::string format = format_of(file);
  const std::array<std::size_t, 3> rgb = checked_rgb(file, rgb_encoded);
  const bool is_deep = options.bits == 16 && format != "jpeg";
  std::vector<std::uint8_t> codes8;
  std::vector<std::uint16_t> codes16;
  is_deep ? void(codes16 = codes_of<std::uint16_t>(rgb_encoded, rgb, options.dither))
          : void(codes8 = codes_of<std::uint8_t>(rgb_encoded, rgb, options.dither));
  const std::string display = display_of(rgb_encoded);
  const int width = rgb_encoded.width;
  const int height = rgb_encoded.height;
  if (format == "png") {
    const std::optional<PngTags> tags = png_tags_of_display(display);
    const auto png = is_deep ? encode_png(width, height, codes16, tags)
                             : encode_png(width, height, codes8, tags);
    write_atomically(file,
                     [&](const std::filesystem::path& temporary) { write_bytes(temporary, png); });
    return;
  }
  RasterOutput image;
  image.width = width;
  image.height = height;
  image.value = is_deep ? RasterValue::Code16 : RasterValue::Code8;
  image.codes = is_deep ? static_cast<const void*>(codes16.data()) : codes8.data();
  image.is_srgb = display.starts_with("sRGB");
  const RasterCodec& codec = raster_codec();
  write_atomically(file, [&](const std::filesystem::path& temporary) {
    try {
      codec.write(temporary.string(), format, image);
    } catch (const std::runtime_error& failed) {
      throw_output_error(file.string(), failed.what(), "an image that can be written as " + format);
    }
  });
}

}  // namespace abbe
