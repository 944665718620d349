/// Where spectra have bands too narrow for wavelengths that are drawn without regard to them.
#pragma once

#include <span>
#include <vector>

#include "abbe/spectrum/spectrum.h"

namespace abbe {

/// A stretch of wavelengths.
struct NarrowBand {
  double low_nm = 0.0, high_nm = 0.0;
};

/// The bands and gaps of tabulated reflectances or transmittances that are narrower than 8 nm and
/// higher (deeper) than 0.15, with their slopes: where a spectrum is above its morphological
/// opening, or below its closing, by an interval of 8 nm. Steps and wider bands, however steep, are
/// none: few wavelengths resolve those.
/// Shape:  rising, apart from each other; what overlaps is one, and is cut into pieces of at most
///         8 nm.
/// Source: the top-hat transforms of Serra, Image Analysis and Mathematical Morphology, 1982.
std::vector<NarrowBand> narrow_bands(std::span<const Spectrum> spectra);

}  // namespace abbe
