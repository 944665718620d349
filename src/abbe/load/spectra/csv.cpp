// Plain tables: lines of a wavelength in nm and a value, of which the first may say what they are.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "abbe/base/constants.h"
#include "abbe/base/error.h"
#include "abbe/base/text.h"
#include "abbe/load/spectra/foreign.h"
#include "abbe/load/spectra/text.h"

namespace abbe {
namespace {

struct Rows {
  std::vector<double> wavelengths_nm, values;
  std::vector<std::size_t> lines;
  std::string header;  ///< Of the second column, in lower case.
};

std::string spaced(std::string_view line) {
  std::string text(line.substr(0, line.find('#')));
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == ',' || c == ';'; }, ' ');
  return text;
}

Rows rows_of(std::string_view text, const std::string& file) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  Rows rows;
  bool may_be_header = true;
  std::size_t number = 0;
  for (const std::string_view line : lines_of(text)) {
    ++number;
    const std::string content = spaced(line);
    const std::vector<std::string_view> words = words_of(content);
    if (words.empty()) continue;
    const auto nm = finite_number_of(words[0]);
    const auto value = finite_number_of(words.size() > 1 ? words[1] : "");
    const std::string where = fmt::format("{}: line {}", file, number);
    if ((!nm || !value) && may_be_header) {
      may_be_header = false;
      if (words.size() > 1) rows.header = lower_case(words[1]);
      continue;
    }
    may_be_header = false;
    if (!nm || !value || words.size() != 2) {
      throw_input_error(where, "\"" + std::string(line) + "\"", "a wavelength in nm and a value");
    }
    constexpr double kLongest_nm = 1e6;
    if (!(*nm > 0.0 && *nm <= kLongest_nm)) {
      throw_input_error(where, fmt::format("a wavelength of {:g} nm", *nm), "0 to 1000000 nm");
    }
    add_rising(*nm, where, rows.wavelengths_nm);
    rows.values.push_back(*value);
    rows.lines.push_back(number);
  }
  if (rows.values.empty()) {
    throw_input_error(file, "no row", "rows of a wavelength in nm and a value");
  }
  // A table in another unit is not to be seen by its values, but by where it lies.
  if (rows.wavelengths_nm.back() < kRangeMin_nm || rows.wavelengths_nm.front() > kRangeMax_nm) {
    const bool looks_like_um = rows.wavelengths_nm.back() < 100.0;
    throw_input_error(file,
                      fmt::format("wavelengths of {:g} to {:g}{}", rows.wavelengths_nm.front(),
                                  rows.wavelengths_nm.back(), looks_like_um ? ", as if in um" : ""),
                      "wavelengths in nm, some of them within 360 to 830");
  }
  return rows;
}

// What a table says of itself: by the name of its column, or of the folder of the catalogue.
std::string quantity_of(const Rows& rows, const std::string& id) {
  static const std::map<std::string, std::string> known{{"emission", "emission"},
                                                        {"power", "emission"},
                                                        {"spd", "emission"},
                                                        {"illuminant", "emission"},
                                                        {"lamp", "emission"},
                                                        {"reflectance", "reflectance"},
                                                        {"transmittance", "transmittance"},
                                                        {"absorption", "absorption"}};
  const auto by_header = known.find(rows.header.substr(0, rows.header.find_first_of("([/")));
  if (by_header != known.end()) return by_header->second;
  const auto by_folder = known.find(id.substr(0, id.find('/')));
  return by_folder != known.end() && id.find('/') != std::string::npos ? by_folder->second
                                                                       : kPlainTable;
}

}  // namespace

CatalogueEntry read_csv_spectrum(std::string_view text, const std::string& file,
                                 const std::string& id) {
  Rows rows = rows_of(text, file);
  CatalogueEntry entry;
  entry.id = id;
  entry.quantity = quantity_of(rows, id);
  entry.unit = entry.quantity == "emission"     ? "relative"
               : entry.quantity == "absorption" ? "1/m"
                                                : "1";
  entry.name = id.substr(id.rfind('/') + 1);
  entry.source = "table " + std::filesystem::path(file).filename().string();
  entry.licence = "the user's own file";
  entry.range_min_nm = rows.wavelengths_nm.front();
  entry.range_max_nm = rows.wavelengths_nm.back();
  const bool is_fraction = entry.quantity == "reflectance" || entry.quantity == "transmittance";
  for (std::size_t i = 0; i < rows.values.size() && entry.quantity != kPlainTable; ++i) {
    if (rows.values[i] >= 0.0 && (!is_fraction || rows.values[i] <= 1.0)) continue;
    throw_input_error(fmt::format("{}: line {}", file, rows.lines[i]),
                      fmt::format("{} {:g}", entry.quantity, rows.values[i]),
                      is_fraction ? "0 to 1" : "at least 0");
  }
  entry.spectrum =
      Spectrum::tabulated(std::move(rows.wavelengths_nm), std::move(rows.values),
                          entry.quantity == "emission" ? OutsideTable::Zero : OutsideTable::Clamp);
  return entry;
}

}  // namespace abbe
