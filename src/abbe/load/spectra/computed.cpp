#include "abbe/load/spectra/computed.h"

#include <fmt/format.h>

#include "abbe/base/error.h"
#include "abbe/load/spectra/text.h"

namespace abbe {
namespace {

constexpr std::string_view kDaylight = "daylight/";
constexpr std::string_view kBlackbody = "blackbody/";
constexpr double kColdest_K = 300.0, kHottest_K = 1e6;

std::optional<double> temperature_behind(std::string_view prefix, std::string_view id) {
  if (!id.starts_with(prefix)) return std::nullopt;
  return finite_number_of(id.substr(prefix.size()));
}

void check(double temperature_K, double coldest_K, double hottest_K, const std::string& id,
           const std::string& where) {
  if (temperature_K >= coldest_K && temperature_K <= hottest_K) return;
  throw_input_error(where, "\"" + id + "\"",
                    fmt::format("a temperature from {:g} to {:g} K", coldest_K, hottest_K));
}

}  // namespace

bool is_computed_id(const std::string& id, const std::string& where) {
  if (const auto temperature_K = temperature_behind(kDaylight, id)) {
    check(*temperature_K, kWarmestDaylight_K, kCoolestDaylight_K, id, where);
    return true;
  }
  const auto temperature_K = temperature_behind(kBlackbody, id);
  if (temperature_K) check(*temperature_K, kColdest_K, kHottest_K, id, where);
  return temperature_K.has_value();
}

CatalogueEntry computed_entry(const std::string& id, const Catalogue& catalogue) {
  CatalogueEntry entry;
  entry.id = id;
  entry.quantity = "emission";
  entry.licence = "CC0-1.0 (computed from the formula)";
  if (const auto temperature_K = temperature_behind(kDaylight, id)) {
    const DaylightComponents components = daylight_components(catalogue);
    entry.unit = "relative";
    entry.name = fmt::format("CIE daylight of {:g} K", *temperature_K);
    entry.source = "CIE 15:2018, Colorimetry, 4th edition (2018): daylight of any temperature";
    entry.doi = "10.25039/TR.015.2018";
    entry.range_min_nm = components.S0.table_points_nm().front();
    entry.range_max_nm = components.S0.table_points_nm().back();
    entry.spectrum = daylight(*temperature_K, components);
    return entry;
  }
  const double temperature_K = temperature_behind(kBlackbody, id).value();
  entry.unit = "W/(m2 sr nm)";
  entry.name = fmt::format("Black body of {:g} K", temperature_K);
  entry.source = "Planck's law with the constants of CODATA 2018";
  entry.range_min_nm = 1.0;
  entry.range_max_nm = 1e6;
  entry.spectrum = Spectrum::blackbody(temperature_K);
  return entry;
}

DaylightComponents daylight_components(const Catalogue& catalogue) {
  const auto component = [&catalogue](const char* id) {
    const CatalogueEntry entry = catalogue.entry(id, id);
    if (!entry.spectrum) throw_input_error(id, entry.quantity, "a daylight component");
    return *entry.spectrum;
  };
  return {component("daylight/S0"), component("daylight/S1"), component("daylight/S2")};
}

}  // namespace abbe
