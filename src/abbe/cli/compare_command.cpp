/// `abbe compare`: the modes side by side, and why they differ.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "abbe/base/error.h"
#include "abbe/base/file.h"
#include "abbe/cli/commands.h"
#include "abbe/cli/compare_files.h"
#include "abbe/cli/compare_report.h"
#include "abbe/cli/console.h"
#include "abbe/cli/development_options.h"
#include "abbe/cli/interrupt.h"
#include "abbe/cli/options.h"
#include "abbe/cli/outputs.h"
#include "abbe/cli/parse.h"
#include "abbe/cli/prepare.h"
#include "abbe/cli/print.h"
#include "abbe/cli/study.h"

namespace abbe {
namespace {

struct SweepPlan {
  std::string parameter;
  std::vector<int> values;  // Rising.
};

struct CompareArguments {
  SceneOptions scene;
  DisplayArguments display;
  DevelopmentArguments development;
  std::string folder, bands = "380:740:10", crop;
  std::optional<int> samples;
  std::vector<std::string> sweeps;
  bool shapley = false, quick = false, fresh = false, quiet = false;
};

// What a quick look is made with, where nothing else is asked for.
constexpr int kQuickWidth = 160;
constexpr int kQuickSamples = 4;

SweepPlan parse_sweep(const std::string& text) {
  const std::size_t equals = text.find('=');
  SweepPlan plan{text.substr(0, equals), {}};
  if (equals != std::string::npos && (plan.parameter == "wavelengths" || plan.parameter == "spp")) {
    for (const std::string& part : parse_names(text.substr(equals + 1))) {
      const auto value = whole_number_of(part);
      if (!value || *value < 1) plan.values = {};
      if (!value || *value < 1) break;
      plan.values.push_back(*value);
    }
    std::sort(plan.values.begin(), plan.values.end());
    const bool has_twice =
        std::adjacent_find(plan.values.begin(), plan.values.end()) != plan.values.end();
    if (plan.values.size() >= 2 && !has_twice) return plan;
  }
  throw_usage_error("--sweep", "\"" + text + "\"",
                    "wavelengths=A,B,… or spp=A,B,…: two or more numbers, each once");
}

RenderSettings with_value(RenderSettings settings, const SweepPlan& plan, int value) {
  (plan.parameter == "spp" ? settings.samples_per_pixel : settings.wavelengths.count) = value;
  settings.bands.reset();
  return settings;
}

std::vector<SweepPlan> check_arguments(CompareArguments& arguments) {
  RenderSettings& settings = arguments.scene.settings;
  if (arguments.scene.mode != "spectral") {
    throw_usage_error("--mode", arguments.scene.mode, "none: compare renders all modes");
  }
  if (!arguments.scene.lines.empty() || !arguments.scene.range.empty()) {
    throw_usage_error(arguments.scene.lines.empty() ? "--range" : "--lines",
                      "a part of the spectrum", "all of it: the RGB modes know no part");
  }
  settings.samples_per_pixel =
      arguments.samples.value_or(arguments.quick ? kQuickSamples : settings.samples_per_pixel);
  settings.bands = parse_bands(arguments.bands);
  if (!arguments.crop.empty()) settings.crop = parse_crop(arguments.crop);
  resolve_settings(arguments.scene);
  resolve_display(arguments.display);
  check_display(arguments.display.options);
  std::vector<SweepPlan> plans;
  for (const std::string& text : arguments.sweeps) {
    plans.push_back(parse_sweep(text));
    for (const int value : plans.back().values) {
      RenderSettings each = with_value(settings, plans.back(), value);
      if (arguments.scene.size.empty()) each.crop.reset();
      check_settings(each);
    }
  }
  return plans;
}

void check_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw_output_error(folder.string(), "no folder that could be made: " + error.message(),
                       "a place for a folder");
  }
  check_writable(folder / "index.html");
}

std::optional<Sweep> run_sweep(Study& study, const SweepPlan& plan, const RenderSettings& settings,
                               double exposure_ev) {
  const auto shot_of = [&](int value) {
    return study.render(fmt::format("sweeps/{}-{}.exr", plan.parameter, value),
                        fmt::format("{} {}", plan.parameter, value),
                        with_value(settings, plan, value));
  };
  const int finest = plan.values.back();
  const auto reference = shot_of(finest);
  if (!reference) return std::nullopt;
  Sweep sweep{plan.parameter, finest, {}};
  for (const int value : plan.values) {
    if (value == finest) continue;
    const auto shot = shot_of(value);
    if (!shot) return std::nullopt;
    const ModeDifference difference = mode_difference(shot->image, reference->image, exposure_ev);
    sweep.runs.push_back(
        {value, map_statistics(difference.maps.delta_e2000), difference.rmse, shot->seconds});
  }
  return sweep;
}

