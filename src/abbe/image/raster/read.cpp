#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <locale>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "abbe/base/error.h"
#include "abbe/image/raster/codec.h"
#include "abbe/image/raster/plain_png.h"
#include "abbe/image/raster/raster.h"
#include "abbe/image/raster/texture_structure.h"

namespace abbe {
namespace {

// Pixels of one to four channels as R, G, B, A.
// Grey is repeated; missing alpha is `opaque`. Domain: `out` holds 4 * pixels values.
template <typename T>
void to_rgba(const T* in, std::size_t pixels, std::size_t channels, T opaque, T* out) {
  const bool is_grey = channels < 3;
  for (std::size_t p = 0; p < pixels; ++p, in += channels, out += 4) {
    out[0] = in[0];
    out[1] = in[is_grey ? 0 : 1];
    out[2] = in[is_grey ? 0 : 2];
    out[3] = channels == 4 ? in[3] : channels == 2 ? in[1] : opaque;
  }
}

constexpr std::int64_t kMaxPixels = std::int64_t{1} << 28;
constexpr std::int64_t kMaxValues = std::int64_t{1} << 31;

bool is_bounded(const RasterHeader& header) {
  const std::int64_t pixels = std::int64_t{header.width} * header.height;
  const auto channels = static_cast<std::int64_t>(header.channels.size());
  return header.width > 0 && header.height > 0 && header.depth <= 1 && channels > 0 &&
         pixels <= kMaxPixels && pixels * channels <= kMaxValues;
}

std::string size_of(const RasterHeader& header) {
  return std::to_string(header.width) + "x" + std::to_string(header.height) + " pixels of " +
         std::to_string(header.channels.size()) + " channels";
}

[[noreturn]] void reject_raster(const std::filesystem::path& file, const std::string& found) {
  throw_input_error(file.string(), found, "an image that OpenImageIO reads");
}

// A file whose header is good.
std::unique_ptr<RasterInput> open_raster(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) {
    reject_raster(file, std::filesystem::exists(file, ignored)
                            ? "something that is not a regular file"
                            : "no such file");
  }
  const RasterCodec& codec = raster_codec();
  std::unique_ptr<RasterInput> input;
  try {
    input = codec.open(file.string());
  } catch (const std::runtime_error& unreadable) {
    reject_raster(file, unreadable.what());
  }
  if (!is_bounded(input->header())) reject_raster(file, size_of(input->header()));
  return input;
}

}  // namespace

namespace {

// OpenImageIO 2.4 multiplies a WebP's colours by alpha whatever is asked. Divided again they are
// right to half a code over alpha: what a surface shows of them, to half a code.
void divide_by_alpha(std::vector<std::uint8_t>& rgba) {
  for (std::size_t i = 0; i + 3 < rgba.size(); i += 4) {
    const unsigned alpha = rgba[i + 3];
    if (alpha == 0 || alpha == 255) continue;
    for (std::size_t c = i; c < i + 3; ++c) {
      rgba[c] = static_cast<std::uint8_t>(std::min(255u, (rgba[c] * 255u + alpha / 2) / alpha));
    }
  }
}

// Strip by strip: the pixels as they are in the file are not held beside those that are kept.
template <typename Value>
std::vector<Value> rgba_of(RasterInput& input, RasterValue value, Value opaque) {
  constexpr int kStripRows = 64;
  const RasterHeader& header = input.header();
  const auto width = static_cast<std::size_t>(header.width);
  const std::size_t channels = header.channels.size();
  std::vector<Value> rgba(4 * width * static_cast<std::size_t>(header.height));
  std::vector<Value> strip(width * kStripRows * channels);
  for (int row = 0; row < header.height; row += kStripRows) {
    const int end = std::min(row + kStripRows, header.height);
    input.read_rows(row, end, value, strip.data());
    to_rgba(strip.data(), width * static_cast<std::size_t>(end - row), channels, opaque,
            rgba.data() + 4 * width * static_cast<std::size_t>(row));
  }
  return rgba;
}

DecodedTexture decoded(RasterInput& input, TextureFormat format) {
  const RasterHeader& header = input.header();
  DecodedTexture texture;
  texture.width = header.width;
  texture.height = header.height;
  if (header.has_8_bits) {
    texture.rgba8 = rgba_of(input, RasterValue::Code8, std::uint8_t{255});
    if (format == TextureFormat::WebP && header.is_alpha_multiplied) {
      divide_by_alpha(texture.rgba8);
    }
  } else {
    texture.rgba16 = rgba_of(input, RasterValue::Code16, std::uint16_t{65535});
  }
  return texture;
}

}  // namespace

