/// What a user should know of a measured material: where it was not measured.
#pragma once

#include <string>

#include "abbe/base/notes.h"
#include "abbe/load/spectra/catalogue.h"
#include "abbe/math/vec.h"

namespace abbe {

/// What of 360 to 830 nm a stated range leaves out: "360-370 nm and 700-830 nm", or nothing.
std::string missing_range_text(const Vec2d& stated_nm);

/// Whether a stated range leaves out a part of 400 to 700 nm, where all but 0.3 % of the observer's
/// weight lies.
bool misses_the_visible(const Vec2d& stated_nm);

/// One warning, at most, that names material and range: when the index of an entry is not stated
/// for all of 400 to 700 nm, or its formula breaks down within 360 to 830 nm.
void warn_of_range(const CatalogueEntry& entry, const std::string& material,
                   const std::string& where, Notes& notes);

/// The same for a formula that a scene states itself.
void warn_of_pole(const Dispersion& dispersion, const std::string& material,
                  const std::string& where, Notes& notes);

}  // namespace abbe
