/// `abbe golden`: a folder of reference images, made and checked.

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <memory>

#include "abbe/base/error.h"
#include "abbe/base/file.h"
#include "abbe/cli/commands/commands.h"
#include "abbe/cli/commands/interrupt.h"
#include "abbe/cli/commands/render.h"
#include "abbe/cli/options/typed.h"
#include "abbe/cli/print/render_command.h"
#include "abbe/cli/print/text.h"
#include "abbe/report/golden/check.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

struct MakeArguments {
  std::vector<std::string> scenes;
  std::string folder, name;
  CompareThresholds thresholds;
  RenderArguments render;
};

struct CheckArguments {
  std::string folder, images, results, junit;
  std::vector<std::string> only;
  int threads = 0;
  bool quiet = false;
};

struct RenewArguments {
  std::string folder;
  std::vector<std::string> only;
};

// What people type to make a reference, on any machine.
std::string command_of(const fs::path& reference, const fs::path& scene) {
  Recipe recipe = golden_recipe(reference);
  recipe.isa.clear();
  recipe.scene.file = scene;
  return render_command(recipe);
}

std::string default_name(const std::string& scene, const std::string& mode) {
  std::string name = fs::path(scene).stem().string() + "_" + mode;
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '.') c = '_';
  }
  return name;
}

ExitCode run_make(MakeArguments& arguments) {
  if (!arguments.name.empty() && arguments.scenes.size() > 1) {
    throw_usage_error("--name",
                      "one name for " + std::to_string(arguments.scenes.size()) + " scenes",
                      "a scene for each call, or no name");
  }
  if (!arguments.name.empty() && !is_golden_name(arguments.name)) {
    throw_usage_error("--name", "\"" + arguments.name + "\"", "letters, digits, _, - and .");
  }
  const auto& thresholds = arguments.thresholds;
  if (!(thresholds.fail >= 0.0) || !(thresholds.hard_fail >= 0.0) ||
      !(thresholds.fail_percent >= 0.0 && thresholds.fail_percent <= 100.0)) {
    throw_usage_error("--fail", "a tolerance below 0", "0 or more, of --fail-percent up to 100");
  }
  check_render_arguments(arguments.render);
  check_golden_choice(arguments.render.development);
  const fs::path folder = arguments.folder;
  std::error_code error;
  fs::create_directories(folder, error);
  check_writable(folder / kGoldenList);
  std::vector<GoldenImage> images;
  if (fs::exists(folder / kGoldenList)) images = read_golden_list(folder);
  const Standards standards = read_standards();
  const InterruptGuard interrupt;
  for (const std::string& scene : arguments.scenes) {
    RenderArguments& typed = arguments.render;
    typed.scene.choice.file = scene;
    GoldenImage image;
    image.name = arguments.name.empty() ? default_name(scene, typed.scene.mode) : arguments.name;
    image.scene = fs::proximate(fs::absolute(scene), fs::absolute(folder)).generic_string();
    image.thresholds = thresholds;
    Notes notes;
    const PreparedScene prepared = prepare_scene(typed.scene.choice, standards.catalogue, notes);
    settle_size(typed.scene, prepared.chosen_camera());
    const Recipe recipe{typed.scene.choice, typed.scene.settings,
                        typed.development,  typed.color_space,
                        typed.exr,          {}};
    const fs::path reference = golden_file(folder, image.name);
    print(image.name + ": " +
          render_golden(recipe, prepared, standards, reference, thresholds, &interrupt.flag()) +
          "\n");
    image.command = command_of(reference, fs::path(scene).filename());
    const auto same = std::find_if(images.begin(), images.end(), [&](const GoldenImage& other) {
      return other.name == image.name;
    });
    (same != images.end() ? *same : images.emplace_back()) = image;
    write_golden_list(folder, images);
  }
  return ExitCode::Done;
}

// The images of a folder that were asked for, at least one.
std::vector<GoldenImage> chosen(const fs::path& folder, const std::vector<std::string>& only) {
  const std::vector<GoldenImage> images = read_golden_list(folder);
  if (images.empty()) {
    throw_input_error((folder / kGoldenList).string(), "no images",
                      "at least one, which `abbe golden make` adds");
  }
  if (only.empty()) return images;
  std::vector<GoldenImage> result;
  std::vector<std::string> names;
  for (const GoldenImage& image : images) names.push_back(image.name);
  for (const std::string& name : only) {
    result.push_back(images[check_choice("--only", name, "a golden image of the folder", names)]);
  }
  return result;
}

