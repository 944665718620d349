/// `abbe golden`: a folder of reference images, made and checked.

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "abbe/base/error.h"
#include "abbe/base/file.h"
#include "abbe/cli/commands.h"
#include "abbe/cli/console.h"
#include "abbe/cli/golden_pictures.h"
#include "abbe/cli/parse.h"
#include "abbe/cli/print.h"
#include "abbe/cli/render_command.h"
#include "abbe/cli/reproduce.h"
#include "abbe/image/exr/exr.h"
#include "abbe/image/metrics/compare.h"
#include "abbe/report/golden.h"
#include "abbe/report/page.h"

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

fs::path reference_of(const fs::path& folder, const std::string& name) {
  return folder / (name + ".exr");
}

// The words of a command as render_command_of writes it: blanks part them but for single quotes.
std::vector<std::string> words_of(const std::string& command) {
  std::vector<std::string> words;
  std::string word;
  bool is_quoted = false, has_word = false;
  for (std::size_t i = 0; i < command.size(); ++i) {
    const char c = command[i];
    if (c == '\'') {
      is_quoted = !is_quoted;
      has_word = true;
    } else if (c == '\\' && !is_quoted && i + 1 < command.size()) {
      word += command[++i];
      has_word = true;
    } else if (c == ' ' && !is_quoted) {
      if (has_word || !word.empty()) words.push_back(word);
      word.clear();
      has_word = false;
    } else {
      word += c;
    }
  }
  if (has_word || !word.empty()) words.push_back(word);
  return words;
}

// The render that has made a file, of another scene's place and into another file.
RenderArguments render_arguments_of(const fs::path& reference, const fs::path& scene,
                                    const fs::path& output) {
  const auto command = render_command_of(read_exr_header(reference));
  if (!command) {
    throw_input_error(reference.string(), "no word on how it was rendered",
                      "a file of abbe golden make, or --images DIR to compare others with");
  }
  std::vector<std::string> words = words_of(*command);
  words.erase(words.begin(), std::find(words.begin(), words.end(), "render"));
  for (std::string& word : words) {
    if (word == "SCENE") word = scene.string();
    if (word == "OUT.exr") word = output.string();
    if (word == "FILE.csv") {
      throw_input_error(reference.string(), "an observer out of a file of its own",
                        "an observer of the catalogue, which every check finds");
    }
  }
  // Read as the program reads them, without running.
  CLI::App program;
  RenderArguments arguments;
  CLI::App& render = *program.add_subcommand("render", "");
  add_scene_options(render, arguments.scene);
  render.add_option("-o,--output", arguments.outputs)->allow_extra_args(false);
  add_render_options(render, arguments);
  std::reverse(words.begin(), words.end());
  try {
    program.parse(words);
  } catch (const CLI::ParseError& error) {
    throw_input_error(reference.string(),
                      std::string("settings of another version: ") + error.what(),
                      "a file of this version");
  }
  arguments.quiet = true;
  return arguments;
}

std::string command_text(const fs::path& reference, const std::string& scene) {
  std::string command = render_command_of(read_exr_header(reference)).value_or("");
  const std::size_t begin = command.find("abbe render");
  if (begin != std::string::npos) command = command.substr(begin);
  const std::size_t place = command.find("SCENE");
  if (place != std::string::npos) command.replace(place, 5, scene);
  return command;
}

// What a new image changes, in a line.
std::string change_text(const fs::path& reference, const fs::path& fresh,
                        const CompareThresholds& thresholds) {
  if (!fs::exists(reference)) return "new";
  try {
    const Comparison comparison = compare_images(read_exr(fresh), read_exr(reference), thresholds);
    return fmt::format("{}; rms {:.3g}, max {:.3g}", comparison.summary(thresholds),
                       comparison.rms_error, comparison.max_error);
  } catch (const Error& error) {
    return std::string("replaces what cannot be compared: ") + error.what();
  }
}

// Renders beside the reference and puts it in its place; prints by how much that changes it.
void render_reference(RenderArguments arguments, const fs::path& reference, const std::string& name,
                      const CompareThresholds& thresholds) {
  const fs::path fresh = reference.parent_path() / ("." + name + ".new.exr");
  arguments.outputs = {fresh.string()};
  arguments.quiet = true;
  const ExitCode code = run_render(arguments);
  if (code != ExitCode::Done) {
    fs::remove(fresh);
    throw_output_error(reference.string(), "an interrupted render", "a whole one");
  }
  const std::string change = change_text(reference, fresh, thresholds);
  fs::rename(fresh, reference);
  print(fmt::format("{}: {}\n", name, change));
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
  const fs::path folder = arguments.folder;
  std::error_code error;
  fs::create_directories(folder, error);
  check_writable(folder / kGoldenList);
  std::vector<GoldenImage> images;
  if (fs::exists(folder / kGoldenList)) images = read_golden_list(folder);
  for (const std::string& scene : arguments.scenes) {
    RenderArguments render = arguments.render;
    render.scene.file = scene;
    GoldenImage image;
    image.name = arguments.name.empty() ? default_name(scene, render.scene.mode) : arguments.name;
    image.scene = fs::proximate(fs::absolute(scene), fs::absolute(folder)).generic_string();
    image.thresholds = thresholds;
    const fs::path reference = reference_of(folder, image.name);
    render_reference(render, reference, image.name, thresholds);
    image.command = command_text(reference, fs::path(scene).filename().string());
    const auto same = std::find_if(images.begin(), images.end(), [&](const GoldenImage& other) {
      return other.name == image.name;
    });
    if (same != images.end()) {
      *same = image;
    } else {
      images.push_back(image);
    }
    write_golden_list(folder, images);
  }
  return ExitCode::Done;
}