void settle_quick_size(CompareArguments& arguments, const Camera& camera) {
  if (!arguments.quick || !arguments.scene.size.empty()) return;
  const Vec2i full = default_size(camera);
  const int rows = std::max(1, kQuickWidth * full.y / full.x);
  arguments.scene.size = fmt::format("{}x{}", kQuickWidth, rows);
  arguments.scene.settings.size = {kQuickWidth, rows};
}

std::string text_of(const CompareResult& result, const std::filesystem::path& folder) {
  const auto line = [](const std::string& name, const MapStatistics& statistics) {
    return fmt::format("{:<26} {:>9.3f} {:>9.3f} {:>9.3f}", name, statistics.mean,
                       statistics.percentile_95, statistics.max);
  };
  std::string text =
      fmt::format("{:<26} {:>9} {:>9} {:>9}\n", "CIEDE2000 to spectral", "mean", "95 %", "max");
  for (const auto& [mode, difference] : result.differences) {
    text += line(mode, map_statistics(difference.maps.delta_e2000)) + "\n";
  }
  text += fmt::format("\n{:<26} {:>9} {:>9} {:>9} {:>9}\n", "cause of rgb's", "mean", "95 %", "max",
                      "share");
  const double whole = result.causes.mean_whole();
  const auto share = [whole](const MapStatistics& statistics) {
    return fmt::format(" {:>7.1f} %\n", whole > 0.0 ? 100.0 * statistics.mean / whole : 0.0);
  };
  for (std::size_t i = 0; i < result.causes.acting.size(); ++i) {
    const MapStatistics statistics = map_statistics(result.causes.attribution.shares[i]);
    text += line(cause_name(result.causes.acting[i]), statistics) + share(statistics);
  }
  const MapStatistics rest = map_statistics(result.causes.attribution.interaction);
  text += line("interaction", rest) + share(rest);
  for (const Sweep& sweep : result.sweeps) {
    text += fmt::format("\n{:<26} {:>9} {:>9} {:>9} {:>11}\n",
                        fmt::format("{} against {}", sweep.parameter, sweep.finest), "mean", "95 %",
                        "max", "RMSE");
    for (const SweepRun& run : sweep.runs) {
      text +=
          line(std::to_string(run.value), run.delta_e2000) + fmt::format(" {:>11.3g}\n", run.rmse);
    }
  }
  return text + "\n" + (folder / "index.html").string() + "\n";
}

