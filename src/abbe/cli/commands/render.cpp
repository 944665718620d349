/// `abbe render`: a scene in, images out.

#include "abbe/cli/commands/render.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <utility>

#include "abbe/base/file.h"
#include "abbe/cli/commands/commands.h"
#include "abbe/cli/commands/interrupt.h"
#include "abbe/cli/options/frames.h"
#include "abbe/cli/options/outputs.h"
#include "abbe/cli/options/typed.h"
#include "abbe/cli/print/console.h"
#include "abbe/cli/print/progress.h"
#include "abbe/cli/print/stats.h"
#include "abbe/image/raster/raster.h"
#include "abbe/session/exposure.h"
#include "abbe/session/picture.h"

namespace abbe {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Display images first: they are made of the rendered space, which the EXR may leave.
void write_images(const RenderArguments& arguments, Image image) {
  const auto [exrs, rasters] = sorted_outputs(arguments.outputs);
  const DisplayOptions& display = arguments.display.options;
  if (!rasters.empty()) {
    const Image shown = to_display(image, display);
    for (const auto& file : rasters) write_raster(file, shown, arguments.display.raster);
  }
  if (!exrs.empty()) {
    write_exrs_in(arguments.color_space, exrs, std::move(image), arguments.exr, display);
  }
}

// What the frames of a sequence share.
struct Shared {
  // Of the first, so that a sequence does not flicker.
  std::optional<double> metered_ev;
  std::optional<AddedRig> rig;
  std::set<std::string> said;  // So that nothing is said of every frame.
};

Notes unsaid(const Notes& notes, Shared& shared) {
  Notes fresh;
  std::set<std::string> now;
  for (const Note& note : notes.all()) {
    if (shared.said.contains(note.text)) continue;
    now.insert(note.text);
    note.kind == NoteKind::Warning ? fresh.warn(note.where, note.text)
                                   : fresh.info(note.where, note.text);
  }
  shared.said.merge(now);
  return fresh;
}

// Settles how display images are exposed. Returns the EV that belongs to the scene: what it states,
// else what a look at the whole image says; in a sequence, at the first one: `metered`.
double settle_exposure(RenderArguments& arguments, const PreparedScene& prepared,
                       const LitWorld& world, const Console& console,
                       std::optional<double>& metered) {
  DisplayOptions& display = arguments.display.options;
  const std::optional<double> stated = prepared.scene.exposure_ev;
  const bool is_new = !metered;
  if (is_new && (!stated || display.auto_exposure)) {
    metered = metered_exposure_ev(prepared, arguments.scene.settings, world);
  }
  const double of_scene = stated ? *stated : *metered;
  const bool is_metered = display.auto_exposure || (!stated && arguments.display.exposure.empty());
  if (is_metered) {
    display.exposure_ev = *metered;
  } else if (arguments.display.exposure.empty()) {
    display.exposure_ev = of_scene;
  }
  display.auto_exposure = false;
  if (is_metered && is_new && !sorted_outputs(arguments.outputs).rasters.empty()) {
    console.say(fmt::format("note: shown at {:+.2f} EV, by a look at the whole image (--exposure)",
                            *metered));
  }
  return of_scene;
}

// Says so where finding bent light took most of the time.
void tell_cost(const RenderResult& result, int threads, const Console& console) {
  constexpr double kMost = 0.75, kNoticed_s = 1.0;
  const double seconds = result.stats.bent_light_seconds / threads;
  if (!(seconds > kMost * result.seconds && seconds > kNoticed_s)) return;
  console.say(
      fmt::format("note: the paths of light over flat glass and mirrors took {:.1f} of {:.1f} s: "
                  "--chain with a small number leaves out inner reflections, --caustics off sends "
                  "all of it straight",
                  seconds, result.seconds));
}

std::string summary(const RenderArguments& arguments, const RenderResult& result,
                    const RenderTimes& times) {
  std::string text = fmt::format("{} in {:.1f} s, {:.3g} million rays/s",
                                 result.complete ? "rendered" : "interrupted", times.total_seconds,
                                 rays_per_second(result.stats, times.render_seconds) * 1e-6);
  const SamplingReport& sampling = result.sampling;
  if (sampling.noise > 0.0 && result.complete) {
    text += fmt::format(", {:.3g} samples a pixel, noise {:.2f}", sampling.samples_per_pixel,
                        sampling.error);
  }
  const char* separator = ": ";
  for (const std::string& file : arguments.outputs) {
    text += separator + file;
    separator = ", ";
  }
  return text;
}

}  // namespace

