/// Three spectra that share out the light among the channels of linear Rec.709.
#pragma once

#include <array>
#include <optional>

#include "abbe/color/color.h"
#include "abbe/spectrum/observer.h"
#include "abbe/spectrum/spectrum.h"

namespace abbe {

/// b_R, b_G, b_B of a triple r, g, b: the spectrum r·b_R + g·b_G + b·b_B has that colour under D65,
/// exactly and for any triple, negative ones too. They are positive and add up to 1 at every
/// wavelength: the triple 1, 1, 1 is the spectrum 1. b_c is exp(q_c)/(exp(q_R) + exp(q_G) +
/// exp(q_B)), where q_R and q_G are quadratic in the wavelength and q_B is 0: six coefficients for
/// the six independent numbers that the three colours are.
/// Against smooth reflectances (color/uplift.h): these are linear in the triple, so that a product
/// of triples, channel by channel, is still a triple; each of them is as saturated as its primary.
using ChannelBasis = std::array<Spectrum, 3>;

/// The basis for an observer, tabulated at 1 nm over 360–830 nm.
/// Domain: `development` is that of the observer with D65 for white, as the RGB modes have it.
/// Errors: none; nothing when no such spectra exist, as may be for a camera.
std::optional<ChannelBasis> channel_basis(const Observer& observer, const Spectrum& d65,
                                          const Development& development);

}  // namespace abbe
