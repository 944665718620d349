// The format of refractiveindex.info: a YAML map with REFERENCES, COMMENTS and DATA, a list of
// formulas and tables.
#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>

#include "abbe/base/constants.h"
#include "abbe/base/error.h"
#include "abbe/load/spectra/foreign.h"
#include "abbe/load/spectra/tabulated_formula.h"
#include "abbe/load/spectra/text.h"

namespace abbe {
namespace {

std::string place(const std::string& file, const YAML::Mark& mark) {
  return mark.is_null() ? file : fmt::format("{}:{}", file, mark.line + 1);
}

std::string text_of(const YAML::Node& map, const char* key, const std::string& file) {
  const YAML::Node node = map[key];
  if (!node || node.IsNull()) return "";
  if (!node.IsScalar()) {
    throw_input_error(place(file, node.Mark()), fmt::format("a {} that is no text", key), "a text");
  }
  std::string text = node.Scalar();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

std::vector<double> numbers_of(const YAML::Node& map, const char* key, const std::string& file) {
  const std::string text = text_of(map, key, file);
  if (text.empty()) return {};
  return abbe::numbers_of(words_of(text), 0, place(file, map[key].Mark()));
}

// Pairs behind the first coefficient.
void split_pairs(const std::vector<double>& c, std::vector<double>& first,
                 std::vector<double>& second) {
  for (std::size_t i = 1; i + 1 < c.size(); i += 2) {
    first.push_back(c[i]);
    second.push_back(c[i + 1]);
  }
}

// Source: refractiveindex.info, Dispersion formulas (2014); λ in µm.
Dispersion formula_of(int number, std::vector<double> c, const std::string& where) {
  constexpr std::size_t kMost = 17;
  if (c.empty() || c.size() > kMost) {
    throw_input_error(where, fmt::format("{} coefficients", c.size()), "1 to 17");
  }
  const bool has_pairs = number <= 3 || number == 5 || number == 6;
  if (has_pairs && c.size() % 2 == 0) {
    throw_input_error(where, fmt::format("{} coefficients", c.size()), "one, and pairs after it");
  }
  if (number == 1 || number == 2) {
    SellmeierFormula formula;
    formula.A = c[0];
    split_pairs(c, formula.B, formula.C);
    if (number == 1) {
      for (double& root_um : formula.C) root_um *= root_um;
    }
    return formula;
  }
  if (number == 3) {
    PolynomialFormula formula{c[0], {}, {}};
    split_pairs(c, formula.c, formula.p);
    return formula;
  }
  if (number == 4) return RefractiveIndexInfoFormula4{std::move(c)};
  if (number == 5) {
    CauchyFormula formula{c[0], {}, {}};
    split_pairs(c, formula.c, formula.p);
    return formula;
  }
  if (number == 6) {
    return tabulated_formula([&](double um) {
      double n = 1.0 + c[0];
      for (std::size_t i = 1; i + 1 < c.size(); i += 2) n += c[i] / (c[i + 1] - 1.0 / (um * um));
      return n;
    });
  }
  c.resize(6, 0.0);
  if (number == 7) return herzberger(c);
  if (number == 8) {
    return tabulated_formula([&](double um) {
      const double um2 = um * um;
      const double q = c[0] + c[1] * um2 / (um2 - c[2]) + c[3] * um2;
      return std::sqrt((1.0 + 2.0 * q) / (1.0 - q));
    });
  }
  if (number == 9) {
    return tabulated_formula([&](double um) {
      const double off = um - c[4];
      return std::sqrt(c[0] + c[1] / (um * um - c[2]) + c[3] * off / (off * off + c[5]));
    });
  }
  throw_input_error(where, fmt::format("formula {}", number), "formula 1 to 9");
}

struct Table {
  std::vector<double> wavelengths_nm;
  std::vector<std::vector<double>> columns;
};

Table table_of(const YAML::Node& data, std::size_t columns, const std::string& file) {
  const YAML::Node node = data["data"];
  if (!node || !node.IsScalar()) {
    throw_input_error(place(file, data.Mark()), "a table without rows", "data: | and rows");
  }
  Table table;
  table.columns.resize(columns);
  std::size_t row = 0;
  for (const std::string_view line : lines_of(node.Scalar())) {
    const std::vector<std::string_view> words = words_of(line);
    if (words.empty()) continue;
    ++row;
    const std::string where = fmt::format("{}, row {}", place(file, node.Mark()), row);
    if (words.size() != columns + 1) {
      throw_input_error(where, fmt::format("{} numbers", words.size()),
                        fmt::format("{}", columns + 1));
    }
    for (std::size_t i = 0; i <= columns; ++i) {
      const auto number = finite_number_of(words[i]);
      if (!number || *number < 0.0) {
        throw_input_error(where, "\"" + std::string(words[i]) + "\"", "a number of at least 0");
      }
      if (i > 0) {
        table.columns[i - 1].push_back(*number);
        continue;
      }
      const double nm = *number * 1e3;
      constexpr double kShortest_nm = 1e-3, kLongest_nm = 1e7;
      if (!(nm >= kShortest_nm && nm <= kLongest_nm)) {
        throw_input_error(where, fmt::format("a wavelength of {}", *number), "one in µm");
      }
      add_rising(nm, where, table.wavelengths_nm);
    }
  }
  if (row == 0) throw_input_error(place(file, node.Mark()), "an empty table", "at least one row");
  return table;
}

Spectrum curve_of(const Table& table, std::size_t column) {
  return Spectrum::tabulated(table.wavelengths_nm, table.columns[column], OutsideTable::Clamp);
}

Spectrum absorption_of_k(const Table& table, std::size_t column) {
  std::vector<double> absorption_per_m = table.columns[column];
  for (std::size_t i = 0; i < absorption_per_m.size(); ++i) {
    absorption_per_m[i] *= 4.0 * kPi / (table.wavelengths_nm[i] * 1e-9);
  }
  return Spectrum::tabulated(table.wavelengths_nm, std::move(absorption_per_m),
                             OutsideTable::Clamp);
}

void set_range(CatalogueEntry& entry, const std::vector<double>& wavelengths_nm) {
  entry.range_min_nm = wavelengths_nm.front();
  entry.range_max_nm = wavelengths_nm.back();
}

void read_nk(const YAML::Node& data, const std::string& file, CatalogueEntry& entry) {
  const Table table = table_of(data, 2, file);
  set_range(entry, table.wavelengths_nm);
  entry.n = curve_of(table, 0);
  entry.k = curve_of(table, 1);
  constexpr double kMetallic = 0.01;
  const std::vector<double>&n = table.columns[0], &k = table.columns[1];
  const bool is_dielectric = *std::min_element(n.begin(), n.end()) >= 1.0 &&
                             *std::max_element(k.begin(), k.end()) < kMetallic;
  entry.quantity = is_dielectric ? "index" : "complex index";
  if (!is_dielectric) return;
  entry.dispersion = TabulatedIndex{*entry.n};
  entry.absorption = absorption_of_k(table, 1);
}

void read_formula(const YAML::Node& data, const std::string& type, const std::string& file,
                  CatalogueEntry& entry) {
  const std::string where = place(file, data.Mark());
  const auto number = finite_number_of(type.substr(std::string("formula ").size()));
  if (!number) throw_input_error(where, "type \"" + type + "\"", "formula 1 to 9");
  entry.dispersion =
      formula_of(static_cast<int>(*number), numbers_of(data, "coefficients", file), where);
  std::vector<double> range_um = numbers_of(data, "wavelength_range", file);
  if (range_um.empty()) range_um = numbers_of(data, "range", file);
  if (range_um.size() != 2 || !(range_um[0] > 0.0 && range_um[0] < range_um[1])) {
    throw_input_error(where, "no rising wavelength_range", "the first and last wavelength in µm");
  }
  entry.range_min_nm = range_um[0] * 1e3;
  entry.range_max_nm = range_um[1] * 1e3;
  entry.quantity = "index";
}

CatalogueEntry read(const YAML::Node& root, const std::string& file, const std::string& id) {
  if (!root.IsMap() || !root["DATA"] || !root["DATA"].IsSequence()) {
    throw_input_error(file, "no list DATA", "a file of refractiveindex.info");
  }
  CatalogueEntry entry;
  entry.id = id;
  entry.unit = "1";
  entry.name = id.substr(id.rfind('/') + 1);
  entry.source = text_of(root, "REFERENCES", file);
  entry.note = text_of(root, "COMMENTS", file);
  entry.licence = "as its file says; refractiveindex.info publishes under CC0-1.0";
  for (const YAML::Node& data : root["DATA"]) {
    if (!data.IsMap()) throw_input_error(place(file, data.Mark()), "no map", "type: ...");
    const std::string type = text_of(data, "type", file);
    if (type == "tabulated nk") {
      read_nk(data, file, entry);
    } else if (type == "tabulated n") {
      const Table table = table_of(data, 1, file);
      set_range(entry, table.wavelengths_nm);
      entry.quantity = "index";
      entry.n = curve_of(table, 0);
      entry.dispersion = TabulatedIndex{*entry.n};
    } else if (type == "tabulated k") {
      const Table table = table_of(data, 1, file);
      entry.k = curve_of(table, 0);
      entry.absorption = absorption_of_k(table, 0);
    } else if (type.starts_with("formula ")) {
      read_formula(data, type, file, entry);
    } else {
      throw_input_error(place(file, data.Mark()), "type \"" + type + "\"", "a known type",
                        {"formula 1 to 9", "tabulated n", "tabulated k", "tabulated nk"});
    }
  }
  if (!entry.dispersion && !entry.n)
    throw_input_error(file, "no n in DATA", "a formula or a table");
  return entry;
}

}  // namespace

CatalogueEntry read_refractiveindex_yaml(std::string_view text, const std::string& file,
                                         const std::string& id) {
  try {
    return read(YAML::Load(std::string(text)), file, id);
  } catch (const YAML::Exception& error) {
    throw_input_error(place(file, error.mark), error.msg, "YAML of refractiveindex.info");
  }
}

}  // namespace abbe
