#include "world/lanes.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "base/error.h"
#include "color/uplift.h"

namespace abbe {
namespace {

// Lines at which the RGB modes evaluate what is no colour: R = C, G = d, B = F.
constexpr double kRgbLines_nm[3] = {kLineC_nm, kLine_d_nm, kLineF_nm};

// Dominant wavelengths of Rec.709's primaries under D65, CIE 1931.
constexpr double kRec709Hues_nm[3] = {611.4, 549.1, 464.2};

std::vector<float> padded_rgb(const Vec3d& value) {
  return {static_cast<float>(value.x), static_cast<float>(value.y), static_cast<float>(value.z),
          static_cast<float>(value.z)};
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
  if (name == "spectral") return Mode::Spectral;
  if (name == "rgb") return Mode::Rgb;
  if (name == "rgb3") return Mode::Rgb3;
  throw_usage_error("--mode", name, "a mode", {"spectral", "rgb", "rgb3"});
}

std::string mode_name(Mode mode) {
  switch (mode) {
    case Mode::Spectral:
      return "spectral";
    case Mode::Rgb:
      return "rgb";
    case Mode::Rgb3:
      break;
  }
  return "rgb3";
}

LaneModel::LaneModel(Mode mode, const WavelengthOptions& options, const Observer& observer,
                     const Spectrum& d65, std::span<const Spectrum> lamps,
                     const DevelopmentOptions& development, Uplift uplift)
    : mode_(mode),
      uplift_(uplift),
      observer_(observer),
      film_observer_(development.observer.value_or(observer)),
      film_to_rec709_(responses_to_rec709(development, observer, d65)) {
  DevelopmentOptions of_d65 = development;
  of_d65.white.reset();
  of_d65.adaptation = Adaptation::Cat16;
  // xyz_of has turned responses into tristimulus values already.
  development_.xyz_to_rec709 =
      responses_to_rec709(of_d65, observer, d65) * glm::inverse(film_observer_.responses_to_xyz);
  development_.rec709_to_xyz = glm::inverse(development_.xyz_to_rec709);
  if (mode != Mode::Spectral) {
    film_to_rec709_ = rec709_to_rec709(development, observer, d65) * development_.xyz_to_rec709;
  }
  d65_ = d65.scaled(1.0 / xyz_of(d65, observer).y);
  for (const Spectrum& lamp : lamps) {
    const double luminance = xyz_of(lamp, observer).y;
    if (luminance > 0.0) lamps_.push_back(lamp.scaled(1.0 / luminance));
  }
  if (lamps_.empty()) lamps_.push_back(d65_);
  if (mode == Mode::Spectral) {
    quadrature_.emplace(options, observer, lamps_);
    lane_count_ = quadrature_->lane_count();
    lane_stride_ = quadrature_->lane_stride();
    set_count_ = quadrature_->set_count();
  }
}

std::vector<float> LaneModel::reflectance(const Reflectance& value) const {
  const auto* color = std::get_if<RgbRec709>(&value);
  if (!quadrature_) {
    return padded_rgb(color ? clamped_color(color->rgb_rec709)
                            : rec709_of_reflectance(std::get<Spectrum>(value), film_observer_, d65_,
                                                    development_));
  }
  return quadrature_->tabulate(color ? uplift_reflectance(uplift_, color->rgb_rec709)
                                     : std::get<Spectrum>(value));
}

std::vector<float> LaneModel::quantity(const Spectrum& value) const {
  if (quadrature_) return quadrature_->tabulate(value);
  return padded_rgb(
      {value.value(kRgbLines_nm[0]), value.value(kRgbLines_nm[1]), value.value(kRgbLines_nm[2])});
}

std::vector<float> LaneModel::emission(const Spectrum& value) const {
  if (quadrature_) return quadrature_->tabulate_emission(value);
  return padded_rgb(rec709_of_emission(value, film_observer_, development_));
}

std::vector<float> LaneModel::emission(const RgbRec709& value) const {
  if (quadrature_) {
    return quadrature_->tabulate_emission(uplift_emission(uplift_, value.rgb_rec709, d65_));
  }
  return padded_rgb(glm::max(value.rgb_rec709, 0.0));
}

std::vector<float> LaneModel::index(const Dispersion& value) const {
  if (quadrature_) {
    return quadrature_->tabulate([&](double nm) { return refractive_index(value, nm); });
  }
  if (mode_ == Mode::Rgb) return padded_rgb(Vec3d(refractive_index(value, kLine_d_nm)));
  return padded_rgb({refractive_index(value, kRgbLines_nm[0]),
                     refractive_index(value, kRgbLines_nm[1]),
                     refractive_index(value, kRgbLines_nm[2])});
}

std::vector<float> LaneModel::absorption(const Spectrum& per_m) const {
  if (quadrature_) return quadrature_->tabulate(per_m);
  const double mean_per_m = integral(per_m) / (kRangeMax_nm - kRangeMin_nm);
  if (!(mean_per_m > 0.0)) return padded_rgb(Vec3d(0.0));
  const double depth_m = 1.0 / mean_per_m;
  std::vector<double> nm, transmittance;
  for (double x = kRangeMin_nm; x <= kRangeMax_nm; x += 1.0) {
    nm.push_back(x);
    transmittance.push_back(std::exp(-per_m.value(x) * depth_m));
  }
  const Vec3d rgb_rec709 = rec709_of_reflectance(
      Spectrum::tabulated(std::move(nm), std::move(transmittance), OutsideTable::Clamp),
      film_observer_, d65_, development_);
  return padded_rgb({absorption_from(rgb_rec709.x, depth_m), absorption_from(rgb_rec709.y, depth_m),
                     absorption_from(rgb_rec709.z, depth_m)});
}

std::vector<float> LaneModel::attenuation(const Vec3d& color_rec709, double distance_m) const {
  if (!quadrature_) {
    return padded_rgb({absorption_from(color_rec709.x, distance_m),
                       absorption_from(color_rec709.y, distance_m),
                       absorption_from(color_rec709.z, distance_m)});
  }
  const Spectrum transmittance = uplift_reflectance(uplift_, color_rec709);
  return quadrature_->tabulate(
      [&](double nm) { return absorption_from(transmittance.value(nm), distance_m); });
}

std::vector<float> LaneModel::uplift_abscissa() const {
  if (!quadrature_) return padded_rgb(Vec3d(0.0));
  return quadrature_->tabulate([](double nm) { return (nm - 595.0) / 235.0; });
}

std::vector<float> LaneModel::uplift_basis(int channel) const {
  if (!quadrature_) return padded_rgb(Vec3d(0.0));
  return quadrature_->tabulate([channel](double nm) { return mallett_yuksel_basis(nm)[channel]; });
}

std::vector<float> LaneModel::inverse_wavelength() const {
  if (!quadrature_) {
    return padded_rgb(1.0 / Vec3d(kRec709Hues_nm[0], kRec709Hues_nm[1], kRec709Hues_nm[2]));
  }
  return quadrature_->tabulate([](double nm) { return 1.0 / nm; });
}

std::vector<float> LaneModel::xyz_weights() const {
  if (quadrature_) return quadrature_->observer_weights(film_observer_);
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

std::vector<float> LaneModel::importance() const {
  std::vector<float> result(static_cast<std::size_t>(set_count_) * lane_stride_, 0.0f);
  if (!quadrature_) {
    for (int lane = 0; lane < 3; ++lane) result[lane] = 1.0f / 3.0f;
    return result;
  }
  const std::vector<float> weights = quadrature_->observer_weights(observer_);
  std::vector<float> light(result.size(), 0.0f);
  for (const Spectrum& lamp : lamps_) {
    const std::vector<float> row = quadrature_->tabulate_emission(lamp);
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
    // Wavelengths that nobody sees (--lines 840) still have to be traced.
    for (int lane = 0; lane < lane_count_; ++lane) {
      result[first + lane] = sum > 0.0 ? static_cast<float>(result[first + lane] / sum)
                                       : 1.0f / static_cast<float>(lane_count_);
    }
  }
  return result;
}

}  // namespace abbe
