/// `abbe display`: a scene-linear EXR in, display images out.

#include <filesystem>
#include <memory>

#include "base/error.h"
#include "base/file.h"
#include "cli/commands.h"
#include "cli/options.h"
#include "cli/outputs.h"
#include "image/exr.h"
#include "image/raster.h"

namespace abbe {
namespace {

struct DisplayCommand {
  std::string input, color_space;
  std::vector<std::string> outputs;
  DisplayArguments display;
};

ExitCode run_display(DisplayCommand& arguments) {
  const std::vector<std::filesystem::path> files(arguments.outputs.begin(),
                                                 arguments.outputs.end());
  resolve_display(arguments.display);
  for (const std::filesystem::path& file : files) {
    if (output_kind(file) == OutputKind::Raster) continue;
    throw_usage_error("-o", "\"" + file.string() + "\"", "a display image",
                      {".png", ".jpg", ".jpeg", ".tif", ".tiff"});
  }
  check_outputs(files);
  DisplayOptions& options = arguments.display.options;
  options.source_space =
      arguments.color_space.empty() ? space_of_file(arguments.input) : arguments.color_space;
  const Image shown = to_display(read_exr(arguments.input), options);
  for (const std::filesystem::path& file : files)
    write_raster(file, shown, arguments.display.raster);
  return ExitCode::Done;
}

}  // namespace

void add_display_command(CLI::App& program, ExitCode& code) {
  CLI::App& command =
      *program.add_subcommand("display", "Make display images of an EXR through OpenColorIO");
  const auto arguments = std::make_shared<DisplayCommand>();
  command.add_option("IN.exr", arguments->input, "scene-linear image")->required();
  add_shown(command, "-o,--output", arguments->outputs, "FILE",
            "image to write, .png, .jpg or .tif; repeatable")
      ->allow_extra_args(false)
      ->required();
  add_shown(command, "--colorspace", arguments->color_space, "NAME",
            "OCIO colour space of the input (default: what the file says, else Linear Rec.709)");
  add_display_options(command, arguments->display);
  command.callback([arguments, &code] { code = run_display(*arguments); });
}

}  // namespace abbe
