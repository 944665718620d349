// Places that stand for lamps with an extent, against the moments of what they stand for.

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "abbe/base/constants.h"
#include "abbe/world/light/lamp_places.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

constexpr std::size_t kCount = 16;

Light turned(const LampShape& shape) {
  const bool is_sun = std::holds_alternative<SkyDisc>(shape);
  Light lamp =
      is_sun ? test::directional_light({0, 0, -1}, 1.0) : test::point_light({0, 0, 0}, 1.0);
  lamp.to_world = test::translation({1, 2, 3}) * test::rotation({1, 2, -1}, 40.0);
  lamp.shape = shape;
  return lamp;
}

// Off the middle, in the lamp's own axes.
std::vector<Vec3d> offsets(const Light& lamp, std::size_t count = kCount) {
  std::vector<Vec3d> result;
  for (const LampPlace& place : lamp_places(lamp, count)) {
    result.push_back(Vec3d(glm::inverse(lamp.to_world) * place.light.to_world[3]));
  }
  return result;
}

Vec3d mean_of(const std::vector<Vec3d>& all) {
  Vec3d sum(0.0);
  for (const Vec3d& at : all) sum += at;
  return sum / static_cast<double>(all.size());
}

double mean_square(const std::vector<Vec3d>& all, const Vec3d& along) {
  double sum = 0.0;
  for (const Vec3d& at : all) sum += glm::dot(at, along) * glm::dot(at, along);
  return sum / static_cast<double>(all.size());
}

TEST(LampPlacesTest, lamp_without_extent_and_a_single_place_are_the_lamp_itself) {
  Light lamp = turned(RectangleLamp{2.0, 1.0});
  EXPECT_EQ(lamp_places(lamp, 1).front().light.to_world, lamp.to_world);
  lamp.shape.reset();
  ASSERT_EQ(lamp_places(lamp, kCount).size(), 1u);
  EXPECT_EQ(lamp_places(lamp, kCount).front().light.to_world, lamp.to_world);
}

TEST(LampPlacesTest, rectangle_is_filled_evenly_and_no_two_places_are_in_a_row) {
  const std::vector<Vec3d> at = offsets(turned(RectangleLamp{2.0, 0.5}));
  ASSERT_EQ(at.size(), kCount);
  EXPECT_NEAR(glm::length(mean_of(at)), 0.0, 1e-12);
  // Of an even row of 16 the mean square is (1 − 1/256) times that of the side.
  EXPECT_NEAR(mean_square(at, {1, 0, 0}), 4.0 / 12.0 * (1.0 - 1.0 / 256.0), 1e-12);
  EXPECT_NEAR(mean_square(at, {0, 1, 0}), 0.25 / 12.0 * (1.0 - 1.0 / 256.0), 1e-12);
  std::set<long> columns, rows;
  for (const Vec3d& place : at) {
    EXPECT_NEAR(place.z, 0.0, 1e-12);
    columns.insert(std::lround(1e6 * place.x));
    rows.insert(std::lround(1e6 * place.y));
  }
  EXPECT_EQ(columns.size(), kCount);
  EXPECT_EQ(rows.size(), kCount);
}

TEST(LampPlacesTest, disk_and_ball_have_the_moments_of_an_even_disc_from_any_side) {
  const std::vector<Vec3d> disk = offsets(turned(DiskLamp{0.5}), 64);
  const std::vector<Vec3d> ball = offsets(turned(SphereLamp{0.5}), 64);
  // An even disc of radius r has r²/4 along each of its diameters; 64 places come so near to it.
  for (const double turn : {0.0, 0.4, 1.1, 2.0, 2.9}) {
    const Vec3d along(std::cos(turn), std::sin(turn), 0.0);
    EXPECT_NEAR(mean_square(disk, along) / 0.0625, 1.0, 0.05) << turn;
    EXPECT_NEAR(mean_square(ball, along) / 0.0625, 1.0, 0.15) << turn;
    EXPECT_NEAR(mean_square(ball, {0.0, along.x, along.y}) / 0.0625, 1.0, 0.15) << turn;
  }
  EXPECT_NEAR(glm::length(mean_of(disk)), 0.0, 0.005);
  EXPECT_NEAR(glm::length(mean_of(ball)), 0.0, 1e-12);
  for (const Vec3d& place : ball) EXPECT_LT(glm::length(place), 0.5);
  for (const Vec3d& place : disk) EXPECT_LT(glm::length(place), 0.5);
}

// What is symmetric about a point attracts and shines as that point does: here in the mean over the
// directions of the places, at a distance of two radii.
TEST(LampPlacesTest, ball_lights_what_faces_it_as_its_middle_does) {
  const Light lamp = turned(SphereLamp{0.5});
  for (const Vec3d& axis : {Vec3d(1, 0, 0), Vec3d(0, 0.6, 0.8), Vec3d(-0.36, 0.48, 0.8)}) {
    double sum = 0.0;
    for (const Vec3d& at : offsets(lamp)) {
      const Vec3d way = axis - at;
      sum += glm::dot(axis, way) / std::pow(glm::dot(way, way), 1.5);
    }
    // 16 places leave a few per cent so near; the error falls with the square of the distance.
    EXPECT_NEAR(sum / kCount, 1.0, 0.08);
  }
}

TEST(LampPlacesTest, disc_on_the_sky_is_filled_evenly_and_gives_its_illuminance) {
  const double angle_deg = 60.0;
  const Light sun = turned(SkyDisc{angle_deg});
  const Vec3d middle = direction_of(sun);
  const double least = std::cos(glm::radians(0.5 * angle_deg));
  double illuminance = 0.0;
  Vec3d across(0.0);
  for (const LampPlace& place : lamp_places(sun, kCount)) {
    const Vec3d direction = direction_of(place.light);
    EXPECT_NEAR(glm::length(direction), 1.0, 1e-12);
    EXPECT_GT(glm::dot(direction, middle), least);
    illuminance += place.times * glm::dot(direction, middle) / kCount;
    across += (direction - glm::dot(direction, middle) * middle) / double{kCount};
  }
  EXPECT_NEAR(illuminance, 1.0, 1e-12);
  EXPECT_LT(glm::length(across), 0.02);  // Of 16 places, in a disc of radius 0.5.
}

}  // namespace
}  // namespace abbe
