// Which closed shells of a mesh face the wrong way: by volume, and by how many others lie around.

#include <gtest/gtest.h>

#include <algorithm>

#include "abbe/scene/shells.h"

namespace abbe {
namespace {

// Adds a box of half width `half` about a place; inside out if that is asked for.
void add_cube(Mesh& mesh, const Vec3f& center, float half, bool inside_out = false) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (int i = 0; i < 8; ++i) {
    mesh.positions.push_back(center + half * Vec3f((i & 1) != 0 ? 1.0f : -1.0f,
                                                   (i & 2) != 0 ? 1.0f : -1.0f,
                                                   (i & 4) != 0 ? 1.0f : -1.0f));
  }
  constexpr std::uint32_t kFaces[12][3] = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5},
                                           {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},
                                           {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  for (const auto& t : kFaces) {
    mesh.triangles.push_back(
        {first + t[0], first + t[inside_out ? 2 : 1], first + t[inside_out ? 1 : 2]});
  }
}

// Six times the volume that the triangles from `first` on enclose.
double six_volumes(const Mesh& mesh, std::size_t first, std::size_t count) {
  double sum = 0.0;
  for (std::size_t i = first; i < first + count; ++i) {
    const auto& t = mesh.triangles[i];
    sum += glm::dot(Vec3d(mesh.positions[t[0]]),
                    glm::cross(Vec3d(mesh.positions[t[1]]), Vec3d(mesh.positions[t[2]])));
  }
  return sum;
}

void expect_count(const ShellCount& count, std::size_t closed, std::size_t turned) {
  EXPECT_EQ(count.closed, closed);
  EXPECT_EQ(count.turned, turned);
}

TEST(Shells, cube_stays_as_it_is_and_one_inside_out_is_turned) {
  Mesh right, wrong;
  add_cube(right, {3, 0, 0}, 1.0f);
  add_cube(wrong, {3, 0, 0}, 1.0f, true);
  const auto before = right.triangles;
  expect_count(turn_shells_outward(right), 1, 0);
  EXPECT_EQ(right.triangles, before);
  expect_count(turn_shells_outward(wrong), 1, 1);
  EXPECT_NEAR(six_volumes(wrong, 0, 12), 48.0, 1e-6);  // Sums of small whole numbers.
}

TEST(Shells, normals_of_a_turned_cube_end_up_outside_wherever_they_were) {
  for (const float side : {1.0f, -1.0f}) {
    Mesh mesh;
    add_cube(mesh, {0, 0, 0}, 1.0f, true);
    for (const Vec3f& position : mesh.positions) {
      mesh.normals.push_back(side * glm::normalize(position));
      mesh.tangents.emplace_back(0.0f, 0.0f, 1.0f, 1.0f);
    }
    expect_count(turn_shells_outward(mesh), 1, 1);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      EXPECT_GT(glm::dot(mesh.normals[i], mesh.positions[i]), 0.0f);
      EXPECT_EQ(mesh.tangents[i].w, side);
    }
  }
}

TEST(Shells, each_of_nested_cubes_faces_by_its_depth) {
  // A body, a cavity in it, a body in that: all the ways they may face.
  for (int ways = 0; ways < 8; ++ways) {
    Mesh mesh;
    add_cube(mesh, {0, 0, 0}, 3.0f, (ways & 1) != 0);
    add_cube(mesh, {0.5, 0, 0}, 2.0f, (ways & 2) != 0);
    add_cube(mesh, {0, 0.5, 0}, 1.0f, (ways & 4) != 0);
    const ShellCount count = turn_shells_outward(mesh);
    EXPECT_EQ(count.closed, 3u);
    EXPECT_GT(six_volumes(mesh, 0, 12), 0.0);
    EXPECT_LT(six_volumes(mesh, 12, 12), 0.0);
    EXPECT_GT(six_volumes(mesh, 24, 12), 0.0);
    EXPECT_EQ(turn_shells_outward(mesh).turned, 0u);
  }
}

TEST(Shells, disjoint_cubes_are_turned_one_by_one) {
  Mesh mesh;
  add_cube(mesh, {0, 0, 0}, 1.0f);
  add_cube(mesh, {5, 0, 0}, 1.0f, true);
  expect_count(turn_shells_outward(mesh), 2, 1);
  EXPECT_GT(six_volumes(mesh, 0, 12), 0.0);
  EXPECT_GT(six_volumes(mesh, 12, 12), 0.0);
}

TEST(Shells, cubes_that_overlap_or_touch_hold_none_of_each_other) {
  for (const float off : {0.7f, 2.0f}) {
    Mesh mesh;
    add_cube(mesh, {0, 0, 0}, 1.0f);
    add_cube(mesh, {off, 0, 0}, 1.0f);
    EXPECT_EQ(turn_shells_outward(mesh).turned, 0u) << off;
  }
}

TEST(Shells, cavity_that_touches_its_body_from_inside_is_one) {
  Mesh mesh;
  add_cube(mesh, {0, 0, 0}, 2.0f);
  add_cube(mesh, {1, 0, 0}, 1.0f);
  expect_count(turn_shells_outward(mesh), 2, 1);
  EXPECT_LT(six_volumes(mesh, 12, 12), 0.0);
}

TEST(Shells, open_mesh_and_one_of_mixed_facing_stay_as_they_are) {
  Mesh open, mixed;
  add_cube(open, {0, 0, 0}, 1.0f, true);
  open.triangles.pop_back();
  add_cube(mixed, {0, 0, 0}, 1.0f, true);
  std::swap(mixed.triangles[3][0], mixed.triangles[3][1]);
  for (Mesh* mesh : {&open, &mixed}) {
    const auto before = mesh->triangles;
    expect_count(turn_shells_outward(*mesh), 0, 0);
    EXPECT_EQ(mesh->triangles, before);
  }
}

TEST(Shells, sheet_of_two_sides_stays_as_it_is) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3f, 0.3f, 0.1f}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 1}};
  expect_count(turn_shells_outward(mesh), 1, 0);
}

TEST(Shells, vertices_apart_at_one_place_are_one_corner) {
  // Each triangle with vertices of its own, as flat shading has them; −0 is 0.
  Mesh cube, mesh;
  add_cube(cube, {1, 1, 1}, 1.0f, true);
  for (const auto& t : cube.triangles) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const std::uint32_t vertex : t) {
      Vec3f position = cube.positions[vertex];
      if (position.x == 0.0f && first % 2 == 0) position.x = -0.0f;
      mesh.positions.push_back(position);
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  expect_count(turn_shells_outward(mesh), 1, 1);
}

}  // namespace
}  // namespace abbe
