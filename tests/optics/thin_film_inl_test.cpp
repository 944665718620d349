// The vector code of optics/thin_film-inl.h on every instruction set of this machine, against
// Airy's sum in long double.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "abbe/base/constants.h"
#include "support/airy.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "optics/thin_film_inl_test.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway asks.
#include <hwy/highway.h>

#include "abbe/optics/thin_film-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace {

void Film(const float* cosine, float film, float n, float k, const float* waves, std::size_t count,
          float* reflectance) {
  const hn::ScalableTag<float> d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    hn::StoreU(ThinFilmReflectance(d, hn::LoadU(d, cosine + i), hn::Set(d, film), hn::Set(d, n),
                                   hn::Set(d, k), hn::LoadU(d, waves + i)),
               d, reflectance + i);
  }
}

void Bare(const float* cosine, float n, float k, std::size_t count, float* reflectance) {
  const hn::ScalableTag<float> d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto c = hn::LoadU(d, cosine + i);
    auto transmitted = hn::Zero(d);
    hn::StoreU(k > 0.0f ? ConductorReflectance(d, c, hn::Set(d, n), hn::Set(d, k))
                        : DielectricReflectance(d, c, hn::Set(d, n), &transmitted),
               d, reflectance + i);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace abbe {
namespace {

HWY_EXPORT(Film);
HWY_EXPORT(Bare);

constexpr std::size_t kCount = 512;

template <typename Body>
void on_every_target(const Body& body) {
  const std::int64_t supported = hwy::SupportedTargets();
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    body();
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(supported);
}

// Angles from 0 to 89.9°, thicknesses from 0.002 to `most` wavelengths, in no order.
void fill(float most_waves, std::vector<float>& cosine, std::vector<float>& waves) {
  cosine.resize(kCount);
  waves.resize(kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    const double u = std::fmod(0.6180339887498949 * static_cast<double>(i), 1.0);
    cosine[i] = static_cast<float>(std::cos(89.9 * kPi / 180.0 * u));
    waves[i] = most_waves * static_cast<float>(i + 1) / kCount;
  }
}

struct Layer {
  float film, n, k;  // Over the index of the medium of incidence.
};

// Air to soap, coated glass, diamond, oil on water, high-index film; metals with oxides; then from
// inside glass: coated faces and a gap of air.
constexpr Layer kLayers[] = {
    {1.33f, 1.0f, 0.0f},    {1.38f, 1.5168f, 0.0f},   {1.5f, 2.4175f, 0.0f}, {1.45f, 1.33f, 0.0f},
    {2.3f, 1.5f, 0.0f},     {1.76f, 0.958f, 6.69f},   {2.4f, 2.2f, 2.9f},    {1.5f, 0.06f, 3.586f},
    {1.33f, 0.43f, 2.455f}, {0.9098f, 0.6593f, 0.0f}, {1.2f, 0.6593f, 0.0f}, {0.6593f, 1.0f, 0.0f}};

TEST(ThinFilmVector, reflectance_equals_airys_sum_on_every_target) {
  for (const Layer& layer : kLayers) {
    std::vector<float> cosine, waves, r(kCount);
    fill(10.0f, cosine, waves);
    std::vector<double> exact(kCount);
    for (std::size_t i = 0; i < kCount; ++i) {
      exact[i] = static_cast<double>(
          test::airy_reflectance(cosine[i], 1.0L, layer.film, {layer.n, layer.k}, waves[i], 1.0L));
    }
    on_every_target([&] {
      HWY_DYNAMIC_DISPATCH(Film)
      (cosine.data(), layer.film, layer.n, layer.k, waves.data(), kCount, r.data());
      double worst = 0.0;
      for (std::size_t i = 0; i < kCount; ++i) {
        // The promise of the header: 1e-5 up to ten wavelengths.
        EXPECT_NEAR(r[i], exact[i], 1e-5) << layer.film << " on " << layer.n << " + i" << layer.k
                                          << ", cosine " << cosine[i] << ", waves " << waves[i];
        worst = std::max(worst, std::abs(r[i] - exact[i]));
        EXPECT_GE(r[i], 0.0f);
        EXPECT_LE(r[i], 1.0f);
      }
      RecordProperty("worst", std::to_string(worst));
    });
  }
}

TEST(ThinFilmVector, zero_thickness_equals_no_film) {
  std::vector<float> cosine, waves, r(kCount), bare(kCount);
  fill(1.0f, cosine, waves);
  waves.assign(kCount, 0.0f);
  on_every_target([&] {
    for (const Layer& layer : kLayers) {
      HWY_DYNAMIC_DISPATCH(Film)
      (cosine.data(), layer.film, layer.n, layer.k, waves.data(), kCount, r.data());
      HWY_DYNAMIC_DISPATCH(Bare)(cosine.data(), layer.n, layer.k, kCount, bare.data());
      for (std::size_t i = 0; i < kCount; ++i) {
        EXPECT_NEAR(r[i], bare[i], 2e-6)  // a few roundings of single precision
            << layer.n << " + i" << layer.k << ", cosine " << cosine[i];
      }
    }
  });
}

TEST(ThinFilmVector, wave_along_the_layer_has_the_limit_of_its_neighbours) {
  // q2 = 0 exactly: Airy's sum is 0/0 there; the neighbours in long double are not.
  const float film = 0.8f;
  const float cosine = 0.6f;
  on_every_target([&] {
    const std::vector<float> c(kCount, cosine);
    std::vector<float> waves(kCount), r(kCount);
    for (std::size_t i = 0; i < kCount; ++i) waves[i] = 0.01f * static_cast<float>(i % 64 + 1);
    HWY_DYNAMIC_DISPATCH(Film)(c.data(), film, 1.0f, 0.0f, waves.data(), kCount, r.data());
    for (std::size_t i = 0; i < kCount; ++i) {
      // The neighbour is 1e-6 away in the cosine, where |dR/dcosine| is below 10.
      EXPECT_NEAR(r[i],
                  static_cast<double>(
                      test::airy_reflectance(cosine + 1e-6L, 1.0L, film, 1.0L, waves[i], 1.0L)),
                  1e-5);
    }
  });
}

TEST(ThinFilmVector, total_reflection_is_exactly_one_and_grazing_light_is_reflected) {
  on_every_target([&] {
    const std::vector<float> c(kCount, 0.5f), grazing(kCount, 0.0f);
    std::vector<float> waves(kCount), r(kCount);
    for (std::size_t i = 0; i < kCount; ++i) waves[i] = 0.02f * static_cast<float>(i + 1);
    for (const float film : {0.79f, 0.91f, 1.5f}) {
      HWY_DYNAMIC_DISPATCH(Film)
      (c.data(), film, 0.6593f, 0.0f, waves.data(), kCount, r.data());
      for (const float value : r) EXPECT_EQ(value, 1.0f);
      HWY_DYNAMIC_DISPATCH(Film)
      (grazing.data(), film, 1.5f, 0.0f, waves.data(), kCount, r.data());
      for (const float value : r) EXPECT_NEAR(value, 1.0f, 1e-6);  // two roundings
    }
  });
}

TEST(ThinFilmVector, results_have_the_same_bits_on_every_target) {
  std::vector<float> cosine, waves;
  fill(40.0f, cosine, waves);
  std::vector<std::vector<std::uint32_t>> by_target;
  on_every_target([&] {
    std::vector<std::uint32_t> bits;
    for (const Layer& layer : kLayers) {
      std::vector<float> r(kCount);
      HWY_DYNAMIC_DISPATCH(Film)
      (cosine.data(), layer.film, layer.n, layer.k, waves.data(), kCount, r.data());
      const std::size_t first = bits.size();
      bits.resize(first + kCount);
      std::memcpy(bits.data() + first, r.data(), kCount * sizeof(float));
    }
    by_target.push_back(bits);
  });
  for (const auto& bits : by_target) EXPECT_EQ(bits, by_target.front());
}

}  // namespace
}  // namespace abbe
#endif  // HWY_ONCE
