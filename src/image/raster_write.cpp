#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <memory>

#include "base/error.h"
#include "base/file.h"
#include "base/parallel.h"
#include "image/raster.h"

namespace abbe {
namespace {

std::string format_of(const std::filesystem::path& file) {
  std::string suffix = file.extension().string();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (suffix == ".png") return "png";
  if (suffix == ".jpg" || suffix == ".jpeg") return "jpeg";
  if (suffix == ".tif" || suffix == ".tiff") return "tiff";
  throw_output_error(file.string(), "suffix '" + suffix + "'", ".png, .jpg, .jpeg, .tif or .tiff");
}

std::uint8_t code_of(float value) {
  // NaN fails the comparison and becomes black.
  if (!(value > 0.0f)) return 0;
  return static_cast<std::uint8_t>(std::lround(std::min(value, 1.0f) * 255.0f));
}

std::vector<std::uint8_t> codes_of(const std::filesystem::path& file, const Image& image) {
  const auto r = image.channel_index("R");
  const auto g = image.channel_index("G");
  const auto b = image.channel_index("B");
  if (!r || !g || !b || image.width < 1 || image.height < 1) {
    throw_output_error(file.string(), "an image without pixels or without channels R, G, B",
                       "R, G, B");
  }
  const auto width = static_cast<std::size_t>(image.width);
  const auto height = static_cast<std::size_t>(image.height);
  const std::size_t channels = image.channel_count();
  std::vector<std::uint8_t> codes(width * height * 3);
  parallel_for(0, height, 16, [&](std::size_t y) {
    for (std::size_t p = y * width; p < (y + 1) * width; ++p) {
      codes[p * 3] = code_of(image.pixels[p * channels + *r]);
      codes[p * 3 + 1] = code_of(image.pixels[p * channels + *g]);
      codes[p * 3 + 2] = code_of(image.pixels[p * channels + *b]);
    }
  });
  return codes;
}

bool is_srgb_encoded(const Image& image) {
  const auto display = image.attributes.find(kDisplayAttribute);
  if (display == image.attributes.end()) return true;
  const auto* name = std::get_if<std::string>(&display->second);
  return name == nullptr || name->starts_with("sRGB");
}

}  // namespace

void write_raster(const std::filesystem::path& file, const Image& rgb_encoded) {
  const std::string format = format_of(file);
  const std::vector<std::uint8_t> codes = codes_of(file, rgb_encoded);

  OIIO::ImageSpec spec(rgb_encoded.width, rgb_encoded.height, 3, OIIO::TypeDesc::UINT8);
  if (is_srgb_encoded(rgb_encoded)) spec.attribute("oiio:ColorSpace", "sRGB");
  if (format == "jpeg") {
    spec.attribute("Compression", "jpeg:95");
    // Fringes are a pixel or two wide: halved chroma would wash them out.
    spec.attribute("jpeg:subsampling", "4:4:4");
  }

  // OpenImageIO would put the present time into a TIFF.
  if (format == "tiff") spec.attribute("DateTime", "");

  write_atomically(file, [&](const std::filesystem::path& temporary) {
    const auto output = OIIO::ImageOutput::create(format);
    const auto reject = [&](const std::string& reason) {
      throw_output_error(file.string(), reason, "an image that can be written as " + format);
    };
    if (!output) reject(OIIO::geterror());
    if (!output->open(temporary.string(), spec)) reject(output->geterror());
    if (!output->write_image(OIIO::TypeDesc::UINT8, codes.data())) reject(output->geterror());
    if (!output->close()) reject(output->geterror());
  });
}

}  // namespace abbe
