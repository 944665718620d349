// The rule of media: what surfaces are to rays inside and outside of bodies.
#include "abbe/integrate/surface/media.h"

#include <gtest/gtest.h>

#include <initializer_list>

namespace abbe {
namespace {

constexpr std::uint32_t kWater = 3, kGlass = 5, kAir = 8;

MediumStack stack_of(std::initializer_list<std::uint32_t> materials) {
  MediumStack stack;
  for (const std::uint32_t material : materials) stack.push(material, 0);
  return stack;
}

MediumChange boundary(const MediumStack& media, std::uint32_t material, bool front) {
  const MetFace face{material, 0, front};
  return cross(media, Transmission::Medium, {&face, 1});
}

MediumChange contact(const MediumStack& media, std::initializer_list<MetFace> faces) {
  return cross(media, Transmission::Medium, faces);
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
  EXPECT_EQ(change.behind.owner(), kGlass);
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

TEST(Media, body_of_the_same_medium_is_no_boundary_and_is_left_as_often_as_entered) {
  MediumChange change = boundary(stack_of({kGlass}), kGlass, true);
  EXPECT_EQ(change.crossing, Crossing::Hidden);
  change = boundary(change.behind, kGlass, false);
  EXPECT_EQ(change.crossing, Crossing::Hidden);
  change = boundary(change.behind, kGlass, false);
  EXPECT_EQ(change.crossing, Crossing::Leave);
  EXPECT_EQ(change.goes_into(), std::nullopt);
}

// Schmidt & Budge 2002: of bodies that overlap the one of the highest priority owns the place.
TEST(Media, higher_priority_owns_the_overlap) {
  const MetFace ice{kGlass, 2, true};
  const MetFace water{kWater, 1, true};
  // Water, then ice that reaches into it, then out of the water and out of the ice.
  MediumChange change = contact({}, {water});
  change = contact(change.behind, {ice});
  EXPECT_EQ(change.crossing, Crossing::Enter);
  EXPECT_EQ(change.goes_into(), kGlass);
  change = contact(change.behind, {{kWater, 1, false}});
  EXPECT_EQ(change.crossing, Crossing::Hidden);
  change = contact(change.behind, {{kGlass, 2, false}});
  EXPECT_EQ(change.crossing, Crossing::Leave);
  EXPECT_EQ(change.goes_into(), std::nullopt);
  // Ice first: the water begins hidden in it, and owns what is behind it.
  change = contact(contact({}, {ice}).behind, {water});
  EXPECT_EQ(change.crossing, Crossing::Hidden);
  change = contact(change.behind, {{kGlass, 2, false}});
  EXPECT_EQ(change.crossing, Crossing::Leave);
  EXPECT_EQ(change.arrives_in, kGlass);
  EXPECT_EQ(change.goes_into(), kWater);
}

TEST(Media, ray_that_began_inside_of_an_overlap_stays_in_the_higher_priority) {
  MediumStack water;
  water.push(kWater, 5);
  const MediumChange change = contact(water, {{kGlass, 0, false}});
  EXPECT_EQ(change.crossing, Crossing::Hidden);
  EXPECT_EQ(change.arrives_in, kWater);
}

TEST(Media, faces_in_contact_are_one_boundary_in_any_order) {
  const MetFace out_of_glass{kGlass, 0, false};
  const MetFace into_water{kWater, 0, true};
  for (const bool water_first : {false, true}) {
    const MediumChange change = water_first
                                    ? contact(stack_of({kGlass}), {into_water, out_of_glass})
                                    : contact(stack_of({kGlass}), {out_of_glass, into_water});
    EXPECT_EQ(change.crossing, water_first ? Crossing::Enter : Crossing::Leave);
    EXPECT_EQ(change.arrives_in, kGlass);
    EXPECT_EQ(change.goes_into(), kWater);
    EXPECT_FALSE(change.behind.contains(kGlass));
  }
  // Panes of one glass: nothing is there.
  const MediumChange same = contact(stack_of({kGlass}), {out_of_glass, {kGlass, 0, true}});
  EXPECT_EQ(same.crossing, Crossing::Hidden);
  EXPECT_EQ(same.behind.owner(), kGlass);
}

TEST(Media, edge_that_is_grazed_changes_nothing) {
  const MediumChange change = contact({}, {{kGlass, 0, true}, {kGlass, 0, false}});
  EXPECT_EQ(change.crossing, Crossing::Hidden);
  EXPECT_TRUE(change.behind.empty());
}

TEST(Media, sheets_and_opaque_surfaces_change_nothing) {
  const MediumStack media = stack_of({kWater});
  for (const bool front : {false, true}) {
    const MetFace face{kGlass, 0, front};
    const MediumChange thin = cross(media, Transmission::ThinSheet, {&face, 1});
    EXPECT_EQ(thin.crossing, Crossing::Thin);
    EXPECT_TRUE(thin.goes_straight());
    EXPECT_EQ(thin.behind.owner(), kWater);
    const MediumChange opaque = cross(media, Transmission::None, {&face, 1});
    EXPECT_EQ(opaque.crossing, Crossing::None);
    EXPECT_EQ(opaque.arrives_in, kWater);
  }
}

TEST(Media, outermost_is_forgotten_where_too_many_nest) {
  MediumStack stack;
  for (std::uint32_t i = 0; i < 9; ++i) stack.push(i, 0);
  EXPECT_EQ(stack.top(), 8u);
  EXPECT_FALSE(stack.contains(1));
  EXPECT_TRUE(stack.contains(2));
}

}  // namespace
}  // namespace abbe
