/// Scene-linear images to display images, by OpenColorIO alone.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "abbe/image/image.h"

namespace abbe {

/// For which display, in which manner and how bright.
struct DisplayOptions {
  std::optional<std::filesystem::path> config;  ///< Default: $OCIO, then config/config.ocio.
  std::string display = "sRGB - Display";
  std::string view = "ACES 1.0 - SDR Video";
  std::string source_space = "Linear Rec.709 (sRGB)";
  double exposure_ev = 0.0;
  bool auto_exposure = false;  ///< Ignore exposure_ev; use auto_exposure_ev().
};

/// The R, G, B of a scene-linear image as display-encoded RGB in [0, 1]-ish floats (not clamped).
/// Errors: input Error for a bad config; usage Error that lists the valid displays, views, spaces.
Image to_display(const Image& scene_linear, const DisplayOptions& options);

/// Scene-linear RGB from one space of the config to another, in place: the channels R, G and B with
/// `layer` in front ("albedo."), all others stay.
void convert_space(Image& image, const std::string& from, const std::string& to,
                   const DisplayOptions& options, const std::string& layer = "");

/// The scene-referred spaces of the configuration in which twice the light is twice the number.
std::vector<std::string> scene_linear_spaces(const DisplayOptions& options);

/// Pixels whose chromaticity the display cannot show: colours that do not come back, dimmed below
/// its white, from the display's own codes of 0 to 1.
/// Shape:  a value per pixel, row by row.
/// Errors: as to_display.
std::vector<bool> outside_gamut(const Image& scene_linear, const DisplayOptions& options);

/// The exposure in EV that auto exposure chooses for an image: what is brighter than 98 % of all
/// that is lit comes to 0.95, just below display white, as long as the log-average luminance of
/// what is lit lies between 2 EV below middle grey, 0.18, and 0.75 EV above it. Luminance at or
/// below 1e-6 of the brightest counts as black; of an image that is black throughout it is 0.
double auto_exposure_ev(const Image& scene_linear);

}  // namespace abbe
