/// Spectra as a scene may write them: an id of the catalogue, a path, a number or a table.
#pragma once

#include <string>

#include "abbe/load/gltf/document/fields.h"
#include "abbe/load/spectra/catalogue.h"
#include "abbe/scene/scene.h"

namespace abbe::gltf {

/// What a spectrum is wanted for; decides which values and catalogue entries make sense.
enum class SpectrumUse {
  Emission,     ///< At least 0; 0 outside its table.
  Reflectance,  ///< 0 to 1.
  Absorption,   ///< m⁻¹, at least 0.
  Index,        ///< n of a metal, above 0.
  Extinction,   ///< k of a metal, at least 0.
};

/// Reads what the ABBE_ extensions call a spectrum.
class Spectra {
 public:
  Spectra(Document& document, const Catalogue& catalogue)
      : document_(document), catalogue_(catalogue) {}

  /// An id, a path, a number or [[nm, value], ...]; for an emission also {blackbody: K} and
  /// {lines: [[nm, strength], ...]}.
  /// Errors: input Error with a JSON pointer, or with file and line inside a file.
  NamedSpectrum read(const Json& value, const std::string& pointer, SpectrumUse use);

  /// The same of a member, which must be there.
  NamedSpectrum read(const Fields& fields, const char* name, SpectrumUse use) {
    return read(fields.at(name), fields.pointer(name), use);
  }
  /// The member `spectrum`, an emission; D65, the illuminant of RGB white, where it is absent.
  NamedSpectrum lamp(const Fields& fields);

  /// The catalogue entry of an id, or of a file in the scene's folder: of the catalogue's format,
  /// of refractiveindex.info, a glass of a Zemax catalogue as FILE.agf#GLASS, or a plain table.
  CatalogueEntry entry(const std::string& id_or_path, const std::string& pointer);

 private:
  Spectrum read_table(const Json& table, const std::string& pointer, SpectrumUse use);
  Spectrum read_lines(const Json& lines, const std::string& pointer);
  Spectrum as_used(const Spectrum& table, const std::string& id, SpectrumUse use);
  NamedSpectrum read_name(const std::string& name, const std::string& pointer, SpectrumUse use);

  Document& document_;
  const Catalogue& catalogue_;
};

}  // namespace abbe::gltf
