/// Chance by name: every random number of a render, drawn or reserved for what is to come.
///
/// A number is a function of (sample of its pixel, pixel, path, purpose), never of a thread, a lane
/// or a number drawn before it. Over the samples of a pixel each is a scrambled (0, 2)-sequence:
/// every prefix is well stratified, so the number of samples need not be known when the first is
/// drawn. (Places in the pixel and wavelength shifts are then moved within the finest strata that a
/// bound of that number fills.) What an effect to come draws is a new Purpose here; the numbers of
/// all others stay as they are.
#pragma once

#include <cstdint>

#include "abbe/math/vec.h"

namespace abbe {

/// What a random number decides.
enum class Purpose : std::uint8_t {
  // Once a sample. Together with its wavelength_shift() these are stratified jointly.
  Film,  ///< 2D. Where in the pixel's filter the ray starts.
  Fog,   ///< 1D. Where in its pieces of fog a path looks for light.
  // Once a sample, each stratified on its own.
  Lens,  ///< 2D. Where the ray passes the lens.
  Time,  ///< 1D. When the shutter lets it in.
  // At a surface or in fog, once a path and item.
  Roulette,     ///< 1D. Which lobe a faint path follows.
  Microfacet,   ///< 2D. The normal of a rough surface, shared by all lanes.
  Light,        ///< 1D. Whether a faint path of light is followed; an item is a chain.
  LightPoint,   ///< 2D. Where on a lamp with an area; an item is a lamp.
  Environment,  ///< 2D. A direction of light from all around.
  Phase,        ///< 2D. Where fog scatters to.
  Rebound,      ///< 2D. Whether light goes on among microfacets, and where it leaves them.
  Layer,        ///< 1D. Which of two rough layers draws where the ray goes.
};
inline constexpr int kPurposes = static_cast<int>(Purpose::Layer) + 1;

/// What all random numbers of a camera sample share. Renders with different seeds take other
/// stretches of the same sequences, as one render with more samples would.
struct SampleChance {
  std::uint32_t pixel = 0;  ///< Of pixel_chance(); the same for all samples of a pixel.
  std::uint32_t index = 0;  ///< Of the sample in its pixel's sequence: 0, 1, 2, … for seed 0.
};

/// The scramble of a pixel's numbers.
std::uint32_t pixel_chance(const Vec2i& pixel, std::uint32_t seed);

/// What has happened to a ray since it left the camera, as a word. Samples of a pixel whose paths
/// have the same word draw from one stratified sequence.
inline constexpr std::uint64_t kCameraPath = 0;

/// The path that goes on after an event: a number of what happened there, such as the lobe
/// followed.
std::uint64_t path_after(std::uint64_t path, std::uint32_t event);

/// The random numbers of a purpose.
/// Shape:  in [0, 1), or [0, 1)². Of a pixel, path, purpose and item the first 2^k samples, and
/// each
///         2^k after them, have one number in each of 2^k equal parts of [0, 1), and one point in
///         each of 2^k equal boxes of any dyadic shape.
/// Domain: `item` counts things of one kind that draw apart at one place, as lamps do.
/// Source: Sobol' 1967; Burley, Practical hash-based Owen scrambling, JCGT 9(4), 2020.
float random_1d(const SampleChance& sample, std::uint64_t path, Purpose purpose,
                std::uint32_t item = 0);
Vec2f random_2d(const SampleChance& sample, std::uint64_t path, Purpose purpose,
                std::uint32_t item = 0);

/// The dimension of sobol() that shifts the wavelengths of a camera sample.
inline constexpr int kWavelengthDimension = 2;

/// By what share of a stratum the wavelengths of a pixel's sample are shifted: one sequence for all
/// pixels, so that neighbours that see the same light get the same colour, and lanes of
/// all samples together divide the spectrum evenly.
/// Shape: in [0, 1); every prefix is stratified as random_1d is.
float wavelength_shift(std::uint32_t sample_index);

/// The grain that hides steps of integer codes; belongs to a place of the full image and a channel,
/// not to a sample, so that a crop has the grain of the whole.
/// Shape: in (−1, 1), the sum of two uniform numbers.
float dither_noise(const Vec2i& place, std::uint32_t channel);

}  // namespace abbe
