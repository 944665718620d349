/// `abbe compare`: the modes side by side, and why they differ.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include "abbe/base/error.h"
#include "abbe/base/file.h"
#include "abbe/base/text.h"
#include "abbe/cli/commands/commands.h"
#include "abbe/cli/commands/interrupt.h"
#include "abbe/cli/options/image.h"
#include "abbe/cli/options/outputs.h"
#include "abbe/cli/options/scene.h"
#include "abbe/cli/options/typed.h"
#include "abbe/cli/print/console.h"
#include "abbe/cli/print/progress.h"
#include "abbe/cli/print/text.h"
#include "abbe/report/comparison/files.h"
#include "abbe/report/comparison/page.h"
#include "abbe/session/comparison/modes.h"

namespace abbe {
namespace {

struct CompareArguments {
  SceneOptions scene;
  DisplayArguments display;
  DevelopmentChoice development;
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

/// Tells on stderr how far a study is.
class StudyLine {
 public:
  explicit StudyLine(const Console& console) : console_(console) {}

  StudyWatcher watcher() {
    return {[this](const Notes& notes) {
              line_.reset();
              console_.show(notes);
            },
            [this](const StudyStep& step, double fraction_done) {
              if (!line_) line_.emplace(console_.is_live(), place(step));
              line_->update(fraction_done);
            },
            [this](const StudyStep& step, double seconds) {
              line_.reset();
              console_.say(fmt::format("{}: {:.1f} s", place(step), seconds));
            }};
  }

 private:
  static std::string place(const StudyStep& step) {
    return fmt::format("{} of {}, {}", step.number, step.count, step.label);
  }

  const Console& console_;
  std::optional<ProgressLine> line_;
};

// What is asked for before minutes of loading, and what needs the scene.
PreparedScene prepare(CompareArguments& arguments, const Standards& standards,
                      const Console& console) {
  check_development(arguments.development, standards);
  Notes notes;
  PreparedScene prepared = prepare_scene(arguments.scene.choice, standards.catalogue, notes);
  settle_quick_size(arguments, prepared.chosen_camera());
  settle_size(arguments.scene, prepared.chosen_camera());
  console.show(notes);
  return prepared;
}

void write_report(const CompareArguments& arguments, const CompareResult& result,
                  const Observer& observer) {
  const std::filesystem::path folder = arguments.folder;
  write_maps(folder, result);
  const auto pictures =
      write_pictures(arguments.display.options, arguments.display.raster, folder, result);
  write_text(folder / "stats.json", compare_stats(result));
  write_text(folder / "index.html", compare_page(result, pictures, observer, kMaxPageBytes));
}

ExitCode run_compare(CompareArguments& arguments) {
  const std::vector<SweepPlan> sweeps = check_arguments(arguments);
  const Console console(arguments.quiet);
  const RenderSettings& settings = arguments.scene.settings;
  const ThreadLimit threads(settings.threads);
  const Standards standards = read_standards();
  const PreparedScene prepared = prepare(arguments, standards, console);
  const DevelopmentOptions development =
      development_options(arguments.development, standards, &prepared);
  const std::filesystem::path folder = arguments.folder;
  check_folder(folder);

  const InterruptGuard interrupt;
  StudyLine line(console);
  Study study(prepared, standards, development,
              {.folder = folder,
               .fresh = arguments.fresh,
               .cancel = &interrupt.flag(),
               .seconds = earlier_seconds(folder / "stats.json"),
               .watcher = line.watcher()});
  const DisplayOptions& display = arguments.display.options;
  std::optional<double> exposure_ev = prepared.scene.exposure_ev;
  if (display.auto_exposure) exposure_ev.reset();
  if (!display.auto_exposure && !arguments.display.exposure.empty()) {
    exposure_ev = display.exposure_ev;
  }
  std::optional<ModesCompared> compared = compare_modes(
      study,
      {.settings = settings,
       .method = arguments.shapley ? AttributionMethod::Shapley : AttributionMethod::FirstAndLast,
       .sweeps = sweeps,
       .exposure_ev = exposure_ev});
  if (!compared) return ExitCode::Interrupted;
  const CompareResult result{std::move(*compared),
                             arguments.scene.choice.file.stem().string(),
                             kept_trees(prepared, standards, settings),
                             study.seconds(),
                             study.rendered_count(),
                             study.reused_count()};
  write_report(arguments, result, standards.observer);
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
  add_number(command, "--threads", arguments->scene.settings.threads, "N",
             "threads to use (default: all cores)");
  add_development_options(command, arguments->development);
  add_display_options(command, arguments->display);
  command.add_flag("--quiet", arguments->quiet, "say nothing but errors");
  command.callback([arguments, &code] { code = run_compare(*arguments); });
}

}  // namespace abbe
