#include <fmt/format.h>

#include "base/constants.h"
#include "cli/describe.h"

namespace abbe {
namespace {

struct Line {
  const char* name;
  double wavelength_nm;
};

// The lines by which makers state an index.
constexpr Line kLines[] = {{"g", 435.84},     {"F'", 479.99}, {"F", kLineF_nm}, {"e", 546.074},
                           {"d", kLine_d_nm}, {"C'", 643.85}, {"C", kLineC_nm}};

Description describe_dispersion(const Dispersion& dispersion) {
  Description lines = Description::array();
  for (const Line& line : kLines) {
    lines.push_back({{"line", line.name},
                     {"wavelength_nm", line.wavelength_nm},
                     {"n", refractive_index(dispersion, line.wavelength_nm)}});
  }
  return lines;
}

Description describe_values(const CatalogueEntry& entry) {
  Description values = Description::array();
  constexpr double kStep_nm = 50.0;
  for (double wavelength_nm = 400.0; wavelength_nm <= 800.0; wavelength_nm += kStep_nm) {
    Description value{{"wavelength_nm", wavelength_nm}};
    if (entry.spectrum) value["value"] = entry.spectrum->value(wavelength_nm);
    if (entry.n) value["n"] = entry.n->value(wavelength_nm);
    if (entry.k) value["k"] = entry.k->value(wavelength_nm);
    values.push_back(std::move(value));
  }
  return values;
}

}  // namespace

Description describe_spectrum(const CatalogueEntry& entry) {
  Description out;
  out["id"] = entry.id;
  if (!entry.name.empty()) out["name"] = entry.name;
  out["quantity"] = entry.quantity;
  out["unit"] = entry.unit;
  out["range_nm"] = {entry.range_min_nm, entry.range_max_nm};
  out["source"] = entry.source;
  if (!entry.doi.empty()) out["doi"] = entry.doi;
  out["licence"] = entry.licence;
  if (!entry.note.empty()) out["note"] = entry.note;
  if (entry.dispersion) {
    out["n_d"] = refractive_index(*entry.dispersion, kLine_d_nm);
    out["V_d"] = abbe_number(*entry.dispersion);
    if (entry.n_d) out["stated_n_d"] = *entry.n_d;
    if (entry.V_d) out["stated_V_d"] = *entry.V_d;
    out["n_at_lines"] = describe_dispersion(*entry.dispersion);
  } else if (entry.spectrum || entry.n) {
    if (entry.spectrum && !entry.spectrum->lines().empty()) {
      out["lines"] = Description::array();
      for (const SpectralLine& line : entry.spectrum->lines()) {
        out["lines"].push_back(
            {{"wavelength_nm", line.wavelength_nm}, {"strength", line.strength}});
      }
    } else {
      out["values"] = describe_values(entry);
    }
  }
  return out;
}

}  // namespace abbe
