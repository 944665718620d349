#include "abbe/color/uplift/uplift.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "abbe/base/constants.h"
#include "abbe/base/error.h"
#include "abbe/color/uplift/fit.h"
#include "abbe/color/uplift/table.h"

namespace abbe {
namespace {

constexpr double kCentre_nm = 595.0;
constexpr double kHalfRange_nm = 235.0;

const ReflectanceProjection& projection() {
  static const ReflectanceProjection result = [] {
    ReflectanceProjection made;
    for (std::size_t i = 0; i < kUpliftWavelengths; ++i) {
      made.s.push_back((kRangeMin_nm + static_cast<double>(i) - kCentre_nm) / kHalfRange_nm);
      for (std::size_t channel = 0; channel < 3; ++channel) {
        made.weight_rec709[channel].push_back(kUpliftProjection[3 * i + channel]);
      }
    }
    return made;
  }();
  return result;
}

// The polynomial through three values of x at kUpliftStored_s, by Newton's divided differences.
Vec3d polynomial_through(const Vec3d& x) {
  constexpr auto& s = kUpliftStored_s;
  constexpr double per_10 = 1.0 / (s[1] - s[0]), per_21 = 1.0 / (s[2] - s[1]),
                   per_20 = 1.0 / (s[2] - s[0]);
  const double first = (x[1] - x[0]) * per_10;
  const double second = ((x[2] - x[1]) * per_21 - first) * per_20;
  return {second, first - second * (s[0] + s[1]), x[0] - s[0] * first + s[0] * s[1] * second};
}

// The four nodes around a position along an axis and their weights in Lagrange's cubic.
struct CubicWeights {
  std::size_t first = 0;
  float weight[4] = {};

  explicit CubicWeights(float coordinate) {
    const float position = uplift_position(coordinate) * (kUpliftNodes - 1);
    const float before =
        std::clamp(std::floor(position) - 1.0f, 0.0f, static_cast<float>(kUpliftNodes - 4));
    first = static_cast<std::size_t>(before);
    const float t = position - before;  // nodes at 0, 1, 2, 3
    const float t1 = t - 1.0f, t2 = t - 2.0f, t3 = t - 3.0f;
    weight[0] = t1 * t2 * t3 * (-1.0f / 6.0f);
    weight[1] = t * t2 * t3 * 0.5f;
    weight[2] = t * t1 * t3 * -0.5f;
    weight[3] = t * t1 * t2 * (1.0f / 6.0f);
  }
};

// −cot θ = (t² − 1)/2t with t = tan θ/2. Lambert's continued fraction of the tangent, cut off after
// five of its terms, is good to 2e-9 up to π/4; beyond θ = π/2, cot θ = −cot(π − θ).
// Domain: (0, π).
double minus_cotangent(double theta) {
  const bool is_obtuse = theta > 0.5 * kPi;
  const double y = 0.5 * (is_obtuse ? kPi - theta : theta), y2 = y * y;
  const double above = y * (945.0 - y2 * (105.0 - y2)), below = 945.0 - y2 * (420.0 - y2 * 15.0);
  const double minus_cot = (above * above - below * below) / (2.0 * above * below);
  return is_obtuse ? -minus_cot : minus_cot;
}

// Angles at the three stored wavelengths, for a colour in the cube of the table's space.
Vec3f angles_at(const float* table, const Vec3f& color) {
  const int largest = color.r >= color.g && color.r >= color.b ? 0 : (color.g >= color.b ? 1 : 2);
  const float brightness = color[largest];
  const CubicWeights along_i(brightness);
  const CubicWeights along_j(color[(largest + 1) % 3] / brightness);
  const CubicWeights along_k(color[(largest + 2) % 3] / brightness);
  // The four nodes along k lie side by side: 12 numbers, summed as they are over i and j.
  float sum[12] = {};
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      const float weight = along_i.weight[i] * along_j.weight[j];
      const float* row = table + uplift_index(static_cast<std::size_t>(largest), along_i.first + i,
                                              along_j.first + j, along_k.first);
      for (std::size_t n = 0; n < 12; ++n) sum[n] += weight * row[n];
    }
  }
  Vec3f angles(0.0f);
  for (int k = 0; k < 4; ++k) {
    angles += along_k.weight[k] * Vec3f(sum[3 * k], sum[3 * k + 1], sum[3 * k + 2]);
  }
  return angles;
}

bool is_in_cube(const Vec3f& color) {
  return std::min({color.r, color.g, color.b}) >= 0.0f &&
         std::max({color.r, color.g, color.b}) <= 1.0f;
}

}  // namespace

