#include "abbe/film/filter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "abbe/base/error.h"

namespace abbe {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr int kSteps = 200000;

// Midpoint rule over the filter's support, each half by itself: the kernels have a kink at 0.
double integral_of(const Filter& filter, double (*of)(double value, double x)) {
  const double radius = filter.radius_px();
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double x = -radius + (i + 0.5) * 2.0 * radius / kSteps;
    sum += of(filter.value(x), x);
  }
  return sum * 2.0 * radius / kSteps;
}

TEST(Filter, names_are_the_documented_ones) {
  EXPECT_THAT(filter_names(), ElementsAre("box", "triangle", "gaussian", "mitchell"));
}

TEST(Filter, unknown_name_is_a_usage_error_that_lists_the_names) {
  try {
    Filter::named("lanczos");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().kind, ErrorKind::Usage);
    EXPECT_THAT(error.what(), HasSubstr("one of box, triangle, gaussian, mitchell"));
  }
}

TEST(Filter, every_kernel_integrates_to_one) {
  for (const std::string& name : filter_names()) {
    const Filter filter = Filter::named(name);
    // The table's trapezoids miss 1e-6 of the Gaussian's mass; 1024 cells, error ~ h²·f'/12.
    EXPECT_NEAR(integral_of(filter, [](double value, double) { return value; }), 1.0, 2e-6) << name;
    EXPECT_EQ(filter.value(filter.radius_px() + 1e-6), 0.0) << name;
  }
}

TEST(Filter, share_below_an_offset_is_the_integral_up_to_there) {
  for (const std::string& name : filter_names()) {
    const Filter filter = Filter::named(name);
    if (filter.is_negative_anywhere()) continue;
    EXPECT_EQ(filter.share_below(-filter.radius_px()), 0.0) << name;
    EXPECT_EQ(filter.share_below(filter.radius_px()), 1.0) << name;
    constexpr int kParts = 4000;
    const double step = 2.0 * filter.radius_px() / kParts;
    double sum = 0.0;
    for (int i = 0; i < kParts; ++i) {
      const double place = -filter.radius_px() + (i + 0.5) * step;
      sum += filter.value(place) * step;
      // The table runs straight between its points: slopes up to 1.6 over 1.5 px / 1024.
      EXPECT_NEAR(filter.share_below(place + 0.5 * step), sum, 1e-5) << name << ' ' << place;
    }
  }
}

TEST(Filter, mitchell_has_the_values_of_its_paper) {
  // Mitchell & Netravali 1988 with B = C = 1/3: the outer cubic is
  // (−7/18)x³ + 2x² − (10/3)x + 16/9, which is −5/144 at 1.5.
  const Filter filter = Filter::named("mitchell");
  EXPECT_NEAR(filter.value(0.0), 8.0 / 9.0, 2e-6);      // the table's normalisation
  EXPECT_NEAR(filter.value(1.0), 1.0 / 18.0, 1e-6);     // the same
  EXPECT_NEAR(filter.value(-1.5), -5.0 / 144.0, 1e-6);  // the same
}

TEST(Filter, weight_magnitude_is_the_absolute_over_the_signed_mass) {
  for (const char* name : {"box", "triangle", "gaussian"}) {
    EXPECT_EQ(Filter::named(name).weight_magnitude(), 1.0f);
  }
  const Filter mitchell = Filter::named("mitchell");
  const double absolute = integral_of(mitchell, [](double v, double) { return std::abs(v); });
  EXPECT_GT(absolute, 1.05);
  EXPECT_NEAR(mitchell.weight_magnitude(), absolute * absolute, 1e-5);  // table of 1024 cells
}

