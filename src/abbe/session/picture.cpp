#include "abbe/session/picture.h"

#include <utility>

namespace abbe {

LitWorld make_lit_world(const PreparedScene& prepared, const RenderSettings& settings,
                        const Standards& standards, Notes& notes,
                        const DevelopmentOptions& development) {
  check_settings(settings);
  WorldOptions options = world_options(settings);
  options.development = development;
  return make_lit_world(prepared.scene, options, caustic_options(settings), standards.observer,
                        standards.d65, notes);
}

Image developed_picture(const Film& film, const World& world, const PreparedScene& prepared,
                        std::map<std::string, Attribute> provenance, bool is_complete) {
  Image image = film.develop({.xyz_to_rec709 = world.lanes.film_to_rec709()});
  image.attributes = std::move(provenance);
  image.attributes["abbe:complete"] = is_complete ? 1 : 0;
  image.id_names = id_names(prepared.scene, image);
  return image;
}

Picture render_picture(const PreparedScene& prepared, const RenderSettings& settings,
                       const Standards& standards, Notes& notes,
                       const DevelopmentOptions& development, const ProgressCallback& progress,
                       const CancelFlag* cancel) {
  check_settings(settings);
  const ThreadLimit threads(settings.threads);
  const LitWorld world = make_lit_world(prepared, settings, standards, notes, development);
  Film film(film_options(settings));
  const RenderResult result =
      render(world, prepared.chosen_camera(), settings, film, progress, cancel);
  return {
      developed_picture(film, world, prepared,
                        provenance(prepared, settings, development, standards), result.complete),
      result};
}

bool render_file(const Recipe& recipe, const PreparedScene& prepared, const Standards& standards,
                 const std::filesystem::path& file, Notes& notes, const CancelFlag* cancel) {
  const DevelopmentOptions development =
      development_options(recipe.development, standards, &prepared);
  Picture picture =
      render_picture(prepared, recipe.settings, standards, notes, development, {}, cancel);
  if (!picture.result.complete) return false;
  write_exrs_in(recipe.color_space, {file}, std::move(picture.image), recipe.form);
  return true;
}

}  // namespace abbe