std::vector<GoldenImage> chosen(const std::vector<GoldenImage>& images,
                                const std::vector<std::string>& only) {
  if (only.empty()) return images;
  std::vector<GoldenImage> result;
  std::vector<std::string> names;
  for (const GoldenImage& image : images) names.push_back(image.name);
  for (const std::string& name : only) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
      throw_usage_error("--only", "\"" + name + "\"", "a golden image of the folder", names);
    }
    result.push_back(images[static_cast<std::size_t>(found - names.begin())]);
  }
  return result;
}

ExitCode run_renew(const RenewArguments& arguments) {
  const fs::path folder = arguments.folder;
  for (const GoldenImage& image : chosen(read_golden_list(folder), arguments.only)) {
    const fs::path reference = reference_of(folder, image.name);
    render_reference(render_arguments_of(reference, folder / image.scene, reference), reference,
                     image.name, image.thresholds);
  }
  return ExitCode::Done;
}

struct Checked {
  GoldenResult result;
  std::optional<Image> reference, image;
};

Checked check(const CheckArguments& arguments, const GoldenImage& golden, const fs::path& results) {
  Checked checked;
  checked.result.name = golden.name;
  const auto start = std::chrono::steady_clock::now();
  try {
    const fs::path folder = arguments.folder;
    const fs::path reference = reference_of(folder, golden.name);
    checked.reference = read_exr(reference);
    fs::path file = results / (golden.name + ".exr");
    if (arguments.images.empty()) {
      RenderArguments render = render_arguments_of(reference, folder / golden.scene, file);
      render.scene.threads = arguments.threads;
      const ExitCode code = run_render(render);
      if (code != ExitCode::Done)
        throw_output_error(file.string(), "an interrupted render", "a whole one");
    } else {
      file = reference_of(arguments.images, golden.name);
    }
    // Of a file with more than the reference has, only that counts.
    checked.image = with_channels(read_exr(file), checked.reference->channels, file.string());
    const Comparison comparison =
        compare_images(*checked.image, *checked.reference, golden.thresholds);
    checked.result.passed = comparison.passed;
    checked.result.message = comparison.summary(golden.thresholds);
  } catch (const Error& error) {
    checked.result.message = error.what();
  }
  checked.result.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return checked;
}

ExitCode run_check(const CheckArguments& arguments) {
  const std::vector<GoldenImage> images =
      chosen(read_golden_list(arguments.folder), arguments.only);
  const fs::path results = arguments.results;
  std::error_code error;
  fs::create_directories(results, error);
  check_writable(results / "index.html");
  if (!arguments.junit.empty()) check_writable(arguments.junit);
  std::vector<GoldenResult> all;
  nlohmann::ordered_json page;
  page["images"] = nlohmann::ordered_json::array();
  std::size_t failed = 0;
  for (const GoldenImage& golden : images) {
    const Checked checked = check(arguments, golden, results);
    all.push_back(checked.result);
    if (!arguments.quiet || !checked.result.passed) {
      print(fmt::format("{} {}: {}\n", checked.result.passed ? "pass" : "FAIL", golden.name,
                        checked.result.message));
    }
    nlohmann::ordered_json entry = {
        {"name", golden.name}, {"passed", checked.result.passed}, {"text", checked.result.message}};
    if (!checked.result.passed) {
      ++failed;
      entry["command"] = golden.command;
      if (checked.reference && checked.image) {
        entry["pictures"] = failure_pictures(*checked.reference, *checked.image, golden.thresholds);
      }
    } else if (arguments.images.empty()) {
      // What passes needs no looking at.
      fs::remove(results / (golden.name + ".exr"), error);
    }
    page["images"].push_back(std::move(entry));
  }
  // Failures first.
  std::stable_sort(page["images"].begin(), page["images"].end(),
                   [](const auto& a, const auto& b) { return !a["passed"] && b["passed"]; });
  page["summary"] = fmt::format("{} of {} golden images passed.", all.size() - failed, all.size());
  write_text(results / "index.html", golden_page("abbe golden check", json_text(page)));
  const fs::path junit =
      arguments.junit.empty() ? results / "junit.xml" : fs::path(arguments.junit);
  write_text(junit, junit_xml("golden", all));
  if (!arguments.quiet || failed > 0) {
    print(fmt::format("{} {}\n", page["summary"].get<std::string>(),
                      (results / "index.html").string()));
  }
  return failed > 0 ? ExitCode::Exceeded : ExitCode::Done;
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
