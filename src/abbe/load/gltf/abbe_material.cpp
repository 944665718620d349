#include <fmt/format.h>

#include "abbe/base/constants.h"
#include "abbe/base/error.h"
#include "abbe/load/gltf/document/check.h"
#include "abbe/load/gltf/film.h"
#include "abbe/load/gltf/materials.h"
#include "abbe/load/spectra/range_notes.h"

namespace abbe::gltf {
namespace {

Dispersion read_sellmeier(const Fields& fields) {
  fields.only({"A", "B", "C"});
  SellmeierFormula formula{fields.number("A", 0.0, {-1e3, 1e3}),
                           fields.numbers("B", 1, 16, {-1e6, 1e6}),
                           fields.numbers("C", 1, 16, {-1e6, 1e6})};
  if (formula.B.size() != formula.C.size()) {
    throw_input_error(fields.where("C"), fmt::format("{} numbers", formula.C.size()),
                      fmt::format("as many as B has, {}", formula.B.size()));
  }
  return formula;
}

Dispersion read_cauchy(const Fields& fields) {
  fields.only({"A", "B", "C", "D"});
  CauchyFormula formula{fields.required_number("A", {0.0, 1e3}), {}, {}};
  double power = -2.0;
  for (const char* name : {"B", "C", "D"}) {
    const double coefficient = fields.number(name, 0.0, {-1e3, 1e3});
    if (coefficient != 0.0) {
      formula.c.push_back(coefficient);
      formula.p.push_back(power);
    }
    power -= 2.0;
  }
  return formula;
}

// A formula typed in by hand is easily off by a unit (nm² for µm²): look at what it gives.
void check_plausible(const Dispersion& dispersion, const std::string& where) {
  constexpr double kLargestPlausible = 5.0;
  for (const double wavelength_nm : {kLineF_nm, kLine_d_nm, kLineC_nm}) {
    const double n = refractive_index(dispersion, wavelength_nm);
    if (!(n > 1.0 && n <= kLargestPlausible)) {
      throw_input_error(where, fmt::format("an index of {:g} at {} nm", n, wavelength_nm),
                        "above 1 and at most 5 (lengths in µm)");
    }
  }
}

void read_dispersion(Document& document, const Fields& fields, Spectra& spectra,
                     Material& material) {
  fields.only({"glass", "sellmeier", "cauchy", "abbe"});
  int given = 0;
  for (const char* name : {"glass", "sellmeier", "cauchy", "abbe"}) given += fields.has(name);
  if (given != 1) {
    throw_input_error(document.where(fields.pointer()), fmt::format("{} formulas", given),
                      "exactly one", {"glass", "sellmeier", "cauchy", "abbe"});
  }
  if (fields.has("glass")) {
    const CatalogueEntry entry =
        spectra.entry(fields.required_text("glass"), fields.pointer("glass"));
    if (!entry.dispersion) {
      throw_input_error(fields.where("glass"), fmt::format("{} ({})", entry.id, entry.quantity),
                        "the index of a glass");
    }
    material.index = *entry.dispersion;
    material.index_id = entry.id;
    // Measured with the glass; an `absorption` of the material replaces it.
    if (entry.absorption) material.absorption_per_m = *entry.absorption;
    material.index_range_nm = Vec2d(entry.range_min_nm, entry.range_max_nm);
    warn_of_range(entry, material.name, fields.where("glass"), document.notes());
    return;
  }
  if (const auto formula = fields.object("sellmeier")) {
    material.index = read_sellmeier(*formula);
    check_plausible(material.index, fields.where("sellmeier"));
    warn_of_pole(material.index, material.name, fields.where("sellmeier"), document.notes());
  } else if (const auto cauchy = fields.object("cauchy")) {
    material.index = read_cauchy(*cauchy);
    check_plausible(material.index, fields.where("cauchy"));
    warn_of_pole(material.index, material.name, fields.where("cauchy"), document.notes());
  } else if (const auto abbe = fields.object("abbe")) {
    abbe->only({"nd", "vd"});
    material.index =
        cauchy_through(abbe->required_number("nd", {1.0, 5.0}), abbe->required_number("vd", {1.0}));
  }
}

Conductor read_conductor(Document& document, const Fields& extension, const std::string& material,
                         Spectra& spectra) {
  const Json& value = extension.at("conductor");
  const std::string pointer = extension.pointer("conductor");
  if (value.is_string()) {
    const CatalogueEntry entry = spectra.entry(value.get<std::string>(), pointer);
    if (!entry.n || !entry.k) {
      throw_input_error(document.where(pointer), fmt::format("{} ({})", entry.id, entry.quantity),
                        "the complex index of a metal");
    }
    warn_of_range(entry, material, document.where(pointer), document.notes());
    return {entry.id, *entry.n, *entry.k, Vec2d(entry.range_min_nm, entry.range_max_nm)};
  }
  const Fields fields(document, value, pointer);
  fields.only({"n", "k"});
  if (!fields.has("n") || !fields.has("k")) {
    throw_input_error(document.where(pointer), "no \"n\" or no \"k\"", "both");
  }
  return {"", spectra.read(fields, "n", SpectrumUse::Index).spectrum,
          spectra.read(fields, "k", SpectrumUse::Extinction).spectrum};
}

// `light` may stand alone, beside an emission that glTF's own members describe.
void read_emission(const Fields& emission, Spectra& spectra, Material& material) {
  emission.only({"spectrum", "luminance", "light"});
  if (emission.has("light")) {
    const Json& light = emission.at("light");
    if (!light.is_boolean()) {
      throw_input_error(emission.where("light"), describe(light), "true or false");
    }
    material.lights_others = light.get<bool>() ? LightsOthers::Yes : LightsOthers::No;
    if (!emission.has("luminance") && !emission.has("spectrum")) return;
  }
  SpectralEmission result;
  result.luminance_cd_per_m2 = emission.required_number("luminance", {0.0, 1e12});
  result.spectrum = spectra.lamp(emission);
  material.emission = std::move(result);
}

}  // namespace

void apply_abbe_material(Document& document, const Fields& extension, const Json& source,
                         Spectra& spectra, Material& material) {
  extension.only({"dispersion", "conductor", "reflectance", "emission", "absorption", "ambient",
                  "film", "priority"});
  const Json* pbr = find(&source, "pbrMetallicRoughness");
  const bool states_roughness = find(pbr, "roughnessFactor") != nullptr;
  const bool states_metallic = find(pbr, "metallicFactor") != nullptr;

  if (extension.has("dispersion") && extension.has("conductor")) {
    throw_input_error(document.where(extension.pointer()), "dispersion and conductor",
                      "one of them");
  }
  if (const auto dispersion = extension.object("dispersion")) {
    read_dispersion(document, *dispersion, spectra, material);
    material.index_is_infinite = false;
    material.transmission = 1.0f;
    material.has_volume = true;
    if (!states_metallic) material.metallic = 0.0f;
    if (!states_roughness) material.roughness = 0.0f;
  }
  if (extension.has("conductor")) {
    material.conductor = read_conductor(document, extension, material.name, spectra);
    material.metallic = 1.0f;
    if (!states_roughness) material.roughness = 0.0f;
  }
  if (extension.has("reflectance")) {
    material.reflectance = spectra.read(extension, "reflectance", SpectrumUse::Reflectance);
  }
  if (const auto emission = extension.object("emission")) {
    read_emission(*emission, spectra, material);
  }
  if (extension.has("absorption")) {
    material.absorption_per_m =
        spectra.read(extension, "absorption", SpectrumUse::Absorption).spectrum;
  }
  if (const auto film = extension.object("film")) {
    apply_abbe_film(*film, document, spectra, material);
  }
  if (extension.has("ambient")) {
    material.ambient_factor = extension.limited("ambient", 0.0, {0.0, 1.0});
  }
  material.priority = extension.integer<std::int16_t>("priority", material.priority);
}

}  // namespace abbe::gltf