SigmoidPolynomial polynomial_in_nm(const Vec3d& coefficients_in_s) {
  constexpr double a = 1.0 / kHalfRange_nm, b = -kCentre_nm / kHalfRange_nm;  // s = a λ + b
  const Vec3d& c = coefficients_in_s;
  return {c[0] * a * a, (2.0 * c[0] * b + c[1]) * a, (c[0] * b + c[1]) * b + c[2]};
}

Vec3d coefficients_in_s(const SigmoidPolynomial& polynomial) {
  constexpr double a = kHalfRange_nm, b = kCentre_nm;  // λ = a s + b
  return {polynomial.c0 * a * a, (2.0 * polynomial.c0 * b + polynomial.c1) * a,
          (polynomial.c0 * b + polynomial.c1) * b + polynomial.c2};
}

SigmoidPolynomial uplift_rec709(const Vec3d& rgb_rec709) {
  return polynomial_in_nm(fit_reflectance(rgb_rec709, projection()).c);
}

Vec3f uplift_rec709_from_table(const Vec3f& rgb_rec709) {
  static const glm::mat3 to_wide(rec709_to_rgb(kUpliftSpaces[1]));
  if (rgb_rec709.r == rgb_rec709.g && rgb_rec709.g == rgb_rec709.b) {
    return Vec3f(constant_reflectance(std::clamp(rgb_rec709.r, 0.0f, 1.0f)).c);
  }
  const Vec3f angles =
      is_in_cube(rgb_rec709)
          ? angles_at(kUpliftTables[0], rgb_rec709)
          : angles_at(kUpliftTables[1], glm::clamp(to_wide * rgb_rec709, 0.0f, 1.0f));
  Vec3d x;
  for (int w = 0; w < 3; ++w) {
    // A cubic may overshoot; 1e-4 is within what single precision calls 0 or 1.
    constexpr double kLeast = 1e-4;
    x[w] = minus_cotangent(std::clamp<double>(angles[w], kLeast, kPi - kLeast));
  }
  return Vec3f(polynomial_through(x));
}

Vec3d mallett_yuksel_basis(double wavelength_nm) {
  const double place = std::clamp((wavelength_nm - kMallettYukselFirst_nm) / kMallettYukselStep_nm,
                                  0.0, static_cast<double>(kMallettYukselRows - 1));
  const std::size_t below = std::min(static_cast<std::size_t>(place), kMallettYukselRows - 2);
  const double t = place - static_cast<double>(below);
  const double* row = &kMallettYukselBasis[3 * below];
  return (1.0 - t) * Vec3d(row[0], row[1], row[2]) + t * Vec3d(row[3], row[4], row[5]);
}

namespace {

const std::vector<std::string> kUpliftNames{"jakob-hanika", "mallett-yuksel"};  // In their order.

Spectrum mallett_yuksel(const Vec3d& rgb_rec709) {
  const Vec3d color = glm::clamp(rgb_rec709, 0.0, 1.0);
  std::vector<double> wavelengths_nm, values;
  for (std::size_t i = 0; i < kMallettYukselRows; ++i) {
    const double* row = &kMallettYukselBasis[3 * i];
    wavelengths_nm.push_back(kMallettYukselFirst_nm +
                             kMallettYukselStep_nm * static_cast<double>(i));
    values.push_back(std::clamp(color.r * row[0] + color.g * row[1] + color.b * row[2], 0.0, 1.0));
  }
  return Spectrum::tabulated(std::move(wavelengths_nm), std::move(values), OutsideTable::Clamp);
}

}  // namespace

Uplift uplift_from_name(const std::string& name) {
  return static_cast<Uplift>(
      check_choice("uplift", name, "a way from RGB to spectra", kUpliftNames));
}

std::string uplift_name(Uplift uplift) {
  return kUpliftNames[static_cast<std::size_t>(uplift)];
}

std::string uplift_title(Uplift uplift) {
  return uplift == Uplift::JakobHanika ? "Jakob-Hanika 2019" : "Mallett-Yuksel 2019";
}

Spectrum uplift_reflectance(Uplift uplift, const Vec3d& rgb_rec709) {
  return uplift == Uplift::MallettYuksel ? mallett_yuksel(rgb_rec709)
                                         : Spectrum::sigmoid(uplift_rec709(rgb_rec709));
}

Spectrum uplift_emission(Uplift uplift, const Vec3d& rgb_rec709,
                         const Spectrum& d65_at_1_cd_per_m2) {
  const double scale = 2.0 * std::max<double>({rgb_rec709.r, rgb_rec709.g, rgb_rec709.b});
  if (!(scale > 0.0)) return {};
  return product(uplift_reflectance(uplift, rgb_rec709 / scale), d65_at_1_cd_per_m2).scaled(scale);
}

}  // namespace abbe
