// The vector code of optics/fresnel-inl.h on every instruction set of this machine, against the
// closed forms in double precision.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "abbe/optics/fresnel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "optics/fresnel_inl_test.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway asks.
#include <hwy/highway.h>

#include "abbe/optics/fresnel-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace {

// Every function over arrays; the sizes are multiples of the widest vector.
void Dielectric(const float* cosine, const float* eta_ti, std::size_t count, float* reflectance,
                float* cos_transmitted) {
  const hn::ScalableTag<float> d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    auto transmitted = hn::Zero(d);
    const auto r =
        DielectricReflectance(d, hn::LoadU(d, cosine + i), hn::LoadU(d, eta_ti + i), &transmitted);
    hn::StoreU(r, d, reflectance + i);
    hn::StoreU(transmitted, d, cos_transmitted + i);
  }
}

void Conductor(const float* cosine, const float* n, const float* k, std::size_t count,
               float* reflectance) {
  const hn::ScalableTag<float> d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    hn::StoreU(
        ConductorReflectance(d, hn::LoadU(d, cosine + i), hn::LoadU(d, n + i), hn::LoadU(d, k + i)),
        d, reflectance + i);
  }
}

void Schlick(const float* cosine, const float* f0, const float* f90, std::size_t count,
             float* reflectance) {
  const hn::ScalableTag<float> d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    hn::StoreU(SchlickReflectance(d, hn::LoadU(d, f0 + i), hn::LoadU(d, f90 + i),
                                  hn::LoadU(d, cosine + i)),
               d, reflectance + i);
  }
}

void Sigmoid(const float* c, const float* s, std::size_t count, float* value) {
  const hn::ScalableTag<float> d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    hn::StoreU(
        SigmoidValue(d, hn::Set(d, c[0]), hn::Set(d, c[1]), hn::Set(d, c[2]), hn::LoadU(d, s + i)),
        d, value + i);
  }
}

