// The text format of the catalogue; spectra/README.md describes it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include "abbe/base/constants.h"
#include "abbe/base/error.h"
#include "abbe/base/file.h"
#include "abbe/base/text.h"
#include "abbe/load/spectra/catalogue.h"
#include "abbe/load/spectra/foreign.h"
#include "abbe/load/spectra/text.h"

namespace abbe {
namespace {

constexpr std::uint64_t kLargestFile = 16u << 20;
constexpr std::size_t kMaxRows = 100'000;
constexpr const char* kSignature = "abbe-spectrum 1";

const std::vector<std::string>& known_keys() {
  static const std::vector<std::string> keys{
      "quantity", "unit",  "wavelength", "name",    "source",  "doi",         "licence",
      "note",     "n_d",   "V_d",        "default", "formula", "A",           "B",
      "C_um",     "C_um2", "c0",         "c",       "p",       "coefficients"};
  return keys;
}

// A file taken apart into keys and rows, every part with its line for messages.
class Parser {
 public:
  Parser(const std::filesystem::path& file, std::string_view text) : file_(file.string()) {
    std::size_t line = 0;
    for (const std::string_view content : lines_of(text)) read_line(++line, content);
    if (!signature_seen_) fail(1, "an empty file", std::string("a line ") + kSignature);
  }

  [[noreturn]] void fail(std::size_t line, std::string found, std::string expected,
                         std::vector<std::string> choices = {}) const {
    throw_input_error(fmt::format("{}:{}", file_, line), std::move(found), std::move(expected),
                      std::move(choices));
  }

  bool has(const std::string& key) const { return keys_.contains(key); }
  std::size_t line_of(const std::string& key) const { return keys_.at(key).line; }
  std::string text(const std::string& key) const { return has(key) ? keys_.at(key).value : ""; }
  std::string required_text(const std::string& key) const {
    if (!has(key)) fail(1, "no key " + key, "a line " + key + ": ...");
    return keys_.at(key).value;
  }

  double number(std::size_t line, std::string_view word) const {
    const auto value = number_of(word);
    if (!value) fail(line, "\"" + std::string(word) + "\"", "a finite number");
    return *value;
  }

  std::vector<double> numbers(const std::string& key) const {
    std::vector<double> values;
    if (!has(key)) return values;
    for (const std::string_view word : words_of(keys_.at(key).value)) {
      values.push_back(number(line_of(key), word));
    }
    return values;
  }

  double required_number(const std::string& key) const {
    required_text(key);
    const std::vector<double> values = numbers(key);
    if (values.size() != 1) {
      fail(line_of(key), fmt::format("{} numbers", values.size()), "one number");
    }
    return values.front();
  }

  bool has_table() const { return columns_line_ > 0; }
  std::size_t columns_line() const { return columns_line_; }
  const std::vector<std::string>& columns() const { return columns_; }
  /// Column by column.
  const std::vector<std::vector<double>>& table() const { return table_; }
  std::size_t row_line(std::size_t row) const { return row_lines_[row]; }

 private:
  struct Entry {
    std::string value;
    std::size_t line = 0;
  };

  void read_line(std::size_t line, std::string_view content) {
    const std::vector<std::string_view> words = words_of(content);
    if (!signature_seen_) {
      if (content != kSignature) {
        fail(line, "\"" + std::string(content.substr(0, 40)) + "\"",
             std::string("a line ") + kSignature);
      }
      signature_seen_ = true;
    } else if (words.empty() || words.front().starts_with('#')) {
      return;
    } else if (has_table()) {
      read_row(line, words);
    } else {
      read_key(line, content);
    }
  }

  void read_key(std::size_t line, std::string_view content) {
    const std::size_t colon = content.find(':');
    const std::string key(content.substr(0, std::min(colon, content.size())));
    if (colon == std::string_view::npos) {
      fail(line, "\"" + key.substr(0, 40) + "\"", "key: value");
    }
    std::string_view value = content.substr(colon + 1);
    const std::size_t first = value.find_first_not_of(" \t");
    value = first == std::string_view::npos ? "" : value.substr(first);
    if (key == "columns") {
      columns_line_ = line;
      for (const std::string_view word : words_of(value)) columns_.emplace_back(word);
      table_.resize(columns_.size());
      return;
    }
    if (std::find(known_keys().begin(), known_keys().end(), key) == known_keys().end()) {
      fail(line, "key \"" + key + "\"", "a known key", nearest_names(key, known_keys()));
    }
    if (!keys_.emplace(key, Entry{std::string(value), line}).second) {
      fail(line, "key " + key + " again", "every key once");
    }
  }

