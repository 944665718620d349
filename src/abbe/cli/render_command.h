/// `abbe render` as a function: its arguments, and running it.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "abbe/cli/cli.h"
#include "abbe/cli/development_options.h"
#include "abbe/cli/options.h"
#include "abbe/cli/outputs.h"
#include "abbe/image/exr/exr.h"

namespace abbe {

/// What is typed.
struct RenderArguments {
  SceneOptions scene;
  DisplayArguments display;
  DevelopmentArguments development;
  std::vector<std::string> outputs;
  std::string bands, crop, aovs, freeze, stats_file;
  std::string color_space = kRenderSpace;
  ExrOptions exr;
  bool quiet = false;

  std::vector<std::filesystem::path> output_files() const {
    return {outputs.begin(), outputs.end()};
  }
  bool has_output(OutputKind kind) const {
    for (const std::string& file : outputs) {
      if (output_kind(file) == kind) return true;
    }
    return false;
  }
};

/// Every option but the scene's, the outputs and --stats.
void add_render_options(CLI::App& command, RenderArguments& arguments);

/// Renders and writes. Errors: as the program's.
ExitCode run_render(RenderArguments& arguments);

}  // namespace abbe