DecodedTexture decode_texture(std::span<const std::uint8_t> bytes, const std::string& where) {
  const auto reject = [&] [[noreturn]] (const std::string& found) {
    throw_input_error(where, found, "a PNG, JPEG or WebP image");
  };
  const std::string error = texture_structure_error(bytes);
  if (!error.empty()) reject(error);
  const TextureFormat kind = texture_format(bytes);
  const std::string format = kind == TextureFormat::Png    ? "png"
                             : kind == TextureFormat::Jpeg ? "jpeg"
                                                           : "webp";

  if (kind == TextureFormat::Png) {
    if (std::optional<DecodedTexture> plain = decode_plain_png(bytes, kMaxPixels))
      return std::move(*plain);
  }
  const RasterCodec& codec = raster_codec();
  try {
    const std::unique_ptr<RasterInput> input = codec.open(bytes, format);
    if (!input) reject("a build of OpenImageIO without " + format);
    const RasterHeader& header = input->header();
    if (!is_bounded(header) || header.channels.size() > 4) reject(size_of(header));
    return decoded(*input, kind);
  } catch (const std::runtime_error& broken) {
    const std::string reason = broken.what();
    reject("a broken " + format + (reason.empty() ? "" : ": " + reason));
  }
}

namespace {

// The numbers after a key in the header of a Radiance file, which ends with an empty line.
std::vector<double> radiance_numbers(const std::filesystem::path& file, const std::string& key) {
  std::ifstream in(file, std::ios::binary);
  std::vector<double> numbers;
  for (std::string line; std::getline(in, line) && !line.empty() && line != "\r";) {
    if (!line.starts_with(key)) continue;
    std::istringstream text(line.substr(key.size()));
    text.imbue(std::locale::classic());
    for (double number = 0.0; text >> number;) numbers.push_back(number);
  }
  return numbers;
}

// A Radiance file says in which order its pixels are and what they have been multiplied by: of
// several lines, by all of them. Source: Ward, Radiance file formats, "Picture".
void apply_radiance_header(const std::filesystem::path& file, int orientation, Image& image) {
  if (orientation > 4) {
    throw_input_error(file.string(), "pixels in columns (a resolution of \"X ... Y ...\")",
                      "pixels in rows: \"-Y N +X M\" or another one with Y first");
  }
  const auto height = static_cast<std::size_t>(image.height);
  const std::size_t channels = image.channel_count();
  const std::size_t row = static_cast<std::size_t>(image.width) * channels;
  const bool is_upside_down = orientation == 3 || orientation == 4;
  const bool is_reversed = orientation == 2 || orientation == 3;
  const auto at = [&](std::size_t y) {
    return image.pixels.begin() + static_cast<std::ptrdiff_t>(y * row);
  };
  for (std::size_t y = 0; is_upside_down && y < height / 2; ++y) {
    std::swap_ranges(at(y), at(y) + static_cast<std::ptrdiff_t>(row), at(height - 1 - y));
  }
  for (std::size_t y = 0; is_reversed && y < height; ++y) {
    for (std::size_t left = 0, right = row - channels; left < right;
         left += channels, right -= channels) {
      std::swap_ranges(at(y) + static_cast<std::ptrdiff_t>(left),
                       at(y) + static_cast<std::ptrdiff_t>(left + channels),
                       at(y) + static_cast<std::ptrdiff_t>(right));
    }
  }
  std::vector<double> factors(channels, 1.0);
  const auto multiply = [&](double number, double& factor) {
    if (!(number > 0.0) || !std::isfinite(number)) {
      throw_input_error(file.string(), fmt::format("an exposure of {:g}", number),
                        "a number above 0");
    }
    factor *= number;
  };
  for (const double exposure : radiance_numbers(file, "EXPOSURE=")) {
    for (double& factor : factors) multiply(exposure, factor);
  }
  const std::vector<double> of_colors = radiance_numbers(file, "COLORCORR=");
  for (std::size_t i = 0; channels == 3 && i < of_colors.size(); ++i) {
    multiply(of_colors[i], factors[i % 3]);
  }
  if (std::all_of(factors.begin(), factors.end(), [](double f) { return f == 1.0; })) return;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] = static_cast<float>(image.pixels[i] / factors[i % channels]);
  }
}

}  // namespace

Image read_raster(const std::filesystem::path& file) {
  const auto input = open_raster(file);
  const RasterHeader& header = input->header();

  Image image;
  image.width = header.width;
  image.height = header.height;
  image.channels = header.channels;
  const std::size_t pixels = static_cast<std::size_t>(header.width) * header.height;
  image.pixels.resize(pixels * image.channel_count());
  try {
    input->read(image.pixels.data());
  } catch (const std::runtime_error& broken) {
    reject_raster(file, broken.what());
  }
  if (header.format == "hdr") apply_radiance_header(file, header.orientation, image);
  return image;
}

bool raster_has_codes(const std::filesystem::path& file) {
  return !open_raster(file)->header().is_floating_point;
}

}  // namespace abbe
