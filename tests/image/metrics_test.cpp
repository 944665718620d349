#include "abbe/image/metrics/metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "abbe/base/error.h"
#include "abbe/image/metrics/compare.h"

namespace abbe {
namespace {

Image constant(int width, int height, float value) {
  Image image;
  image.width = width;
  image.height = height;
  image.channels = {"R", "G", "B"};
  image.pixels.assign(static_cast<std::size_t>(width * height) * 3, value);
  return image;
}

TEST(Metrics, constant_offset_has_closed_forms) {
  const auto metrics = image_metrics(constant(4, 4, 0.6f), constant(4, 4, 0.5f));
  ASSERT_EQ(metrics.size(), 3u);
  EXPECT_EQ(metrics[1].channel, "G");
  EXPECT_NEAR(metrics[0].rmse, 0.1, 1e-7);                  // 0.6 and 0.5 as floats
  EXPECT_NEAR(metrics[0].max_abs, 0.1, 1e-7);               // the same
  EXPECT_NEAR(metrics[0].relative_mse, 0.01 / 0.26, 1e-7);  // the same
  EXPECT_NEAR(metrics[0].psnr_db, 20.0, 1e-5);              // the same
}

TEST(Metrics, equal_images_have_infinite_psnr) {
  const auto metrics = image_metrics(constant(2, 2, 0.5f), constant(2, 2, 0.5f));
  EXPECT_EQ(metrics[0].rmse, 0.0);
  EXPECT_TRUE(std::isinf(metrics[0].psnr_db));
}

TEST(Metrics, channels_are_matched_by_name) {
  Image image = constant(1, 1, 0.0f);
  image.channels = {"B", "Z", "R"};
  image.pixels = {3.0f, 100.0f, 1.0f};
  Image reference = image;
  reference.channels = {"R", "B", "Z"};
  reference.pixels = {1.0f, 3.5f, 100.0f};
  const auto metrics = image_metrics(image, reference);
  EXPECT_EQ(metrics[0].max_abs, 0.0);
  EXPECT_EQ(metrics[1].max_abs, 0.5);
}

TEST(Metrics, values_that_are_not_finite_are_counted_apart) {
  Image image = constant(2, 1, 0.5f);
  image.at(0, 0, 0) = std::numeric_limits<float>::quiet_NaN();
  const auto metrics = image_metrics(image, constant(2, 1, 0.5f));
  EXPECT_EQ(metrics[0].non_finite, 1u);
  EXPECT_EQ(metrics[0].rmse, 0.0);
}

TEST(Metrics, other_size_or_missing_channel_is_an_input_error) {
  EXPECT_THROW(image_metrics(constant(2, 2, 0), constant(2, 3, 0)), Error);
  Image image = constant(2, 2, 0);
  image.channels[2] = "Z";
  EXPECT_THROW(image_metrics(image, constant(2, 2, 0)), Error);
}

TEST(Compare, equal_images_pass) {
  const Comparison result = compare_images(constant(8, 8, 0.5f), constant(8, 8, 0.5f));
  EXPECT_TRUE(result.passed);
  EXPECT_EQ(result.summary({}), "identical");
}

TEST(Compare, share_of_failing_pixels_decides_below_the_hard_limit) {
  // 100×100 pixels: 0.02 % are two.
  const Image reference = constant(100, 100, 0.5f);
  Image image = reference;
  image.at(1, 2, 0) += 0.005f;
  image.at(1, 2, 1) += 0.005f;  // The same pixel counts once.
  image.at(3, 4, 2) -= 0.006f;
  Comparison result = compare_images(image, reference);
  EXPECT_TRUE(result.passed);
  EXPECT_EQ(result.failed_pixels, 2u);
  EXPECT_EQ(result.worst_x, 3);
  EXPECT_EQ(result.worst_y, 4);
  EXPECT_EQ(result.worst_channel, "B");
  EXPECT_NEAR(result.max_error, 0.006, 1e-7);  // float rounding near 0.5
  image.at(5, 5, 0) += 0.005f;
  result = compare_images(image, reference);
  EXPECT_FALSE(result.passed);
  EXPECT_EQ(result.failed_pixels, 3u);
}

TEST(Compare, one_value_beyond_the_hard_limit_fails) {
  const Image reference = constant(100, 100, 0.5f);
  Image image = reference;
  image.at(50, 60, 1) = 0.513f;
  const Comparison result = compare_images(image, reference);
  EXPECT_FALSE(result.passed);
  EXPECT_EQ(result.hard_failed_pixels, 1u);
  EXPECT_EQ(
      result.summary({}),
      "1 pixels (0.01 %) beyond 0.004, 1 beyond 0.012, worst 0.013 at 50,60 G: 0.513 for 0.5");
}

TEST(Compare, nan_matches_only_nan) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Image image = constant(100, 100, 0.5f);
  Image reference = image;
  image.at(0, 0, 0) = nan;
  EXPECT_FALSE(compare_images(image, reference).passed);
  EXPECT_FALSE(compare_images(reference, image).passed);
  reference.at(0, 0, 0) = nan;
  EXPECT_TRUE(compare_images(image, reference).passed);
}

TEST(Compare, infinities_match_by_sign) {
  const float infinity = std::numeric_limits<float>::infinity();
  Image image = constant(100, 100, infinity);
  Image reference = image;
  EXPECT_TRUE(compare_images(image, reference).passed);
  image.at(0, 0, 0) = -infinity;
  const Comparison result = compare_images(image, reference);
  EXPECT_FALSE(result.passed);
  EXPECT_TRUE(std::isinf(result.max_error));
}

TEST(Compare, other_crop_or_channels_are_an_input_error) {
  Image image = constant(2, 2, 0.5f);
  const Image reference = image;
  image.data_origin = {1, 0};
  image.full_size = {4, 4};
  EXPECT_THROW(compare_images(image, reference), Error);
  Image more = constant(2, 2, 0.5f);
  more.channels.push_back("Z");
  more.pixels.resize(16);
  EXPECT_THROW(compare_images(more, reference), Error);
  EXPECT_THROW(compare_images(reference, more), Error);
}

}  // namespace
}  // namespace abbe
