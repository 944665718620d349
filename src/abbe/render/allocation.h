/// Where camera samples are needed: how many each pixel takes.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "abbe/film/film.h"
#include "abbe/math/vec.h"
#include "abbe/render/sample_places.h"
#include "abbe/render/settings.h"

namespace abbe {

/// Gives pixels the samples that bring their error, as a person sees it, down to a target.
///
/// A pilot decides: the first kPilotSamples samples of every pixel. They fall into two halves, and
/// how far the means of these are apart, in CIEDE2000 at the exposure of the display, is twice one
/// draw of the error of the mean of all. How many samples a pixel gets is decided from the pilots
/// of its neighbours, by nearness, and not from any sample of its own: to stop where the samples of
/// a pixel happen to agree would miss light that few of them find, and pixels would be too dark
/// (Kirk & Arvo, Unbiased sampling techniques for image synthesis, SIGGRAPH 1991). So the mean of a
/// pixel's samples is what it would be with any fixed number of them. To go on deciding from what
/// comes after would be no better: what a pixel finds makes its neighbours look closer, and what
/// they find then sends it on.
///
/// The error that is allowed grows slowly with how much samples scatter, as noise hides in
/// contrast: with its third root, which is half way from the same error everywhere to the fewest
/// samples for the mean of all (Neyman's allocation). It is the target where that takes
/// kEvenSamples.
///
/// Only pixels of one block of the image are neighbours, so that a crop that is rendered in whole
/// blocks has the pixels of the whole image.
class SampleAllocation {
 public:
  /// Blocks have this width and height, and lie on a grid of the whole image.
  static constexpr int kBlock_px = 16;
  static constexpr double kEvenSamples = 16.0;

  /// Shape:  `to_xyz` turns what is added into XYZ, where xy 0.3127, 0.3290 at 1 cd/m² is Y = 1.
  /// Domain: settings.noise > 0; a film of these settings.
  SampleAllocation(const RenderSettings& settings, const FilmOptions& film, const Mat3d& to_xyz);

  /// The crop grown to whole blocks: the pixels that have to be rendered for it.
  const PixelRect& region() const { return region_; }

  /// Samples of a pixel from `begin` on, before `end`.
  struct Step {
    int begin = 0, end = 0;

    int half_of(int sample) const { return 2 * sample < begin + end ? 0 : 1; }
  };
  /// The steps in which the samples of a pixel grow, the pilot first; each is stratified as those
  /// before are.
  const std::vector<Step>& steps() const { return steps_; }

  /// How many steps a pixel shall have done.
  int steps_wanted(const Vec2i& pixel) const { return pixels_[index_of(pixel)].steps; }

  /// Adds a camera sample. Different pixels may be added to by different threads.
  /// Units: cd/m² of `to_xyz`. What is not finite is left out.
  void add(const Vec2i& pixel, int half, const Vec3f& xyz);

  /// Decides how many samples the pixels of a block shall have: their number.
  /// Domain: the pilots of the block have been added.
  double decide(const PixelRect& block);

  /// What the samples of a block show.
  struct BlockError {
    double squared = 0.0;     ///< Sum over its pixels of the squared error of their means.
    double unfinished = 0.0;  ///< Pixels for which the bound is too few.
  };
  /// Domain: the pixels of the block have the samples that they wanted.
  BlockError error(const PixelRect& block) const;

 private:
  struct Pixel {
    std::array<Vec3f, 2> sums{Vec3f(0.0f), Vec3f(0.0f)};  ///< Of both halves.
    std::int16_t steps = 1;
    bool is_bounded = false;  ///< Whether it would have more samples if it might.
  };

  std::size_t index_of(const Vec2i& pixel) const {
    return static_cast<std::size_t>(pixel.y - region_.y0) *
               static_cast<std::size_t>(region_.width()) +
           static_cast<std::size_t>(pixel.x - region_.x0);
  }
  int samples_of(const Pixel& pixel) const {
    return steps_[static_cast<std::size_t>(pixel.steps - 1)].end;
  }
  double squared_error(const Pixel& pixel) const;

  PixelRect region_;
  double target_ = 1.0;
  Mat3d to_shown_xyz_{1.0};
  std::vector<Step> steps_;
  std::vector<Pixel> pixels_;
};

}  // namespace abbe
