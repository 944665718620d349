#include "abbe/color/rgb_space.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "abbe/base/error.h"
#include "abbe/color/color.h"

namespace abbe {
namespace {

TEST(RgbSpace, white_of_every_space_is_white_of_rec709) {
  for (const RgbPrimaries& space : rgb_spaces()) {
    const Vec3d white = rgb_to_rec709(space.space) * Vec3d(1.0);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(white[i], 1.0, 1e-14) << space.name;  // rounding
  }
}

TEST(RgbSpace, matrices_agree_with_published_ones) {
  // ITU-R BT.2087-0, Table 4, from Rec.2020 to Rec.709, printed with four digits.
  const Mat3d rec2020 = rgb_to_rec709(RgbSpace::Rec2020);
  const double of_bt2087[3][3] = {
      {1.6605, -0.5876, -0.0728}, {-0.1246, 1.1329, -0.0083}, {-0.0182, -0.1006, 1.1187}};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      EXPECT_NEAR(rec2020[column][row], of_bt2087[row][column], 5e-5);  // its last digit
    }
  }
}

TEST(RgbSpace, matrix_and_inverse_cancel) {
  for (const RgbPrimaries& space : rgb_spaces()) {
    const Mat3d product = rgb_to_rec709(space.space) * rec709_to_rgb(space.space);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) EXPECT_NEAR(product[i][j], i == j ? 1.0 : 0.0, 1e-13);
    }
  }
}

TEST(RgbSpace, acescg_holds_all_others) {
  const Mat3d to_acescg = rec709_to_rgb(RgbSpace::AcesCg);
  for (const RgbPrimaries& space : rgb_spaces()) {
    const Mat3d primaries = to_acescg * rgb_to_rec709(space.space);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) EXPECT_GT(primaries[i][j], -1e-12) << space.name;
    }
  }
}

TEST(RgbSpace, unknown_name_lists_the_known_ones) {
  try {
    rgb_space_from_name("sRGB", "a.gltf: /scenes/0");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("ACEScg"));
    EXPECT_THAT(error.what(), testing::HasSubstr("Linear P3-D65"));
  }
}

}  // namespace
}  // namespace abbe
