/// The search among few primitives against SahCell::rate(), plane by plane.
#include "abbe/accel/kd/build/few_split.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "accel/worlds.h"

namespace abbe::test {
namespace {

constexpr float kGrid = 8.0f;

float on_grid(Random& random) {
  return std::floor(random.uniform(0.0f, kGrid + 0.999f));
}

/// Boxes whose sides often coincide, some of them flat.
std::vector<BuildPrimitive> boxes(std::size_t count, bool coincide, Random& random) {
  std::vector<BuildPrimitive> primitives(count);
  for (BuildPrimitive& p : primitives) {
    for (int axis = 0; axis < 3; ++axis) {
      const float a = coincide ? on_grid(random) : random.uniform(0.0f, kGrid);
      const float b = coincide ? on_grid(random) : random.uniform(0.0f, kGrid);
      p.low[axis] = std::min(a, b);
      p.high[axis] = std::max(a, b);
    }
  }
  return primitives;
}

/// Every side of every primitive rated, axes and planes in rising order.
void rate_all(const std::vector<BuildPrimitive>& primitives, SahCell& cell) {
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<float> planes;
    for (const BuildPrimitive& p : primitives) {
      planes.push_back(p.low[axis]);
      planes.push_back(p.high[axis]);
    }
    std::sort(planes.begin(), planes.end());
    for (const float plane : planes) {
      std::size_t below = 0, above = 0, in_plane = 0;
      for (const BuildPrimitive& p : primitives) {
        below += p.low[axis] < plane;
        above += p.high[axis] > plane;
        in_plane += p.low[axis] == plane && p.high[axis] == plane;
      }
      cell.rate(axis, plane, below + in_plane, above, true);
      if (in_plane > 0) cell.rate(axis, plane, below, above + in_plane, false);
    }
  }
}

TEST(KdFewSplit, finds_the_split_that_rating_each_plane_in_turn_finds) {
  Random random(11);
  KdTreeConfig config;
  config.block_cost = 3.0f;
  int split = 0;
  for (int round = 0; round < 3000; ++round) {
    const std::size_t count = 1 + static_cast<std::size_t>(round) % kFewPrimitives;
    config.block_size = 1u + static_cast<std::uint32_t>(round) % 16u;
    const auto primitives = boxes(count, round % 2 == 0, random);
    // Some planes lie outside the cell, and some splits make more parts than are left.
    const Box3f box{Vec3f(round % 3 == 0 ? 1.0f : 0.0f), Vec3f(kGrid)};
    const std::size_t max_added = round % 5 == 0 ? count / 4 : count;
    const float solids = round % 7 == 0 ? 0.5f : 0.0f;
    SahCell expected(config, box, count, max_added, solids);
    SahCell found = expected;
    rate_all(primitives, expected);
    search_few(primitives, found);
    SCOPED_TRACE("round " + std::to_string(round));
    ASSERT_EQ(found.found, expected.found);
    // To the bit: trees are the same on every instruction set level.
    ASSERT_EQ(found.best.cost, expected.best.cost);
    ASSERT_EQ(found.best.axis, expected.best.axis);
    ASSERT_EQ(found.best.plane, expected.best.plane);
    ASSERT_EQ(found.best.planar_below, expected.best.planar_below);
    split += found.found ? 1 : 0;
  }
  EXPECT_GT(split, 1000);
}

}  // namespace
}  // namespace abbe::test
