/// Whether what a render is given was made for its settings.
#pragma once

#include "abbe/caustics/lit_world.h"
#include "abbe/film/film.h"
#include "abbe/render/settings.h"
#include "abbe/scene/scene.h"

namespace abbe {

/// Checks settings, camera, world and film, and that the world was made by world_options and
/// caustic_options, the film by film_options, of these settings.
/// Errors: as check_settings and validate; a usage Error that names the first part that differs,
///         with what was found and what the settings have.
void check_agreement(const LitWorld& world, const Camera& camera, const RenderSettings& settings,
                     const Film& film);

}  // namespace abbe
