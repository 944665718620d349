#include "abbe/load/spectra/range_notes.h"

#include <fmt/format.h>

#include "abbe/base/constants.h"

namespace abbe {
namespace {

std::string pole_text(double wavelength_nm) {
  return fmt::format("its formula breaks down at {:g} nm, where n is limited to 1 to 1000",
                     wavelength_nm);
}

}  // namespace

std::string missing_range_text(const Vec2d& stated_nm) {
  std::string text;
  if (stated_nm.x > kRangeMin_nm) text = fmt::format("{:g}-{:g} nm", kRangeMin_nm, stated_nm.x);
  if (stated_nm.y < kRangeMax_nm) {
    if (!text.empty()) text += " and ";
    text += fmt::format("{:g}-{:g} nm", stated_nm.y, kRangeMax_nm);
  }
  return text;
}

bool misses_the_visible(const Vec2d& stated_nm) {
  return stated_nm.x > 400.0 || stated_nm.y < 700.0;
}

void warn_of_range(const CatalogueEntry& entry, const std::string& material,
                   const std::string& where, Notes& notes) {
  const bool is_formula =
      entry.dispersion && !std::holds_alternative<TabulatedIndex>(*entry.dispersion);
  const Vec2d stated_nm(entry.range_min_nm, entry.range_max_nm);
  const auto pole_nm = entry.dispersion ? breakdown_nm(*entry.dispersion) : std::nullopt;
  std::string text;
  if (misses_the_visible(stated_nm)) {
    text = fmt::format("{} at {}", is_formula ? "n is extrapolated" : "the table is held constant",
                       missing_range_text(stated_nm));
  }
  if (pole_nm) text += (text.empty() ? "" : ", and ") + pole_text(*pole_nm);
  if (text.empty()) return;
  notes.warn(where, fmt::format("material \"{}\": {} is stated for {:g}-{:g} nm; {}", material,
                                entry.id, entry.range_min_nm, entry.range_max_nm, text));
}

void warn_of_pole(const Dispersion& dispersion, const std::string& material,
                  const std::string& where, Notes& notes) {
  if (const auto pole_nm = breakdown_nm(dispersion)) {
    notes.warn(where, fmt::format("material \"{}\", within {:g}-{:g} nm: {}", material,
                                  kRangeMin_nm, kRangeMax_nm, pole_text(*pole_nm)));
  }
}

}  // namespace abbe
