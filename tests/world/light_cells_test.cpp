// Directions drawn by light and cosine, against their own density and integrals by rows.
#include "abbe/world/light/light_cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "abbe/base/constants.h"

namespace abbe {
namespace {

constexpr int kColumns = 96, kRows = 48;
constexpr float kFirstTurn = 0.17f;
constexpr int kSunRow = 33, kSunColumn = 40;

// Grey with a soft side, black in a corner; with a sun below the middle, if wanted.
std::vector<float> sky(float sun) {
  std::vector<float> light;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const bool is_dark = row < 8 && column > 60;
      light.push_back(is_dark ? 0.0f
                              : 1.0f + (column < 20 ? 0.1f * static_cast<float>(row) : 0.0f));
    }
  }
  light[kSunRow * kColumns + kSunColumn] += sun;
  return light;
}

LightCells cells_of(float sun) {
  std::vector<float> limits;
  for (int row = 0; row <= kRows; ++row) limits.push_back(static_cast<float>(row) / kRows);
  return {sky(sun), kColumns, limits, kFirstTurn};
}

Vec3d direction_at(double column, double row) {
  const double theta = kPi * row / kRows;
  const double phi = 2.0 * kPi * (static_cast<double>(kFirstTurn) + column / kColumns);
  return {std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)};
}

double light_in(const std::vector<float>& light, const Vec3f& direction) {
  const double theta = std::acos(std::clamp(static_cast<double>(direction.y), -1.0, 1.0));
  double turns =
      std::atan2(static_cast<double>(direction.z), static_cast<double>(direction.x)) / (2.0 * kPi) -
      static_cast<double>(kFirstTurn);
  turns -= std::floor(turns);
  const int row = std::min(kRows - 1, static_cast<int>(theta / kPi * kRows));
  const int column = std::min(kColumns - 1, static_cast<int>(turns * kColumns));
  return static_cast<double>(light[static_cast<std::size_t>(row * kColumns + column)]);
}

const std::vector<Vec3f> kNormals{{0.0f, 0.0f, 0.0f},
                                  {0.0f, 1.0f, 0.0f},
                                  {0.0f, -1.0f, 0.0f},
                                  glm::normalize(Vec3f(-0.3f, 0.5f, 0.8f))};

TEST(LightCells, density_is_that_of_what_is_drawn_and_adds_up_to_one) {
  for (const float sun : {0.0f, 1e6f}) {
    const LightCells cells = cells_of(sun);
    for (const Vec3f& normal : kNormals) {
      LightCells::Seen seen;
      cells.look(normal, seen);
      double sum = 0.0;
      constexpr int kFiner = 2;
      for (int i = 0; i < kColumns * kFiner; ++i) {
        for (int j = 0; j < kRows * kFiner; ++j) {
          const double column = (i + 0.5) / kFiner, row = (j + 0.5) / kFiner;
          sum +=
              static_cast<double>(
                  cells.density(normal, seen.total, Vec3f(direction_at(column, row)))) *
              2.0 * kPi / (kColumns * kFiner) *
              (std::cos(kPi * j / (kRows * kFiner)) - std::cos(kPi * (j + 1) / (kRows * kFiner)));
        }
      }
      EXPECT_NEAR(sum, 1.0, 1e-4);
      double worst = 0.0;
      for (std::uint32_t i = 0; i < 2000; ++i) {
        const auto drawn =
            cells.draw(seen, {std::fmod(0.5f + static_cast<float>(i) * 0.618034f, 1.0f),
                              (static_cast<float>(i) + 0.5f) / 2000.0f});
        ASSERT_TRUE(drawn);
        const float again = cells.density(normal, seen.total, drawn->direction);
        // Between two parts rounding may choose the other: skipped where the neighbour is as near.
        const double ratio = static_cast<double>(again / drawn->density);
        if (std::abs(ratio - 1.0) > 1e-3) worst += 1.0 / 2000.0;
      }
      EXPECT_LE(worst, 2e-3);
    }
  }
}

// A million times as bright as the rest, below the horizon of three of four normals.
TEST(LightCells, irradiance_by_draws_has_little_grain_whatever_shines_below_the_horizon) {
  for (const float sun : {0.0f, 1e6f}) {
    const std::vector<float> light = sky(sun);
    const LightCells cells = cells_of(sun);
    for (const Vec3f& normal : kNormals) {
      if (normal == Vec3f(0.0f)) continue;
      double expected = 0.0;
      for (int i = 0; i < kColumns; ++i) {
        for (int j = 0; j < kRows; ++j) {
          constexpr int kParts = 8;
          double cosine = 0.0;
          for (int k = 0; k < kParts * kParts; ++k) {
            const Vec3d way =
                direction_at(i + (k % kParts + 0.5) / kParts, j + (k / kParts + 0.5) / kParts);
            cosine += std::max(0.0, glm::dot(way, Vec3d(normal))) / (kParts * kParts);
          }
          expected += static_cast<double>(light[static_cast<std::size_t>(j * kColumns + i)]) *
                      cosine * 2.0 * kPi / kColumns *
                      (std::cos(kPi * j / kRows) - std::cos(kPi * (j + 1) / kRows));
        }
      }
      LightCells::Seen seen;
      cells.look(normal, seen);
      double sum = 0.0, squares = 0.0;
      constexpr int kDraws = 4000;
      for (int i = 0; i < kDraws; ++i) {
        const auto drawn =
            cells.draw(seen, {std::fmod(0.5f + static_cast<float>(i) * 0.618034f, 1.0f),
                              (static_cast<float>(i) + 0.5f) / kDraws});
        ASSERT_TRUE(drawn);
        const double value =
            light_in(light, drawn->direction) *
            std::max(0.0, static_cast<double>(glm::dot(drawn->direction, normal))) /
            static_cast<double>(drawn->density);
        sum += value / kDraws;
        squares += value * value / kDraws;
      }
      EXPECT_NEAR(sum / expected, 1.0, 0.01) << sun << " " << normal.x;
      // A tenth to a third of the draws lie in cells that reach over the horizon.
      EXPECT_LT(std::sqrt(squares - sum * sum), 0.6 * expected) << sun << " " << normal.x;
    }
  }
}

TEST(LightCells, black_draws_nothing) {
  std::vector<float> limits{0.0f, 0.5f, 1.0f};
  const LightCells cells(std::vector<float>(8, 0.0f), 4, limits, 0.0f);
  EXPECT_TRUE(cells.is_empty());
  LightCells::Seen seen;
  cells.look({0.0f, 1.0f, 0.0f}, seen);
  EXPECT_FALSE(cells.draw(seen, {0.3f, 0.4f}));
  EXPECT_EQ(cells.density({0.0f, 1.0f, 0.0f}, seen.total, {0.0f, 1.0f, 0.0f}), 0.0f);
}

}  // namespace
}  // namespace abbe
