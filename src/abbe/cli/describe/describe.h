/// What was understood of a scene, an image or a spectrum, as data; printed as text or as JSON.
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "abbe/base/notes.h"
#include "abbe/color/lamp/daylight.h"
#include "abbe/load/spectra/catalogue.h"
#include "abbe/scene/scene.h"
#include "abbe/session/prepare.h"

namespace abbe {

using Description = nlohmann::ordered_json;

/// `[x, y, z]`.
Description triple(const Vec3d& v);

/// Cameras, lights, materials, meshes, shapes, textures, bounds, and what was ignored.
Description describe_scene(const PreparedScene& prepared, Notes& notes);

/// One material: its kind, colour, glass or metal. Approximations it needs become notes.
Description describe_material(const Material& material, Notes& notes);

/// One light with its spectrum and units.
Description describe_light(const Light& light, const Vec3d& origin_m);

/// Size, channels and provenance of an EXR; size and channels of other images.
Description describe_image(const std::filesystem::path& file);

/// A float as the shortest decimal that is the same float: 0.3, not 0.30000001192092896.
double short_decimal(float value);

/// What a spectrum is among others: the folder of the catalogue that holds it ("glass", "metal"),
/// or its quantity when it lies in none.
std::string kind_of(const CatalogueEntry& entry);

/// How a spectrum is looked at.
struct SpectrumView {
  Observer observer;    ///< CIE 1931.
  std::string lamp_id;  ///< Of the lamp under which a reflectance has its colour.
  Spectrum lamp;
  std::vector<double> at_nm;  ///< Wavelengths at which values are wanted as well.
  DaylightComponents daylight;
  std::array<Spectrum, 14> test_colors;  ///< Of CIE's colour rendering indices.
};

/// One file of the catalogue: source, range, and the numbers that suit its quantity.
Description describe_spectrum(const CatalogueEntry& entry, const SpectrumView& view);

}  // namespace abbe
