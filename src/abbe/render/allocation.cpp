#include "abbe/render/allocation.h"

#include <algorithm>
#include <cmath>

#include "abbe/color/color.h"

namespace abbe {
namespace {

constexpr int kBlock = SampleAllocation::kBlock_px;
/// Neighbours are at most this far away, along each axis.
constexpr int kReach_px = 4;
/// How fast their weight falls with the square of their distance.
constexpr double kFade_per_px2 = 3.0;
/// Samples grow with this power of the squared error of one: the error left grows with its third
/// root then.
constexpr double kGrowth = 2.0 / 3.0;
/// A mean over the root mean square, of squares of normally distributed numbers.
constexpr double kOfMean = 0.5773502691896258;

PixelRect whole_blocks(const FilmOptions& film) {
  const Vec2i& size = film.full_size;
  const PixelRect crop = film.crop.value_or(PixelRect{0, 0, size.x, size.y});
  const auto up = [](int px, int most) {
    return std::min((px + kBlock - 1) / kBlock * kBlock, most);
  };
  return {crop.x0 / kBlock * kBlock, crop.y0 / kBlock * kBlock, up(crop.x1, size.x),
          up(crop.y1, size.y)};
}

// 8, 12, 16, 20, 24, 28, 32, 40, 48, …: by powers of two, from a half to an eighth of what is
// there; the bound ends them.
std::vector<SampleAllocation::Step> steps_up_to(int most) {
  std::vector<SampleAllocation::Step> steps;
  int begin = 0;
  int size = kPilotSamples / 2;
  for (int end = kPilotSamples; end < most; end += size) {
    steps.push_back({begin, end});
    begin = end;
    if (end >= 8 * size) size *= 2;
  }
  steps.push_back({begin, most});
  return steps;
}

/// A number for each pixel of a block, which the edge of the image may cut.
struct BlockField {
  std::array<double, std::size_t{kBlock} * kBlock> values{};

  double& at(int u, int v) { return values[index_of(u, v)]; }
  double at(int u, int v) const { return values[index_of(u, v)]; }

  static std::size_t index_of(int u, int v) {
    return static_cast<std::size_t>(v) * kBlock + static_cast<std::size_t>(u);
  }
};

// The root mean square of a field over the neighbours of a pixel, by nearness, without its own; a
// block of one pixel has no neighbours. Squares, so that a line one pixel wide is not lost among
// pixels that show nothing.
double root_mean_square_about(const BlockField& field, int x, int y, int width, int height) {
  double sum = 0.0, weights = 0.0;
  for (int v = std::max(y - kReach_px, 0); v < std::min(y + kReach_px + 1, height); ++v) {
    for (int u = std::max(x - kReach_px, 0); u < std::min(x + kReach_px + 1, width); ++u) {
      const int squared_distance = (u - x) * (u - x) + (v - y) * (v - y);
      if (squared_distance == 0) continue;
      const double weight = 1.0 / (1.0 + kFade_per_px2 * squared_distance);
      sum += weight * field.at(u, v) * field.at(u, v);
      weights += weight;
    }
  }
  return weights > 0.0 ? std::sqrt(sum / weights) : field.at(x, y);
}

}  // namespace

SampleAllocation::SampleAllocation(const RenderSettings& settings, const FilmOptions& film,
                                   const Mat3d& to_xyz)
    : region_(whole_blocks(film)),
      target_(settings.noise),
      to_shown_xyz_(std::exp2(settings.noise_exposure_ev) * to_xyz),
      steps_(steps_up_to(settings.samples_per_pixel)),
      pixels_(static_cast<std::size_t>(region_.width()) *
              static_cast<std::size_t>(region_.height())) {}

void SampleAllocation::add(const Vec2i& pixel, int half, const Vec3f& xyz) {
  if (!std::isfinite(xyz.x) || !std::isfinite(xyz.y) || !std::isfinite(xyz.z)) return;
  pixels_[index_of(pixel)].sums[static_cast<std::size_t>(half)] += xyz;
}

// One draw of the squared error of a pixel's mean.
double SampleAllocation::squared_error(const Pixel& pixel) const {
  static const Vec3d kWhite_xyz = xyz_of_xy(kD65_xy);
  const double samples_of_half = 0.5 * samples_of(pixel);
  const auto lab = [&](const Vec3f& sum) {
    return lab_of_xyz(to_shown_xyz_ * Vec3d(sum) / samples_of_half, kWhite_xyz);
  };
  const double error = 0.5 * delta_e2000(lab(pixel.sums[0]), lab(pixel.sums[1]));
  return error * error;
}

double SampleAllocation::decide(const PixelRect& block) {
  const int width = block.width(), height = block.height();
  BlockField of_sample;  // Squared errors as one sample would have them.
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const Pixel& pixel = pixels_[index_of({block.x0 + u, block.y0 + v})];
      of_sample.at(u, v) = squared_error(pixel) * samples_of(pixel);
    }
  }
  double samples = 0.0;
  const double most = steps_.back().end;
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      Pixel& pixel = pixels_[index_of({block.x0 + u, block.y0 + v})];
      const double even =
          kOfMean * root_mean_square_about(of_sample, u, v, width, height) / (target_ * target_);
      const double wanted = kEvenSamples * std::pow(even / kEvenSamples, kGrowth);
      while (samples_of(pixel) < std::min(wanted, most)) ++pixel.steps;
      pixel.is_bounded = wanted > most;
      samples += samples_of(pixel);
    }
  }
  return samples;
}

SampleAllocation::BlockError SampleAllocation::error(const PixelRect& block) const {
  BlockError error;
  for (int y = block.y0; y < block.y1; ++y) {
    for (int x = block.x0; x < block.x1; ++x) {
      const Pixel& pixel = pixels_[index_of({x, y})];
      error.squared += squared_error(pixel);
      if (pixel.is_bounded) error.unfinished += 1.0;
    }
  }
  return error;
}

}  // namespace abbe
