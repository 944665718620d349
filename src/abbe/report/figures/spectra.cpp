#include "abbe/report/figures/spectra.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "abbe/base/constants.h"
#include "abbe/base/error.h"
#include "abbe/color/color.h"
#include "abbe/color/lamp/lamp.h"
#include "abbe/color/rgb_space.h"
#include "abbe/color/spectrum_colors.h"
#include "abbe/load/spectra/foreign.h"
#include "abbe/report/figures/svg.h"

namespace abbe {
namespace {

// Okabe and Ito's colours, which colour-blind readers tell apart; the yellow is too light on white.
constexpr std::array<const char*, 8> kColors{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                             "#000000", "#e69f00", "#56b4e9", "#8a8a00"};
constexpr const char* kInk = "#222222";
constexpr Vec2i kFrame_px{760, 420};

std::string last_part(const std::string& id) {
  return id.substr(id.rfind('/') + 1);
}

Vec3d xyz_at(double wavelength_nm, const Observer& observer) {
  return {observer.x_bar.value(wavelength_nm), observer.y_bar.value(wavelength_nm),
          observer.z_bar.value(wavelength_nm)};
}

Vec3d encoded(const Vec3d& rgb_rec709) {
  return {srgb_encode(std::clamp(rgb_rec709.x, 0.0, 1.0)),
          srgb_encode(std::clamp(rgb_rec709.y, 0.0, 1.0)),
          srgb_encode(std::clamp(rgb_rec709.z, 0.0, 1.0))};
}

// What one axis can carry together.
enum class Axis { Emission, Fraction, Absorption, Index, Observer, Value };

Axis axis_of(const CatalogueEntry& entry) {
  if (entry.quantity == "emission") return Axis::Emission;
  if (entry.quantity == "absorption") return Axis::Absorption;
  if (entry.quantity == "observer") return Axis::Observer;
  if (entry.quantity == kPlainTable || entry.quantity == "daylight component") return Axis::Value;
  return entry.quantity == "reflectance" || entry.quantity == "transmittance" ? Axis::Fraction
                                                                              : Axis::Index;
}

const char* label_of(Axis axis) {
  switch (axis) {
    case Axis::Emission:
      return "Power, relative to the highest";
    case Axis::Fraction:
      return "Reflectance or transmittance";
    case Axis::Absorption:
      return "Absorption in 1/m";
    case Axis::Observer:
      return "Colour matching functions";
    case Axis::Value:
      return "Value";
    default:
      return "Index of refraction n; k dashed";
  }
}

struct Curve {
  std::string name;
  std::vector<Vec2d> points;
  std::vector<SpectralLine> lines;
  bool dashed = false;
  std::size_t color = 0;
};

constexpr double kStep_nm = 1.0;

// At every nm, and at the points of a table between them.
template <typename Function>
std::vector<Vec2d> sampled(const std::pair<double, double>& range_nm, const Spectrum* table,
                           const Function& function) {
  std::vector<double> wavelengths_nm;
  for (double nm = range_nm.first; nm < range_nm.second; nm += kStep_nm)
    wavelengths_nm.push_back(nm);
  wavelengths_nm.push_back(range_nm.second);
  if (table) {
    for (const double nm : table->table_points_nm()) {
      if (nm > range_nm.first && nm < range_nm.second) wavelengths_nm.push_back(nm);
    }
    std::sort(wavelengths_nm.begin(), wavelengths_nm.end());
    wavelengths_nm.erase(std::unique(wavelengths_nm.begin(), wavelengths_nm.end()),
                         wavelengths_nm.end());
  }
  std::vector<Vec2d> points;
  points.reserve(wavelengths_nm.size());
  for (const double nm : wavelengths_nm) points.emplace_back(nm, function(nm));
  return points;
}

// A measurement is drawn where it was measured; a formula over the whole range.
std::pair<double, double> drawn_range(const CatalogueEntry& entry,
                                      const std::pair<double, double>& range_nm) {
  const bool is_formula =
      entry.dispersion && !std::holds_alternative<TabulatedIndex>(*entry.dispersion);
  if (is_formula) return range_nm;
  return {std::max(range_nm.first, entry.range_min_nm),
          std::min(range_nm.second, entry.range_max_nm)};
}

std::vector<Curve> curves_of(const CatalogueEntry& entry, std::size_t color,
                             const std::pair<double, double>& range_nm) {
  const std::string name = last_part(entry.id);
  const std::pair<double, double> drawn = drawn_range(entry, range_nm);
  std::vector<Curve> curves;
  const auto add = [&](const Spectrum& spectrum, const std::string& what, bool dashed,
                       std::size_t number) {
    if (drawn.first >= drawn.second) return;
    curves.push_back({what,
                      sampled(drawn, &spectrum, [&](double nm) { return spectrum.value(nm); }),
                      {},
                      dashed,
                      number});
  };
  if (entry.observer) {
    add(entry.observer->x_bar, name + " x", false, color);
    add(entry.observer->y_bar, name + " y", false, color + 1);
    add(entry.observer->z_bar, name + " z", false, color + 2);
  } else if (entry.quantity == "complex index") {
    if (entry.n) add(*entry.n, name + " n", false, color);
    if (entry.k) add(*entry.k, name + " k", true, color);
  } else if (entry.dispersion) {
    if (drawn.first < drawn.second) {
      curves.push_back({name,
                        sampled(drawn, nullptr,
                                [&](double nm) { return refractive_index(*entry.dispersion, nm); }),
                        {},
                        false,
                        color});
    }
  } else if (entry.spectrum) {
    if (!entry.spectrum->is_lines_only()) add(*entry.spectrum, name, false, color);
    if (!entry.spectrum->lines().empty()) {
      if (curves.empty()) curves.push_back({name, {}, {}, false, color});
      for (const SpectralLine& line : entry.spectrum->lines()) curves.back().lines.push_back(line);
    }
  }
  return curves;
}

void scale_to_highest(std::vector<Curve>& curves) {
  for (Curve& curve : curves) {
    double highest = 0.0, strongest = 0.0;
    for (const Vec2d& point : curve.points) highest = std::max(highest, point.y);
    for (const SpectralLine& line : curve.lines) strongest = std::max(strongest, line.strength);
    if (highest > 0.0) {
      for (Vec2d& point : curve.points) point.y /= highest;
    }
    if (strongest > 0.0) {
      for (SpectralLine& line : curve.lines) line.strength /= strongest;
    }
  }
}

SvgAxis value_axis(Axis axis, const std::vector<Curve>& curves) {
  if (axis == Axis::Emission) return {label_of(axis), 0.0, 1.05};
  if (axis == Axis::Fraction) return {label_of(axis), 0.0, 1.0};
  double low = kInfinity, high = -kInfinity;
  for (const Curve& curve : curves) {
    for (const Vec2d& point : curve.points) {
      low = std::min(low, point.y);
      high = std::max(high, point.y);
    }
  }
  const bool has_k =
      std::any_of(curves.begin(), curves.end(), [](const Curve& curve) { return curve.dashed; });
  if (axis != Axis::Index || has_k) low = std::min(low, 0.0);
  // A constant still needs an axis with two ends.
  const double margin = std::max(0.05 * (high - low), 1e-3 * std::max(std::abs(high), 1e-3));
  return {label_of(axis), low == 0.0 ? 0.0 : low - margin, high + margin};
}

}  // namespace

std::string plot_curves(const std::vector<CatalogueEntry>& entries,
                        const std::pair<double, double>& range_nm, const Observer& observer) {
  const Axis axis = axis_of(entries.front());
  std::vector<Curve> curves;
  std::string title;
  for (const CatalogueEntry& entry : entries) {
    if (axis_of(entry) != axis) {
      throw_usage_error("entries",
                        fmt::format("{} ({}) beside {} ({})", entry.id, entry.quantity,
                                    entries.front().id, entries.front().quantity),
                        "spectra of one quantity in one plot");
    }
    const std::size_t next = curves.empty() ? 0 : curves.back().color + 1;
    for (Curve& curve : curves_of(entry, next, range_nm)) curves.push_back(std::move(curve));
    title += (title.empty() ? "" : ", ") + last_part(entry.id);
  }
  const bool is_empty = std::none_of(curves.begin(), curves.end(), [](const Curve& curve) {
    return !curve.points.empty() || !curve.lines.empty();
  });
  if (is_empty) {
    throw_usage_error(
        "range_nm", fmt::format("{} to {} nm", range_nm.first, range_nm.second),
        fmt::format("a part of {} to {} nm, where {} was measured", entries.front().range_min_nm,
                    entries.front().range_max_nm, entries.front().id));
  }
  if (axis == Axis::Emission) scale_to_highest(curves);
  constexpr std::size_t kLongestTitle = 90;
  if (title.size() > kLongestTitle) title = fmt::format("{} spectra", entries.size());
  if (entries.size() == 1 && !entries.front().name.empty()) title = entries.front().name;

  SvgDiagram diagram(title, {"Wavelength in nm", range_nm.first, range_nm.second},
                     value_axis(axis, curves), kFrame_px);
  constexpr int kStrip_px = 26;
  diagram.strip_below(kStrip_px);
  const SpectrumColors colors(observer);
  const double cell_nm = (range_nm.second - range_nm.first) / 235.0;
  for (int i = 0; i < 235; ++i) {
    const double nm = range_nm.first + i * cell_nm;
    diagram.strip_cell(nm, nm + cell_nm, svg_color(colors.at(nm + 0.5 * cell_nm)));
  }
  for (const Curve& curve : curves) {
    const char* color = kColors[curve.color % kColors.size()];
    constexpr double kWidth_px = 2.0, kLineWidth_px = 2.5;
    if (!curve.points.empty()) diagram.line(curve.points, color, kWidth_px, curve.dashed);
    for (const SpectralLine& line : curve.lines) {
      diagram.line({{line.wavelength_nm, 0.0}, {line.wavelength_nm, line.strength}}, color,
                   kLineWidth_px);
    }
    diagram.key(curve.name, color, curve.dashed);
  }
  return diagram.text();
}

std::string plot_glass_map(const std::vector<CatalogueEntry>& entries) {
  struct Glass {
    std::string name, family;
    Vec2d at;
  };
  std::vector<Glass> glasses;
  std::vector<std::string> families;
  Vec2d low{kInfinity}, high{-kInfinity};
  for (const CatalogueEntry& entry : entries) {
    if (!entry.dispersion || !std::isfinite(abbe_number(*entry.dispersion))) {
      throw_usage_error("entries", fmt::format("{} ({})", entry.id, entry.quantity),
                        "a glass, crystal, liquid or plastic with dispersion");
    }
    const Vec2d at{abbe_number(*entry.dispersion), refractive_index(*entry.dispersion, kLine_d_nm)};
    low = {std::min(low.x, at.x), std::min(low.y, at.y)};
    high = {std::max(high.x, at.x), std::max(high.y, at.y)};
    const std::size_t slash = entry.id.rfind('/');
    const std::string family = slash == std::string::npos ? "file" : entry.id.substr(0, slash);
    if (std::find(families.begin(), families.end(), family) == families.end()) {
      families.push_back(family);
    }
    glasses.push_back({last_part(entry.id), family, at});
  }
  constexpr Vec2i kMap_px{860, 620};
  SvgDiagram diagram("Glass map", {"Abbe number V_d", high.x + 4.0, low.x - 4.0},
                     {"Index of refraction n_d", low.y - 0.03, high.y + 0.03}, kMap_px);
  for (const Glass& glass : glasses) {
    const auto family =
        std::find(families.begin(), families.end(), glass.family) - families.begin();
    diagram.dot(glass.at, 4.0, kColors[static_cast<std::size_t>(family) % kColors.size()]);
  }
  // After all dots, so that no name covers one.
  for (const Glass& glass : glasses) diagram.label_where_free(glass.at, glass.name);
  for (std::size_t i = 0; i < families.size(); ++i) {
    diagram.key(families[i], kColors[i % kColors.size()]);
  }
  return diagram.text();
}

namespace {

// Of the gamuts, in the order of rgb_spaces().
constexpr std::array<const char*, 4> kGamutColors{"#000000", "#0072b2", "#d55e00", "#8a4f7d"};

std::vector<Vec2d> spectrum_locus(const Observer& observer) {
  std::vector<Vec2d> locus;
  // Below 380 and above 700 nm the table's few digits make the locus shake in one spot.
  for (double nm = 380.0; nm <= 700.0; nm += 1.0) locus.push_back(xy_of_xyz(xyz_at(nm, observer)));
  return locus;
}

// The colour of a chromaticity at the brightness at which its largest channel is full.
std::string color_of_xy(const Vec2d& xy) {
  Vec3d rgb = xyz_to_rec709() * Vec3d{xy.x / xy.y, 1.0, (1.0 - xy.x - xy.y) / xy.y};
  rgb = {std::max(rgb.x, 0.0), std::max(rgb.y, 0.0), std::max(rgb.z, 0.0)};
  return svg_color(encoded(rgb / std::max({rgb.x, rgb.y, rgb.z})));
}

}  // namespace

std::string plot_chromaticity(const std::vector<CatalogueEntry>& entries,
                              const Observer& observer) {
  constexpr Vec2i kSquare_px{640, 720};
  SvgDiagram diagram("Chromaticity", {"x", 0.0, 0.8}, {"y", 0.0, 0.9}, kSquare_px);
  const std::vector<Vec2d> locus = spectrum_locus(observer);
  diagram.begin_clip(locus);
  constexpr double kCell = 0.0125;
  for (int row = 0; row < 72; ++row) {
    for (int column = 0; column < 64; ++column) {
      const Vec2d from{column * kCell, row * kCell}, to{from.x + kCell, from.y + kCell};
      if (from.x + from.y > 1.0) continue;
      diagram.cell(from, to, color_of_xy(0.5 * (from + to)));
    }
  }
  diagram.end_clip();
  diagram.line(locus, kInk, 1.5, false, true);
  for (double nm = 460.0; nm <= 640.0; nm += nm < 480.0 || nm >= 620.0 ? 20.0 : 10.0) {
    const Vec2d at = xy_of_xyz(xyz_at(nm, observer));
    const bool is_left = nm <= 510.0;
    diagram.dot(at, 2.0, kInk);
    diagram.label(at, {is_left ? -6.0 : 6.0, nm == 520.0 ? -4.0 : 3.0}, fmt::format("{:.0f}", nm),
                  "", is_left);
  }
  for (std::size_t i = 0; i < rgb_spaces().size(); ++i) {
    const RgbPrimaries& gamut = rgb_spaces()[i];
    const std::vector<Vec2d> triangle(gamut.primaries_xy.begin(), gamut.primaries_xy.end());
    diagram.line(triangle, kGamutColors.at(i), 1.5, false, true);
    diagram.key(gamut.title, kGamutColors.at(i));
  }
  std::vector<Vec2d> planckian;
  for (double mired = 20.0; mired <= 1000.0; mired += 10.0) {
    planckian.push_back(xy_of_xyz(xyz_of(Spectrum::blackbody(1e6 / mired), observer)));
  }
  diagram.line(planckian, kInk, 1.5, true);
  diagram.key("Black bodies", kInk, true);
  std::vector<std::pair<std::string, Vec2d>> lamps;
  for (const CatalogueEntry& entry : entries) {
    if (entry.quantity != "emission") {
      throw_usage_error("entries", fmt::format("{} ({})", entry.id, entry.quantity), "a lamp");
    }
    lamps.emplace_back(last_part(entry.id), xy_of_xyz(xyz_of(*entry.spectrum, observer)));
    diagram.dot(lamps.back().second, 4.0, kInk);
  }
  for (const auto& [name, at] : lamps) diagram.label_where_free(at, name);
  return diagram.text();
}

}  // namespace abbe
