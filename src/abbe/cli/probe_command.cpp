/// `abbe probe`: the tree of rays of one pixel.

#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "abbe/base/error.h"
#include "abbe/base/file.h"
#include "abbe/cli/commands.h"
#include "abbe/cli/console.h"
#include "abbe/cli/light_figure.h"
#include "abbe/cli/options.h"
#include "abbe/cli/outputs.h"
#include "abbe/cli/parse.h"
#include "abbe/cli/prepare.h"
#include "abbe/cli/print.h"
#include "abbe/cli/probe_figure.h"
#include "abbe/cli/probe_print.h"
#include "abbe/cli/probe_tree.h"
#include "abbe/render/render.h"

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

std::string camera_name(const PreparedScene& prepared) {
  if (prepared.has_default_camera) return "default";
  const std::string& name = prepared.chosen_camera().name;
  return name.empty() ? std::to_string(prepared.camera) : name;
}

std::string text_of(const ProbeArguments& arguments, const PreparedScene& prepared,
                    const Vec2i& pixel, const Probed& probed, std::span<const ProbeNode> nodes) {
  const RenderSettings& settings = arguments.scene.settings;
  const Vec3f& origin = probed.sample.origin;
  const Vec3f& direction = probed.sample.direction;
  const std::string place =
      arguments.sample ? fmt::format("sample {}", *arguments.sample) : std::string("its centre");
  std::string text = fmt::format(
      "pixel {},{} of {}x{}, {}, camera {}, {}\n"
      "from {:.6g} {:.6g} {:.6g} along {}; angles in degrees, positions in m\n\n",
      pixel.x, pixel.y, settings.size.x, settings.size.y, place, camera_name(prepared),
      mode_name(settings.mode), origin.x, origin.y, origin.z, direction_text(Vec3d(direction)));
  const ProbeView view{arguments.all_lanes || !settings.wavelengths.exact_nm.empty(),
                       arguments.least_weight};
  return text + probe_text(nodes, view);
}

std::string json_of(const ProbeArguments& arguments, const PreparedScene& prepared,
                    const Vec2i& pixel, const Probed& probed, std::span<const ProbeNode> nodes,
                    const std::optional<LitPlace>& lit, const World& world) {
  const RenderSettings& settings = arguments.scene.settings;
  const auto triple = [](const Vec3f& v) { return std::array<float, 3>{v.x, v.y, v.z}; };
  nlohmann::ordered_json json;
  json["pixel"] = {pixel.x, pixel.y};
  json["size"] = {settings.size.x, settings.size.y};
  if (arguments.sample) json["sample"] = *arguments.sample;
  json["mode"] = mode_name(settings.mode);
  json["camera"] = {{"name", camera_name(prepared)},
                    {"origin_m", triple(probed.sample.origin)},
                    {"direction", triple(probed.sample.direction)}};
  json["rays"] = probe_json(nodes);
  if (lit) json["light"] = light_json(*lit, world, prepared.scene);
  return json_text(json);
}

ExitCode run_probe(ProbeArguments& arguments) {
  const Vec2i pixel = parse_pixel(arguments.pixel);
  if (!(arguments.least_weight >= 0.0 && arguments.least_weight <= 1.0)) {
    throw_usage_error("--faint", fmt::format("{:g}", arguments.least_weight),
                      "a weight from 0 to 1");
  }
  if (!arguments.svg.empty()) check_writable(arguments.svg);
  resolve_settings(arguments.scene);
  const Console console(false);
  RenderSettings& settings = arguments.scene.settings;
  Notes notes;
  const Catalogue catalogue = Catalogue::standard();
  const Standards standards = read_standards(catalogue);
  const PreparedScene prepared = prepare_scene(arguments.scene, catalogue, notes);
  settle_size(arguments.scene, prepared.chosen_camera());
  if (pixel.x < 0 || pixel.y < 0 || pixel.x >= settings.size.x || pixel.y >= settings.size.y) {
    throw_usage_error(
        "--pixel", arguments.pixel,
        fmt::format("a pixel from 0,0 to {},{}", settings.size.x - 1, settings.size.y - 1));
  }
  const World world =
      make_world(prepared.scene, world_options(settings), standards.observer, standards.d65, notes);
  console.show(notes);
  const Probed probed =
      probe_pixel(world, prepared.chosen_camera(), settings, pixel, arguments.sample);
  const std::vector<ProbeNode> nodes =
      probe_tree(probed.records, prepared.scene, world, probed.sample);
  std::optional<LitPlace> lit;
  if (!arguments.light.empty()) {
    const std::uint32_t light = light_named(world, arguments.light);
    lit = lit_place(nodes, world, probed.sample.set, light);
    if (!lit) {
      throw_usage_error("--light",
                        fmt::format("pixel {},{}, which sees no surface", pixel.x, pixel.y),
                        "a pixel on something that light falls on");
    }
  }
  if (!arguments.svg.empty()) {
    const std::string title = fmt::format(
        "{}, pixel {},{}", std::filesystem::path(arguments.scene.file).filename().string(), pixel.x,
        pixel.y);
    const RayFigure figure =
        lit ? light_figure(*lit, world, prepared.scene, title, standards.observer)
            : probe_figure(nodes, Vec3d(probed.sample.origin), {title, arguments.least_weight},
                           standards.observer);
    write_text(arguments.svg, figure_svg(figure, world));
  }
  if (arguments.as_json) {
    print(json_of(arguments, prepared, pixel, probed, nodes, lit, world));
    return ExitCode::Done;
  }
  print(text_of(arguments, prepared, pixel, probed, nodes) +
        (lit ? light_text(*lit, world, prepared.scene) : std::string()));
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
            "also follow the ways on which light of this lamp comes to what the pixel shows, bent "
            "ones through flat glass included; with --svg, draw those instead");
  command.add_flag("--json", arguments->as_json, "print JSON with all rays and wavelengths");
  command.callback([arguments, &code] { code = run_probe(*arguments); });
}

}  // namespace abbe
