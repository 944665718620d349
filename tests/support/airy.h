/// Airy's sum written out term by term in long double: the oracle of everything about thin films.
#pragma once

#include <cmath>
#include <complex>
#include <numbers>

namespace abbe::test {

/// Reflectance of a layer for unpolarised light: the wave reflected at its front, and all those
/// that cross it back and forth m times, are added until they fade.
/// Units: indices absolute, lengths in nm.
inline long double airy_reflectance(long double cos_incident, long double n_incident,
                                    long double n_film, std::complex<long double> n_substrate,
                                    long double thickness_nm, long double wavelength_nm) {
  using Complex = std::complex<long double>;
  const Complex n[3] = {n_incident, n_film, n_substrate};
  Complex cosine[3];
  for (int i = 0; i < 3; ++i) {
    const Complex sine = n_incident * std::sqrt(1.0L - cos_incident * cos_incident) / n[i];
    cosine[i] = std::sqrt(1.0L - sine * sine);
    // The wave that fades away from the boundary.
    if ((n[i] * cosine[i]).imag() < 0.0L) cosine[i] = -cosine[i];
  }
  const Complex half_trip = std::exp(Complex(0.0L, 2.0L * std::numbers::pi_v<long double>) * n[1] *
                                     cosine[1] * thickness_nm / wavelength_nm);
  long double sum_of_both = 0.0L;
  for (const bool is_s : {true, false}) {
    const auto denominator = [&](int a, int b) {
      return is_s ? n[a] * cosine[a] + n[b] * cosine[b] : n[b] * cosine[a] + n[a] * cosine[b];
    };
    const auto r = [&](int a, int b) {
      return (is_s ? n[a] * cosine[a] - n[b] * cosine[b] : n[b] * cosine[a] - n[a] * cosine[b]) /
             denominator(a, b);
    };
    const auto t = [&](int a, int b) { return 2.0L * n[a] * cosine[a] / denominator(a, b); };
    Complex sum = r(0, 1);
    Complex term = t(0, 1) * half_trip * r(1, 2) * half_trip * t(1, 0);
    for (int m = 0; m < 200000 && std::abs(term) > 1e-18L; ++m) {
      sum += term;
      term *= r(1, 0) * half_trip * r(1, 2) * half_trip;
    }
    sum_of_both += std::norm(sum);
  }
  return 0.5L * sum_of_both;
}

}  // namespace abbe::test
