/// `abbe probe`: the tree of rays of one pixel.

#include <fmt/format.h>

#include <memory>
#include <utility>

#include "abbe/base/error.h"
#include "abbe/base/file.h"
#include "abbe/cli/commands/commands.h"
#include "abbe/cli/options/outputs.h"
#include "abbe/cli/options/scene.h"
#include "abbe/cli/options/typed.h"
#include "abbe/cli/print/console.h"
#include "abbe/cli/print/text.h"
#include "abbe/report/figures/light.h"
#include "abbe/report/figures/probe.h"
#include "abbe/report/probe_text.h"
#include "abbe/session/lit_place.h"
#include "abbe/session/picture.h"
#include "abbe/session/probe.h"

namespace abbe {
namespace {

struct ProbeArguments {
  SceneOptions scene;
  std::string pixel;
  std::optional<std::uint32_t> sample;
  bool all_lanes = false;
  double least_weight = 0.01;
  bool as_json = false;
  std::string svg, light;
};

ExitCode run_probe(ProbeArguments& arguments) {
  const Vec2i pixel = parse_pixel(arguments.pixel);
  if (!(arguments.least_weight >= 0.0 && arguments.least_weight <= 1.0)) {
    throw_usage_error("--faint", fmt::format("{:g}", arguments.least_weight),
                      "a weight from 0 to 1");
  }
  if (!arguments.svg.empty()) check_writable(arguments.svg);
  check_apart({{"--svg", arguments.svg}}, {{"SCENE", arguments.scene.choice.file},
                                           {"--environment", arguments.scene.choice.environment}});
  resolve_settings(arguments.scene);
  const Console console(false);
  RenderSettings& settings = arguments.scene.settings;
  Notes notes;
  const Standards standards = read_standards();
  const PreparedScene prepared = prepare_scene(arguments.scene.choice, standards.catalogue, notes);
  settle_size(arguments.scene, prepared.chosen_camera());
  if (pixel.x < 0 || pixel.y < 0 || pixel.x >= settings.size.x || pixel.y >= settings.size.y) {
    throw_usage_error(
        "--pixel", arguments.pixel,
        fmt::format("a pixel from 0,0 to {},{}", settings.size.x - 1, settings.size.y - 1));
  }
  const LitWorld world = make_lit_world(prepared, settings, standards, notes);
  console.show(notes);
  const Probed probed =
      probe_pixel(world, prepared.chosen_camera(), settings, pixel, arguments.sample);
  std::vector<ProbeNode> nodes = probe_tree(probed.records, prepared.scene, world, probed.sample);
  std::optional<LitPlace> lit;
  if (!arguments.light.empty()) {
    const std::uint32_t light = light_named(world, arguments.light);
    lit = lit_place(nodes, world, prepared.scene, probed.sample.set, light);
    if (!lit) {
      throw_usage_error("--light",
                        fmt::format("pixel {},{}, which sees no surface", pixel.x, pixel.y),
                        "a pixel on something that light falls on");
    }
  }
  if (!arguments.svg.empty()) {
    const std::string title = fmt::format(
        "{}, pixel {},{}", arguments.scene.choice.file.filename().string(), pixel.x, pixel.y);
    const RayFigure figure =
        lit ? light_figure(*lit, title, standards.observer)
            : probe_figure(nodes, Vec3d(probed.sample.origin), {title, arguments.least_weight},
                           standards.observer);
    write_text(arguments.svg, figure_svg(figure, world));
  }
  const Vec3d& origin_m = prepared.scene.origin_m;
  move_places(nodes, origin_m);
  if (lit) move_places(*lit, origin_m);
  const PixelProbe probe{.pixel = pixel,
                         .size = settings.size,
                         .sample = arguments.sample,
                         .mode = mode_name(settings.mode),
                         .camera = prepared.camera_name(),
                         .origin = origin_m + Vec3d(probed.sample.origin),
                         .direction = probed.sample.direction,
                         .nodes = nodes,
                         .lit = std::move(lit)};
  const ProbeView view{.all_lanes = arguments.all_lanes || !settings.wavelengths.exact_nm.empty(),
                       .least_weight = arguments.least_weight,
                       .hint = " (--faint 0 shows all)"};
  print(arguments.as_json ? probe_json(probe) : probe_text(probe, view));
  return ExitCode::Done;
}

}  // namespace

void add_probe_command(CLI::App& program, ExitCode& code) {
  CLI::App& command =
      *program.add_subcommand("probe", "Print the tree of rays of one pixel, per wavelength");
  const auto arguments = std::make_shared<ProbeArguments>();
  add_scene_options(command, arguments->scene);
  add_shown(command, "--pixel", arguments->pixel, "X,Y", "pixel, from the upper left corner")
      ->required();
  add_number(command, "--sample", arguments->sample, "N",
             "follow this sample of the pixel, as render does (default: the pixel's centre)");
  command.add_flag("--all", arguments->all_lanes,
                   "print every wavelength, not only the first, the middle and the last");
  add_number(command, "--faint", arguments->least_weight, "X",
             "only count rays of a smaller weight (default: 0.01)");
  add_shown(command, "--svg", arguments->svg, "FILE.svg",
            "also draw these rays, in the plane that shows them best");
  add_shown(command, "--light", arguments->light, "NAME",
            "also follow the paths on which light of this lamp comes to what the pixel shows, bent "
            "ones through flat glass included; with --svg, draw those instead");
  command.add_flag("--json", arguments->as_json, "print JSON with all rays and wavelengths");
  command.callback([arguments, &code] { code = run_probe(*arguments); });
}

}  // namespace abbe
