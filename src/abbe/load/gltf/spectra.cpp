#include "abbe/load/gltf/spectra.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "abbe/base/error.h"
#include "abbe/load/gltf/document/check.h"
#include "abbe/load/spectra/foreign.h"

namespace abbe::gltf {
namespace {

constexpr Range kWavelengths_nm{1.0, 1e6};
// What a file in the catalogue's own format begins with.
constexpr std::string_view kCatalogueSignature = "abbe-spectrum";

Range values_of(SpectrumUse use) {
  constexpr double kHuge = 1e30;
  switch (use) {
    case SpectrumUse::Reflectance:
      return {0.0, 1.0};
    case SpectrumUse::Index:
      return {1e-6, 1000.0};
    default:
      return {0.0, kHuge};
  }
}

const char* name_of(SpectrumUse use) {
  switch (use) {
    case SpectrumUse::Emission:
      return "an emission";
    case SpectrumUse::Reflectance:
      return "a reflectance";
    case SpectrumUse::Absorption:
      return "an absorption";
    default:
      return "a complex index";
  }
}

bool matches(SpectrumUse use, const std::string& quantity) {
  if (quantity == kPlainTable) return true;
  switch (use) {
    case SpectrumUse::Emission:
      return quantity == "emission";
    case SpectrumUse::Reflectance:
      return quantity == "reflectance" || quantity == "transmittance";
    case SpectrumUse::Absorption:
      return quantity == "absorption";
    default:
      return quantity == "complex index";
  }
}

OutsideTable outside_of(SpectrumUse use) {
  return use == SpectrumUse::Emission ? OutsideTable::Zero : OutsideTable::Clamp;
}

}  // namespace

CatalogueEntry Spectra::entry(const std::string& id_or_path, const std::string& pointer) {
  // One glass of an AGF catalogue is written FILE.agf#GLASS.
  const std::size_t hash = std::min(id_or_path.find('#'), id_or_path.size());
  const std::string path = id_or_path.substr(0, hash);
  if (!is_spectrum_path(path)) return catalogue_.entry(id_or_path, document_.where(pointer));
  const std::filesystem::path file = document_.resolve_path(path, pointer);
  // Into the hash, and checked to be a regular file.
  const Bytes bytes = document_.read_resolved(file, pointer);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::string suffix = file.extension().string();
  const bool is_known = text.starts_with(kCatalogueSignature) || suffix == ".yml" ||
                        suffix == ".yaml" || suffix == ".agf" || suffix == ".AGF";
  if (!is_known) return read_csv_spectrum(text, file.string(), id_or_path);
  const std::string glass = hash < id_or_path.size() ? id_or_path.substr(hash + 1) : "";
  return read_spectrum_file(file, id_or_path, glass);
}

NamedSpectrum Spectra::lamp(const Fields& fields) {
  if (fields.has("spectrum")) return read(fields, "spectrum", SpectrumUse::Emission);
  return {"illuminant/D65", catalogue_.illuminant("illuminant/D65")};
}

Spectrum Spectra::read_table(const Json& table, const std::string& pointer, SpectrumUse use) {
  std::vector<double> wavelengths_nm;
  std::vector<double> values;
  const Range range = values_of(use);
  if (table.empty()) throw_input_error(document_.where(pointer), "an empty table", "[[nm, value]]");
  for (std::size_t i = 0; i < table.size(); ++i) {
    const std::string row = fmt::format("{}/{}", pointer, i);
    if (!table[i].is_array() || table[i].size() != 2) {
      throw_input_error(document_.where(row), describe(table[i]), "[nm, value]");
    }
    const double wavelength_nm =
        finite_number(table[i][0], document_.where(row + "/0"), kWavelengths_nm);
    if (!wavelengths_nm.empty() && wavelength_nm <= wavelengths_nm.back()) {
      throw_input_error(document_.where(row + "/0"),
                        fmt::format("{} nm after {} nm", wavelength_nm, wavelengths_nm.back()),
                        "rising wavelengths");
    }
    wavelengths_nm.push_back(wavelength_nm);
    values.push_back(limit(finite_number(table[i][1], document_.where(row + "/1"), {}), range,
                           document_.where(row + "/1"), document_.notes()));
  }
  return Spectrum::tabulated(std::move(wavelengths_nm), std::move(values), outside_of(use));
}

Spectrum Spectra::as_used(const Spectrum& table, const std::string& id, SpectrumUse use) {
  std::vector<double> wavelengths_nm, values;
  for (const double nm : table.table_points_nm()) {
    wavelengths_nm.push_back(nm);
    values.push_back(limit(table.value(nm), values_of(use), id, document_.notes()));
  }
  return Spectrum::tabulated(std::move(wavelengths_nm), std::move(values), outside_of(use));
}

Spectrum Spectra::read_lines(const Json& lines, const std::string& pointer) {
  if (!lines.is_array() || lines.empty()) {
    throw_input_error(document_.where(pointer), describe(lines), "[[nm, strength], ...]");
  }
  constexpr std::size_t kMaxLines = 64;  // Each takes a wavelength lane of its own.
  if (lines.size() > kMaxLines) {
    throw_input_error(document_.where(pointer), fmt::format("{} lines", lines.size()),
                      fmt::format("at most {}", kMaxLines));
  }
  std::vector<SpectralLine> result;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string row = fmt::format("{}/{}", pointer, i);
    if (!lines[i].is_array() || lines[i].size() != 2) {
      throw_input_error(document_.where(row), describe(lines[i]), "[nm, strength]");
    }
    result.push_back({finite_number(lines[i][0], document_.where(row + "/0"), {360.0, 830.0}),
                      finite_number(lines[i][1], document_.where(row + "/1"), {0.0, 1e30})});
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const auto& a, const auto& b) { return a.wavelength_nm < b.wavelength_nm; });
  return Spectrum::lines(std::move(result));
}

