#include "abbe/image/metrics/flip.h"

#include <gtest/gtest.h>

#include "abbe/base/error.h"

namespace abbe {
namespace {

constexpr int kWidth = 48;
constexpr int kHeight = 40;

template <typename Pattern>
Image image_of(const Pattern& pattern) {
  Image image;
  image.width = kWidth;
  image.height = kHeight;
  image.channels = {"R", "G", "B"};
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const Vec3f rgb_rec709 = pattern(x, y);
      image.pixels.insert(image.pixels.end(), {rgb_rec709.x, rgb_rec709.y, rgb_rec709.z});
    }
  }
  return image;
}

Vec3f checks(int x, int y) {
  return {static_cast<float>((x * 7 + y * 3) % 32) / 31.0f, (x / 4 + y / 5) % 2 != 0 ? 0.8f : 0.2f,
          static_cast<float>(x * y % 17) / 16.0f};
}
Vec3f moved_checks(int x, int y) {
  return checks(x + 1, y) * Vec3f(0.9f, 1.0f, 1.0f);
}
Vec3f step(int x, int) {
  return Vec3f(x < 24 ? 0.1f : 0.6f);
}
Vec3f moved_step_with_a_spot(int x, int y) {
  return Vec3f(x < 25 ? 0.1f : 0.6f) + Vec3f(0.0f, 0.0f, x == 10 && y == 20 ? 0.4f : 0.0f);
}

double mean(const std::vector<float>& errors) {
  double sum = 0.0;
  for (const float error : errors) sum += static_cast<double>(error);
  return sum / static_cast<double>(errors.size());
}

/// What the authors' own program (FLIP 1.6, single precision) says about a pair of images.
struct Published {
  double mean, at_10_20, at_24_20, at_0_0, at_47_39;
};

void expect_published(const std::vector<float>& errors, const Published& published) {
  const auto at = [&](int x, int y) {
    return static_cast<double>(errors[static_cast<std::size_t>(y * kWidth + x)]);
  };
  // The reference is in single precision: a rounding of 6e-8 between two equal edges is 2e-4 after
  // the square root, and 8e-5 in an error of 0.4.
  constexpr double kTolerance = 1e-4;
  EXPECT_NEAR(mean(errors), published.mean, kTolerance);
  EXPECT_NEAR(at(10, 20), published.at_10_20, kTolerance);
  EXPECT_NEAR(at(24, 20), published.at_24_20, kTolerance);
  EXPECT_NEAR(at(0, 0), published.at_0_0, kTolerance);
  EXPECT_NEAR(at(47, 39), published.at_47_39, kTolerance);
}

TEST(Flip, equals_the_authors_program_on_textures) {
  const Image image = image_of(moved_checks);
  const Image reference = image_of(checks);
  expect_published(flip_errors(image, reference),
                   {0.3909380, 0.3045116, 0.2353929, 0.4699243, 0.9704679});
  expect_published(flip_errors(image, reference, 30.0),
                   {0.6137726, 0.3060907, 0.4625123, 0.5469959, 0.9788824});
}

TEST(Flip, equals_the_authors_program_on_an_edge_and_a_point) {
  const Image image = image_of(moved_step_with_a_spot);
  const Image reference = image_of(step);
  expect_published(flip_errors(image, reference), {0.0407010, 0.1236731, 0.3873095, 0.0, 0.0});
  expect_published(flip_errors(image, reference, 30.0),
                   {0.0305322, 0.3566435, 0.6966164, 0.0, 0.0});
}

TEST(Flip, green_against_blue_is_the_largest_error) {
  const auto errors = flip_errors(image_of([](int, int) { return Vec3f(0, 0, 1); }),
                                  image_of([](int, int) { return Vec3f(0, 1, 0); }));
  // By definition 1; the error is a float.
  for (const float error : errors) EXPECT_NEAR(error, 1.0f, 1e-6f);
}

TEST(Flip, equal_images_have_no_error) {
  const Image image = image_of(checks);
  for (const float error : flip_errors(image, image)) EXPECT_EQ(error, 0.0f);
}

TEST(Flip, values_beyond_the_screen_count_as_its_limits) {
  const auto errors = flip_errors(image_of([](int, int) { return Vec3f(7.0f, 1.0f, -2.0f); }),
                                  image_of([](int, int) { return Vec3f(1.0f, 1.0f, 0.0f); }));
  for (const float error : errors) EXPECT_EQ(error, 0.0f);
}

TEST(Flip, other_size_or_missing_channel_is_an_input_error) {
  Image small = image_of(step);
  small.height = 20;
  small.pixels.resize(small.pixels.size() / 2);
  EXPECT_THROW(flip_errors(small, image_of(step)), Error);
  Image other = image_of(step);
  other.channels = {"X", "Y", "Z"};
  EXPECT_THROW(flip_errors(other, image_of(step)), Error);
}

}  // namespace
}  // namespace abbe
