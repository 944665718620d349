#include "abbe/math/random.h"

#include "abbe/math/sampling.h"

namespace abbe {
namespace {

/// What digits that all pixels share are flipped by: 16 samples then lie in the middles of 16
/// parts, 4 and 8 between a quarter and three quarters of theirs, more at the ends of ever smaller
/// ones.
constexpr std::uint32_t kMiddle = 0xa8000000u;
/// Digits of a place on the film that are scrambled from pixel to pixel. The others are shared, so
/// that along one axis 4, 8, 16, … samples lie alike in all pixels: an edge along an axis, a fringe
/// or a gradient has no noise from them. What goes with what of the two axes differs from pixel to
/// pixel, so that slanted edges show noise, never a pattern.
constexpr int kFilmDigits = 2;

/// The seeds of one use's numbers.
struct Scramble {
  std::uint32_t index, first, second;
};

Scramble scramble_of(const SampleChance& sample, std::uint64_t path, Purpose purpose,
                     std::uint32_t item) {
  const std::uint64_t use = (static_cast<std::uint64_t>(purpose) << 32) | sample.pixel;
  const std::uint64_t key = hash64(hash64(path + item) ^ use);
  const std::uint64_t more = hash64(key);
  return {static_cast<std::uint32_t>(key >> 32), static_cast<std::uint32_t>(more),
          static_cast<std::uint32_t>(more >> 32)};
}

std::uint32_t film_scrambled(std::uint32_t fraction, std::uint32_t seed) {
  constexpr std::uint32_t kShared = 0xffffffffu >> kFilmDigits;
  return (owen_scrambled(fraction, seed) & ~kShared) | ((fraction ^ kMiddle) & kShared);
}

}  // namespace

std::uint32_t pixel_chance(const Vec2i& pixel, std::uint32_t seed) {
  return hash32(hash32(static_cast<std::uint32_t>(pixel.x), static_cast<std::uint32_t>(pixel.y)),
                seed);
}

std::uint64_t path_after(std::uint64_t path, std::uint32_t event) {
  return hash64(path + event + 1);
}

// What a camera sample draws once takes dimensions of one sequence at the sample's own index: the
// film 0 and 1, wavelengths 2, fog 3. All else takes dimensions 0 and 1 at an index of its own,
// which Owen's scramble of the index chooses: each 2^k samples stay an aligned block of 2^k, and no
// two uses are tied together.

float random_1d(const SampleChance& sample, std::uint64_t path, Purpose purpose,
                std::uint32_t item) {
  const Scramble scramble = scramble_of(sample, path, purpose, item);
  const std::uint32_t fraction = path == kCameraPath && purpose == Purpose::Fog
                                     ? sobol(sample.index, 3)
                                     : sobol(owen_scrambled(sample.index, scramble.index), 0);
  return unit_float(owen_scrambled(fraction, scramble.first));
}

Vec2f random_2d(const SampleChance& sample, std::uint64_t path, Purpose purpose,
                std::uint32_t item) {
  const Scramble scramble = scramble_of(sample, path, purpose, item);
  if (path == kCameraPath && purpose == Purpose::Film) {
    return {unit_float(film_scrambled(sobol(sample.index, 0), scramble.first)),
            unit_float(film_scrambled(sobol(sample.index, 1), scramble.second))};
  }
  const std::uint32_t index = owen_scrambled(sample.index, scramble.index);
  return {unit_float(owen_scrambled(sobol(index, 0), scramble.first)),
          unit_float(owen_scrambled(sobol(index, 1), scramble.second))};
}

float wavelength_shift(std::uint32_t sample_index) {
  return unit_float(sobol(sample_index, kWavelengthDimension) ^ kMiddle);
}

float dither_noise(const Vec2i& place, std::uint32_t channel) {
  const std::uint32_t bits = hash32(
      hash32(static_cast<std::uint32_t>(place.x), static_cast<std::uint32_t>(place.y)), channel);
  return unit_float(bits) - unit_float(hash32(bits ^ 0x5bd1e995u));
}

}  // namespace abbe
