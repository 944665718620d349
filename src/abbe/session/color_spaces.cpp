#include "abbe/session/color_spaces.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "abbe/base/error.h"
#include "abbe/image/channels.h"

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

}  // namespace

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
                      "`color_space`, which says which it is");
  }
  return *space;
}

void check_color_space(const std::string& space, const DisplayOptions& options) {
  const std::vector<std::string> spaces = scene_linear_spaces(options);
  Image image = grey_pixel();
  // An alias is as good as a name; what is unknown is an error there.
  convert_space(image, kRenderSpace, space, options);
  check_choice("color_space", space, "a scene-linear space of the configuration by its name",
               spaces);
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

void write_exrs_in(const std::string& space, const std::vector<std::filesystem::path>& files,
                   Image image, ExrOptions form, const DisplayOptions& options) {
  if (space != kRenderSpace) convert_colors(image, kRenderSpace, space, options);
  image.attributes["abbe:primaries"] = space;
  form.chromaticities = chromaticities_of(space);
  for (const std::filesystem::path& file : files) write_exr(file, image, form);
}

}  // namespace abbe
