#include "abbe/optics/fresnel.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "abbe/base/constants.h"

namespace abbe {

DielectricFresnel fresnel_dielectric(double cos_incident, double eta_ti) {
  const double g_squared = (eta_ti - 1.0) * (eta_ti + 1.0) + cos_incident * cos_incident;
  if (g_squared <= 0.0) return {1.0, 1.0, 0.0};
  const double g = std::sqrt(g_squared);  // eta_ti · cos_transmitted
  const double s = (cos_incident - g) / (cos_incident + g);
  const double p_cosine = eta_ti * eta_ti * cos_incident;
  const double p = (p_cosine - g) / (p_cosine + g);
  return {s * s, p * p, std::min(g / eta_ti, 1.0)};
}

double fresnel_conductor(double cos_incident, double n, double k, double n_incident) {
  // Straight from the complex amplitudes, so that it shares nothing with the real-valued form of
  // the vector code.
  const std::complex<double> eta{n / n_incident, k / n_incident};
  const double sin_squared = 1.0 - cos_incident * cos_incident;
  const std::complex<double> g = std::sqrt(eta * eta - sin_squared);
  const std::complex<double> s = (cos_incident - g) / (cos_incident + g);
  const std::complex<double> p = (eta * eta * cos_incident - g) / (eta * eta * cos_incident + g);
  return 0.5 * (std::norm(s) + std::norm(p));
}

double fresnel_schlick(double cos_incident, double f0, double f90) {
  return f0 + (f90 - f0) * std::pow(1.0 - cos_incident, 5);
}

double normal_reflectance(double eta_ti) {
  const double amplitude = (eta_ti - 1.0) / (eta_ti + 1.0);
  return amplitude * amplitude;
}

double brewster_angle_rad(double eta_ti) {
  return std::atan(eta_ti);
}

double critical_angle_rad(double eta_ti) {
  return eta_ti < 1.0 ? std::asin(eta_ti) : kPi / 2.0;
}

}  // namespace abbe