NamedSpectrum Spectra::read_name(const std::string& name, const std::string& pointer,
                                 SpectrumUse use) {
  const CatalogueEntry found = entry(name, pointer);
  if (!matches(use, found.quantity)) {
    throw_input_error(document_.where(pointer), fmt::format("{} ({})", found.id, found.quantity),
                      name_of(use));
  }
  if (found.quantity == kPlainTable) return {found.id, as_used(*found.spectrum, found.id, use)};
  const std::optional<Spectrum>& curve = use == SpectrumUse::Index        ? found.n
                                         : use == SpectrumUse::Extinction ? found.k
                                                                          : found.spectrum;
  if (!curve) throw_input_error(document_.where(pointer), found.id, name_of(use));
  return {found.id, *curve};
}

NamedSpectrum Spectra::read(const Json& value, const std::string& pointer, SpectrumUse use) {
  if (value.is_string()) return read_name(value.get<std::string>(), pointer, use);
  if (value.is_number()) {
    return {"",
            Spectrum::constant(limit(finite_number(value, document_.where(pointer), {}),
                                     values_of(use), document_.where(pointer), document_.notes()))};
  }
  if (value.is_array()) return {"", read_table(value, pointer, use)};
  if (use == SpectrumUse::Emission && value.is_object()) {
    const Fields fields(document_, value, pointer);
    fields.only({"blackbody", "lines"});
    if (fields.has("blackbody")) {
      return {"", Spectrum::blackbody(fields.required_number("blackbody", {300.0, 1e6}))};
    }
    if (fields.has("lines")) {
      return {"", read_lines(fields.at("lines"), fields.pointer("lines"))};
    }
  }
  throw_input_error(document_.where(pointer), describe(value),
                    use == SpectrumUse::Emission
                        ? "an id, a path, a number, [[nm, value], ...], {blackbody} or {lines}"
                        : "an id, a path, a number or [[nm, value], ...]");
}

}  // namespace abbe::gltf