TEST(Filter, share_of_samples_follows_the_kernel) {
  for (const std::string& name : filter_names()) {
    const Filter filter = Filter::named(name);
    const double absolute = integral_of(filter, [](double v, double) { return std::abs(v); });
    // The offset at u must have the share u of |f| to its left.
    double mass = 0.0;
    double x = -filter.radius_px();
    for (int i = 1; i < 64; ++i) {
      const double u = i / 64.0;
      const double offset = filter.sample({static_cast<float>(u), 0.5f}).offset_px.x;
      const int steps = 2000;
      const double width = (offset - x) / steps;
      for (int s = 0; s < steps; ++s) mass += std::abs(filter.value(x + (s + 0.5) * width)) * width;
      x = offset;
      EXPECT_NEAR(mass / absolute, u, 1e-5) << name;  // promised 1e-4
    }
  }
}

TEST(Filter, samples_stay_inside_the_radius_and_are_monotone) {
  for (const std::string& name : filter_names()) {
    const Filter filter = Filter::named(name);
    float previous = -filter.radius_px();
    for (int i = 0; i <= 10000; ++i) {
      const float u = static_cast<float>(i) / 10000.0f;
      const FilterSample sample = filter.sample({0.25f, u});
      EXPECT_GE(sample.offset_px.y, previous) << name << " at " << u;
      EXPECT_LE(sample.offset_px.y, filter.radius_px()) << name << " at " << u;
      previous = sample.offset_px.y;
    }
    EXPECT_NEAR(previous, filter.radius_px(), 1e-6f) << name;  // float rounding
  }
}

TEST(Filter, centre_of_the_unit_square_is_the_centre_of_the_pixel) {
  for (const std::string& name : filter_names()) {
    const FilterSample sample = Filter::named(name).sample({0.5f, 0.5f});
    EXPECT_NEAR(sample.offset_px.x, 0.0f, 1e-6f) << name;  // float rounding of u
    EXPECT_GT(sample.weight, 0.0f) << name;
  }
}

TEST(Filter, weighted_mean_of_a_function_is_its_filtered_value) {
  // g(x, y) = x² + cos(3y): its filtered value is the sum of two integrals along one axis.
  for (const std::string& name : filter_names()) {
    const Filter filter = Filter::named(name);
    const double expected =
        integral_of(filter, [](double v, double x) { return v * x * x; }) +
        integral_of(filter, [](double v, double x) { return v * std::cos(3 * x); });
    double sum = 0.0;
    constexpr int kSide = 2000;
    for (int i = 0; i < kSide * kSide; ++i) {
      const Vec2f u{(static_cast<float>(i % kSide) + 0.5f) / kSide,
                    (static_cast<float>(i / kSide) + 0.5f) / kSide};
      const FilterSample s = filter.sample(u);
      sum += s.weight * (s.offset_px.x * s.offset_px.x + std::cos(3.0 * s.offset_px.y));
    }
    // Along each of four zeros half a stratum of 1/2000 may count with the wrong sign: 2·M·g/2000.
    EXPECT_NEAR(sum / (kSide * kSide), expected, 1e-3) << name;
  }
}

TEST(Filter, negative_weights_fall_where_the_kernel_is_negative) {
  const Filter filter = Filter::named("mitchell");
  int negative = 0;
  constexpr int kSide = 1000;
  for (int i = 0; i < kSide * kSide; ++i) {
    const Vec2f u{(static_cast<float>(i % kSide) + 0.5f) / kSide,
                  (static_cast<float>(i / kSide) + 0.5f) / kSide};
    const FilterSample s = filter.sample(u);
    const bool is_negative = filter.value(s.offset_px.x) * filter.value(s.offset_px.y) < 0.0;
    EXPECT_EQ(s.weight < 0.0f, is_negative);
    EXPECT_EQ(std::abs(s.weight), filter.weight_magnitude());
    negative += is_negative;
  }
  // (M − 1)/(2M) of the samples, but for a stratum of 1/1000 at each of the four zeros.
  const double M = filter.weight_magnitude();
  EXPECT_NEAR(negative / double{kSide * kSide}, (M - 1.0) / (2.0 * M), 4e-3);
}

}  // namespace
}  // namespace abbe
