/// Reconstruction filters, importance-sampled: a camera sample belongs to one pixel.
#pragma once

#include <string>
#include <vector>

#include "abbe/math/vec.h"

namespace abbe {

/// Where in the film plane a camera sample of a pixel goes, and how it counts there.
struct FilterSample {
  Vec2f offset_px{0.0f};  ///< From the centre of the pixel; reaches into the neighbours.
  float weight = 1.0f;    ///< ±Filter::weight_magnitude().
};

/// A separable filter f(x)·f(y), drawn in proportion to |f|.
///
/// The weight is sign(f)·∫|f|/∫f: the mean of weight × radiance over the samples of a pixel is the
/// filtered radiance, also for filters with negative lobes.
class Filter {
 public:
  /// One of filter_names(). Errors: a usage Error that lists the names.
  static Filter named(const std::string& name);

  /// The sample at a point of the unit square. Monotone along each axis: strata stay strata.
  /// Domain: u in [0, 1]².
  /// Errors: none; the distribution is exact to 1e-4 of the filter's mass.
  FilterSample sample(const Vec2f& u) const;

  /// f along one axis, with ∫f = 1; 0 outside the radius.
  double value(double offset_px) const;

  /// ∫f below an offset. Domain: filters that are never negative.
  double share_below(double offset_px) const;
  bool is_negative_anywhere() const { return weight_magnitude_ > 1.0f; }

  const std::string& name() const { return name_; }
  float radius_px() const { return static_cast<float>(radius_px_); }
  /// ∫|f|/∫f over the plane: 1 where the filter is never negative.
  float weight_magnitude() const { return weight_magnitude_; }

 private:
  enum class Kind { Box, Tent, Gaussian, Mitchell };

  Filter(Kind kind, std::string name, double radius_px);
  double shape(double offset_px) const;
  double offset_of(double u) const;

  Kind kind_;
  std::string name_;
  double radius_px_;
  double scale_ = 1.0;  ///< Makes ∫f = 1.
  float weight_magnitude_ = 1.0f;
  /// |f| and its normalised integral at equidistant points of [0, radius].
  std::vector<double> density_, cumulated_;
};

/// "box", "triangle", "gaussian" (the default), "mitchell".
std::vector<std::string> filter_names();

}  // namespace abbe