ExitCode run_renew(const RenewArguments& arguments) {
  const fs::path folder = arguments.folder;
  const Standards standards = read_standards();
  const InterruptGuard interrupt;
  for (const GoldenImage& image : chosen(folder, arguments.only)) {
    const fs::path reference = golden_file(folder, image.name);
    Recipe recipe = golden_recipe(reference);
    recipe.scene.file = folder / image.scene;
    Notes notes;
    const PreparedScene prepared = prepare_scene(recipe.scene, standards.catalogue, notes);
    print(
        image.name + ": " +
        render_golden(recipe, prepared, standards, reference, image.thresholds, &interrupt.flag()) +
        "\n");
  }
  return ExitCode::Done;
}

ExitCode run_check(const CheckArguments& arguments) {
  const std::vector<GoldenImage> images = chosen(arguments.folder, arguments.only);
  const fs::path results = arguments.results;
  std::error_code error;
  fs::create_directories(results, error);
  check_writable(results / "index.html");
  if (!arguments.junit.empty()) check_writable(arguments.junit);
  const InterruptGuard interrupt;
  const GoldenCheck how{arguments.folder, results, arguments.images, arguments.threads,
                        &interrupt.flag()};
  std::vector<GoldenResult> all;
  for (const GoldenImage& golden : images) {
    const GoldenResult result = check_golden(golden, how);
    if (interrupt.flag()) return ExitCode::Interrupted;
    if (!arguments.quiet || !result.passed) {
      print(
          fmt::format("{} {}: {}\n", result.passed ? "pass" : "FAIL", result.name, result.message));
    }
    all.push_back(result);
  }
  write_text(results / "index.html", golden_results_page(all));
  const fs::path junit =
      arguments.junit.empty() ? results / "junit.xml" : fs::path(arguments.junit);
  write_text(junit, junit_xml("golden", all));
  const bool any_failed = std::any_of(all.begin(), all.end(),
                                      [](const GoldenResult& result) { return !result.passed; });
  if (!arguments.quiet || any_failed) {
    print(golden_summary(all) + " " + (results / "index.html").string() + "\n");
  }
  return any_failed ? ExitCode::Exceeded : ExitCode::Done;
}

CLI::Option* add_folder(CLI::App& command, std::string& folder) {
  return command.add_option("DIR", folder, "folder of golden images")->required();
}

void add_only(CLI::App& command, std::vector<std::string>& only) {
  add_shown(command, "--only", only, "NAME", "only this image; repeatable")
      ->allow_extra_args(false);
}

}  // namespace

void add_golden_command(CLI::App& program, ExitCode& code) {
  CLI::App& group =
      *program.add_subcommand("golden", "Reference images: make them, check renders against them");
  group.require_subcommand(1);

  CLI::App& make = *group.add_subcommand("make", "Render references into a folder");
  const auto made = std::make_shared<MakeArguments>();
  make.add_option("SCENE", made->scenes, "glTF scenes")->required();
  add_shown(make, "-o,--output", made->folder, "DIR",
            "folder for NAME.exr and golden.json, which is added to")
      ->required();
  add_shown(make, "--name", made->name, "NAME", "of the image (default: SCENE_MODE)");
  add_number(make, "--fail", made->thresholds.fail, "X",
             "a pixel fails when a channel differs by more (default: 0.004)");
  add_number(make, "--fail-percent", made->thresholds.fail_percent, "X",
             "the image fails when more of its pixels do, in percent (default: 0.02)");
  add_number(make, "--hard-fail", made->thresholds.hard_fail, "X",
             "the image fails when one value differs by more (default: 0.012)");
  add_view_options(make, made->render.scene);
  add_render_options(make, made->render);
  make.callback([made, &code] { code = run_make(*made); });

  CLI::App& check = *group.add_subcommand("check", "Hold renders against a folder of references");
  const auto checked = std::make_shared<CheckArguments>();
  checked->results = "golden-check";
  add_folder(check, checked->folder);
  add_shown(check, "--images", checked->images, "DIR",
            "compare NAME.exr of this folder, by any renderer, instead of rendering");
  add_only(check, checked->only);
  add_shown(check, "-o,--output", checked->results, "DIR",
            "for index.html, junit.xml and renders that fail (default: golden-check)");
  add_shown(check, "--junit", checked->junit, "FILE.xml", "the JUnit report elsewhere");
  add_number(check, "--threads", checked->threads, "N", "threads to use (default: all cores)");
  check.add_flag("--quiet", checked->quiet, "say nothing but failures");
  check.callback([checked, &code] { code = run_check(*checked); });

  CLI::App& renew = *group.add_subcommand(
      "renew", "Render references again as they were made, and say what that changes");
  const auto renewed = std::make_shared<RenewArguments>();
  add_folder(renew, renewed->folder);
  add_only(renew, renewed->only);
  renew.callback([renewed, &code] { code = run_renew(*renewed); });
}

}  // namespace abbe
