#include "abbe/cli/outputs.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>

#include "abbe/base/error.h"
#include "abbe/base/file.h"
#include "abbe/image/exr/exr.h"

namespace abbe {
namespace {

struct KnownSpace {
  const char* name;
  std::array<float, 8> chromaticities;
};

constexpr std::array<KnownSpace, 7> kKnownSpaces{{
    // ITU-R BT.709-6
    {kRenderSpace, {0.64f, 0.33f, 0.30f, 0.60f, 0.15f, 0.06f, 0.3127f, 0.3290f}},
    // SMPTE EG 432-1 with the white of D65
    {"Linear P3-D65", {0.680f, 0.320f, 0.265f, 0.690f, 0.150f, 0.060f, 0.3127f, 0.3290f}},
    // ITU-R BT.2020-2
    {"Linear Rec.2020", {0.708f, 0.292f, 0.170f, 0.797f, 0.131f, 0.046f, 0.3127f, 0.3290f}},
    // S-2014-004: AP1
    {"ACEScg", {0.713f, 0.293f, 0.165f, 0.830f, 0.128f, 0.044f, 0.32168f, 0.33767f}},
    // SMPTE ST 2065-1: AP0
    {"ACES2065-1", {0.7347f, 0.2653f, 0.0f, 1.0f, 0.0001f, -0.0770f, 0.32168f, 0.33767f}},
    // Tristimulus values themselves: 1, 1, 1 is equal energy, whatever white they are adapted to.
    // Of
    // the two, what chromaticities alone mean is the first.
    {"CIE-XYZ-D65", {1.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 1.0f / 3.0f, 1.0f / 3.0f}},
    {"CIE-XYZ-E", {1.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 1.0f / 3.0f, 1.0f / 3.0f}},
}};

Image one_pixel() {
  Image image;
  image.width = 1;
  image.height = 1;
  image.channels = {"R", "G", "B"};
  image.pixels = {0.18f, 0.18f, 0.18f};
  return image;
}

}  // namespace

OutputKind output_kind(const std::filesystem::path& file) {
  std::string suffix = file.extension().string();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (suffix == ".exr") return OutputKind::Exr;
  for (const char* raster : {".png", ".jpg", ".jpeg", ".tif", ".tiff"}) {
    if (suffix == raster) return OutputKind::Raster;
  }
  throw_usage_error("-o", "\"" + file.string() + "\"", "a file name with a known suffix",
                    {".exr", ".png", ".jpg", ".jpeg", ".tif", ".tiff"});
}

void check_outputs(const std::vector<std::filesystem::path>& files) {
  for (std::size_t i = 0; i < files.size(); ++i) {
    (void)output_kind(files[i]);
    for (std::size_t j = 0; j < i; ++j) {
      if (files[i].lexically_normal() == files[j].lexically_normal()) {
        throw_usage_error("-o", "\"" + files[i].string() + "\" twice", "each file once");
      }
    }
  }
  for (const std::filesystem::path& file : files) check_writable(file);
}

void check_display(const DisplayOptions& options) {
  (void)to_display(one_pixel(), options);
}

void check_color_space(const std::string& space, const DisplayOptions& options) {
  const std::vector<std::string> spaces = scene_linear_spaces(options);
  Image image = one_pixel();
  // An alias is as good as a name; what is unknown is an error there.
  convert_space(image, kRenderSpace, space, options);
  if (std::find(spaces.begin(), spaces.end(), space) == spaces.end()) {
    throw_usage_error("--colorspace", "\"" + space + "\"",
                      "a scene-linear space of the configuration by its name", spaces);
  }
}

void convert_colors(Image& image, const std::string& from, const std::string& to,
                    const DisplayOptions& options) {
  const std::vector<std::string> channels = image.channels;
  for (const std::string& channel : channels) {
    if (channel == "R") convert_space(image, from, to, options);
    if (!channel.ends_with(".R")) continue;
    const std::string layer = channel.substr(0, channel.size() - 1);
    if (image.channel_index(layer + "G") && image.channel_index(layer + "B")) {
      convert_space(image, from, to, options, layer);
    }
  }
}

std::optional<std::array<float, 8>> chromaticities_of(const std::string& space) {
  for (const KnownSpace& known : kKnownSpaces) {
    if (space == known.name) return known.chromaticities;
  }
  return std::nullopt;
}

std::optional<std::string> space_of(const std::array<float, 8>& chromaticities) {
  for (const KnownSpace& known : kKnownSpaces) {
    bool same = true;
    for (std::size_t i = 0; i < chromaticities.size(); ++i) {
      // Far closer than two spaces ever are, and wider than the digits of other writers.
      same = same && std::abs(chromaticities[i] - known.chromaticities[i]) < 5e-4f;
    }
    if (same) return known.name;
  }
  return std::nullopt;
}

void write_text(const std::filesystem::path& target, const std::string& text) {
  write_atomically(target, [&](const std::filesystem::path& temporary) {
    std::ofstream stream(temporary, std::ios::binary | std::ios::trunc);
    stream << text;
    stream.close();
    if (!stream) {
      throw_output_error(target.string(), "a file that could not be written to its end",
                         "a place with room for it");
    }
  });
}

std::string space_of_file(const std::filesystem::path& file) {
  const ExrHeader header = read_exr_header(file);
  const auto named = header.attributes.find("abbe:primaries");
  if (named != header.attributes.end()) {
    if (const auto* name = std::get_if<std::string>(&named->second)) return *name;
  }
  if (!header.chromaticities) return kRenderSpace;
  const std::optional<std::string> space = space_of(*header.chromaticities);
  if (!space) {
    throw_input_error(file.string(), "chromaticities of no known colour space",
                      "--colorspace NAME to say which it is");
  }
  return *space;
}

}  // namespace abbe
