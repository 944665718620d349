#include "abbe/optics/thin_film.h"

#include <algorithm>
#include <cmath>

#include "abbe/base/constants.h"

namespace abbe {
namespace {

using Complex = std::complex<double>;

// n cosθ of a medium, with the root that decays away from the boundary.
Complex normal_index(Complex n, double tangential_squared) {
  const Complex q = std::sqrt(n * n - tangential_squared);
  return q.imag() < 0.0 ? -q : q;
}

// Amplitude reflected at one boundary, by the admittances of both sides times a common factor.
Complex amplitude(Complex from, Complex to) {
  return (from - to) / (from + to);
}

double reflected(Complex first, Complex second, Complex round_trip) {
  return std::norm((first + second * round_trip) / (1.0 + first * second * round_trip));
}

}  // namespace

double thin_film_reflectance(double cos_incident, double n_incident, double n_film,
                             std::complex<double> n_substrate, double thickness_nm,
                             double wavelength_nm) {
  const double sin_squared = std::max(1.0 - cos_incident * cos_incident, 0.0);
  const double tangential_squared = n_incident * n_incident * sin_squared;
  const Complex q1 = n_incident * cos_incident;
  Complex q2 = normal_index(n_film, tangential_squared);
  const Complex q3 = normal_index(n_substrate, tangential_squared);
  const Complex e1 = n_incident * n_incident;
  const Complex e3 = n_substrate * n_substrate;
  if (thickness_nm == 0.0) {
    return 0.5 * (std::norm(amplitude(q1, q3)) + std::norm(amplitude(e3 * q1, e1 * q3)));
  }
  // Exactly along the layer both amplitudes are ±1 and the sum has no value, only a limit.
  if (std::abs(q2) < 1e-7) q2 = 1e-7;
  const Complex e2 = n_film * n_film;
  const Complex round_trip = std::exp(Complex(0.0, 4.0 * kPi * thickness_nm / wavelength_nm) * q2);
  const double s = reflected(amplitude(q1, q2), amplitude(q2, q3), round_trip);
  const double p = reflected(amplitude(e2 * q1, e1 * q2), amplitude(e3 * q2, e2 * q3), round_trip);
  return std::min(0.5 * (s + p), 1.0);
}

}  // namespace abbe