ExitCode run_compare(CompareArguments& arguments) {
  const std::vector<SweepPlan> plans = check_arguments(arguments);
  const Console console(arguments.quiet);
  const ThreadLimit threads(arguments.scene.threads);
  const Catalogue catalogue = Catalogue::standard();
  const Standards standards = read_standards(catalogue);
  if (arguments.development.white != "scene") {
    (void)development_options(arguments.development, catalogue, standards, nullptr);
  }
  Notes notes;
  const PreparedScene prepared = prepare_scene(arguments.scene, catalogue, notes);
  settle_quick_size(arguments, prepared.chosen_camera());
  settle_size(arguments.scene, prepared.chosen_camera());
  console.show(notes);
  const DevelopmentOptions development =
      development_options(arguments.development, catalogue, standards, &prepared);
  const std::filesystem::path folder = arguments.folder;
  check_folder(folder);

  const RenderSettings& settings = arguments.scene.settings;
  const InterruptGuard interrupt;
  Study study(prepared, standards, development, console,
              {.folder = folder,
               .fresh = arguments.fresh,
               .cancel = &interrupt.flag(),
               .seconds = earlier_seconds(folder / "stats.json")});
  const std::vector<Cause> acting = acting_causes(prepared.scene, standards.d65);
  const AttributionMethod method =
      arguments.shapley ? AttributionMethod::Shapley : AttributionMethod::FirstAndLast;
  study.announce(
      3 + static_cast<int>(coalitions_needed(static_cast<int>(acting.size()), method).size()));
  for (const SweepPlan& plan : plans) study.announce(static_cast<int>(plan.values.size()));

  CompareResult result;
  result.scene = std::filesystem::path(arguments.scene.file).stem().string();
  result.settings = settings;
  for (const Mode mode : {Mode::Rgb, Mode::Rgb3, Mode::Spectral}) {
    RenderSettings of_mode = settings;
    of_mode.mode = mode;
    if (mode != Mode::Spectral) of_mode.bands.reset();
    const std::string name = mode_name(mode);
    std::optional<StudyImage> shot = study.render(name + ".exr", name, of_mode);
    if (!shot) return ExitCode::Interrupted;
    result.modes.emplace(name, std::move(*shot));
  }
  const Image& spectral = result.modes.at("spectral").image;
  result.exposure_ev = arguments.display.options.auto_exposure
                           ? auto_exposure_ev(spectral)
                           : arguments.display.options.exposure_ev;
  for (const char* mode : {"rgb", "rgb3"}) {
    result.differences.emplace(
        mode, mode_difference(result.modes.at(mode).image, spectral, result.exposure_ev));
  }
  RenderSettings frozen = settings;
  frozen.wavelengths.count =
      std::min(frozen.wavelengths.count, most_frozen_wavelengths(prepared.scene, standards.d65));
  std::optional<Causes> causes =
      find_causes(study, acting, method, frozen, result.modes.at("rgb").image,
                  result.differences.at("rgb"), result.exposure_ev);
  if (!causes) return ExitCode::Interrupted;
  result.causes = std::move(*causes);
  for (const SweepPlan& plan : plans) {
    std::optional<Sweep> sweep = run_sweep(study, plan, settings, result.exposure_ev);
    if (!sweep) return ExitCode::Interrupted;
    result.sweeps.push_back(std::move(*sweep));
  }
  result.trees = kept_trees(prepared, standards, settings);
  result.render_seconds = study.seconds();
  result.rendered = study.rendered_count();
  result.reused = study.reused_count();

  write_maps(folder, result);
  const auto pictures = write_pictures(arguments.display, folder, result);
  write_text(folder / "stats.json", json_text(compare_stats(result)));
  write_text(folder / "index.html",
             compare_page(result, pictures, standards.observer, kMostPageBytes));
  if (result.reused > 0) {
    console.say(fmt::format("{} renders made, {} reused", result.rendered, result.reused));
  }
  if (!arguments.quiet) print(text_of(result, folder));
  return ExitCode::Done;
}

}  // namespace

void add_compare_command(CLI::App& program, ExitCode& code) {
  CLI::App& command = *program.add_subcommand(
      "compare", "Render a scene in all modes, with a page that explains their differences");
  const auto arguments = std::make_shared<CompareArguments>();
  add_scene_options(command, arguments->scene);
  add_shown(command, "-o,--output", arguments->folder, "DIR",
            "folder for images, maps, stats.json and index.html; what stands there and is what "
            "would be rendered is used again")
      ->required();
  command.add_flag(
      "--quick", arguments->quick,
      fmt::format("a small look: {} pixels wide, {} samples", kQuickWidth, kQuickSamples));
  add_number(command, "--spp", arguments->samples, "N",
             "camera samples per pixel (default: 16, quick: 4)");
  add_shown(command, "--sweep", arguments->sweeps, "NAME=LIST",
            "error against the finest of several runs: wavelengths=4,8,16,32,64 or spp=1,4,16; "
            "repeatable")
      ->allow_extra_args(false);
  command.add_flag("--shapley", arguments->shapley,
                   "share out all interactions of causes, by an image for each set of them "
                   "(default: up to three causes, otherwise first and last effects)");
  command.add_flag("--fresh", arguments->fresh, "render everything again");
  add_shown(command, "--bands", arguments->bands, "A:B:STEP",
            "bands of the spectra that the page's probe shows (default: 380:740:10)");
  add_shown(command, "--crop", arguments->crop, "X0,Y0,X1,Y1",
            "render only these pixels, half-open");
  add_number(command, "--threads", arguments->scene.threads, "N",
             "threads to use (default: all cores)");
  add_development_options(command, arguments->development);
  add_display_options(command, arguments->display);
  command.add_flag("--quiet", arguments->quiet, "say nothing but errors");
  command.callback([arguments, &code] { code = run_compare(*arguments); });
}

}  // namespace abbe