void check_render_arguments(RenderArguments& arguments) {
  RenderSettings& settings = arguments.scene.settings;
  settings.samples_per_pixel = arguments.samples.value_or(settings.samples_per_pixel);
  if (!arguments.bands.empty()) settings.bands = parse_bands(arguments.bands);
  if (!arguments.crop.empty()) settings.crop = parse_crop(arguments.crop);
  if (!arguments.aovs.empty()) settings.aovs = parse_names(arguments.aovs);
  if (!arguments.freeze.empty()) settings.frozen = parse_causes(parse_names(arguments.freeze));
  resolve_settings(arguments.scene);
  resolve_display(arguments.display);
  check_exr_options(arguments.exr);
  check_outputs({arguments.outputs.begin(), arguments.outputs.end()});
  if (!arguments.stats_file.empty()) check_writable(arguments.stats_file);
  std::vector<NamedFile> written{{"--stats", arguments.stats_file}};
  for (const std::string& file : arguments.outputs) written.push_back({"-o", file});
  check_apart(written, {{"SCENE", arguments.scene.choice.file},
                        {"--environment", arguments.scene.choice.environment}});
  // What is asked for is checked, even where nothing is shown.
  const DisplayOptions &display = arguments.display.options, plain;
  if (!sorted_outputs(arguments.outputs).rasters.empty() || display.config ||
      display.display != plain.display || display.view != plain.view) {
    check_display(display);
  }
  if (arguments.color_space != kRenderSpace) {
    check_color_space(arguments.color_space, arguments.display.options);
  }
}

namespace {

// Samples where they are needed, unless their number is all that was asked for.
void settle_sampling(RenderArguments& arguments) {
  if (arguments.samples && !arguments.noise) return;
  RenderSettings& settings = arguments.scene.settings;
  if (arguments.noise && !(*arguments.noise > 0.0)) {
    throw_usage_error("--noise", fmt::format("{}", *arguments.noise),
                      "a number above 0; --spp alone gives all pixels as many samples");
  }
  settings.noise = arguments.noise.value_or(kFinishedNoise);
  if (!arguments.samples) arguments.samples = kMostSamples;
}

ExitCode render_one(RenderArguments& arguments, Shared& shared) {
  const Clock::time_point start = Clock::now();
  settle_sampling(arguments);
  check_render_arguments(arguments);
  const Console console(arguments.quiet);
  RenderSettings& settings = arguments.scene.settings;
  const ThreadLimit threads(settings.threads);
  RenderTimes times;

  Notes notes;
  const Standards standards = read_standards();
  check_development(arguments.development, standards);
  const PreparedScene prepared = prepare_scene(arguments.scene.choice, standards.catalogue, notes,
                                               shared.rig ? &*shared.rig : nullptr);
  shared.rig = prepared.rig;
  settle_size(arguments.scene, prepared.chosen_camera());
  times.load_seconds = seconds_since(start);

  const DevelopmentOptions development =
      development_options(arguments.development, standards, &prepared);
  const LitWorld world = make_lit_world(prepared, settings, standards, notes, development);
  times.build_seconds = world.build_seconds;

  const InterruptGuard interrupt;
  console.show(unsaid(notes, shared));
  const double exposure_ev =
      settle_exposure(arguments, prepared, world, console, shared.metered_ev);
  settings.noise_exposure_ev = arguments.display.options.exposure_ev;
  ProgressLine progress(console.is_live());
  Film film(film_options(settings));
  const RenderResult result = render(
      world, prepared.chosen_camera(), settings, film,
      [&progress](double fraction_done) { progress.update(fraction_done); }, &interrupt.flag());
  progress.wipe();
  times.render_seconds = result.seconds;
  if (film.dropped_sample_count() > 0) {
    console.say(fmt::format("warning: {} camera samples were not finite and were left out",
                            film.dropped_sample_count()));
  }

  const Clock::time_point write_start = Clock::now();
  auto attributes = provenance(prepared, settings, development, standards);
  attributes[kExposureAttribute] = static_cast<float>(exposure_ev);
  write_images(arguments,
               developed_picture(film, world, prepared, std::move(attributes), result.complete));
  times.write_seconds = seconds_since(write_start);
  times.total_seconds = seconds_since(start);
  const auto threads_used = static_cast<int>(oneapi::tbb::global_control::active_value(
      oneapi::tbb::global_control::max_allowed_parallelism));
  if (!arguments.stats_file.empty()) {
    write_text(arguments.stats_file,
               stats_json(world, film, result, times, threads_used).dump(2) + "\n");
  }
  console.say(summary(arguments, result, times));
  tell_cost(result, threads_used, console);
  return result.complete ? ExitCode::Done : ExitCode::Interrupted;
}

// The arguments of one frame of a sequence.
RenderArguments frame_arguments(const RenderArguments& arguments, std::uint32_t frame,
                                std::uint32_t first_frame) {
  RenderArguments one = arguments;
  constexpr double kCinema = 24.0;
  const double fps = arguments.frames_per_second.value_or(kCinema);
  one.scene.choice.time_s = frame / fps;
  if (!one.scene.choice.rig_time_s) one.scene.choice.rig_time_s = first_frame / fps;
  for (std::string& file : one.outputs) file = frame_file(file, frame, "-o");
  if (!one.stats_file.empty()) one.stats_file = frame_file(one.stats_file, frame, "--stats");
  return one;
}

void check_sequence(const RenderArguments& arguments) {
  if (arguments.frames.empty()) {
    if (!arguments.frames_per_second) return;
    throw_usage_error("--fps", fmt::format("{}", *arguments.frames_per_second), "--frames with it");
  }
  if (arguments.scene.choice.time_s) {
    throw_usage_error("--time", "a time beside --frames", "one of the two");
  }
  const double fps = arguments.frames_per_second.value_or(1.0);
  if (!(fps > 0.0) || !std::isfinite(fps)) {
    throw_usage_error("--fps", fmt::format("{}", fps), "a number above 0");
  }
}

}  // namespace

