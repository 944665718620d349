/// Where the samples of a pixel lie in what they divide among them.
#pragma once

#include <cstdint>

#include "abbe/render/settings.h"

namespace abbe {

/// The number of a pixel's sample in the sequence of all. A seed is a stretch of one sequence, as
/// its samples would be in a render of many more; what passes its 32 bits scrambles the pixels.
std::uint64_t number_in_sequence(const RenderSettings& settings, std::uint32_t sample);

/// The place in the finest stratum that `count` samples of a pixel can fill: the same in all of
/// them, so that they are evenly apart, a quadrature rule where light changes evenly across a pixel
/// or a stratum of wavelengths. Seed 0 takes the middle, others go on from there, so that seeds
/// together fill finer strata. A bound of the number of samples is enough; coarser strata, and so
/// shorter prefixes, are filled as before.
/// Domain: u in [0, 1), of that dimension of sobol().
float placed(float u, int dimension, std::uint32_t seed, int count);

/// Samples of a pixel that are alone where RenderSettings::noise decides on more: they fill their
/// own strata.
inline constexpr int kPilotSamples = 8;

/// By what share of their strata the wavelengths of a sample are shifted, in every pixel.
float placed_wavelength_shift(const RenderSettings& settings, std::uint32_t sample);

}  // namespace abbe
