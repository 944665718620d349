#include "abbe/report/golden/check.h"

#include <fmt/format.h>

#include <chrono>
#include <optional>

#include "abbe/base/error.h"
#include "abbe/base/text.h"
#include "abbe/image/exr/exr.h"
#include "abbe/image/metrics/compare.h"
#include "abbe/load/spectra/observer_file.h"
#include "abbe/report/golden/pictures.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

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

[[noreturn]] void throw_interrupted(const fs::path& file) {
  throw_output_error(file.string(), "an interrupted render", "a whole one");
}

// What of a scene is not as it was when its reference was made; empty when all is.
std::string changes_of(const ExrHeader& reference, const ExrHeader& now) {
  std::string text;
  for (const char* name : {"abbe:sceneHash", "abbe:spectraHash"}) {
    const auto then = reference.attributes.find(name);
    const auto found = now.attributes.find(name);
    const bool are_known = then != reference.attributes.end() && found != now.attributes.end();
    if (!are_known || then->second == found->second) continue;
    text += fmt::format("; {} differs: files have changed since the reference was made", name);
  }
  return text;
}

// Renders a golden image again, as its reference was made. Returns what has changed since.
std::string render_again(const GoldenImage& golden, const GoldenCheck& how, const fs::path& file) {
  const fs::path reference = golden_file(how.folder, golden.name);
  Recipe recipe = golden_recipe(reference);
  recipe.scene.file = how.folder / golden.scene;
  recipe.settings.threads = how.threads;
  Notes notes;
  const Standards standards = read_standards();
  const PreparedScene prepared = prepare_scene(recipe.scene, standards.catalogue, notes);
  if (!render_file(recipe, prepared, standards, file, notes, how.cancel)) throw_interrupted(file);
  return changes_of(read_exr_header(reference), read_exr_header(file));
}

}  // namespace

fs::path golden_file(const fs::path& folder, const std::string& name) {
  return folder / (name + ".exr");
}

Recipe golden_recipe(const fs::path& reference) {
  std::optional<Recipe> recipe;
  try {
    recipe = recipe_of(read_exr_header(reference));
  } catch (const Error& error) {
    ErrorDetail detail = error.detail();
    if (detail.where.empty()) detail.where = reference.string();
    throw Error(std::move(detail));
  }
  if (!recipe) {
    throw_input_error(reference.string(), "no word on how it was rendered",
                      "a file of `abbe golden make`, or images to compare it with");
  }
  if (recipe->development.observer.starts_with("csv:")) {
    throw_input_error(reference.string(), "an observer out of a file of its own",
                      "an observer of the catalogue, which every check finds");
  }
  if (!recipe->scene.environment.empty()) {
    throw_input_error(reference.string(), "an environment out of a file of its own",
                      "the environment of the scene, which every check finds");
  }
  return *recipe;
}

void check_golden_choice(const DevelopmentChoice& choice) {
  if (is_observer_file(choice.observer)) {
    throw_usage_error("observer", in_quotes(choice.observer),
                      "an observer of the catalogue, which every check finds");
  }
}

std::string render_golden(const Recipe& recipe, const PreparedScene& prepared,
                          const Standards& standards, const fs::path& reference,
                          const CompareThresholds& thresholds, const CancelFlag* cancel) {
  check_golden_choice(recipe.development);
  if (!recipe.scene.environment.empty()) {
    throw_usage_error("environment", in_quotes(recipe.scene.environment.string()),
                      "the environment of the scene (ABBE_scene), which every check finds");
  }
  const fs::path fresh = reference.parent_path() / ("." + reference.stem().string() + ".new.exr");
  Notes notes;
  if (!render_file(recipe, prepared, standards, fresh, notes, cancel)) {
    throw_interrupted(reference);
  }
  const std::string change = change_text(reference, fresh, thresholds);
  fs::rename(fresh, reference);
  return change;
}

GoldenResult check_golden(const GoldenImage& golden, const GoldenCheck& how) {
  GoldenResult result;
  result.name = golden.name;
  result.command = golden.command;
  const auto start = std::chrono::steady_clock::now();
  try {
    const Image reference = read_exr(golden_file(how.folder, golden.name));
    const bool renders = how.images.empty();
    const fs::path file = golden_file(renders ? how.results : how.images, golden.name);
    const std::string changes = renders ? render_again(golden, how, file) : "";
    // Of a file with more than the reference has, only that counts.
    const Image image = with_channels(read_exr(file), reference.channels, file.string());
    const Comparison comparison = compare_images(image, reference, golden.thresholds);
    result.passed = comparison.passed;
    result.message = comparison.summary(golden.thresholds) + changes;
    std::error_code ignored;
    // What passes needs no looking at.
    if (renders && result.passed) fs::remove(file, ignored);
    if (!result.passed) result.pictures = failure_pictures(reference, image, golden.thresholds);
  } catch (const Error& error) {
    result.message = error.what();
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace abbe
