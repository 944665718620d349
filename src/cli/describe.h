/// What was understood of a scene, an image or a spectrum, as data; printed as text or as JSON.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/notes.h"
#include "cli/prepare.h"
#include "load/catalogue.h"
#include "scene/scene.h"

namespace abbe {

using Description = nlohmann::ordered_json;

/// Cameras, lights, materials, meshes, shapes, textures, bounds, and what was ignored.
Description describe_scene(const PreparedScene& prepared, const Catalogue& catalogue, Notes& notes);

/// One material: its kind, colour, glass or metal. Approximations it needs become notes.
Description describe_material(const Material& material, const Catalogue& catalogue, Notes& notes);

/// One light with its spectrum and units.
Description describe_light(const Light& light);

/// Size, channels and provenance of an EXR; size and channels of other images.
Description describe_image(const std::filesystem::path& file);

/// A float as the shortest decimal that is the same float: 0.3, not 0.30000001192092896.
double short_decimal(float value);

/// One file of the catalogue.
Description describe_spectrum(const CatalogueEntry& entry);

}  // namespace abbe
