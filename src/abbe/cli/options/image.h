/// Options of how light becomes an image, and an image a file.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "abbe/display/display.h"
#include "abbe/image/exr/exr.h"
#include "abbe/image/raster/raster.h"
#include "abbe/session/development.h"

namespace abbe {

/// --observer, --white and --adaptation.
void add_development_options(CLI::App& command, DevelopmentChoice& choice);

/// Settings for images by OpenColorIO: what --config, --display, --view, --exposure,
/// --bits and --dither say.
struct DisplayArguments {
  std::string config;
  std::string exposure;  ///< Empty: what the scene or the image says.
  DisplayOptions options;
  RasterOptions raster;
};

/// --config, --display, --view, --exposure, --bits and --dither.
void add_display_options(CLI::App& command, DisplayArguments& arguments);

/// Turns texts into options; an exposure that was not given is left as `exposure_ev` 0. Errors: a
/// usage Error.
void resolve_display(DisplayArguments& arguments);

/// How an EXR is kept: what --half, --compression, --tiles and --multipart say.
void add_exr_options(CLI::App& command, ExrOptions& options);

}  // namespace abbe
