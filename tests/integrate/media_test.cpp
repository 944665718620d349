// The rule of media: what surfaces are to rays inside and outside of bodies.
#include "abbe/integrate/surface/media.h"

#include <gtest/gtest.h>

#include <initializer_list>

namespace abbe {
namespace {

constexpr std::uint32_t kWater = 3, kGlass = 5, kAir = 8;

MediumStack stack_of(std::initializer_list<std::uint32_t> materials) {
  MediumStack stack;
  for (const std::uint32_t material : materials) stack.push(material);
  return stack;
}

MediumChange boundary(const MediumStack& media, std::uint32_t material, bool front) {
  return cross(media, material, Transmission::Medium, front);
}

TEST(Media, front_of_a_body_is_entered_from_what_the_ray_is_in) {
  const MediumChange from_air = boundary({}, kGlass, true);
  EXPECT_EQ(from_air.crossing, Crossing::Enter);
  EXPECT_FALSE(from_air.arrives_in);
  EXPECT_EQ(from_air.goes_into(), kGlass);
  const MediumChange from_water = boundary(stack_of({kWater}), kGlass, true);
  EXPECT_EQ(from_water.crossing, Crossing::Enter);
  EXPECT_EQ(from_water.arrives_in, kWater);
  EXPECT_EQ(from_water.goes_into(), kGlass);
}

TEST(Media, back_of_the_innermost_body_is_left_into_the_next) {
  const MediumChange change = boundary(stack_of({kWater, kGlass}), kGlass, false);
  EXPECT_EQ(change.crossing, Crossing::Leave);
  EXPECT_EQ(change.arrives_in, kGlass);
  EXPECT_EQ(change.goes_into(), kWater);
  EXPECT_EQ(boundary(stack_of({kGlass}), kGlass, false).goes_into(), std::nullopt);
}

TEST(Media, back_of_an_outer_body_is_hidden_by_the_inner_one) {
  const MediumChange change = boundary(stack_of({kWater, kGlass}), kWater, false);
  EXPECT_EQ(change.crossing, Crossing::Hidden);
  EXPECT_TRUE(change.goes_straight());
  EXPECT_EQ(change.arrives_in, kGlass);
  EXPECT_EQ(change.behind.innermost(), kGlass);
  EXPECT_FALSE(change.behind.contains(kWater));
}

TEST(Media, ray_that_began_inside_gets_out) {
  const MediumChange change = boundary({}, kGlass, false);
  EXPECT_EQ(change.crossing, Crossing::Leave);
  EXPECT_EQ(change.arrives_in, kGlass);
  EXPECT_EQ(change.goes_into(), std::nullopt);
  // In a bubble of air within glass that the ray does not know, too.
  const MediumChange in_water = boundary(stack_of({kWater}), kAir, false);
  EXPECT_EQ(in_water.crossing, Crossing::Leave);
  EXPECT_EQ(in_water.arrives_in, kAir);
  EXPECT_EQ(in_water.goes_into(), kWater);
}

TEST(Media, body_entered_twice_is_left_twice) {
  MediumChange change = boundary(stack_of({kGlass}), kGlass, true);
  change = boundary(change.behind, kGlass, false);
  EXPECT_EQ(change.crossing, Crossing::Leave);
  EXPECT_EQ(change.goes_into(), kGlass);
}

TEST(Media, sheets_and_opaque_surfaces_change_nothing) {
  const MediumStack media = stack_of({kWater});
  for (const bool front : {false, true}) {
    const MediumChange thin = cross(media, kGlass, Transmission::ThinSheet, front);
    EXPECT_EQ(thin.crossing, Crossing::Thin);
    EXPECT_TRUE(thin.goes_straight());
    EXPECT_EQ(thin.behind.innermost(), kWater);
    const MediumChange opaque = cross(media, kGlass, Transmission::None, front);
    EXPECT_EQ(opaque.crossing, Crossing::None);
    EXPECT_EQ(opaque.arrives_in, kWater);
  }
}

TEST(Media, outermost_is_forgotten_where_too_many_nest) {
  MediumStack stack;
  for (std::uint32_t i = 0; i < 9; ++i) stack.push(i);
  EXPECT_EQ(stack.top(), 8u);
  EXPECT_FALSE(stack.contains(1));
  EXPECT_TRUE(stack.contains(2));
}

}  // namespace
}  // namespace abbe
