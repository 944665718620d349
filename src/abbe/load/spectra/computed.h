/// Lamps that a number names: `daylight/6504` and `blackbody/2856`, temperatures in K.
#pragma once

#include <string>

#include "abbe/color/lamp/daylight.h"
#include "abbe/load/spectra/catalogue.h"

namespace abbe {

/// Whether an id is one of these: a number after `daylight/` or `blackbody/`.
/// Errors: input Error at `where` for a temperature outside 4000 to 25 000 K of daylight, or 300 to
///         1 000 000 K of a black body.
bool is_computed_id(const std::string& id, const std::string& where);

/// Domain: an id of which is_computed_id says so.
CatalogueEntry computed_entry(const std::string& id, const Catalogue& catalogue);

/// The components of daylight in the catalogue.
DaylightComponents daylight_components(const Catalogue& catalogue);

}  // namespace abbe
