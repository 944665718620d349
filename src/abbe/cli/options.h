/// Options that several commands share, as they are typed.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <type_traits>

#include "abbe/cli/parse.h"
#include "abbe/display/display.h"
#include "abbe/image/exr/exr.h"
#include "abbe/image/raster/raster.h"
#include "abbe/render/settings.h"

namespace abbe {

/// A scene, a camera, and how light is followed: what render and probe have in common.
struct SceneOptions {
  std::string file;
  std::string scene_name, camera_name;  ///< Empty: the file's own, the first.
  std::string lamp;                     ///< Empty: the scene's own.
  std::string size;                     ///< Empty: in the camera's shape.
  std::string mode = "spectral";
  std::string range, lines;
  std::string caustics = "exact";
  std::string uplift = "jakob-hanika";
  int threads = 0;
  RenderSettings settings;  ///< The numbers; complete after resolve_settings.
};

void add_scene_options(CLI::App& command, SceneOptions& options);
/// The same without the scene's file.
void add_view_options(CLI::App& command, SceneOptions& options);

/// Turns texts into settings and checks them as far as possible without a scene: with a default
/// size where none is given. Errors: a usage Error.
void resolve_settings(SceneOptions& options);

/// Settings for images by OpenColorIO: what --config, --display, --view, --exposure,
/// --bits and --dither say.
struct DisplayArguments {
  std::string config;
  std::string exposure = "0";
  DisplayOptions options;
  RasterOptions raster;
};

void add_display_options(CLI::App& command, DisplayArguments& arguments);

/// Turns texts into options. Errors: a usage Error.
void resolve_display(DisplayArguments& arguments);

/// How an EXR is kept: what --half, --compression, --tiles and --multipart say.
void add_exr_options(CLI::App& command, ExrOptions& options);

/// Adds an option whose help shows `placeholder`.
template <typename T>
CLI::Option* add_shown(CLI::App& command, const std::string& name, T& value,
                       const std::string& placeholder, const std::string& description) {
  return command.add_option(name, value, description)->option_text(placeholder);
}

/// The same for a number or an optional one; what is none becomes a usage Error like all others.
template <typename T>
CLI::Option* add_number(CLI::App& command, const std::string& name, T& value,
                        const std::string& placeholder, const std::string& description) {
  return command
      .add_option_function<std::string>(
          name,
          [&value, name](const std::string& text) {
            if constexpr (std::is_arithmetic_v<T>) {
              value = parse_number<T>(name, text);
            } else {
              value = parse_number<typename T::value_type>(name, text);
            }
          },
          description)
      ->option_text(placeholder);
}

}  // namespace abbe