void Exponential(const float* x, std::size_t count, float* value) {
  const hn::ScalableTag<float> d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    hn::StoreU(ExpNegative(d, hn::LoadU(d, x + i)), d, value + i);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace abbe {
namespace {

HWY_EXPORT(Dielectric);
HWY_EXPORT(Conductor);
HWY_EXPORT(Schlick);
HWY_EXPORT(Sigmoid);
HWY_EXPORT(Exponential);

// Runs the body with dispatch limited to each target that was compiled in and that runs here.
template <typename Body>
void on_every_target(const Body& body) {
  const std::int64_t supported = hwy::SupportedTargets();
  int count = 0;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    body();
    ++count;
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(supported);
  EXPECT_GE(count, 1);
}

void expect_close(double value, double expected, double relative, double absolute) {
  EXPECT_NEAR(value, expected, std::max(relative * std::abs(expected), absolute));
}

constexpr std::size_t kCosines = 256;
constexpr float kPi_f = 3.14159265f;

std::vector<float> cosines() {
  std::vector<float> result(kCosines);
  for (std::size_t i = 0; i < kCosines; ++i) {
    result[i] = std::cos(0.5f * kPi_f * static_cast<float>(i) / (kCosines - 1));
    result[i] = std::max(result[i], 0.0f);
  }
  result[0] = 1.0f;
  result[kCosines - 1] = 0.0f;
  return result;
}

TEST(FresnelVector, dielectric_equals_the_closed_form_on_every_target) {
  on_every_target([] {
    const std::vector<float> c = cosines();
    for (const float eta_ti : {0.4137f, 0.6667f, 0.99f, 1.0f, 1.01f, 1.33f, 1.5f, 1.9f, 2.4175f}) {
      const std::vector<float> eta(kCosines, eta_ti);
      std::vector<float> r(kCosines), t(kCosines);
      HWY_DYNAMIC_DISPATCH(Dielectric)(c.data(), eta.data(), kCosines, r.data(), t.data());
      for (std::size_t i = 0; i < kCosines; ++i) {
        const DielectricFresnel exact = fresnel_dielectric(c[i], eta_ti);
        // Near the critical angle the cosine is the root of a difference: its error grows without
        // bound there, so the neighbourhood is left to the next test.
        if (exact.cos_transmitted > 0.0 && exact.cos_transmitted < 0.05 && eta_ti < 1.0f) continue;
        expect_close(r[i], exact.reflectance(), 5e-6, 2e-7);  // a few roundings of single precision
        expect_close(t[i], exact.cos_transmitted, 2e-5, 1e-7);  // the root of a difference
        EXPECT_GE(r[i], 0.0f);
        EXPECT_LE(r[i], 1.0f);
      }
    }
  });
}

TEST(FresnelVector, total_reflection_is_exactly_one_with_no_transmitted_cosine) {
  on_every_target([] {
    const std::vector<float> c = cosines();
    const std::vector<float> eta(kCosines, 1.0f / 1.5168f);
    std::vector<float> r(kCosines), t(kCosines);
    HWY_DYNAMIC_DISPATCH(Dielectric)(c.data(), eta.data(), kCosines, r.data(), t.data());
    int reflected = 0;
    for (std::size_t i = 0; i < kCosines; ++i) {
      if (std::acos(c[i]) < 41.246f * kPi_f / 180.0f) continue;  // FACTS: critical angle 41.245°
      EXPECT_EQ(r[i], 1.0f);
      EXPECT_EQ(t[i], 0.0f);
      ++reflected;
    }
    EXPECT_GT(reflected, 100);
  });
}

TEST(FresnelVector, equal_indices_reflect_exactly_nothing) {
  on_every_target([] {
    const std::vector<float> c = cosines();
    const std::vector<float> eta(kCosines, 1.0f);
    std::vector<float> r(kCosines), t(kCosines);
    HWY_DYNAMIC_DISPATCH(Dielectric)(c.data(), eta.data(), kCosines, r.data(), t.data());
    for (std::size_t i = 0; i + 1 < kCosines; ++i) {
      EXPECT_NEAR(r[i], 0.0f, 0.0f) << "cosine " << c[i];
      EXPECT_NEAR(t[i], c[i], 1e-7) << "rounding of the root of a square";
    }
  });
}

TEST(FresnelVector, conductor_equals_the_complex_amplitudes_on_every_target) {
  on_every_target([] {
    const std::vector<float> c = cosines();
    // Gold, silver, aluminium, copper near 550 nm; silver's smallest n; glass; a nearly black one.
    const float pairs[][2] = {{0.43f, 2.455f}, {0.06f, 3.586f}, {0.958f, 6.690f}, {1.04f, 2.583f},
                              {0.04f, 4.9f},   {1.5f, 0.0f},    {1.1f, 0.2f},     {3.2f, 3.3f}};
    for (const auto& pair : pairs) {
      const std::vector<float> n(kCosines, pair[0]), k(kCosines, pair[1]);
      std::vector<float> r(kCosines);
      HWY_DYNAMIC_DISPATCH(Conductor)(c.data(), n.data(), k.data(), kCosines, r.data());
      for (std::size_t i = 0; i < kCosines; ++i) {
        const double exact = fresnel_conductor(c[i], pair[0], pair[1]);
        expect_close(r[i], exact, 5e-6, 5e-7);  // sums of squares in single precision
        EXPECT_GE(r[i], 0.0f);
        EXPECT_LE(r[i], 1.0f);
      }
    }
  });
}

TEST(FresnelVector, schlick_runs_from_f0_to_f90) {
  on_every_target([] {
    const std::vector<float> c = cosines();
    const std::vector<float> f0(kCosines, 0.04f), f90(kCosines, 0.9f);
    std::vector<float> r(kCosines);
    HWY_DYNAMIC_DISPATCH(Schlick)(c.data(), f0.data(), f90.data(), kCosines, r.data());
    EXPECT_EQ(r.front(), 0.04f);
    EXPECT_FLOAT_EQ(r.back(), 0.9f);
    for (std::size_t i = 0; i < kCosines; ++i) {
      // Subtracting the cosine from 1 costs one rounding, raised to the fifth power.
      EXPECT_NEAR(r[i], fresnel_schlick(c[i], 0.04f, 0.9f), 1e-6);
    }
  });
}

TEST(FresnelVector, sigmoid_equals_its_formula_and_saturates_exactly) {
  on_every_target([] {
    std::vector<float> s(64), value(64);
    for (std::size_t i = 0; i < s.size(); ++i) s[i] = -1.0f + 2.0f * static_cast<float>(i) / 63.0f;
    const float curves[][3] = {{0, 0, 0}, {3, -2, 0.5f}, {-40, 10, 7}, {100, 20, -30}};
    for (const auto& c : curves) {
      HWY_DYNAMIC_DISPATCH(Sigmoid)(c, s.data(), s.size(), value.data());
      for (std::size_t i = 0; i < s.size(); ++i) {
        const double x = (double{c[0]} * s[i] + c[1]) * s[i] + c[2];
        // Rounding of x moves the value by at most |x|·ε/(1 + x²)^1.5; sums of large terms more.
        EXPECT_NEAR(value[i], 0.5 + 0.5 * x / std::sqrt(1 + x * x), 2e-6);
        EXPECT_GE(value[i], 0.0f);
        EXPECT_LE(value[i], 1.0f);
      }
    }
    for (const float sign : {1.0f, -1.0f}) {
      const float c[3] = {0, 0, sign * 4096.0f};
      HWY_DYNAMIC_DISPATCH(Sigmoid)(c, s.data(), s.size(), value.data());
      for (const float v : value) EXPECT_EQ(v, sign > 0 ? 1.0f : 0.0f);
    }
  });
}

TEST(FresnelVector, exponential_keeps_six_digits_from_zero_to_underflow) {
  on_every_target([] {
    std::vector<float> x(4096), value(4096);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = 0.02125f * static_cast<float>(i);
    x[4090] = 1e-20f;
    x[4091] = 86.99f;
    x[4092] = 87.0f;
    x[4093] = 1e6f;
    x[4094] = std::numeric_limits<float>::max();
    x[4095] = std::numeric_limits<float>::infinity();
    HWY_DYNAMIC_DISPATCH(Exponential)(x.data(), x.size(), value.data());
    EXPECT_EQ(value[0], 1.0f);
    EXPECT_EQ(value[4090], 1.0f);
    for (std::size_t i = 0; i < 4092; ++i) {
      const double exact = std::exp(-double{x[i]});
      EXPECT_NEAR(value[i], exact, 1e-6 * exact) << "x = " << x[i];  // the function's contract
    }
    for (std::size_t i = 4092; i < 4096; ++i) EXPECT_EQ(value[i], 0.0f);
  });
}

TEST(FresnelVector, results_have_the_same_bits_on_every_target) {
  std::vector<std::vector<std::uint32_t>> by_target;
  on_every_target([&by_target] {
    const std::vector<float> c = cosines();
    const std::vector<float> eta(kCosines, 1.0f / 1.7847f), n(kCosines, 0.06f), k(kCosines, 3.6f);
    std::vector<float> all(4 * kCosines);
    HWY_DYNAMIC_DISPATCH(Dielectric)
    (c.data(), eta.data(), kCosines, all.data(), all.data() + kCosines);
    HWY_DYNAMIC_DISPATCH(Conductor)
    (c.data(), n.data(), k.data(), kCosines, all.data() + 2 * kCosines);
    HWY_DYNAMIC_DISPATCH(Exponential)(c.data(), kCosines, all.data() + 3 * kCosines);
    std::vector<std::uint32_t> bits(all.size());
    std::memcpy(bits.data(), all.data(), all.size() * sizeof(float));
    by_target.push_back(bits);
  });
  for (const auto& bits : by_target) EXPECT_EQ(bits, by_target.front());
}

}  // namespace
}  // namespace abbe
#endif  // HWY_ONCE
