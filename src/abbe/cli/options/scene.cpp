#include "abbe/cli/options/scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdint>
#include <string>

#include "abbe/accel/accelerator.h"
#include "abbe/base/error.h"
#include "abbe/base/text.h"
#include "abbe/cli/options/typed.h"
#include "abbe/film/filter.h"

namespace abbe {
namespace {

// Bytes; units are powers of 1024.
std::uint64_t parse_bytes(const std::string& text) {
  std::string bytes = text;
  std::uint64_t size = 0;
  const bool is_size = !text.empty() && text.front() >= '0' && text.front() <= '9' &&
                       CLI::AsSizeValue(false)(bytes).empty() &&
                       CLI::detail::lexical_cast(bytes, size);
  if (!is_size) throw_usage_error("--texture-memory", in_quotes(text), "a size, as 512MB or 4GB");
  return size;
}

}  // namespace

void add_scene_options(CLI::App& command, SceneOptions& options) {
  command.add_option("SCENE", options.choice.file, "glTF scene, .gltf or .glb")->required();
  add_view_options(command, options);
}

void add_reading_options(CLI::App& command, SceneChoice& choice) {
  add_number(command, "--time", choice.time_s, "SECONDS",
             "when to see the scene: its animations pose it (default: as it rests)");
  add_shown(command, "--animation", choice.animation, "NAME",
            "which of the file's animations, by name or by number from 0 (default: all; of those "
            "that move the same, the first)");
  add_shown(command, "--variant", choice.variant, "NAME",
            "set of materials of the file to show (default: what it shows first)");
  command.add_flag("--strict", choice.strict, "what would be a warning about the file is an error");
  command
      .add_option_function<std::string>(
          "--texture-memory",
          [&choice](const std::string& text) { choice.texture_memory = parse_bytes(text); },
          "about how much memory textures may take, as 512MB or 4GB; what is beyond lies in "
          "a file in TMPDIR or /var/tmp, and the image is the same (default: 1GB)")
      ->option_text("SIZE");
}

void add_view_options(CLI::App& command, SceneOptions& options) {
  RenderSettings& settings = options.settings;
  add_shown(command, "--scene", options.choice.scene, "NAME",
            "scene of the file to take, by name or by number from 0 (default: the file's own)");
  add_shown(
      command, "--camera", options.choice.camera, "NAME",
      "camera to look through, by name or by number from 0, #N where a name is a number; frame: "
      "one that frames the scene (default: the first)");
  add_shown(
      command, "--lamp", options.choice.lamp, "ID",
      "spectrum of the catalogue for all lamps of the scene, as illuminant/A; their brightness "
      "stays (default: the scene's own)");
  add_reading_options(command, options.choice);
  add_light_options(command, options.choice, options.rig, options.emissive_light);
  add_shown(
      command, "--mode", options.mode, "MODE",
      "spectral, rgb (one index of refraction) or rgb3 (one per channel) (default: spectral)");
  add_shown(command, "--uplift", options.uplift, "NAME",
            "how RGB colours become spectra: jakob-hanika, or mallett-yuksel, which knows Rec.709 "
            "only (default: jakob-hanika)");
  add_shown(command, "--size", options.size, "WxH",
            "pixels (default: 540 rows in the camera's shape, 960x540 without one)");
  add_number(command, "--wavelengths", settings.wavelengths.count, "N",
             fmt::format("wavelengths per camera sample, 1 to 64 (default: {})",
                         settings.wavelengths.count));
  add_shown(command, "--range", options.range, "A:B",
            "render only this part of the spectrum, in nm (default: 360:830)");
  add_shown(command, "--lines", options.lines, "A,B,C",
            "render exactly these wavelengths, in nm, a spectral channel each");
  add_shown(command, "--filter", settings.filter, "NAME",
            fmt::format("reconstruction filter: {} (default: {})", fmt::join(filter_names(), ", "),
                        settings.filter));
  add_number(command, "--depth", settings.max_depth, "N",
             fmt::format("most surfaces a path may leave (default: {})", settings.max_depth));
  add_shown(
      command, "--cutoff", settings.cutoff, "X",
      fmt::format("weight below which a fan no longer branches (default: {:g})", settings.cutoff));
  command.add_flag("--drop", settings.drop,
                   "end fans below the cutoff instead of following one child; loses energy");
  add_shown(command, "--caustics", options.caustics, "HOW",
            "light of lamps through and off flat facets: exact, or off for straight shadow rays "
            "(default: exact)");
  add_number(command, "--chain", settings.inner_reflections, "N",
             fmt::format("most reflections inside of glass on a path from a lamp (default: {})",
                         settings.inner_reflections));
  command.add_flag("--multiple-scattering", settings.multiple_scattering,
                   "rough metals give back what meets more than one microfacet (default: it is "
                   "lost, as in glTF's model)");
  add_number(command, "--seed", settings.seed, "N", "of the sampling pattern (default: 0)");
  add_shown(command, "--accel", settings.accelerator, "NAME",
            fmt::format("what finds where rays meet surfaces: {}; shapes no image (default: {})",
                        fmt::join(accelerator_names(), ", "), settings.accelerator));
}

void add_light_options(CLI::App& command, SceneChoice& choice, std::string& rig,
                       std::string& emissive_light) {
  add_shown(command, "--environment", choice.environment, "FILE",
            "light from all around, as an equirectangular image, .exr or .hdr, of RGB or spectral "
            "(default: the scene's own)");
  add_number(command, "--environment-scale", choice.environment_scale, "X",
             "what multiplies its values, which are cd/m2 then (default: 1; beside lamps of "
             "Blender 683)");
  add_number(command, "--environment-rotation", choice.environment_rotation_deg, "DEG",
             "how far it is turned about the vertical, counterclockwise from above (default: 0)");
  add_shown(command, "--rig", rig, "NAME",
            fmt::format("light that the file has not: {} (default: auto: a studio without lamps, "
                        "a faint surround beside lamps alone)",
                        fmt::join(rig_names(), ", ")));
  add_number(command, "--rig-time", choice.rig_time_s, "SECONDS",
             "when that light is chosen, for all times (default: at --time; of --frames, at the "
             "first)");
  add_shown(command, "--emissive-light", emissive_light, "HOW",
            "whether surfaces that shine light others: auto, on, off (default: auto: as the "
            "materials say, else where the file has no lamps)");
}

void resolve_settings(SceneOptions& options) {
  RenderSettings& settings = options.settings;
  options.choice.rig = rig_from_name(options.rig);
  options.choice.emissive_light = emissive_light_from_name(options.emissive_light);
  settings.mode = mode_from_name(options.mode);
  settings.uplift = uplift_from_name(options.uplift);
  settings.caustics =
      check_choice("--caustics", options.caustics, "a way to follow light", {"exact", "off"}) == 0;
  if (!options.size.empty()) settings.size = parse_size(options.size);
  if (!options.range.empty()) {
    const auto [low, high] = parse_range(options.range);
    settings.wavelengths.range_min_nm = low;
    settings.wavelengths.range_max_nm = high;
  }
  if (!options.lines.empty()) settings.wavelengths.exact_nm = parse_lines(options.lines);
  RenderSettings without_crop = settings;
  // Whether a crop fits shows when the size is known.
  if (options.size.empty()) without_crop.crop.reset();
  check_settings(without_crop);
}

void settle_size(SceneOptions& options, const Camera& camera) {
  if (options.size.empty()) options.settings.size = default_size(camera);
  check_settings(options.settings);
}

}  // namespace abbe
