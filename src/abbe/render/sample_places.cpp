#include "abbe/render/sample_places.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "abbe/math/random.h"
#include "abbe/math/sampling.h"

namespace abbe {

std::uint64_t number_in_sequence(const RenderSettings& settings, std::uint32_t sample) {
  return std::uint64_t{settings.seed} * static_cast<std::uint32_t>(settings.samples_per_pixel) +
         sample;
}

float placed(float u, int dimension, std::uint32_t seed, int count) {
  const auto strata = static_cast<float>(std::bit_ceil(static_cast<std::uint32_t>(count)));
  const float within = unit_float(sobol(seed, dimension) ^ 0x80000000u);
  const float place = (std::floor(u * strata) + within) / strata;
  return std::min(place, std::nextafter(1.0f, 0.0f));  // Rounding may reach 1.
}

float placed_wavelength_shift(const RenderSettings& settings, std::uint32_t sample) {
  const auto at = static_cast<std::uint32_t>(number_in_sequence(settings, sample));
  const bool is_pilot = settings.noise > 0.0 && sample < kPilotSamples;
  return placed(wavelength_shift(at), kWavelengthDimension, settings.seed,
                is_pilot ? kPilotSamples : settings.samples_per_pixel);
}

}  // namespace abbe
