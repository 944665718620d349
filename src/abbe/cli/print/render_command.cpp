#include "abbe/cli/print/render_command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "abbe/color/uplift/uplift.h"

namespace abbe {
namespace {

// As a shell takes it for one word.
std::string quoted(const std::string& word) {
  const auto is_plain = [](unsigned char c) {
    return std::isalnum(c) != 0 ||
           std::string("-_./:,=+%@").find(static_cast<char>(c)) != std::string::npos;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), is_plain)) return word;
  std::string result = "'";
  for (const char c : word) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

class Command {
 public:
  explicit Command(std::string text) : text_(std::move(text)) {}

  template <typename T>
  void add(const char* option, const T& value) {
    add_word(option, fmt::format("{}", value));
  }
  // Of texts and lists, those that are not empty.
  void add_given(const char* option, const std::string& value) {
    if (!value.empty()) add_word(option, value);
  }
  void add_flag(const char* option, bool is_set) {
    if (is_set) text_ += std::string(" ") + option;
  }
  const std::string& text() const { return text_; }

 private:
  void add_word(const char* option, const std::string& word) {
    text_ += std::string(" ") + option + " " + quoted(word);
  }
  std::string text_;
};

void add_wavelengths(const RenderSettings& settings, Command& command) {
  if (settings.mode != Mode::Spectral) return;
  if (!settings.wavelengths.exact_nm.empty()) {
    command.add("--lines", lines_text(settings.wavelengths));
    return;
  }
  command.add("--wavelengths", settings.wavelengths.count);
  command.add("--range", range_text(settings.wavelengths));
  if (settings.bands) command.add("--bands", bands_text(*settings.bands));
}

void add_form(const Recipe& recipe, Command& command) {
  const std::string& observer = recipe.development.observer;
  command.add_given("--observer", observer.starts_with("csv:") ? "FILE.csv" : observer);
  command.add("--colorspace", recipe.color_space);
  command.add("--compression", recipe.form.compression);
  if (recipe.form.tile_size > 0) command.add("--tiles", recipe.form.tile_size);
  command.add_flag("--multipart", recipe.form.multi_part);
  command.add_flag("--half", recipe.form.half);
}

}  // namespace

std::string render_command(const Recipe& recipe) {
  const RenderSettings& settings = recipe.settings;
  const std::string scene = recipe.scene.file.string();
  Command command((recipe.isa.empty() ? "" : "ABBE_ISA=" + quoted(recipe.isa) + " ") +
                  "abbe render " + (scene.empty() ? "SCENE" : quoted(scene)) + " -o OUT.exr");
  command.add("--size", fmt::format("{}x{}", settings.size.x, settings.size.y));
  if (settings.crop) {
    const PixelRect& crop = *settings.crop;
    command.add("--crop", fmt::format("{},{},{},{}", crop.x0, crop.y0, crop.x1, crop.y1));
  }
  command.add_given("--scene", recipe.scene.scene);
  if (recipe.scene.time_s) command.add("--time", *recipe.scene.time_s);
  command.add_given("--animation", recipe.scene.animation);
  command.add_given("--variant", recipe.scene.variant);
  command.add("--mode", mode_name(settings.mode));
  command.add("--spp", settings.samples_per_pixel);
  if (settings.noise > 0.0) {
    command.add("--noise", settings.noise);
    command.add("--exposure", settings.noise_exposure_ev);
  }
  add_wavelengths(settings, command);
  command.add("--filter", settings.filter);
  command.add("--depth", settings.max_depth);
  command.add("--cutoff", settings.cutoff);
  command.add("--seed", settings.seed);
  command.add("--caustics", settings.caustics ? "exact" : "off");
  command.add("--chain", settings.inner_reflections);
  command.add_given("--lamp", recipe.scene.lamp);
  const std::string environment = recipe.scene.environment.string();
  command.add_given("--environment", environment.starts_with("image:") ? "IMAGE" : environment);
  if (!environment.empty()) {
    command.add("--environment-scale", recipe.scene.environment_scale.value_or(1.0));
    if (recipe.scene.environment_rotation_deg != 0.0) {
      command.add("--environment-rotation", recipe.scene.environment_rotation_deg);
    }
  }
  if (recipe.scene.rig != Rig::Auto) command.add("--rig", rig_name(recipe.scene.rig));
  if (recipe.scene.rig_time_s) command.add("--rig-time", *recipe.scene.rig_time_s);
  if (recipe.scene.emissive_light != LightsOthers::Auto) {
    command.add("--emissive-light", emissive_light_name(recipe.scene.emissive_light));
  }
  command.add_given("--aov", fmt::format("{}", fmt::join(settings.aovs, ",")));
  command.add_given("--freeze", causes_text(settings.frozen));
  command.add_given("--white", recipe.development.white);
  command.add_given("--adaptation", recipe.development.adaptation);
  if (settings.uplift != RenderSettings{}.uplift) {
    command.add("--uplift", uplift_name(settings.uplift));
  }
  command.add_given("--camera", recipe.scene.camera);
  command.add_flag("--drop", settings.drop);
  command.add_flag("--multiple-scattering", settings.multiple_scattering);
  add_form(recipe, command);
  return command.text();
}

}  // namespace abbe
