#include "abbe/cli/development_options.h"

#include <fmt/format.h>

#include "abbe/base/error.h"
#include "abbe/cli/options.h"
#include "abbe/cli/parse.h"
#include "abbe/load/spectra/observer_file.h"
#include "abbe/world/scene_white.h"

namespace abbe {
namespace {

std::optional<Vec2d> chromaticity_in(const std::string& text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos) return std::nullopt;
  const auto x = number_of(text.substr(0, comma));
  const auto y = number_of(text.substr(comma + 1));
  if (!x || !y || !(*x > 0.0) || !(*y > 0.0) || *x + *y > 1.0) {
    throw_usage_error("--white", "\"" + text + "\"", "x,y of a colour, as in 0.3127,0.3290");
  }
  return Vec2d(*x, *y);
}

White white_named(const std::string& name, const Catalogue& catalogue, const Standards& standards,
                  const PreparedScene* scene) {
  if (const auto xy = chromaticity_in(name)) {
    return {fmt::format("{},{}", xy->x, xy->y), {}, *xy};
  }
  if (name == "scene") {
    if (scene == nullptr) {
      throw_usage_error("--white", "scene, of an image", "a light by name, or x,y",
                        {"D65", "A", "illuminant ids"});
    }
    return scene_white(scene->scene, scene->bounds, standards.d65, standards.observer);
  }
  std::vector<std::string> choices;
  for (const std::string& id : catalogue.ids()) {
    if (!id.starts_with("illuminant/")) continue;
    if (id == name || id == "illuminant/" + name) {
      return {id, {{catalogue.illuminant(id), 1.0}}, std::nullopt};
    }
    choices.push_back(id.substr(std::string("illuminant/").size()));
  }
  throw_usage_error("--white", "\"" + name + "\"",
                    "scene, a chromaticity x,y, or an illuminant, of which these are nearest",
                    nearest_names(name, choices));
}

}  // namespace

void add_development_options(CLI::App& command, DevelopmentArguments& arguments) {
  add_shown(command, "--observer", arguments.observer, "NAME|FILE.csv",
            "whose eyes the colours are for: cie1931, cie1964, or a camera's three sensitivities "
            "(default: cie1931)");
  add_shown(command, "--white", arguments.white, "NAME|scene|x,y",
            "the light that looks neutral: D65, A or another illuminant, the scene's own, or a "
            "chromaticity (default: D65)");
  add_shown(command, "--adaptation", arguments.adaptation, "NAME",
            "how that white is adapted to D65: cat16, bradford or none (default: cat16)");
}

DevelopmentOptions development_options(const DevelopmentArguments& arguments,
                                       const Catalogue& catalogue, const Standards& standards,
                                       const PreparedScene* scene) {
  DevelopmentOptions options;
  if (!arguments.observer.empty()) {
    options.observer =
        observer_named(arguments.observer, catalogue, standards.observer, standards.d65);
  }
  if (!arguments.white.empty()) {
    options.white = white_named(arguments.white, catalogue, standards, scene);
  }
  if (!arguments.adaptation.empty()) {
    options.adaptation = adaptation_from_name(arguments.adaptation);
  }
  return options;
}

std::map<std::string, Attribute> development_attributes(const DevelopmentOptions& options,
                                                        const Standards& standards) {
  const Observer& observer = options.observer ? *options.observer : standards.observer;
  std::map<std::string, Attribute> out;
  out["abbe:observer"] = fmt::format(
      "{}, integral of {} {:.6f} nm", observer.id,
      observer.responses_to_xyz == Mat3d(1.0) ? "y-bar" : "channel 2", integral(observer.y_bar));
  out["abbe:white"] = options.white ? options.white->name : std::string("illuminant/D65");
  out["abbe:adaptation"] = adaptation_name(options.adaptation) +
                           (options.adaptation == Adaptation::None ? "" : " to xy 0.3127, 0.3290");
  return out;
}

}  // namespace abbe
