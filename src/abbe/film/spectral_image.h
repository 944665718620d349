/// Colours of images that hold spectra.
#pragma once

#include "abbe/color/development.h"
#include "abbe/image/image.h"

namespace abbe {

/// Whether an image has emissive spectral channels, S0.….
bool has_spectrum(const Image& image);

/// R, G and B, linear Rec.709, of an image's spectral channels, under any observer and white. A
/// band reaches half way to its neighbours and counts with the mean of the observer over it; lines
/// (the attribute `abbe:lines`) count with 1 nm at their wavelength, as when they were rendered.
/// Shape:  channels R, G, B of the same pixels and windows, without attributes.
/// Errors: an input Error for an image without spectral channels, or with a single band, whose
/// width
///         nothing tells.
Image developed(const Image& spectral, const DevelopmentOptions& options,
                const Observer& photometer, const Spectrum& d65);

}  // namespace abbe
