/// `abbe display`: a scene-linear or spectral EXR in, display images out.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <set>
#include <variant>

#include "abbe/base/error.h"
#include "abbe/base/file.h"
#include "abbe/cli/commands/commands.h"
#include "abbe/cli/options/image.h"
#include "abbe/cli/options/outputs.h"
#include "abbe/cli/options/typed.h"
#include "abbe/cli/print/text.h"
#include "abbe/film/spectral_image.h"
#include "abbe/image/channels.h"
#include "abbe/image/exr/exr.h"
#include "abbe/image/metrics/false_color.h"
#include "abbe/image/raster/raster.h"
#include "abbe/session/color_spaces.h"
#include "abbe/session/development.h"
#include "abbe/session/exposure.h"

namespace abbe {
namespace {

struct DisplayCommand {
  std::string input, color_space, layer;
  std::vector<std::string> outputs;
  DisplayArguments display;
  DevelopmentChoice development;
  bool false_color = false;
  bool gamut_warning = false;
};

struct ColorImage {
  Image image;  ///< With channels R, G and B.
  std::string space;
};

// Three channels, or one three times, as R, G and B.
Image picked(const Image& from, const std::array<std::size_t, 3>& channels) {
  Image image = same_window(from, {"R", "G", "B"});
  image.pixels = picked_values(from, channels);
  return image;
}

ColorImage layer_of(const Image& image, const std::string& layer, const std::string& space) {
  for (const auto& names : {std::array<const char*, 3>{".R", ".G", ".B"}, {".X", ".Y", ".Z"}}) {
    if (const auto found = channels_named(image, layer, names))
      return {picked(image, *found), space};
  }
  if (const auto single = image.channel_index(layer)) {
    return {picked(image, {*single, *single, *single}), space};
  }
  std::set<std::string> layers;
  for (const std::string& channel : image.channels) {
    const bool is_spectral = spectral_channel_wavelength_nm(channel).has_value() ||
                             reflective_channel_wavelength_nm(channel).has_value();
    if (!is_spectral) layers.insert(channel.substr(0, channel.find('.')));
  }
  throw_usage_error("--layer", "\"" + layer + "\"", "a layer of the image",
                    {layers.begin(), layers.end()});
}

// The colours of any EXR: what it calls R, G, B, else XYZ, else a grey, else its spectrum.
ColorImage colors_of(const DisplayCommand& arguments, Image image) {
  const auto space = [&arguments](const char* otherwise) {
    if (!arguments.color_space.empty()) return arguments.color_space;
    return otherwise != nullptr ? std::string(otherwise) : space_of_file(arguments.input);
  };
  if (!arguments.layer.empty()) return layer_of(image, arguments.layer, space(nullptr));
  if (rgb_channels(image)) {
    std::string name = space(nullptr);
    return {std::move(image), std::move(name)};
  }
  if (const auto xyz = channels_named(image, "", {"X", "Y", "Z"})) {
    return {picked(image, *xyz), space("CIE-XYZ-D65")};
  }
  if (const auto grey = image.channel_index("Y")) {
    return {picked(image, {*grey, *grey, *grey}), space(nullptr)};
  }
  throw_input_error(arguments.input, "neither R, G, B nor X, Y, Z, Y or a spectrum",
                    "--layer NAME, one of its channels", image.channels);
}

std::string percent_of(std::size_t part, std::size_t whole) {
  return fmt::format("{:.2f} %", 100.0 * static_cast<double>(part) / static_cast<double>(whole));
}

Image false_color_picture(const ColorImage& colors, const DisplayOptions& options) {
  ColorImage linear = colors;
  if (linear.space != kRenderSpace) {
    convert_space(linear.image, linear.space, kRenderSpace, options);
  }
  const double ev = options.auto_exposure ? auto_exposure_ev(linear.image) : options.exposure_ev;
  for (float& value : linear.image.pixels) value *= static_cast<float>(std::exp2(ev));
  const FalseColorImage result = false_color_image(linear.image);
  std::string legend = "stops  luminance  sRGB colour     pixels\n";
  const std::size_t pixels = result.picture.pixels.size() / 3;
  for (std::size_t zone = result.pixels.size(); zone-- > 0;) {
    const int stops = kFalseColorLowest_ev + static_cast<int>(zone);
    const Vec3f color = 255.0f * false_color(stops);
    legend += fmt::format("{:>+5}  {:>9.4g}  {:>3.0f} {:>3.0f} {:>3.0f}  {:>11}\n", stops,
                          0.18 * std::exp2(stops), color.x, color.y, color.z,
                          percent_of(result.pixels[zone], pixels));
  }
  print(legend);
  return result.picture;
}

// Marks in magenta what the display cannot show.
void mark_gamut(const ColorImage& colors, const DisplayOptions& options, Image& shown) {
  const std::vector<bool> outside = outside_gamut(colors.image, options);
  for (std::size_t p = 0; p < outside.size(); ++p) {
    if (!outside[p]) continue;
    shown.pixels[3 * p] = 1.0f;
    shown.pixels[3 * p + 1] = 0.0f;
    shown.pixels[3 * p + 2] = 1.0f;
  }
  const auto count = static_cast<std::size_t>(std::count(outside.begin(), outside.end(), true));
  print(fmt::format("{} of the pixels lie outside the gamut of {}\n",
                    percent_of(count, outside.size()), options.display));
}

// Puts new R, G, B into a spectral image, whose other channels stay.
void replace_colors(Image& image, const Image& rgb) {
  Image result = rgb;
  result.attributes = image.attributes;
  result.id_names = image.id_names;
  std::vector<std::size_t> kept;
  for (std::size_t c = 0; c < image.channel_count(); ++c) {
    const std::string& name = image.channels[c];
    if (name == "R" || name == "G" || name == "B") continue;
    kept.push_back(c);
    result.channels.push_back(name);
  }
  const std::vector<float> others = picked_values(image, kept);
  result.pixels.clear();
  for (std::size_t p = 0; p < rgb.pixels.size() / 3; ++p) {
    const auto color = rgb.pixels.begin() + 3 * p;
    const auto other = others.begin() + kept.size() * p;
    result.pixels.insert(result.pixels.end(), color, color + 3);
    result.pixels.insert(result.pixels.end(), other, other + kept.size());
  }
  image = std::move(result);
}

// Gives the image the colours of its spectrum. Returns whether it did.
bool develop_again(const DisplayCommand& arguments, Image& image) {
  const bool has_color = image.channel_index("R") || image.channel_index("X") ||
                         image.channel_index("Y") || !arguments.layer.empty();
  if (!arguments.development.any() && (has_color || !has_spectrum(image))) return false;
  if (!has_spectrum(image)) {
    throw_input_error(arguments.input, "an image without spectral channels",
                      "channels S0.<nm>nm, which --bands makes, for another observer or white");
  }
  if (!arguments.color_space.empty()) {
    throw_usage_error("--colorspace", "--observer, --white or --adaptation beside it",
                      "one of the two: a spectrum has no colour space");
  }
  const Standards standards = read_standards();
  const DevelopmentOptions options = development_options(arguments.development, standards, nullptr);
  replace_colors(image, developed(image, options, standards.observer, standards.d65));
  for (const auto& [name, value] : development_attributes(options, standards)) {
    image.attributes[name] = value;
  }
  image.attributes["abbe:primaries"] = std::string(kRenderSpace);
  image.attributes["abbe:developed"] = std::string("anew, from the spectral channels");
  return true;
}

ExitCode run_display(DisplayCommand& arguments) {
  resolve_display(arguments.display);
  if (arguments.false_color && arguments.gamut_warning) {
    throw_usage_error("--false-color", "--gamut-warning beside it", "one of the two");
  }
  const auto [exrs, rasters] = sorted_outputs(arguments.outputs);
  if (!exrs.empty() && !arguments.development.any()) {
    throw_usage_error("-o", "\"" + exrs.front().string() + "\"",
                      "a display image, or --observer, --white or --adaptation to develop anew",
                      {image_suffixes().begin() + 1, image_suffixes().end()});
  }
  check_outputs({arguments.outputs.begin(), arguments.outputs.end()});
  Image image = read_exr(arguments.input);
  if (arguments.display.exposure.empty()) {
    // An EXR of abbe's says at which EV it is to be shown; any other is shown as it is.
    const auto stated = image.attributes.find(kExposureAttribute);
    if (stated != image.attributes.end()) {
      if (const auto* ev = std::get_if<float>(&stated->second)) {
        arguments.display.options.exposure_ev = *ev;
      }
    }
  }
  ColorImage colors;
  if (develop_again(arguments, image)) {
    const ExrOptions exr{.chromaticities = chromaticities_of(kRenderSpace)};
    for (const std::filesystem::path& file : exrs) write_exr(file, image, exr);
    colors = {std::move(image), kRenderSpace};
  } else {
    colors = colors_of(arguments, std::move(image));
  }
  DisplayOptions& options = arguments.display.options;
  options.source_space = colors.space;
  if (rasters.empty()) return ExitCode::Done;
  Image shown = arguments.false_color ? false_color_picture(colors, options)
                                      : to_display(colors.image, options);
  if (arguments.gamut_warning) mark_gamut(colors, options, shown);
  for (const std::filesystem::path& file : rasters) {
    write_raster(file, shown, arguments.display.raster);
  }
  return ExitCode::Done;
}

}  // namespace

void add_display_command(CLI::App& program, ExitCode& code) {
  CLI::App& command =
      *program.add_subcommand("display", "Make display images of an EXR through OpenColorIO");
  const auto arguments = std::make_shared<DisplayCommand>();
  command.add_option("IN.exr", arguments->input, "scene-linear image")->required();
  add_shown(command, "-o,--output", arguments->outputs, "FILE",
            "image to write, .png, .jpg or .tif; repeatable; .exr for colours developed anew")
      ->allow_extra_args(false)
      ->required();
  add_shown(command, "--colorspace", arguments->color_space, "NAME",
            "OCIO colour space of the input (default: what the file says, else Linear Rec.709)");
  add_shown(command, "--layer", arguments->layer, "NAME",
            "show another layer of the image, as albedo, N or Z");
  add_development_options(command, arguments->development);
  command.add_flag("--false-color", arguments->false_color,
                   "luminance in stops around 0.18 as colours, with their legend on stdout");
  command.add_flag("--gamut-warning", arguments->gamut_warning,
                   "mark in magenta what the display cannot show");
  add_display_options(command, arguments->display);
  command.callback([arguments, &code] { code = run_display(*arguments); });
}

}  // namespace abbe