  void read_row(std::size_t line, const std::vector<std::string_view>& words) {
    if (words.size() != columns_.size()) {
      fail(line, fmt::format("{} numbers", words.size()),
           fmt::format("{}, one for each column", columns_.size()));
    }
    if (row_lines_.size() == kMaxRows) {
      fail(line, "another row", fmt::format("at most {}", kMaxRows));
    }
    for (std::size_t i = 0; i < words.size(); ++i) table_[i].push_back(number(line, words[i]));
    row_lines_.push_back(line);
  }

  std::string file_;
  bool signature_seen_ = false;
  std::map<std::string, Entry> keys_;
  std::size_t columns_line_ = 0;
  std::vector<std::string> columns_;
  std::vector<std::vector<double>> table_;
  std::vector<std::size_t> row_lines_;
};

// What may follow the wavelength in a table of each quantity.
const std::map<std::string, std::vector<std::string>>& columns_by_quantity() {
  static const std::map<std::string, std::vector<std::string>> columns{
      {"observer", {"x y z"}},      {"emission", {"value", "strength"}}, {"reflectance", {"value"}},
      {"transmittance", {"value"}}, {"absorption", {"value"}},           {"index", {"n", "n k"}},
      {"complex index", {"n k"}},   {"daylight component", {"value"}},
  };
  return columns;
}

// What the values of each quantity may be counted in.
const std::vector<std::string>& units_of(const std::string& quantity) {
  static const std::vector<std::string> number{"1"}, per_metre{"1/m"}, relative{"relative"},
      power{"relative", "W/(m2 sr nm)"};
  if (quantity == "emission") return power;
  if (quantity == "absorption") return per_metre;
  return quantity == "daylight component" ? relative : number;
}

std::vector<std::string> names_of_quantities() {
  std::vector<std::string> names;
  for (const auto& [name, columns] : columns_by_quantity()) names.push_back(name);
  return names;
}

Dispersion formula_of(const Parser& parser) {
  const std::string formula = parser.required_text("formula");
  const auto same_length = [&parser](const std::vector<double>& first,
                                     const std::vector<double>& second, const std::string& key) {
    if (first.empty() || first.size() != second.size()) {
      parser.fail(parser.line_of("formula"),
                  fmt::format("{} coefficients and {} of {}", first.size(), second.size(), key),
                  "as many of both, and at least one");
    }
  };
  if (formula == "sellmeier") {
    SellmeierFormula result;
    if (parser.has("A")) result.A = parser.required_number("A");
    result.B = parser.numbers("B");
    if (parser.has("C_um") == parser.has("C_um2")) {
      parser.fail(parser.line_of("formula"), "a Sellmeier formula", "either C_um or C_um2");
    }
    result.C = parser.numbers(parser.has("C_um") ? "C_um" : "C_um2");
    if (parser.has("C_um")) {
      for (double& root_um : result.C) root_um *= root_um;
    }
    same_length(result.B, result.C, "C");
    return result;
  }
  if (formula == "polynomial" || formula == "cauchy") {
    const double c0 = parser.required_number("c0");
    const std::vector<double> c = parser.numbers("c"), p = parser.numbers("p");
    same_length(c, p, "p");
    if (formula == "polynomial") return PolynomialFormula{c0, c, p};
    return CauchyFormula{c0, c, p};
  }
  if (formula == "refractiveindex.info-4") {
    const std::vector<double> coefficients = parser.numbers("coefficients");
    if (coefficients.empty() || coefficients.size() > 17) {
      parser.fail(parser.line_of("formula"), fmt::format("{} coefficients", coefficients.size()),
                  "1 to 17");
    }
    return RefractiveIndexInfoFormula4{coefficients};
  }
  parser.fail(parser.line_of("formula"), "formula \"" + formula + "\"", "a known formula",
              {"sellmeier", "polynomial", "cauchy", "refractiveindex.info-4"});
}

// Checks the rows against the header and turns the wavelengths into nm.
std::vector<double> checked_wavelengths_nm(const Parser& parser, const CatalogueEntry& entry,
                                           double nm_per_unit) {
  std::string columns;
  for (std::size_t i = 1; i < parser.columns().size(); ++i) {
    columns += (i > 1 ? " " : "") + parser.columns()[i];
  }
  const std::vector<std::string>& allowed = columns_by_quantity().at(entry.quantity);
  const std::string unit = nm_per_unit == 1.0 ? "nm" : "um";
  if (parser.columns().empty() || parser.columns().front() != unit ||
      std::find(allowed.begin(), allowed.end(), columns) == allowed.end()) {
    std::vector<std::string> choices;
    choices.reserve(allowed.size());
    for (const std::string& choice : allowed) choices.push_back(fmt::format("{} {}", unit, choice));
    parser.fail(parser.columns_line(), "these columns", "those of a file of " + entry.quantity,
                choices);
  }
  std::vector<double> wavelengths_nm = parser.table().front();
  for (double& wavelength : wavelengths_nm) wavelength *= nm_per_unit;
  if (wavelengths_nm.empty()) parser.fail(parser.columns_line(), "no rows", "at least one");
  if (wavelengths_nm.back() < kRangeMin_nm) {
    parser.fail(parser.line_of("wavelength"),
                fmt::format("{:g} to {:g} nm", wavelengths_nm.front(), wavelengths_nm.back()),
                "wavelengths within 360 to 830 nm, or um for the unit");
  }
  for (std::size_t row = 1; row < wavelengths_nm.size(); ++row) {
    if (wavelengths_nm[row] <= wavelengths_nm[row - 1]) {
      parser.fail(parser.row_line(row),
                  fmt::format("{} nm after {} nm", wavelengths_nm[row], wavelengths_nm[row - 1]),
                  "rising wavelengths");
    }
  }
  constexpr double kRounding_nm = 1e-6;
  if (std::abs(wavelengths_nm.front() - entry.range_min_nm) > kRounding_nm ||
      std::abs(wavelengths_nm.back() - entry.range_max_nm) > kRounding_nm) {
    parser.fail(
        parser.line_of("wavelength"),
        fmt::format("{} to {} nm", entry.range_min_nm, entry.range_max_nm),
        fmt::format("the table's {} to {} nm", wavelengths_nm.front(), wavelengths_nm.back()));
  }
  return wavelengths_nm;
}

void check_values(const Parser& parser, const CatalogueEntry& entry) {
  const bool is_fraction = entry.quantity == "reflectance" || entry.quantity == "transmittance";
  // x̄, ȳ, z̄, powers, k and absorption are never negative; n of a conductor may be near 0.
  for (std::size_t column = 1; column < parser.columns().size(); ++column) {
    for (std::size_t row = 0; row < parser.table()[column].size(); ++row) {
      const double value = parser.table()[column][row];
      const bool is_index_of_dielectric =
          entry.quantity == "index" && parser.columns()[column] == "n";
      const double lowest = entry.quantity == "daylight component" ? -kInfinity
                            : is_index_of_dielectric               ? 1.0
                                                                   : 0.0;
      if (value < lowest) {
        parser.fail(parser.row_line(row), fmt::format("{}", value),
                    fmt::format("at least {}", lowest));
      }
      if (is_fraction && value > 1.0) {
        parser.fail(parser.row_line(row), fmt::format("{}", value), "at most 1");
      }
    }
  }
}

void read_table(const Parser& parser, CatalogueEntry& entry, double nm_per_unit) {
  const std::vector<double> nm = checked_wavelengths_nm(parser, entry, nm_per_unit);
  check_values(parser, entry);
  const bool ends_in_dark = entry.quantity == "emission" || entry.quantity == "observer";
  const OutsideTable outside = ends_in_dark ? OutsideTable::Zero : OutsideTable::Clamp;
  const auto curve = [&](std::size_t column) {
    return Spectrum::tabulated(nm, parser.table()[column], outside);
  };
  if (entry.quantity == "observer") {
    entry.observer = Observer{entry.id, curve(1), curve(2), curve(3)};
  } else if (parser.columns()[1] == "strength") {
    std::vector<SpectralLine> lines;
    for (std::size_t row = 0; row < nm.size(); ++row) {
      lines.push_back({nm[row], parser.table()[1][row]});
    }
    entry.spectrum = Spectrum::lines(std::move(lines));
  } else if (entry.quantity == "index" || entry.quantity == "complex index") {
    entry.n = curve(1);
    if (parser.columns().size() > 2) entry.k = curve(2);
    if (entry.quantity == "index") entry.dispersion = TabulatedIndex{*entry.n};
  } else {
    entry.spectrum = curve(1);
  }
}

}  // namespace

CatalogueEntry read_spectrum_file(const std::filesystem::path& file, const std::string& id,
                                  const std::string& glass) {
  const std::vector<std::uint8_t> bytes = read_file(file, file.string(), kLargestFile);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::string suffix = file.extension().string();
  if (suffix == ".yml" || suffix == ".yaml") {
    return read_refractiveindex_yaml(text, file.string(), id);
  }
  if (suffix == ".csv") return read_csv_spectrum(text, file.string(), id);
  if (suffix == ".agf" || suffix == ".AGF") {
    if (!glass.empty()) return read_agf_glass(text, file.string(), glass, id);
    const std::vector<std::string> glasses = names_in_agf(text);
    if (glasses.size() == 1) return read_agf_glass(text, file.string(), glasses.front(), id);
    throw_input_error(file.string(), fmt::format("{} glasses", glasses.size()),
                      "the name of one behind the file: FILE.agf#GLASS");
  }
  const Parser parser(file, text);

  CatalogueEntry entry;
  entry.id = id;
  entry.quantity = parser.required_text("quantity");
  if (!columns_by_quantity().contains(entry.quantity)) {
    parser.fail(parser.line_of("quantity"), "quantity \"" + entry.quantity + "\"",
                "a known quantity", names_of_quantities());
  }
  entry.unit = parser.required_text("unit");
  const std::vector<std::string>& units = units_of(entry.quantity);
  if (std::find(units.begin(), units.end(), entry.unit) == units.end()) {
    parser.fail(parser.line_of("unit"), "unit \"" + entry.unit + "\"",
                "the unit of a file of " + entry.quantity, units);
  }
  entry.name = parser.required_text("name");
  entry.source = parser.required_text("source");
  entry.licence = parser.required_text("licence");
  entry.doi = parser.text("doi");
  entry.note = parser.text("note");
  if (parser.has("default")) {
    entry.is_default = parser.text("default") == "yes";
    if (!entry.is_default) {
      parser.fail(parser.line_of("default"), "\"" + parser.text("default") + "\"", "yes");
    }
  }
  if (parser.has("n_d")) entry.n_d = parser.required_number("n_d");
  if (parser.has("V_d")) entry.V_d = parser.required_number("V_d");

  const std::string range_text = parser.required_text("wavelength");
  const std::vector<std::string_view> range = words_of(range_text);
  const std::size_t range_line = parser.line_of("wavelength");
  if (range.size() != 3 || (range[0] != "nm" && range[0] != "um")) {
    parser.fail(range_line, "\"" + range_text + "\"",
                "nm or um, the first and the last wavelength");
  }
  const double nm_per_unit = range[0] == "um" ? 1000.0 : 1.0;
  entry.range_min_nm = parser.number(range_line, range[1]) * nm_per_unit;
  entry.range_max_nm = parser.number(range_line, range[2]) * nm_per_unit;
  if (!(entry.range_min_nm > 0.0 && entry.range_min_nm <= entry.range_max_nm)) {
    parser.fail(range_line, "\"" + range_text + "\"", "a rising range above 0");
  }

  if (parser.has_table() == parser.has("formula")) {
    parser.fail(range_line, "quantity " + entry.quantity, "either columns or a formula");
  }
  if (parser.has_table()) {
    read_table(parser, entry, nm_per_unit);
  } else if (entry.quantity == "index") {
    entry.dispersion = formula_of(parser);
  } else {
    parser.fail(parser.line_of("formula"), "a formula of " + entry.quantity,
                "a formula only for an index");
  }
  return entry;
}

}  // namespace abbe
