/// Sums per pixel and their development into an image.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "abbe/film/bands.h"
#include "abbe/image/image.h"
#include "abbe/math/vec.h"

namespace abbe {

/// How the samples of a pixel make the value of an extra channel.
enum class AovRule : std::uint8_t {
  Mean,   ///< The filtered mean, like colour: albedo, costs.
  First,  ///< The value of the pixel's first sample, where a mean means nothing: ids, depth,
          ///< normals.
  Count,  ///< How many samples the pixel has; what is added to it counts for nothing.
};

/// An extra channel of an image.
struct AovChannel {
  std::string name;
  AovRule rule = AovRule::Mean;
};

/// The channel of that name with the rule that suits it: Mean for colours, spectra and `cost.*`,
/// Count for `samples`, First for all others.
AovChannel aov_channel(const std::string& name);

/// Pixels [x0, x1) × [y0, y1).
struct PixelRect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  bool operator==(const PixelRect&) const = default;
  bool contains(const Vec2i& pixel) const {
    return pixel.x >= x0 && pixel.x < x1 && pixel.y >= y0 && pixel.y < y1;
  }
};

/// What a film holds.
struct FilmOptions {
  Vec2i full_size{0, 0};
  std::optional<PixelRect> crop = {};     ///< Default: the whole image.
  std::optional<BandOptions> bands = {};  ///< Spectral channels beside the colour.
  /// Spectral channels at exactly these wavelengths instead of bands.
  std::vector<double> lines_nm = {};
  std::vector<AovChannel> aovs = {};
  float weight_magnitude = 1.0f;  ///< Filter::weight_magnitude() of the filter used.
};

/// Errors: a usage Error for an empty or too large size, a crop that is empty or leaves it, as
///         check_bands, and for channels of the same name.
void check_film(const FilmOptions& options);

/// How a film becomes an image.
struct FilmDevelopment {
  /// From what was added as `xyz` to linear Rec.709; Development::xyz_to_rec709, or the identity
  /// for a film that was given linear Rec.709.
  Mat3d xyz_to_rec709{1.0};
  std::map<std::string, Attribute> attributes = {};  ///< Provenance, copied to the image.
};

/// Accumulates the samples of each pixel of a crop. Different pixels may be added to by different
/// threads at a time; the samples of one pixel come from one thread at a time, in their order.
///
/// With a filter of negative lobes, samples of positive and of negative weight are averaged apart
/// and then combined as S₊·mean₊ − S₋·mean₋, S± = (∫|f|/∫f ± 1)/2: right in expectation, exact for
/// a constant, and never a quotient of two small differences. A pixel where one sign is still
/// missing shows the mean of the other.
class Film {
 public:
  /// Errors: as check_film.
  explicit Film(const FilmOptions& options);
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;

  /// Adds one camera sample. A sample that is not finite is dropped and counted.
  /// Shape:  `bands` holds spectral_count() values or none, `aovs` as many as FilmOptions::aovs.
  /// Units:  xyz in cd/m²; bands the sample's mean spectral radiance of each band,
  ///         W·m⁻²·sr⁻¹·nm⁻¹ (of lines: spectral radiance).
  /// Domain: pixel inside crop(), in coordinates of the full image; weight ±weight_magnitude.
  void add(const Vec2i& pixel, float weight, const Vec3f& xyz, std::span<const float> bands = {},
           std::span<const float> aovs = {});

  /// R, G, B, then the spectral channels in order of wavelength, then the AOVs in theirs. Pixels
  /// without samples are 0.
  Image develop(const FilmDevelopment& development) const;

  const FilmOptions& options() const { return options_; }
  const PixelRect& crop() const { return crop_; }
  std::size_t sample_count(const Vec2i& pixel) const;
  std::size_t dropped_sample_count() const { return dropped_.load(std::memory_order_relaxed); }
  std::size_t bytes() const;

 private:
  /// What one sign of weight has added up to. Colour is summed in double precision: the sum of up
  /// to 2^29 equal floats is exact. Bands and mean AOVs are running means, exact for constants at
  /// half the memory.
  struct Sums {
    std::vector<double> xyz;
    std::vector<float> extra;
    std::vector<std::uint32_t> count;
  };

  std::size_t pixel_index(const Vec2i& pixel) const;
  void develop_pixel(std::size_t pixel, const Mat3d& xyz_to_rec709, float* out) const;

  FilmOptions options_;
  PixelRect crop_;
  std::size_t spectral_count_ = 0;
  std::size_t extra_count_ = 0;
  Sums positive_;
  Sums negative_;  ///< Empty unless the filter has negative lobes.
  std::atomic<std::size_t> dropped_{0};
};

}  // namespace abbe
