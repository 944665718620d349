#include "abbe/cli/options/image.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "abbe/base/error.h"
#include "abbe/cli/options/typed.h"

namespace abbe {

void add_development_options(CLI::App& command, DevelopmentChoice& choice) {
  add_shown(command, "--observer", choice.observer, "NAME|FILE.csv",
            "whose eyes the colours are for: cie1931, cie1964, or a camera's three sensitivities "
            "(default: cie1931)");
  add_shown(command, "--white", choice.white, "NAME|scene|x,y",
            "the light that looks neutral: D65, A or another illuminant, the scene's own, or a "
            "chromaticity (default: D65)");
  add_shown(command, "--adaptation", choice.adaptation, "NAME",
            "how that white is adapted to D65: cat16, bradford or none (default: cat16)");
}

void add_display_options(CLI::App& command, DisplayArguments& arguments) {
  DisplayOptions& options = arguments.options;
  add_shown(command, "--config", arguments.config, "FILE",
            "OpenColorIO configuration (default: $OCIO, then abbe's own)");
  add_shown(command, "--display", options.display, "NAME",
            fmt::format("OCIO display of PNG, JPEG and TIFF (default: {})", options.display));
  add_shown(command, "--view", options.view, "NAME",
            fmt::format("OCIO view of it (default: {})", options.view));
  add_shown(
      command, "--exposure", arguments.exposure, "EV|auto",
      "brightens the display image by EV stops; the EXR stays as it is (default: what the scene "
      "or the EXR says, else auto)");
  add_number(command, "--bits", arguments.raster.bits, "N",
             "bits per channel of PNG and TIFF, 8 or 16 (default: 8)");
  command.add_flag("--dither", arguments.raster.dither,
                   "noise of one code before rounding, against bands in gradients");
}

void add_exr_options(CLI::App& command, ExrOptions& options) {
  command.add_flag("--half", options.half, "half instead of float for colours in the EXR");
  add_shown(command, "--compression", options.compression, "NAME",
            fmt::format("of the EXR: {} (default: {})", fmt::join(exr_compressions(), ", "),
                        options.compression));
  add_number(command, "--tiles", options.tile_size, "N",
             "square tiles of N pixels in the EXR instead of scan lines");
  command.add_flag("--multipart", options.multi_part,
                   "a part of the EXR for colour, one for the spectrum, one for each layer");
}

void resolve_display(DisplayArguments& arguments) {
  if (arguments.raster.bits != 8 && arguments.raster.bits != 16) {
    throw_usage_error("--bits", std::to_string(arguments.raster.bits), "8 or 16");
  }
  if (!arguments.config.empty()) arguments.options.config = arguments.config;
  if (arguments.exposure.empty()) return;
  const std::optional<double> exposure = parse_exposure(arguments.exposure);
  arguments.options.auto_exposure = !exposure;
  arguments.options.exposure_ev = exposure.value_or(0.0);
}

}  // namespace abbe
