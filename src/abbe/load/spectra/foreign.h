/// Spectra in the formats that others publish them in.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "abbe/load/spectra/catalogue.h"

namespace abbe {

/// A file of refractiveindex.info: formulas 1 to 9, tabulated n, k and nk; lengths in µm. Formulas
/// 6 to 9 are tabulated at 0.25 nm within 360 to 830 nm. A table of n and k in which k stays below
/// 0.01 is a dielectric's; its k, or one beside a formula, becomes an absorption 4πk/λ.
/// Errors: input Error with file and line.
CatalogueEntry read_refractiveindex_yaml(std::string_view text, const std::string& file,
                                         const std::string& id);

/// What a plain table is when nothing says: its use decides.
inline constexpr const char* kPlainTable = "table";

/// A plain table: lines of a wavelength in nm and a value (comma, semicolon, tab or blank between;
/// # starts a comment). A first line of words may name the quantity in its second column: emission,
/// reflectance, transmittance or absorption (1/m); so may the first folder of the id.
/// Errors: input Error with file and line, for values the quantity cannot have, falling or no
///         wavelengths, and a table with none of them within 360 to 830 nm.
CatalogueEntry read_csv_spectrum(std::string_view text, const std::string& file,
                                 const std::string& id);

/// Names of the glasses of a Zemax AGF catalogue, in its order. UTF-16 is understood.
std::vector<std::string> names_in_agf(std::string_view text);

/// One glass of a Zemax AGF catalogue: formulas 1 to 13; internal transmittance (IT) becomes an
/// absorption −ln(T)/thickness.
/// Errors: input Error with file and line; with the nearest names when the glass is not there.
CatalogueEntry read_agf_glass(std::string_view text, const std::string& file,
                              const std::string& glass, const std::string& id);

}  // namespace abbe
