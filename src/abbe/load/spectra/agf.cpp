// Zemax's glass catalogues. A glass begins with NM; CD has its coefficients, LD its range in µm,
// and each IT line a wavelength in µm, an internal transmittance and a thickness in mm.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/base/error.h"
#include "abbe/load/spectra/foreign.h"
#include "abbe/load/spectra/tabulated_formula.h"
#include "abbe/load/spectra/text.h"
#include "abbe/optics/absorption.h"

namespace abbe {
namespace {

// Zemax also writes UTF-16; what is not ASCII stands only in comments.
std::string ascii_of(std::string_view text) {
  const bool is_utf16_le = text.starts_with("\xff\xfe"), is_utf16_be = text.starts_with("\xfe\xff");
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  if (!is_utf16_le && !is_utf16_be) return std::string(text);
  std::string result;
  for (std::size_t i = 2; i + 1 < text.size(); i += 2) {
    const char low = text[is_utf16_le ? i : i + 1], high = text[is_utf16_le ? i + 1 : i];
    result += high == 0 && static_cast<unsigned char>(low) < 0x80 ? low : '?';
  }
  return result;
}

struct AgfGlass {
  std::string where;  // Of its NM line.
  int formula = 0;
  double n_d = 0.0, V_d = 0.0;
  std::vector<double> coefficients;
  double range_min_um = 0.0, range_max_um = 0.0;
  std::string comment;
  std::vector<double> wavelengths_nm, absorption_per_m;
};

void read_transmittance(const std::vector<std::string_view>& words, const std::string& where,
                        AgfGlass& glass) {
  const std::vector<double> numbers = numbers_of(words, 1, where);
  // Some catalogues leave thickness, or all but the wavelength, out where nothing was measured.
  if (numbers.size() < 3) return;
  const double nm = numbers[0] * 1e3, transmittance = numbers[1], thickness_m = numbers[2] * 1e-3;
  if (!(transmittance >= 0.0 && transmittance <= 1.0)) {
    throw_input_error(where, fmt::format("an internal transmittance of {}", transmittance),
                      "0 to 1");
  }
  if (!(nm > 0.0) || !(thickness_m > 0.0)) {
    throw_input_error(where, fmt::format("{} um through {} mm", numbers[0], numbers[2]),
                      "a wavelength in um and a thickness in mm, above 0");
  }
  add_rising(nm, where, glass.wavelengths_nm);
  // + 0.0 so that a transmittance of 1 is not −0.
  glass.absorption_per_m.push_back(
      std::min(-std::log(transmittance) / thickness_m + 0.0, kLargestAbsorption_per_m));
}

SellmeierFormula sellmeier_of(const std::vector<double>& c, std::size_t terms) {
  SellmeierFormula formula;
  for (std::size_t i = 0; i < terms; ++i) {
    formula.B.push_back(c[2 * i]);
    formula.C.push_back(c[2 * i + 1]);
  }
  return formula;
}

PolynomialFormula polynomial_of(const std::vector<double>& c, std::vector<double> powers) {
  return {
      c[0], {c.begin() + 1, c.begin() + 1 + static_cast<std::ptrdiff_t>(powers.size())}, powers};
}

// Source: Zemax OpticStudio manual, Glass dispersion formulas; λ in µm.
Dispersion formula_of(const AgfGlass& glass) {
  std::vector<double> c = glass.coefficients;
  if (c.empty()) throw_input_error(glass.where, "no coefficients", "a line CD");
  constexpr std::size_t kMost = 12;
  c.resize(std::max(c.size(), kMost), 0.0);
  switch (glass.formula) {
    case 1:  // Schott.
      return polynomial_of(c, {2.0, -2.0, -4.0, -6.0, -8.0});
    case 2:  // Sellmeier 1.
      return sellmeier_of(c, 3);
    case 3:  // Herzberger.
      return herzberger(c);
    case 4:  // Sellmeier 2: n² = 1 + A + B1 λ²/(λ² − λ1²) + B2/(λ² − λ2²).
      return RefractiveIndexInfoFormula4{{1.0 + c[0], c[1], 2.0, c[2], 2.0, c[3], 0.0, c[4], 2.0}};
    case 5:  // Conrady.
      return CauchyFormula{c[0], {c[1], c[2]}, {-1.0, -3.5}};
    case 6:  // Sellmeier 3.
      return sellmeier_of(c, 4);
    case 7:  // Handbook 1: n² = A + B/(λ² − C) − D λ².
      return RefractiveIndexInfoFormula4{
          {c[0], c[1], 0.0, c[2], 1.0, 0.0, 0.0, 0.0, 1.0, -c[3], 2.0}};
    case 8:  // Handbook 2: n² = A + B λ²/(λ² − C) − D λ².
      return RefractiveIndexInfoFormula4{
          {c[0], c[1], 2.0, c[2], 1.0, 0.0, 0.0, 0.0, 1.0, -c[3], 2.0}};
    case 9:  // Sellmeier 4: n² = A + B λ²/(λ² − C) + D λ²/(λ² − E).
      return SellmeierFormula{c[0] - 1.0, {c[1], c[3]}, {c[2], c[4]}};
    case 10:  // Extended.
      return polynomial_of(c, {2.0, -2.0, -4.0, -6.0, -8.0, -10.0, -12.0});
    case 11:  // Sellmeier 5.
      return sellmeier_of(c, 5);
    case 12:  // Extended 2.
      return polynomial_of(c, {2.0, -2.0, -4.0, -6.0, -8.0, 4.0, 6.0});
    case 13:  // Extended 3.
      return polynomial_of(c, {2.0, 4.0, -2.0, -4.0, -6.0, -8.0, -10.0, -12.0});
    default:
      throw_input_error(glass.where, fmt::format("formula {}", glass.formula), "formula 1 to 13");
  }
}

}  // namespace

std::vector<std::string> names_in_agf(std::string_view text) {
  const std::string ascii = ascii_of(text);
  std::vector<std::string> names;
  for (const std::string_view line : lines_of(ascii)) {
    const std::vector<std::string_view> words = words_of(line);
    if (words.size() > 1 && words[0] == "NM") names.emplace_back(words[1]);
  }
  return names;
}

CatalogueEntry read_agf_glass(std::string_view text, const std::string& file,
                              const std::string& glass_name, const std::string& id) {
  const std::string ascii = ascii_of(text);
  AgfGlass glass;
  bool is_inside = false;
  std::size_t number = 0;
  for (const std::string_view line : lines_of(ascii)) {
    const std::string where = fmt::format("{}:{}", file, ++number);
    const std::vector<std::string_view> words = words_of(line);
    if (words.empty()) continue;
    if (words[0] == "NM") {
      if (is_inside) break;
      is_inside = words.size() > 1 && words[1] == glass_name;
      if (!is_inside) continue;
      glass.where = where;
      if (words.size() < 6) {
        throw_input_error(where, fmt::format("{} words", words.size()),
                          "NM, name, formula, code, n_d and V_d");
      }
      const std::vector<double> numbers = numbers_of({words[2], words[4], words[5]}, 0, where);
      glass.formula = static_cast<int>(std::clamp(numbers[0], 0.0, 99.0));
      glass.n_d = numbers[1];
      glass.V_d = numbers[2];
    }
    if (!is_inside) continue;
    if (words[0] == "GC") glass.comment = std::string(line.substr(2));
    if (words[0] == "CD") glass.coefficients = numbers_of(words, 1, where);
    if (words[0] == "LD") {
      const std::vector<double> range = numbers_of(words, 1, where);
      if (range.size() < 2 || !(range[0] > 0.0 && range[0] < range[1])) {
        throw_input_error(where, "\"" + std::string(line) + "\"", "a rising range in um");
      }
      glass.range_min_um = range[0];
      glass.range_max_um = range[1];
    }
    if (words[0] == "IT") read_transmittance(words, where, glass);
  }
  if (!is_inside) {
    throw_input_error(file, "no glass \"" + glass_name + "\"", "one of the catalogue, nearest",
                      nearest_names(glass_name, names_in_agf(text)));
  }
  if (!(glass.range_max_um > 0.0)) throw_input_error(glass.where, "no range", "a line LD");

  CatalogueEntry entry;
  entry.id = id;
  entry.quantity = "index";
  entry.unit = "1";
  entry.name = glass_name;
  entry.source = "Zemax catalogue " + std::filesystem::path(file).filename().string();
  entry.licence = "the user's own file";
  entry.note = glass.comment;
  entry.range_min_nm = glass.range_min_um * 1e3;
  entry.range_max_nm = glass.range_max_um * 1e3;
  entry.dispersion = formula_of(glass);
  entry.n_d = glass.n_d;
  entry.V_d = glass.V_d;
  if (!glass.wavelengths_nm.empty()) {
    entry.absorption =
        Spectrum::tabulated(glass.wavelengths_nm, glass.absorption_per_m, OutsideTable::Clamp);
  }
  return entry;
}

}  // namespace abbe
