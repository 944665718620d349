// Renders of the scenes against their golden images, and proofs that wrong renders fail.

#include <gtest/gtest.h>

#include "golden/golden_cases.h"
#include "image/exr.h"

namespace abbe {
namespace {

class Golden : public testing::TestWithParam<golden::Case> {};

TEST_P(Golden, render_matches_its_golden_image) {
  const golden::Case& golden = GetParam();
  ASSERT_TRUE(std::filesystem::exists(golden.reference()))
      << "no golden image " << golden.reference() << ": make bless CASE=" << golden.name;
  const Image reference = read_exr(golden.reference());
  const Image image = golden::render(golden);
  // OpenImageIO's thresholds; the program is deterministic, so they only allow for other libraries'
  // last bits.
  const CompareThresholds thresholds;
  const Comparison comparison = compare_images(image, reference, thresholds);
  EXPECT_TRUE(comparison.passed) << comparison.summary(thresholds) << "; the render lies in "
                                 << golden::failure_folder();
}

INSTANTIATE_TEST_SUITE_P(scenes, Golden, testing::ValuesIn(golden::cases()),
                         [](const auto& test) { return test.param.name; });

// A wrong render has to fail, or the comparison proves nothing.
class WrongRender : public testing::TestWithParam<const char*> {};

TEST_P(WrongRender, deliberately_wrong_render_fails_its_golden_image) {
  golden::Case golden = golden::cases().front();
  ASSERT_TRUE(std::filesystem::exists(golden.reference()));
  const Image reference = read_exr(golden.reference());
  golden.name += "_wrong";
  const Image image = golden::render(golden, GetParam());
  EXPECT_FALSE(compare_images(image, reference).passed) << GetParam();
}

INSTANTIATE_TEST_SUITE_P(ways, WrongRender,
                         testing::Values("--depth 3", "--wavelengths 4", "--seed 2",
                                         "--range 400:640", "--filter box"));

TEST(GoldenTest, image_brighter_by_two_per_cent_fails) {
  const Image reference = read_exr(golden::cases().front().reference());
  Image image = reference;
  for (float& value : image.pixels) value *= 1.02f;
  EXPECT_FALSE(compare_images(image, reference).passed);
}

TEST(GoldenTest, image_without_a_golden_fails) {
  golden::Case missing = golden::cases().front();
  missing.name = "no_such_case";
  EXPECT_FALSE(std::filesystem::exists(missing.reference()));
  EXPECT_ANY_THROW(read_exr(missing.reference()));
}

}  // namespace
}  // namespace abbe
