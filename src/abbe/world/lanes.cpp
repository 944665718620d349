#include "abbe/world/lanes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/base/constants.h"
#include "abbe/base/error.h"
#include "abbe/color/uplift/uplift.h"

namespace abbe {
namespace {

// Lines at which the RGB modes evaluate what is no colour: R = C, G = d, B = F.
constexpr double kRgbLines_nm[3] = {kLineC_nm, kLine_d_nm, kLineF_nm};

// Dominant wavelengths of Rec.709's primaries under D65, CIE 1931.
constexpr double kRec709Hues_nm[3] = {611.4, 549.1, 464.2};

const std::vector<std::string> kModeNames{"spectral", "rgb", "rgb3"};  // In their order.

int padded_count(int lanes) {
  const int multiple = lanes <= 8 ? 4 : 16;
  return (lanes + multiple - 1) / multiple * multiple;
}

Vec3d clamped_color(const Vec3d& rgb_rec709) {
  return glm::clamp(rgb_rec709, Vec3d(0.0), Vec3d(1.0));
}

// Transmittances below this are black for every purpose; keeps the logarithm finite.
constexpr double kLeastTransmittance = 1e-12;

double absorption_from(double transmittance, double distance_m) {
  return -std::log(std::clamp(transmittance, kLeastTransmittance, 1.0)) / distance_m;
}

}  // namespace

Mode mode_from_name(const std::string& name) {
  return static_cast<Mode>(check_choice("mode", name, "a mode", kModeNames));
}

std::string mode_name(Mode mode) {
  return kModeNames[static_cast<std::size_t>(mode)];
}

void check_world_options(const WorldOptions& options) {
  const auto require = [](const char* field, auto value, auto last) {
    if (value >= decltype(value){} && value <= last) return;
    throw_usage_error(field, fmt::format("{}", static_cast<int>(value)),
                      fmt::format("0 to {}", static_cast<int>(last)));
  };
  require("mode", options.mode, Mode::Rgb3);
  require("uplift", options.uplift, Uplift::MallettYuksel);
}

LaneModel::LaneModel(const WorldOptions& options, const Observer& observer, const Spectrum& d65,
                     std::span<const Spectrum> lamps, std::span<const Spectrum> filters)
    : mode_(options.mode),
      uplift_(options.uplift),
      frozen_(options.frozen),
      observer_(observer),
      film_observer_(options.development.observer.value_or(observer)),
      film_to_rec709_(responses_to_rec709(options.development, observer, d65)) {
  check_world_options(options);
  const DevelopmentOptions& development = options.development;
  DevelopmentOptions of_d65 = development;
  of_d65.white.reset();
  of_d65.adaptation = Adaptation::Cat16;
  // xyz_of has turned responses into tristimulus values already.
  development_.xyz_to_rec709 =
      responses_to_rec709(of_d65, observer, d65) * glm::inverse(film_observer_.responses_to_xyz);
  development_.rec709_to_xyz = glm::inverse(development_.xyz_to_rec709);
  if (mode_ != Mode::Spectral) {
    film_to_rec709_ = rec709_to_rec709(development, observer, d65) * development_.xyz_to_rec709;
  }
  d65_ = d65.scaled(1.0 / xyz_of(d65, observer).y);
  for (const Spectrum& lamp : lamps) {
    const double luminance = xyz_of(lamp, observer).y;
    if (luminance > 0.0) lamps_.push_back(lamp.scaled(1.0 / luminance));
  }
  if (lamps_.empty()) lamps_.push_back(d65_);
  if (mode_ != Mode::Spectral) return;
  if (frozen_.has_channels()) {
    copies_ = 3;
    basis_ = channel_basis(film_observer_, d65_, development_);
    if (!basis_) {
      throw_usage_error("frozen", "the observer " + film_observer_.id,
                        "one that sees Rec.709's primaries as parts of white, as cie1931");
    }
    if (frozen_.contains(Cause::Lamps)) lamps_ = {d65_};
  }
  quadrature_.emplace(options.wavelengths, observer, lamps_,
                      ResolvedBands{narrow_bands(filters), options.shifts});
  lane_count_ = copies_ * quadrature_->lane_count();
  lane_stride_ = copies_ == 1 ? quadrature_->lane_stride() : padded_count(lane_count_);
  set_count_ = quadrature_->set_count();
  if (!basis_) return;
  if (lane_count_ > kMaxLanes) {
    throw_usage_error(
        "frozen", fmt::format("{} wavelengths, lines of lamps included", lane_count_ / copies_),
        fmt::format("at most {}: each has a lane for every channel", kMaxLanes / copies_));
  }
  shares_.resize(static_cast<std::size_t>(set_count_) * lane_stride_, 0.0f);
  for (int set = 0; set < set_count_; ++set) {
    for (int lane = 0; lane < lane_count_; ++lane) {
      const auto nm = static_cast<double>(wavelength_nm(set, lane));
      double share = (*basis_)[static_cast<std::size_t>(channel_of(lane))].value(nm);
      if (frozen_.contains(Cause::Lamps)) share *= d65_.value(nm);
      shares_[static_cast<std::size_t>(set) * lane_stride_ + lane] = static_cast<float>(share);
    }
  }
}

int LaneModel::channel_of(int lane) const {
  return copies_ == 1 ? std::min(lane, 2) : std::min(lane, lane_count_ - 1) % copies_;
}

float LaneModel::wavelength_nm(int set, int lane) const {
  if (!quadrature_) return 0.0f;
  return quadrature_->wavelengths_nm(set)[static_cast<std::size_t>(lane / copies_)];
}

std::span<const float> LaneModel::folded(int set, std::span<const float> radiance,
                                         std::vector<float>& folded) const {
  if (copies_ == 1) return radiance;
  const float* shares = shares_.data() + static_cast<std::size_t>(set) * lane_stride_;
  folded.assign(static_cast<std::size_t>(quadrature_->lane_stride()), 0.0f);
  for (int lane = 0; lane < lane_count_; ++lane) {
    folded[static_cast<std::size_t>(lane / copies_)] += shares[lane] * radiance[lane];
  }
  return folded;
}

std::vector<float> LaneModel::of_wavelengths(std::vector<float> row) const {
  if (copies_ == 1) return row;
  const int from_stride = quadrature_->lane_stride();
  std::vector<float> result(static_cast<std::size_t>(set_count_) * lane_stride_);
  for (int set = 0; set < set_count_; ++set) {
    for (int lane = 0; lane < lane_stride_; ++lane) {
      // Padding repeats the last wavelength.
      const int wavelength = std::min(lane, lane_count_ - 1) / copies_;
      result[static_cast<std::size_t>(set) * lane_stride_ + lane] =
          row[static_cast<std::size_t>(set) * from_stride + wavelength];
    }
  }
  return result;
}

std::vector<float> LaneModel::of_channels(const Vec3d& rgb) const {
  std::vector<float> result(static_cast<std::size_t>(set_count_) * lane_stride_);
  for (std::size_t i = 0; i < result.size(); ++i) {
    const int lane = static_cast<int>(i % static_cast<std::size_t>(lane_stride_));
    result[i] = static_cast<float>(rgb[channel_of(lane)]);
  }
  return result;
}

std::vector<float> LaneModel::observer_weights(const Observer& observer) const {
  if (copies_ == 1) return quadrature_->observer_weights(observer);
  const std::vector<float> weights = quadrature_->observer_weights(observer);
  const int from_stride = quadrature_->lane_stride();
  std::vector<float> result(static_cast<std::size_t>(set_count_) * 3 * lane_stride_, 0.0f);
  for (int set = 0; set < set_count_; ++set) {
    const float* shares = shares_.data() + static_cast<std::size_t>(set) * lane_stride_;
    for (int c = 0; c < 3; ++c) {
      const std::size_t row = static_cast<std::size_t>(set) * 3 + c;
      for (int lane = 0; lane < lane_count_; ++lane) {
        result[row * lane_stride_ + lane] =
            weights[row * from_stride + lane / copies_] * shares[lane];
      }
    }
  }
  if (frozen_.contains(Cause::Lamps)) settle_primaries(observer, result);
  return result;
}

// Frozen lamps are 1, 1, 1 under which a channel is its primary: with the weights scaled so that
// each adds up to that, no set of wavelengths errs in the colour of a triple.
void LaneModel::settle_primaries(const Observer& observer, std::vector<float>& weights) const {
  if (quadrature_->kinds().front() == LaneKind::Exact) return;
  const Spectrum light =
      product(d65_, Spectrum::tabulated({quadrature_->range_min_nm(), quadrature_->range_max_nm()},
                                        {1.0, 1.0}, OutsideTable::Zero));
  for (int channel = 0; channel < copies_; ++channel) {
    const Vec3d primary =
        responses_of(product((*basis_)[static_cast<std::size_t>(channel)], light), observer);
    for (int row = 0; row < 3 * set_count_; ++row) {
      float* of_set = weights.data() + static_cast<std::size_t>(row) * lane_stride_;
      double sum = 0.0;
      for (int lane = channel; lane < lane_count_; lane += copies_) {
        sum += static_cast<double>(of_set[lane]);
      }
      if (!(sum > 0.0)) continue;
      const auto scale = static_cast<float>(primary[row % 3] / sum);
      for (int lane = channel; lane < lane_count_; lane += copies_) of_set[lane] *= scale;
    }
  }
}

std::vector<float> LaneModel::reflectance(const Reflectance& value, Cause cause) const {
  const auto* color = std::get_if<RgbRec709>(&value);
  if (is_rgb(cause)) {
    return of_channels(color ? clamped_color(color->rgb_rec709)
                             : rec709_of_reflectance(std::get<Spectrum>(value), film_observer_,
                                                     d65_, development_));
  }
  return of_wavelengths(quadrature_->tabulate_reflectance(
      color ? uplift_reflectance(uplift_, color->rgb_rec709) : std::get<Spectrum>(value)));
}

std::vector<float> LaneModel::quantity(const Spectrum& value) const {
  if (quadrature_) return of_wavelengths(quadrature_->tabulate(value));
  return of_channels(
      {value.value(kRgbLines_nm[0]), value.value(kRgbLines_nm[1]), value.value(kRgbLines_nm[2])});
}

std::vector<float> LaneModel::emission(const Spectrum& value) const {
  if (!is_rgb(Cause::Lamps)) return of_wavelengths(quadrature_->tabulate_emission(value));
  return of_channels(rec709_of_emission(value, film_observer_, development_));
}

std::vector<float> LaneModel::emission(const Spectrum& value, double luminance) const {
  const double own = xyz_of(value, observer_).y;
  return emission(own > 0.0 ? value.scaled(luminance / own) : Spectrum());
}

std::vector<float> LaneModel::emission(const RgbRec709& value) const {
  if (!is_rgb(Cause::Lamps)) {
    return of_wavelengths(
        quadrature_->tabulate_emission(uplift_emission(uplift_, value.rgb_rec709, d65_)));
  }
  return of_channels(glm::max(value.rgb_rec709, 0.0));
}

std::vector<float> LaneModel::index(const Dispersion& value) const {
  if (!is_rgb(Cause::IndexDispersion)) {
    return of_wavelengths(
        quadrature_->tabulate([&](double nm) { return refractive_index(value, nm); }));
  }
  if (mode_ != Mode::Rgb3) return of_channels(Vec3d(refractive_index(value, kLine_d_nm)));
  return of_channels({refractive_index(value, kRgbLines_nm[0]),
                      refractive_index(value, kRgbLines_nm[1]),
                      refractive_index(value, kRgbLines_nm[2])});
}

std::vector<float> LaneModel::absorption(const Spectrum& per_m) const {
  if (!is_rgb(Cause::Absorption)) return of_wavelengths(quadrature_->tabulate(per_m));
  const double mean_per_m = integral(per_m) / (kRangeMax_nm - kRangeMin_nm);
  if (!(mean_per_m > 0.0)) return of_channels(Vec3d(0.0));
  const double depth_m = 1.0 / mean_per_m;
  std::vector<double> nm, transmittance;
  for (double x = kRangeMin_nm; x <= kRangeMax_nm; x += 1.0) {
    nm.push_back(x);
    transmittance.push_back(std::exp(-per_m.value(x) * depth_m));
  }
  const Vec3d rgb_rec709 = rec709_of_reflectance(
      Spectrum::tabulated(std::move(nm), std::move(transmittance), OutsideTable::Clamp),
      film_observer_, d65_, development_);
  return of_channels({absorption_from(rgb_rec709.x, depth_m),
                      absorption_from(rgb_rec709.y, depth_m),
                      absorption_from(rgb_rec709.z, depth_m)});
}

std::vector<float> LaneModel::attenuation(const Vec3d& color_rec709, double distance_m) const {
  if (is_rgb(Cause::Absorption)) {
    return of_channels({absorption_from(color_rec709.x, distance_m),
                        absorption_from(color_rec709.y, distance_m),
                        absorption_from(color_rec709.z, distance_m)});
  }
  const Spectrum transmittance = uplift_reflectance(uplift_, color_rec709);
  return of_wavelengths(quadrature_->tabulate(
      [&](double nm) { return absorption_from(transmittance.value(nm), distance_m); }));
}

std::vector<float> LaneModel::uplift_abscissa() const {
  if (!quadrature_) return of_channels(Vec3d(0.0));
  return of_wavelengths(quadrature_->tabulate([](double nm) { return (nm - 595.0) / 235.0; }));
}

std::vector<float> LaneModel::uplift_basis(int channel) const {
  if (!quadrature_) return of_channels(Vec3d(0.0));
  return of_wavelengths(
      quadrature_->tabulate([channel](double nm) { return mallett_yuksel_basis(nm)[channel]; }));
}

std::vector<float> LaneModel::inverse_wavelength() const {
  if (is_rgb(Cause::Fresnel)) {
    return of_channels(1.0 / Vec3d(kRec709Hues_nm[0], kRec709Hues_nm[1], kRec709Hues_nm[2]));
  }
  return of_wavelengths(quadrature_->tabulate([](double nm) { return 1.0 / nm; }));
}

std::vector<float> LaneModel::xyz_weights() const {
  if (quadrature_) return observer_weights(film_observer_);
  // A lane is a channel: its weight is the XYZ of that primary, so that development, the inverse,
  // returns the channels as they were.
  std::vector<float> weights(static_cast<std::size_t>(3) * lane_stride_, 0.0f);
  for (int c = 0; c < 3; ++c) {
    for (int lane = 0; lane < 3; ++lane) {
      weights[c * lane_stride_ + lane] = static_cast<float>(development_.rec709_to_xyz[lane][c]);
    }
  }
  return weights;
}

std::vector<float> LaneModel::luminance_weights() const {
  std::vector<float> result(static_cast<std::size_t>(set_count_) * lane_stride_, 0.0f);
  if (!quadrature_) {
    for (int lane = 0; lane < 3; ++lane) result[lane] = 1.0f / 3.0f;
    return result;
  }
  const std::vector<float> weights = observer_weights(observer_);
  std::vector<float> light(result.size(), 0.0f);
  for (const Spectrum& lamp : lamps_) {
    // A frozen lamp is 1, 1, 1: its spectrum is in the weights.
    const std::vector<float> row = is_rgb(Cause::Lamps)
                                       ? of_channels(Vec3d(1.0))
                                       : of_wavelengths(quadrature_->tabulate_emission(lamp));
    for (std::size_t i = 0; i < light.size(); ++i) light[i] += row[i];
  }
  for (int set = 0; set < set_count_; ++set) {
    const std::size_t first = static_cast<std::size_t>(set) * lane_stride_;
    double sum = 0.0;
    for (int lane = 0; lane < lane_count_; ++lane) {
      const float* w = weights.data() + 3 * first + lane;
      result[first + lane] =
          std::max(0.0f, (w[0] + w[lane_stride_] + w[2 * lane_stride_]) * light[first + lane]);
      sum += result[first + lane];
    }
    // Wavelengths that nobody sees (840 nm) still have to be traced.
    for (int lane = 0; lane < lane_count_; ++lane) {
      result[first + lane] = sum > 0.0 ? static_cast<float>(result[first + lane] / sum)
                                       : 1.0f / static_cast<float>(lane_count_);
    }
  }
  return result;
}

}  // namespace abbe
