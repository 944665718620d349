#include "abbe/session/development.h"

#include <fmt/format.h>

#include "abbe/base/error.h"
#include "abbe/base/text.h"
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
    throw_usage_error("white", "\"" + text + "\"", "x,y of a colour, as in 0.3127,0.3290");
  }
  return Vec2d(*x, *y);
}

White white_named(const std::string& name, const Standards& standards, const PreparedScene* scene) {
  const Catalogue& catalogue = standards.catalogue;
  if (const auto xy = chromaticity_in(name)) {
    return {fmt::format("{},{}", xy->x, xy->y), {}, *xy};
  }
  if (name == "scene") {
    if (scene == nullptr) {
      throw_usage_error("white", "scene, of an image", "a light by name, or x,y",
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
  throw_usage_error("white", "\"" + name + "\"",
                    "scene, a chromaticity x,y, or an illuminant, of which these are nearest",
                    nearest_names(name, choices));
}

}  // namespace

DevelopmentOptions development_options(const DevelopmentChoice& choice, const Standards& standards,
                                       const PreparedScene* scene) {
  DevelopmentOptions options;
  if (!choice.observer.empty()) {
    options.observer =
        observer_named(choice.observer, standards.catalogue, standards.observer, standards.d65);
  }
  if (!choice.white.empty()) {
    options.white = white_named(choice.white, standards, scene);
  }
  if (!choice.adaptation.empty()) {
    options.adaptation = adaptation_from_name(choice.adaptation);
  }
  return options;
}

void check_development(const DevelopmentChoice& choice, const Standards& standards) {
  if (choice.white != "scene") (void)development_options(choice, standards, nullptr);
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
