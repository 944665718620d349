// The reflectance of boundaries over lanes against its scalar judge, and Snell's law over lanes
// against the scalar one, on random boundaries.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "abbe/optics/boundary.h"
#include "abbe/optics/fresnel.h"
#include "abbe/optics/snell.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "optics/boundary_inl_test.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway asks.
#include <hwy/highway.h>

#include "abbe/optics/boundary-inl.h"
#include "abbe/optics/snell-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace {

// One boundary in all lanes; the first lane's answer.
float Reflectance(const Boundary& boundary, float cosine) {
  const hn::ScalableTag<float> d;
  const auto set = [d](double x) { return hn::Set(d, static_cast<float>(x)); };
  const auto n_incident = set(boundary.n_incident);
  const auto c = set(cosine);
  FilmLanes<hn::Vec<decltype(d)>> store;
  const FilmLanes<hn::Vec<decltype(d)>>* film = nullptr;
  if (boundary.film) {
    store = {set(boundary.film->n), set(boundary.film->thickness_nm), set(boundary.film->share),
             set(1.0 / boundary.wavelength_nm)};
    film = &store;
  }
  auto cos_transmitted = c;
  const auto n = hn::Div(set(boundary.n), n_incident);
  switch (boundary.kind) {
    case BoundaryKind::Dielectric:
      return hn::GetLane(DielectricBoundary(d, film, c, n, n_incident, &cos_transmitted));
    case BoundaryKind::Conductor:
      return hn::GetLane(
          ConductorBoundary(d, film, c, n, hn::Div(set(boundary.k), n_incident), n_incident));
    case BoundaryKind::ColoredMetal:
      return hn::GetLane(ColoredMetalBoundary(d, film, c, set(boundary.f0), n_incident));
  }
  return -1.0f;
}

// The normalised refracted direction of one ray, in the first lane.
Vec3f Refracted(const Vec3f& direction, const Vec3f& normal, float eta_ti) {
  const hn::ScalableTag<float> d;
  const auto i = Set3(d, direction);
  const auto n = Set3(d, normal);
  const auto eta = hn::Set(d, eta_ti);
  const auto cosine = hn::Neg(Dot3(d, i, n));
  auto cos_transmitted = cosine;
  DielectricReflectance(d, cosine, eta, &cos_transmitted);
  const auto eta_it = hn::Div(hn::Set(d, 1.0f), eta);
  const auto t = Normalized3(d, RefractedDirection(d, i, n, cosine, cos_transmitted, eta_it));
  return {hn::GetLane(t.x), hn::GetLane(t.y), hn::GetLane(t.z)};
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace abbe {
namespace {

HWY_EXPORT(Reflectance);
HWY_EXPORT(Refracted);

/// Boundaries of every kind, bare and under films, from air and from denser media.
class BoundaryLanes : public testing::TestWithParam<BoundaryKind> {
 protected:
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  Boundary any_boundary() {
    Boundary boundary;
    boundary.kind = GetParam();
    boundary.n_incident = between(0.0, 1.0) < 0.5 ? 1.0 : between(1.0, 2.4);
    const bool metal = boundary.kind == BoundaryKind::Conductor;
    boundary.n = metal ? between(0.05, 4.0) : between(1.0, 2.4);
    boundary.k = metal ? between(0.0, 8.0) : 0.0;
    boundary.f0 = between(0.0, 1.0);
    boundary.wavelength_nm = between(360.0, 830.0);
    if (between(0.0, 1.0) < 0.5) {
      boundary.film = BoundaryFilm{between(1.0, 2.4), between(0.0, 1500.0), between(0.0, 1.0)};
    }
    return boundary;
  }

  std::mt19937 random_{7};
};

TEST_P(BoundaryLanes, reflectance_equals_the_judge) {
  for (int i = 0; i < 20000; ++i) {
    const Boundary boundary = any_boundary();
    const auto cosine = static_cast<float>(between(0.02, 1.0));
    const double sin2 = 1.0 - static_cast<double>(cosine) * cosine;
    const double eta = boundary.n / boundary.n_incident;
    // At the critical angle the cosine behind is the root of a difference: no bound holds there.
    if (GetParam() == BoundaryKind::Dielectric && std::abs(eta * eta - sin2) < 1e-3) continue;
    const double expected = boundary_reflectance(boundary, cosine);
    const float value = HWY_DYNAMIC_DISPATCH(Reflectance)(boundary, cosine);
    // Phases of films are known to 2e-5 after a thousand nanometres; bare boundaries to roundings.
    EXPECT_NEAR(value, expected, boundary.film ? 5e-5 : 5e-6) << i;
    EXPECT_GE(value, 0.0f);
    EXPECT_LE(value, 1.0f);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, BoundaryLanes,
                         testing::Values(BoundaryKind::Dielectric, BoundaryKind::Conductor,
                                         BoundaryKind::ColoredMetal));

TEST(Boundary, bare_reflectances_are_those_of_fresnel) {
  EXPECT_DOUBLE_EQ(boundary_reflectance({.n = 1.5}, 1.0), 0.04);
  EXPECT_DOUBLE_EQ(boundary_reflectance({.n_incident = 1.5, .n = 1.0}, 0.5), 1.0);
  const Boundary silver{.kind = BoundaryKind::Conductor, .n_incident = 1.33, .n = 0.06, .k = 3.6};
  EXPECT_DOUBLE_EQ(boundary_reflectance(silver, 0.7), fresnel_conductor(0.7, 0.06, 3.6, 1.33));
  const Boundary colored{.kind = BoundaryKind::ColoredMetal, .f0 = 0.8};
  EXPECT_DOUBLE_EQ(boundary_reflectance(colored, 0.0), 1.0);
}

TEST(Boundary, film_without_thickness_or_share_is_none) {
  const Boundary bare{.n = 1.7, .wavelength_nm = 550.0};
  Boundary covered = bare;
  covered.film = BoundaryFilm{.n = 1.38, .thickness_nm = 0.0};
  EXPECT_EQ(boundary_reflectance(covered, 0.6), boundary_reflectance(bare, 0.6));
  covered.film = BoundaryFilm{.n = 1.38, .thickness_nm = 100.0, .share = 0.0};
  EXPECT_EQ(boundary_reflectance(covered, 0.6), boundary_reflectance(bare, 0.6));
}

TEST(SnellLanes, refracted_direction_equals_the_scalar_one) {
  std::mt19937 random(11);
  std::normal_distribution<float> normal_distribution;
  std::uniform_real_distribution<float> eta_distribution(0.4f, 2.5f);
  const auto any_unit = [&] {
    return glm::normalize(Vec3f(normal_distribution(random), normal_distribution(random),
                                normal_distribution(random)));
  };
  int refracted = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3f normal = any_unit();
    Vec3f direction = any_unit();
    if (glm::dot(direction, normal) > 0.0f) direction = -direction;
    const float eta = eta_distribution(random);
    const auto exact = refracted_direction(glm::normalize(Vec3d(direction)),
                                           glm::normalize(Vec3d(normal)), static_cast<double>(eta));
    // Near total reflection the direction is the root of a difference.
    if (!exact || std::abs(glm::dot(*exact, Vec3d(normal))) < 0.05) continue;
    const Vec3f value = HWY_DYNAMIC_DISPATCH(Refracted)(direction, normal, eta);
    EXPECT_LT(glm::length(Vec3d(value) - *exact), 1e-5) << i;  // Roundings over a cosine of 0.05.
    ++refracted;
  }
  EXPECT_GT(refracted, 10000);
}

}  // namespace
}  // namespace abbe
#endif  // HWY_ONCE
