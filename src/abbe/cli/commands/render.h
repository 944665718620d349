/// `abbe render` as a function: its arguments, and running it.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "abbe/cli/commands/commands.h"
#include "abbe/cli/options/image.h"
#include "abbe/cli/options/scene.h"
#include "abbe/session/color_spaces.h"

namespace abbe {

/// What is typed.
struct RenderArguments {
  SceneOptions scene;
  DisplayArguments display;
  DevelopmentChoice development;
  std::vector<std::string> outputs;
  std::string bands, crop, aovs, freeze, stats_file;
  std::string frames;  ///< Of a sequence; empty: one image.
  std::optional<double> frames_per_second;
  std::optional<int> samples;   ///< --spp
  std::optional<double> noise;  ///< Of `render`; without it and --spp: kFinishedNoise.
  std::string color_space = kRenderSpace;
  ExrOptions exr;
  bool quiet = false;
};

/// Every option but the scene's, the outputs, --noise and --stats.
void add_render_options(CLI::App& command, RenderArguments& arguments);

/// Turns texts into settings and finds everything wrong that can be found without the scene.
/// Errors: a usage Error; an output Error for a place that takes no file.
void check_render_arguments(RenderArguments& arguments);

/// Renders and writes, a frame after the other where there are several. Errors: as the program's.
ExitCode run_render(RenderArguments& arguments);

}  // namespace abbe
