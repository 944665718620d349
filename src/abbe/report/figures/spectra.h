/// Diagrams of spectra, as SVG.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "abbe/load/spectra/catalogue.h"

namespace abbe {

/// Curves over a strip of the spectrum's colours. Lamps are drawn relative to their highest value,
/// n as a full line and k as a dashed one.
/// Domain: at least one entry; the range in nm rises, within 360 to 830.
/// Errors: a usage Error when the quantities do not share an axis.
std::string plot_curves(const std::vector<CatalogueEntry>& entries,
                        const std::pair<double, double>& range_nm, const Observer& observer);

/// n_d against V_d, which falls to the right as glass makers draw it.
/// Errors: a usage Error for what has no dispersion.
std::string plot_glass_map(const std::vector<CatalogueEntry>& entries);

/// CIE x, y: the spectrum locus, the Planckian locus, gamuts of Rec.709, Display P3, Rec.2020 and
/// ACEScg, and the colours of lamps.
/// Errors: a usage Error for what is no lamp.
std::string plot_chromaticity(const std::vector<CatalogueEntry>& entries, const Observer& observer);

}  // namespace abbe
