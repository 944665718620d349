#include "abbe/optics/rough/layer_albedo.h"

#include <algorithm>
#include <cmath>

#include "abbe/base/constants.h"
#include "abbe/optics/fresnel.h"
#include "abbe/optics/rough/smith.h"

namespace abbe {
namespace {

constexpr double kCoatIndex = 1.5;

// Over visible microfacets, by the substitutions of microfacet_loss.cpp.
double coat_share(double cosine, double alpha) {
  if (alpha < 1e-3) return fresnel_dielectric(cosine, kCoatIndex).reflectance();
  constexpr int kPlaces = 32, kTurns = 21;
  const double sine = std::sqrt(1.0 - cosine * cosine);
  const double of_view = smith_lambda(cosine, alpha);
  double sum = 0.0;
  for (int j = 0; j < kTurns; ++j) {
    const double shift = (8 * j % kTurns + 0.5) / kTurns;
    for (int i = 0; i < kPlaces; ++i) {
      const double x = (i + shift) / kPlaces;
      const double q = x * x * (3.0 - 2.0 * x);
      const double rest = 1.0 - q * q;
      const double steep = alpha * std::sqrt(1.0 - rest * rest) / rest;
      const double facing = cosine + sine * steep * std::cos(kPi * (j + 0.5) / kTurns);
      if (!(facing > 0.0)) continue;
      const double out = 2.0 * facing / (1.0 + steep * steep) - cosine;
      if (!(out > 0.0)) continue;
      const double let_by = (1.0 + of_view) / (1.0 + of_view + smith_lambda(out, alpha));
      const double half = std::min(1.0, facing / std::sqrt(1.0 + steep * steep));
      sum += 24.0 * x * (1.0 - x) * q * rest * facing / (cosine * (1.0 + of_view)) * let_by *
             fresnel_dielectric(half, kCoatIndex).reflectance();
    }
  }
  return sum / (kPlaces * kTurns);
}

// Over fibres: u = sin^(2 + 1/α) of the half vector takes all of the distribution, and
// 1 − u = (1 − t)² what is left of a pole at the horizon.
double sheen_share(double cosine, double alpha) {
  constexpr int kPlaces = 48, kTurns = 48;
  const double sine = std::sqrt(1.0 - cosine * cosine);
  const double of_view = sheen_lambda(cosine, alpha);
  double sum = 0.0;
  for (int i = 0; i < kPlaces; ++i) {
    for (int j = 0; j < kTurns; ++j) {
      const double shift = std::fmod(j * 0.6180339887498949, 1.0);
      const double t = (i + shift) / kPlaces;
      const double u = 1.0 - (1.0 - t) * (1.0 - t);
      const double across = std::pow(u, 1.0 / (2.0 + 1.0 / alpha));
      const double up = std::sqrt(std::max(0.0, 1.0 - across * across));
      const double facing = sine * across * std::cos(kPi * (j + 0.5) / kTurns) + cosine * up;
      const double out = 2.0 * facing * up - cosine;
      if (!(facing > 0.0) || !(out > 0.0)) continue;
      sum += 2.0 * (1.0 - t) * facing / (up * cosine * (1.0 + of_view + sheen_lambda(out, alpha)));
    }
  }
  return sum / (kPlaces * kTurns);
}

struct Place {
  std::size_t below;
  float part;
};

Place place_of(float value, int steps) {
  const float place = std::clamp(value, 0.0f, 1.0f) * static_cast<float>(steps);
  const int below = std::min(static_cast<int>(place), steps - 1);
  return {static_cast<std::size_t>(below), place - static_cast<float>(below)};
}

float mixed(float a, float b, float part) {
  return a + part * (b - a);
}

template <class Table>
float value_at(const Table& table, float cosine, float roughness, int steps) {
  const Place r = place_of(roughness, steps);
  const Place c = place_of(std::sqrt(std::max(cosine, 0.0f)), steps);
  return mixed(mixed(table[r.below][c.below], table[r.below][c.below + 1], c.part),
               mixed(table[r.below + 1][c.below], table[r.below + 1][c.below + 1], c.part), r.part);
}

template <class Means>
float mean_at(const Means& means, float roughness, int steps) {
  const Place r = place_of(roughness, steps);
  return mixed(means[r.below], means[r.below + 1], r.part);
}

// 2∫ μ dμ of a column that is linear in the root of μ.
template <class Column>
float mean_of(const Column& column, int steps) {
  double sum = 0.0;
  for (int c = 1; c <= steps; ++c) {
    const double high = static_cast<double>(c) / steps, low = high - 1.0 / steps;
    const double before = static_cast<double>(column[static_cast<std::size_t>(c) - 1]);
    const double slope =
        (static_cast<double>(column[static_cast<std::size_t>(c)]) - before) * steps;
    sum += (before - slope * low) * (std::pow(high, 4) - std::pow(low, 4)) +
           slope * 0.8 * (std::pow(high, 5) - std::pow(low, 5));
  }
  return static_cast<float>(sum);
}

}  // namespace

double sheen_lambda(double cosine, double alpha) {
  const double narrow = (1.0 - alpha) * (1.0 - alpha);
  const auto between = [narrow](double rough, double smooth) {
    return rough + narrow * (smooth - rough);
  };
  const double a = between(21.5473, 25.3245), b = between(3.82987, 3.32435);
  const double c = between(0.19823, 0.16801), d = between(-1.97760, -1.27393);
  const double e = between(-4.32054, -4.85967);
  const auto fit = [&](double x) { return a / (1.0 + b * std::pow(x, c)) + d * x + e; };
  return cosine < 0.5 ? std::exp(fit(cosine)) : std::exp(2.0 * fit(0.5) - fit(1.0 - cosine));
}

const LayerAlbedo& LayerAlbedo::table() {
  static const LayerAlbedo kTable;
  return kTable;
}

LayerAlbedo::LayerAlbedo() {
  for (std::size_t r = 0; r < kNodes; ++r) {
    const double roughness = static_cast<double>(r) / kSteps;
    const double fibres = std::max(roughness, static_cast<double>(kLeastSheenRoughness));
    for (std::size_t c = 0; c < kNodes; ++c) {
      // At grazing angles the limit of what is just above.
      const double root = std::max(static_cast<double>(c), 0.05) / kSteps;
      const double cosine = root * root;
      coat_[r][c] = static_cast<float>(coat_share(cosine, roughness * roughness));
      sheen_[r][c] = static_cast<float>(sheen_share(cosine, fibres * fibres));
    }
    coat_mean_[r] = mean_of(coat_[r], kSteps);
    sheen_mean_[r] = mean_of(sheen_[r], kSteps);
  }
}

float LayerAlbedo::coat(float cosine, float roughness) const {
  return value_at(coat_, cosine, roughness, kSteps);
}

float LayerAlbedo::coat_mean(float roughness) const {
  return mean_at(coat_mean_, roughness, kSteps);
}

float LayerAlbedo::sheen(float cosine, float roughness) const {
  return value_at(sheen_, cosine, roughness, kSteps);
}

float LayerAlbedo::sheen_mean(float roughness) const {
  return std::min(1.0f, mean_at(sheen_mean_, roughness, kSteps));
}

float sheen_lobe(float cos_view, float cos_light, float cos_half, float roughness) {
  const double rough = static_cast<double>(std::max(roughness, kLeastSheenRoughness));
  const double alpha = rough * rough;
  const double view = std::max(static_cast<double>(cos_view), 1e-4);
  const double light = std::max(static_cast<double>(cos_light), 1e-4);
  const double half = std::min(1.0, static_cast<double>(cos_half));
  const double distribution =
      (2.0 + 1.0 / alpha) * std::pow(1.0 - half * half, 0.5 / alpha) / (2.0 * kPi);
  const double visible =
      1.0 / (4.0 * view * light * (1.0 + sheen_lambda(view, alpha) + sheen_lambda(light, alpha)));
  const LayerAlbedo& albedo = LayerAlbedo::table();
  const float most =
      std::max({1.0f, albedo.sheen(cos_view, roughness), albedo.sheen(cos_light, roughness)});
  return static_cast<float>(distribution * visible) / most;
}

}  // namespace abbe
