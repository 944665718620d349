#include "abbe/film/filter.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "abbe/base/error.h"
#include "abbe/base/text.h"

namespace abbe {
namespace {

constexpr std::size_t kCells = 1024;
constexpr double kGaussianSigma_px = 0.5;

// Mitchell & Netravali 1988, B = C = 1/3, over [0, 2].
double mitchell(double x) {
  constexpr double B = 1.0 / 3.0;
  constexpr double C = 1.0 / 3.0;
  if (x < 1.0) {
    return ((12.0 - 9.0 * B - 6.0 * C) * x * x * x + (-18.0 + 12.0 * B + 6.0 * C) * x * x +
            (6.0 - 2.0 * B)) /
           6.0;
  }
  return ((-B - 6.0 * C) * x * x * x + (6.0 * B + 30.0 * C) * x * x + (-12.0 * B - 48.0 * C) * x +
          (8.0 * B + 24.0 * C)) /
         6.0;
}

}  // namespace

Filter Filter::named(const std::string& name) {
  if (name == "box") return {Kind::Box, name, 0.5};
  if (name == "triangle") return {Kind::Tent, name, 1.0};
  if (name == "gaussian") return {Kind::Gaussian, name, 1.5};
  if (name == "mitchell") return {Kind::Mitchell, name, 2.0};
  throw_usage_error("filter", in_quotes(name), "the name of a filter", filter_names());
}

std::vector<std::string> filter_names() {
  return {"box", "triangle", "gaussian", "mitchell"};
}

Filter::Filter(Kind kind, std::string name, double radius_px)
    : kind_(kind), name_(std::move(name)), radius_px_(radius_px) {
  density_.resize(kCells + 1);
  cumulated_.resize(kCells + 1, 0.0);
  const double width = radius_px_ / kCells;
  double signed_mass = 0.0;
  for (std::size_t i = 0; i <= kCells; ++i) {
    const double x = static_cast<double>(i) * width;
    density_[i] = std::abs(shape(x));
    if (i == 0) continue;
    // The density between the points is linear by definition here, so the trapezoid is its exact
    // mass and offset_of inverts it exactly; only the curvature of f within a cell is neglected.
    const double mass = 0.5 * width * (density_[i - 1] + density_[i]);
    cumulated_[i] = cumulated_[i - 1] + mass;
    signed_mass += std::copysign(mass, shape(x - 0.5 * width));
  }
  const double absolute_mass = cumulated_.back();
  for (std::size_t i = 0; i <= kCells; ++i) {
    density_[i] /= absolute_mass;
    cumulated_[i] /= absolute_mass;
  }
  scale_ = 0.5 / signed_mass;
  const double magnitude = absolute_mass / signed_mass;
  weight_magnitude_ = static_cast<float>(magnitude * magnitude);
}

double Filter::shape(double offset_px) const {
  const double x = std::abs(offset_px);
  switch (kind_) {
    case Kind::Box:
      return 1.0;
    case Kind::Tent:
      return 1.0 - x;
    case Kind::Gaussian: {
      // Lowered so that it ends at 0 instead of in a step.
      const auto bell = [](double t) {
        return std::exp(-t * t / (2.0 * kGaussianSigma_px * kGaussianSigma_px));
      };
      return bell(x) - bell(radius_px_);
    }
    case Kind::Mitchell:
      return mitchell(x);
  }
  return 0.0;
}

double Filter::value(double offset_px) const {
  return std::abs(offset_px) > radius_px_ ? 0.0 : scale_ * shape(offset_px);
}

double Filter::share_below(double offset_px) const {
  const double cells = std::min(std::abs(offset_px) / radius_px_, 1.0) * kCells;
  const auto cell = std::min(static_cast<std::size_t>(cells), kCells - 1);
  const double part = cells - static_cast<double>(cell);
  const double inner = cumulated_[cell] + part * (cumulated_[cell + 1] - cumulated_[cell]);
  return 0.5 + std::copysign(0.5 * inner, offset_px);
}

// The offset in [0, radius] below which the share u of |f| lies.
double Filter::offset_of(double u) const {
  const auto above = std::upper_bound(cumulated_.begin() + 1, cumulated_.end() - 1, u);
  const auto cell = static_cast<std::size_t>(above - cumulated_.begin()) - 1;
  const double width = radius_px_ / kCells;
  const double low = density_[cell];
  const double slope = (density_[cell + 1] - low) / width;
  const double rest = std::max(u - cumulated_[cell], 0.0);
  // low·t + slope·t²/2 = rest, in the form that does not cancel for either sign of the slope.
  const double root = std::sqrt(std::max(low * low + 2.0 * slope * rest, 0.0));
  const double within = low + root > 0.0 ? 2.0 * rest / (low + root) : 0.0;
  return static_cast<double>(cell) * width + std::min(within, width);
}

FilterSample Filter::sample(const Vec2f& u) const {
  const auto along = [this](double v) {
    return v < 0.5 ? -offset_of(1.0 - 2.0 * v) : offset_of(2.0 * v - 1.0);
  };
  const double x = along(std::clamp(static_cast<double>(u.x), 0.0, 1.0));
  const double y = along(std::clamp(static_cast<double>(u.y), 0.0, 1.0));
  const bool is_negative = std::signbit(shape(x)) != std::signbit(shape(y));
  return {{static_cast<float>(x), static_cast<float>(y)},
          is_negative ? -weight_magnitude_ : weight_magnitude_};
}

}  // namespace abbe
