#include "abbe/load/gltf/film.h"

#include <fmt/format.h>

#include "abbe/base/constants.h"
#include "abbe/base/error.h"
#include "abbe/load/spectra/range_notes.h"

namespace abbe::gltf {
namespace {

// Past a tenth of a millimetre no eye and no lane resolves the fringes, nor does single precision.
constexpr Range kThickness_nm{0.0, 1e5};
constexpr Range kIndex{1.0, 1000.0};

// An id or a file of a dielectric, or a curve written in the scene.
void read_index(const Fields& film, Document& document, Spectra& spectra,
                const std::string& material, ThinFilm& out) {
  const Json& value = film.at("ior");
  const std::string pointer = film.pointer("ior");
  out.index_id.clear();
  const bool is_plain_table =
      value.is_string() && std::filesystem::path(value.get<std::string>()).extension() == ".csv";
  if (value.is_string() && !is_plain_table) {
    const CatalogueEntry entry = spectra.entry(value.get<std::string>(), pointer);
    if (!entry.dispersion) {
      throw_input_error(document.where(pointer), fmt::format("{} ({})", entry.id, entry.quantity),
                        "the index of a film that does not absorb");
    }
    out.index = *entry.dispersion;
    out.index_id = entry.id;
    out.index_range_nm = Vec2d(entry.range_min_nm, entry.range_max_nm);
    warn_of_range(entry, material, document.where(pointer), document.notes());
    return;
  }
  if (value.is_number()) {
    out.index = ConstantIndex{film.required_number("ior", kIndex)};
    return;
  }
  const Spectrum n = spectra.read(value, pointer, SpectrumUse::Index).spectrum;
  if (!(n.value(kLine_d_nm) >= kIndex.low)) {
    throw_input_error(document.where(pointer),
                      fmt::format("an index of {:g} at {} nm", n.value(kLine_d_nm), kLine_d_nm),
                      "at least 1");
  }
  out.index = TabulatedIndex{n};
}

}  // namespace

void read_iridescence(const Fields& extensions, Document& document, Textures& textures,
                      Material& material) {
  const auto extension = extensions.object("KHR_materials_iridescence");
  if (!extension) return;
  ThinFilm film;
  film.factor = static_cast<float>(extension->limited("iridescenceFactor", 0.0, {0.0, 1.0}));
  film.factor_texture = textures.use(*extension, "iridescenceTexture");
  film.index = ConstantIndex{extension->number("iridescenceIor", 1.3, kIndex)};
  film.thickness_min_nm =
      static_cast<float>(extension->number("iridescenceThicknessMinimum", 100.0, kThickness_nm));
  film.thickness_max_nm =
      static_cast<float>(extension->number("iridescenceThicknessMaximum", 400.0, kThickness_nm));
  film.thickness_texture = textures.use(*extension, "iridescenceThicknessTexture");
  if (film.thickness_texture && film.thickness_min_nm > film.thickness_max_nm) {
    document.notes().warn(extension->where("iridescenceThicknessMinimum"),
                          "the minimum exceeds the maximum: the film is thinner where the texture "
                          "is brighter");
  }
  if (film.factor > 0.0f) material.film = film;
}

void apply_abbe_film(const Fields& film, Document& document, Spectra& spectra, Material& material) {
  film.only({"ior", "thickness_nm"});
  if (!material.film) {
    for (const char* name : {"ior", "thickness_nm"}) {
      if (film.has(name)) continue;
      throw_input_error(film.where(name), "nothing",
                        std::string(name) == "ior"
                            ? "the index of the film: a number, [[nm, n], ...] or an id"
                            : "the thickness of the film in nm");
    }
    material.film = ThinFilm{};
  }
  if (film.has("ior")) read_index(film, document, spectra, material.name, *material.film);
  if (film.has("thickness_nm")) {
    material.film->thickness_max_nm =
        static_cast<float>(film.required_number("thickness_nm", kThickness_nm));
    material.film->thickness_min_nm = material.film->thickness_max_nm;
    material.film->thickness_texture.reset();
  }
}

}  // namespace abbe::gltf
