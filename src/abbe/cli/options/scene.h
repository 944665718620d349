/// Options of a scene, a camera, and how light is followed, as they are typed.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "abbe/render/settings.h"
#include "abbe/session/prepare.h"

namespace abbe {

/// What render, compare, golden and probe have in common.
struct SceneOptions {
  SceneChoice choice;
  std::string size;  ///< Empty: in the camera's shape.
  std::string mode = "spectral";
  std::string range, lines;
  std::string caustics = "exact";
  std::string uplift = "jakob-hanika";
  std::string rig = "auto", emissive_light = "auto";
  RenderSettings settings;  ///< The numbers; complete after resolve_settings.
};

/// The scene's file, and everything of add_view_options.
void add_scene_options(CLI::App& command, SceneOptions& options);
/// The same without the scene's file.
void add_view_options(CLI::App& command, SceneOptions& options);

/// How a file is read, of `render` and of `inspect`: --time, --animation, --variant,
/// --strict.
void add_reading_options(CLI::App& command, SceneChoice& choice);

/// --environment, --rig and --emissive-light, of `render` and of `inspect`.
void add_light_options(CLI::App& command, SceneChoice& choice, std::string& rig,
                       std::string& emissive_light);

/// Turns texts into settings and checks them as far as possible without a scene: with a default
/// size where none is given. Errors: a usage Error.
void resolve_settings(SceneOptions& options);

/// Completes the settings by the camera and checks them again. Errors: a usage Error.
void settle_size(SceneOptions& options, const Camera& camera);

}  // namespace abbe
