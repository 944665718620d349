
#include <cmath>

#include "abbe/base/constants.h"
#include "abbe/cli/describe/describe.h"
#include "abbe/color/color.h"
#include "abbe/color/lamp/lamp.h"
#include "abbe/color/lamp/rendering.h"

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

// All that an entry says at one wavelength.
Description describe_value(const CatalogueEntry& entry, double wavelength_nm) {
  Description value{{"wavelength_nm", wavelength_nm}};
  if (entry.observer) {
    value["x_bar"] = entry.observer->x_bar.value(wavelength_nm);
    value["y_bar"] = entry.observer->y_bar.value(wavelength_nm);
    value["z_bar"] = entry.observer->z_bar.value(wavelength_nm);
  }
  if (entry.spectrum) value["value"] = entry.spectrum->value(wavelength_nm);
  if (entry.dispersion) value["n"] = refractive_index(*entry.dispersion, wavelength_nm);
  if (!entry.dispersion && entry.n) value["n"] = entry.n->value(wavelength_nm);
  if (entry.k) value["k"] = entry.k->value(wavelength_nm);
  if (entry.absorption) value["absorption_per_m"] = entry.absorption->value(wavelength_nm);
  return value;
}

Description describe_values(const CatalogueEntry& entry) {
  Description values = Description::array();
  constexpr double kStep_nm = 50.0;
  for (double wavelength_nm = 400.0; wavelength_nm <= 800.0; wavelength_nm += kStep_nm) {
    values.push_back(describe_value(entry, wavelength_nm));
  }
  return values;
}

Description pair_of(const Vec2d& value) {
  return {value.x, value.y};
}

void describe_rendering(const Spectrum& lamp, const SpectrumView& view, Description& out) {
  const auto rendering = color_rendering(lamp, view.observer, view.test_colors, view.daylight);
  if (!rendering) return;
  out["CRI_Ra"] = rendering->general;
  out["CRI_R"] = Description::array();
  for (const double index : rendering->special) out["CRI_R"].push_back(index);
}

void describe_lamp(const Spectrum& lamp, const SpectrumView& view, Description& out) {
  const Observer& observer = view.observer;
  const Vec3d xyz = xyz_of(lamp, observer);
  if (!(xyz.y > 0.0)) return;
  out["white_xy"] = pair_of(xy_of_xyz(xyz));
  if (const auto nearest = correlated_temperature(xyz, observer)) {
    out["CCT_K"] = nearest->temperature_K;
    out["Duv"] = nearest->duv;
    describe_rendering(lamp, view, out);
  }
  if (lamp.lines().empty()) return;
  out["lines"] = Description::array();
  for (const SpectralLine& line : lamp.lines()) {
    out["lines"].push_back({{"wavelength_nm", line.wavelength_nm}, {"strength", line.strength}});
  }
}

// Under a lamp, relative to its own white: Lab as CIE defines it, and RGB as the eye that has
// adapted to the lamp sees it.
void describe_color(const Spectrum& fraction, const SpectrumView& view, Description& out) {
  const Vec3d xyz_white = xyz_of(view.lamp, view.observer);
  const Vec3d xyz = xyz_of(product(view.lamp, fraction), view.observer) / xyz_white.y;
  const Vec3d white = xyz_white / xyz_white.y;
  const Vec3d rgb_rec709 = xyz_to_rec709() * (cat16_adaptation(white, xyz_of_xy(kD65_xy)) * xyz);
  out["lamp"] = view.lamp_id;
  out["Y"] = xyz.y;
  out["xy"] = pair_of(xy_of_xyz(xyz));
  out["Lab"] = triple(lab_of_xyz(xyz, white));
  out["rgb_rec709"] = triple(rgb_rec709);
}

}  // namespace

std::string kind_of(const CatalogueEntry& entry) {
  const std::size_t slash = entry.id.find('/');
  const bool has_folder = slash != std::string::npos && slash > 0;
  return has_folder ? entry.id.substr(0, slash) : entry.quantity;
}

Description describe_spectrum(const CatalogueEntry& entry, const SpectrumView& view) {
  Description out;
  out["id"] = entry.id;
  out["kind"] = kind_of(entry);
  if (!entry.name.empty()) out["name"] = entry.name;
  out["quantity"] = entry.quantity;
  out["unit"] = entry.unit;
  out["range_nm"] = {entry.range_min_nm, entry.range_max_nm};
  if (entry.is_default) out["default"] = true;
  out["source"] = entry.source;
  if (!entry.doi.empty()) out["doi"] = entry.doi;
  out["licence"] = entry.licence;
  if (!entry.note.empty()) out["note"] = entry.note;
  if (entry.dispersion) {
    out["n_d"] = refractive_index(*entry.dispersion, kLine_d_nm);
    const double V_d = abbe_number(*entry.dispersion);
    if (std::isfinite(V_d)) out["V_d"] = V_d;
    if (entry.n_d) out["stated_n_d"] = *entry.n_d;
    if (entry.V_d) out["stated_V_d"] = *entry.V_d;
    out["n"] = describe_dispersion(*entry.dispersion);
    if (const auto pole_nm = breakdown_nm(*entry.dispersion)) out["breaks_down_at_nm"] = *pole_nm;
  }
  if (entry.quantity == "emission") {
    describe_lamp(*entry.spectrum, view, out);
  } else if (entry.quantity == "reflectance" || entry.quantity == "transmittance") {
    describe_color(*entry.spectrum, view, out);
  }
  const bool is_lines_only = entry.spectrum && entry.spectrum->is_lines_only();
  if (!entry.dispersion && !is_lines_only) out["values"] = describe_values(entry);
  if (!view.at_nm.empty()) {
    out["at"] = Description::array();
    for (const double nm : view.at_nm) out["at"].push_back(describe_value(entry, nm));
  }
  return out;
}

}  // namespace abbe
