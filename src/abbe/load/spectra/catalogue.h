/// The catalogue of measured spectra: files under spectra/, found by id.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "abbe/base/notes.h"
#include "abbe/optics/dispersion.h"
#include "abbe/spectrum/observer.h"
#include "abbe/spectrum/spectrum.h"

namespace abbe {

/// One file of the catalogue. Which of the data members is set follows from `quantity`.
struct CatalogueEntry {
  std::string id;
  std::string quantity;  ///< "observer", "emission", "index", "complex index", "reflectance", ...
  std::string unit;      ///< "1", "relative", "W/(m2 sr nm)", "1/m".
  std::string name, source, doi, licence, note;
  double range_min_nm = 0.0, range_max_nm = 0.0;
  bool is_default = false;  ///< Of several papers on one metal: metal/Au is metal/Au-Johnson.
  std::optional<Spectrum> spectrum;      ///< One curve: emission, reflectance, absorption.
  std::optional<Dispersion> dispersion;  ///< Index of a dielectric.
  std::optional<Spectrum> n, k;          ///< Complex index; a dielectric's if it was tabulated.
  std::optional<Spectrum> absorption;    ///< In m⁻¹, of a dielectric of which it is known.
  std::optional<double> n_d, V_d;        ///< As the maker's catalogue states them.
  std::optional<Observer> observer;
};

/// Where spectra are looked for. A .txt, .csv, .yml or .yaml file is one spectrum, its id the path
/// without the suffix; of an .agf file each glass is one, as in SCHOTT/N-BK7 of SCHOTT.AGF. A
/// number makes `daylight/6504` and `blackbody/2856`.
class Catalogue {
 public:
  /// Folders, first match wins: ABBE_SPECTRA_PATH (colon separated), spectra/ beside the binary or
  /// up to two folders above it, the install prefix's share/abbe/spectra, the source tree.
  /// Errors: input Error when none of them exists.
  static Catalogue standard();
  explicit Catalogue(std::vector<std::filesystem::path> folders);

  /// What stands in the folders and cannot be read.
  const Notes& notes() const { return notes_; }

  /// All ids, sorted; those that a number makes are not among them.
  const std::vector<std::string>& ids() const { return ids_; }
  /// The full id for an id or a unique tail of one: "SF10" for glass/schott/SF10. A tail begins at
  /// a slash, so "SF10" is not one of N-SF10; "Au" stands for the default among Au-Johnson, ...
  /// Errors: input Error at `where` when unknown (nearest names) or ambiguous (candidates).
  std::string resolve(const std::string& id_or_tail, const std::string& where) const;
  /// Reads and checks the file of an id or unique tail.
  CatalogueEntry entry(const std::string& id_or_tail, const std::string& where) const;

  /// Shorthands that also check the quantity.
  Observer observer(const std::string& id = "observer/cie1931-2deg") const;
  Spectrum illuminant(const std::string& id) const;

 private:
  std::vector<std::filesystem::path> folders_;
  std::optional<std::string> default_of(const std::string& id_or_tail) const;
  void add(const std::filesystem::path& file, const std::filesystem::path& folder);

  std::vector<std::string> ids_;
  Notes notes_;
  struct Place {
    std::filesystem::path file;
    std::string glass;  ///< In an AGF catalogue of many.
  };
  std::map<std::string, Place> places_;
};

/// Whether a name is a file and no id: it has a suffix of letters, or the marks of a path.
bool is_spectrum_path(const std::string& name);

/// Reads one file: in the catalogue's format, or by its suffix a refractiveindex.info .yml or
/// .yaml, a plain .csv, or of a Zemax .agf catalogue the glass named (its only one, if it is not).
/// Errors: input Error with file and line.
CatalogueEntry read_spectrum_file(const std::filesystem::path& file, const std::string& id,
                                  const std::string& glass = "");

}  // namespace abbe