ExitCode run_render(RenderArguments& arguments) {
  check_sequence(arguments);
  Shared shared;
  if (arguments.frames.empty()) return render_one(arguments, shared);
  const FrameRange range = parse_frames(arguments.frames);
  for (std::uint32_t frame = range.first; frame <= range.last; ++frame) {
    RenderArguments one = frame_arguments(arguments, frame, range.first);
    const ExitCode code = render_one(one, shared);
    if (code != ExitCode::Done) return code;
  }
  return ExitCode::Done;
}

void add_render_options(CLI::App& command, RenderArguments& arguments) {
  RenderSettings& settings = arguments.scene.settings;
  add_number(command, "--spp", arguments.samples, "N", "camera samples per pixel");
  add_shown(command, "--bands", arguments.bands, "A:B:STEP",
            "spectral channels beside RGB: bands [A + i STEP, A + (i+1) STEP), in nm");
  add_shown(command, "--crop", arguments.crop, "X0,Y0,X1,Y1",
            "render only these pixels, half-open");
  add_shown(command, "--aov", arguments.aovs, "LIST",
            fmt::format("extra channels: {}", fmt::join(aov_names(), ", ")));
  add_shown(command, "--freeze", arguments.freeze, "LIST",
            fmt::format("causes of spectral effects to hold as the mode rgb has them: {}, or all",
                        fmt::join(cause_names(), ", ")));
  add_number(command, "--threads", settings.threads, "N", "threads to use (default: all cores)");
  add_shown(command, "--colorspace", arguments.color_space, "NAME",
            fmt::format("OCIO colour space of the EXR's RGB (default: {})", kRenderSpace));
  add_development_options(command, arguments.development);
  add_exr_options(command, arguments.exr);
  add_display_options(command, arguments.display);
  command.add_flag("--quiet", arguments.quiet, "say nothing but errors");
}

void add_render_command(CLI::App& program, ExitCode& code) {
  CLI::App& command = *program.add_subcommand("render", "Render a scene to images");
  const auto arguments = std::make_shared<RenderArguments>();
  add_scene_options(command, arguments->scene);
  add_shown(command, "-o,--output", arguments->outputs, "FILE",
            "image to write, .exr scene-linear or .png, .jpg, .tif through OCIO; repeatable")
      ->allow_extra_args(false)
      ->required();
  add_render_options(command, *arguments);
  add_shown(command, "--frames", arguments->frames, "A:B",
            "render these frames, both included; # in the names of files are their numbers");
  add_number(command, "--noise", arguments->noise, "X",
             fmt::format("visible error, CIEDE2000, at which a pixel needs no more samples, judged "
                         "as it is shown; --spp is the most then (default: {:g}, at most {} "
                         "samples; with --spp alone: all pixels have as many)",
                         kFinishedNoise, kMostSamples));
  add_number(command, "--fps", arguments->frames_per_second, "N",
             "frames per second: frame k is at k / N seconds (default: 24)");
  add_shown(command, "--stats", arguments->stats_file, "FILE.json",
            "write times, counts of rays and memory");
  command.callback([arguments, &code] { code = run_render(*arguments); });
}

}  // namespace abbe
