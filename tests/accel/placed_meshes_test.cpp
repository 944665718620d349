/// Meshes at many places against the same triangles flattened into one world.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "abbe/accel/instances/numbers.h"
#include "accel/judge.h"
#include "accel/worlds.h"

namespace abbe::test {
namespace {

constexpr QueryMask kFromFront = kAllBits | kCullBack;
constexpr QueryMask kFromBehind = kAllBits | kCullFront;

// Meshes in their own space, places of them, and what stands in the world besides.
struct Placed {
  World rest;  // Its positions begin with those of the meshes.
  std::vector<std::vector<Triangle>> meshes;
  std::vector<MeshPlace> places;
  std::vector<Triangle> mesh_triangles = {};
  std::vector<TriangleRange> ranges = {};

  ShapeSpans spans() {
    mesh_triangles.clear();
    ranges.clear();
    for (const std::vector<Triangle>& mesh : meshes) {
      ranges.push_back({static_cast<std::uint32_t>(mesh_triangles.size()),
                        static_cast<std::uint32_t>(mesh.size())});
      mesh_triangles.insert(mesh_triangles.end(), mesh.begin(), mesh.end());
    }
    ShapeSpans spans = rest.spans();
    spans.mesh_triangles = mesh_triangles;
    spans.meshes = ranges;
    spans.places = places;
    return spans;
  }
  // The same triangles, each corner rounded where it stands.
  World flat() const {
    World world = rest;
    std::vector<VisibilityMask> of_solids;
    if (!rest.masks.empty()) {
      const auto solids = rest.masks.begin() + static_cast<std::ptrdiff_t>(rest.triangles.size());
      of_solids.assign(solids, rest.masks.end());
      world.masks.resize(rest.triangles.size());
    }
    world.front_only.resize(rest.triangles.size());
    for (const MeshPlace& place : places) {
      for (const Triangle& triangle : meshes[place.mesh]) {
        const auto corner = [&](std::size_t i) {
          return Vec3f(place.linear * Vec3d(rest.positions[triangle[i]]) + place.offset_m);
        };
        world.add_triangle(corner(0), corner(1), corner(2));
        if (!rest.masks.empty()) world.masks.push_back(place.mask);
        world.front_only.push_back(place.front_only ? 1 : 0);
      }
    }
    if (!rest.masks.empty()) {
      world.masks.insert(world.masks.end(), of_solids.begin(), of_solids.end());
    }
    return world;
  }
  std::size_t placed_triangles() const {
    std::size_t count = 0;
    for (const MeshPlace& place : places) count += meshes[place.mesh].size();
    return count;
  }
  // The number of a primitive in flat().
  std::uint32_t in_flat(std::uint32_t primitive) const {
    if (primitive == kNoPrimitive || primitive < rest.triangles.size()) return primitive;
    const std::size_t own = rest.spans().primitive_count();
    if (primitive < own) return primitive + static_cast<std::uint32_t>(placed_triangles());
    return primitive - static_cast<std::uint32_t>(own - rest.triangles.size());
  }
};

Mat3d rotation(Random& random) {
  const Vec3d x(random.direction());
  const Vec3d y = glm::normalize(glm::cross(x, Vec3d(random.direction())));
  return {x, y, glm::cross(x, y)};
}

// A rough ball and a patch of loose triangles, each also as a mirror image, as it stands under two
// transforms: the scales differ along axes, and shear where they come between two rotations.
Placed random_places(Random& random, int count, float spread, bool has_solids) {
  Placed placed;
  const World ball = closed_sphere(2, Vec3f(0.3f, -0.2f, 0.1f), 0.6f, 0.1f);
  const World patch = random_triangles(random, 60, 0.3f);
  for (const World* world : {&ball, &patch}) {
    const auto first = static_cast<std::uint32_t>(placed.rest.positions.size());
    placed.rest.positions.insert(placed.rest.positions.end(), world->positions.begin(),
                                 world->positions.end());
    std::vector<Triangle> own, mirrored;
    for (const Triangle& t : world->triangles) {
      own.push_back({t[0] + first, t[1] + first, t[2] + first});
      mirrored.push_back({t[0] + first, t[2] + first, t[1] + first});
    }
    placed.meshes.push_back(own);
    placed.meshes.push_back(mirrored);
  }
  for (int i = 0; i < count; ++i) {
    const auto scale = [&](bool may_mirror) {
      const double size = std::exp(static_cast<double>(random.uniform(-1.2f, 0.5f)));
      return may_mirror && random.below(2) == 0 ? -size : size;
    };
    MeshPlace place;
    place.linear = rotation(random);
    for (int node = 0; node < 2; ++node) {
      const Mat3d scaled(Vec3d(scale(true), 0, 0), Vec3d(0, scale(true), 0),
                         Vec3d(0, 0, scale(false)));
      place.linear = place.linear * scaled * rotation(random);
    }
    place.offset_m = Vec3d(random.in_cube(spread));
    place.mesh = static_cast<std::uint32_t>(2 * random.below(2)) +
                 (glm::determinant(place.linear) < 0.0 ? 1u : 0u);
    placed.places.push_back(place);
  }
  std::sort(placed.places.begin(), placed.places.end(),
            [](const MeshPlace& a, const MeshPlace& b) { return a.mesh < b.mesh; });
  for (int i = 0; i < 40; ++i) {
    const Vec3f center = random.in_cube(spread);
    placed.rest.add_triangle(center, center + random.in_cube(1.0f), center + random.in_cube(1.0f));
    placed.rest.front_only.push_back(i % 2 == 0 ? 1 : 0);
  }
  for (std::size_t i = 0; i < placed.places.size(); ++i) placed.places[i].front_only = i % 3 != 0;
  if (has_solids) {
    for (int i = 0; i < 4; ++i) {
      placed.rest.add_ellipsoid(Vec3d(random.in_cube(spread)), Vec3d(0.3, 0.5, 0.4));
    }
    placed.rest.add_box_solid({-0.4, -0.4, -0.4}, {0.3, 0.3, 0.3});
  }
  return placed;
}

// How far from a triangle's edges, as a share of its size, and how far along the ray the two may
// differ: a ray is rounded to 2^-24 of what it is measured by, on either way and in either place.
struct Rounding {
  float edge, t;
};
Rounding rounding_at(const World& flat, const Ray& ray, const Hit& hit) {
  if (hit.primitive >= flat.triangles.size()) return {0.0f, 0.0f};
  const Triangle& triangle = flat.triangles[hit.primitive];
  const Vec3f a = flat.positions[triangle[0]], b = flat.positions[triangle[1]],
              c = flat.positions[triangle[2]];
  const Vec3f cross = glm::cross(b - a, c - a);
  const float area = glm::length(cross);
  const float longest = std::max({glm::length(b - a), glm::length(c - a), glm::length(c - b)});
  const float speed = glm::length(ray.direction);
  const float reach = glm::length(ray.origin) + glm::length(a) + longest + speed * hit.t;
  // Sheared and unevenly scaled spaces enlarge what is rounded in them: scales here are within 30.
  const float error_m = 64.0f * std::numeric_limits<float>::epsilon() * reach;
  const float cosine = std::abs(glm::dot(cross, ray.direction)) / (area * speed);
  return {error_m * longest / (area * cosine), error_m / (cosine * speed)};
}

bool is_at_an_edge(const Hit& hit, float margin) {
  return std::min({hit.u, hit.v, 1.0f - hit.u - hit.v}) <= margin;
}

class PlacedMeshesTest : public EveryAccelerator {};
ABBE_FOR_EVERY_ACCELERATOR(PlacedMeshesTest);

// Where the two answers differ, one of them lies on an edge or both at the same distance.
void expect_same(const World& flat, const Ray& ray, const Hit& in_flat, const Hit& hit) {
  const Rounding of_flat = rounding_at(flat, ray, in_flat.is_hit() ? in_flat : hit);
  const Rounding of_placed = rounding_at(flat, ray, hit.is_hit() ? hit : in_flat);
  if (in_flat.primitive == hit.primitive) {
    if (!hit.is_hit()) return;
    EXPECT_NEAR(in_flat.t, hit.t, of_flat.t) << text_of(ray);
    EXPECT_NEAR(in_flat.u, hit.u, of_flat.edge) << text_of(ray);
    EXPECT_NEAR(in_flat.v, hit.v, of_flat.edge) << text_of(ray);
    return;
  }
  const Hit& nearer = in_flat.t < hit.t ? in_flat : hit;
  const Rounding& rounding = in_flat.t < hit.t ? of_flat : of_placed;
  const bool is_tie = std::abs(in_flat.t - hit.t) <= of_flat.t + of_placed.t;
  EXPECT_TRUE(is_tie || is_at_an_edge(nearer, rounding.edge) ||
              std::abs(nearer.t - ray.t_max) <= rounding.t)
      << text_of(ray) << "\nflat " << text_of(in_flat) << "\nplaced " << text_of(hit);
}

TEST_P(PlacedMeshesTest, hits_are_those_of_the_flat_world_but_for_rounding) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    Random random(seed);
    Placed placed = random_places(random, 200, 3.0f, seed != 1);
    const World flat = placed.flat();
    const auto two_level = build_accelerator(GetParam(), placed.spans());
    const auto one = build_accelerator("brute", flat.spans());
    std::vector<Ray> rays = random_rays(random, 3200, 4.0f);
    if (seed == 3) make_directions_awkward(random, rays);
    for (const QueryMask mask : {QueryMask{kAllBits}, kFromFront, kFromBehind}) {
      std::vector<Hit> expected(rays.size()), hits(rays.size());
      one->closest_hits(std::span<const Ray>(rays), mask, std::span<Hit>(expected));
      two_level->closest_hits(std::span<const Ray>(rays), mask, std::span<Hit>(hits));
      std::size_t met = 0, same = 0;
      for (std::size_t i = 0; i < rays.size(); ++i) {
        hits[i].primitive = placed.in_flat(hits[i].primitive);
        expect_same(flat, rays[i], expected[i], hits[i]);
        met += expected[i].is_hit() ? 1 : 0;
        same += expected[i].primitive == hits[i].primitive ? 1 : 0;
      }
      EXPECT_GT(met, rays.size() / 4);
      // Off edges nearly all rays agree, and few come that near to one.
      EXPECT_GE(same, rays.size() - rays.size() / 500);
    }
  }
}

TEST_P(PlacedMeshesTest, every_form_of_query_gives_the_same_answers) {
  Random random(5);
  Placed placed = random_places(random, 60, 3.0f, true);
  placed.rest.masks.assign(placed.rest.spans().primitive_count(), kOpaqueBit);
  for (VisibilityMask& mask : placed.rest.masks) {
    if (random.below(3) != 0) mask = kTransparentBit;
  }
  for (MeshPlace& place : placed.places) {
    place.mask = random.below(2) == 0 ? kOpaqueBit : kTransparentBit;
  }
  const auto accelerator = build_accelerator(GetParam(), placed.spans());
  const std::vector<Ray> rays = random_rays(random, 1600, 4.0f);
  for (const QueryMask mask : {QueryMask{kAllBits}, QueryMask{kOpaqueBit},
                               QueryMask{kTransparentBit}, kFromFront, kFromBehind}) {
    std::vector<Hit> hits(rays.size());
    std::vector<std::uint8_t> any(rays.size());
    accelerator->closest_hits(std::span<const Ray>(rays), mask, std::span<Hit>(hits));
    accelerator->any_hits(std::span<const Ray>(rays), mask, std::span<std::uint8_t>(any));
    HitLists lists, to_opaque;
    accelerator->all_hits(std::span<const Ray>(rays), mask, 0, lists);
    accelerator->all_hits(std::span<const Ray>(rays), mask, kOpaqueBit, to_opaque);
    std::vector<RayPacket> packets;
    for (std::size_t i = 0; i < rays.size(); i += 16) {
      packets.push_back(make_packet(std::span(rays).subspan(i, 16)));
    }
    packets[3].active = 0x5a5a;
    packets[4].active = 0;
    std::vector<HitPacket> of_packets(packets.size());
    std::vector<std::uint32_t> any_of_packets(packets.size());
    accelerator->closest_hits(std::span<const RayPacket>(packets), mask,
                              std::span<HitPacket>(of_packets));
    accelerator->any_hits(std::span<const RayPacket>(packets), mask,
                          std::span<std::uint32_t>(any_of_packets));
    for (std::size_t i = 0; i < rays.size(); ++i) {
      QueryCost cost;
      EXPECT_EQ(any[i] != 0, hits[i].is_hit());
      EXPECT_TRUE(is_same(accelerator->closest_hit_with_cost(rays[i], mask, cost), hits[i]));
      EXPECT_EQ(accelerator->any_hit_with_cost(rays[i], mask, cost), hits[i].is_hit());
      EXPECT_EQ(!lists[i].empty(), hits[i].is_hit());
      if (!lists[i].empty()) {
        EXPECT_TRUE(is_same(lists[i].front(), hits[i]));
      }
      const bool is_active = (packets[i / 16].active >> (i % 16) & 1u) != 0;
      const Hit of_lane = hit_of(of_packets[i / 16], static_cast<int>(i % 16));
      EXPECT_TRUE(is_same(of_lane, is_active ? hits[i] : Hit{})) << text_of(rays[i]);
      EXPECT_EQ(any_of_packets[i / 16] >> (i % 16) & 1u, is_active && hits[i].is_hit() ? 1u : 0u);
      // The list that ends is the beginning of the one that does not.
      ASSERT_LE(to_opaque[i].size(), lists[i].size());
      for (std::size_t n = 0; n < lists[i].size(); ++n) {
        if (n > 0) {
          EXPECT_LE(lists[i][n - 1].t, lists[i][n].t);
        }
        if (n < to_opaque[i].size()) {
          EXPECT_TRUE(is_same(lists[i][n], to_opaque[i][n]));
        }
      }
      // It ends with what is opaque, or because there is nothing more.
      HitLists opaque;
      accelerator->all_hits(std::span(&rays[i], 1),
                            static_cast<QueryMask>(mask & (kOpaqueBit | kCullBack | kCullFront)),
                            kOpaqueBit, opaque);
      if (opaque[0].empty()) {
        EXPECT_EQ(to_opaque[i].size(), lists[i].size());
      } else {
        ASSERT_FALSE(to_opaque[i].empty());
        EXPECT_TRUE(is_same(to_opaque[i].back(), opaque[0].front()));
      }
    }
  }
}

TEST_P(PlacedMeshesTest, lists_hold_what_the_flat_world_has) {
  Random random(11);
  Placed placed = random_places(random, 30, 3.0f, true);
  const World flat = placed.flat();
  const auto two_level = build_accelerator(GetParam(), placed.spans());
  const auto one = build_accelerator("brute", flat.spans());
  const std::vector<Ray> rays = random_rays(random, 800, 4.0f);
  for (const QueryMask mask : {QueryMask{kAllBits}, kFromFront, kFromBehind}) {
    HitLists lists, expected;
    two_level->all_hits(std::span<const Ray>(rays), mask, 0, lists);
    one->all_hits(std::span<const Ray>(rays), mask, 0, expected);
    std::size_t differ = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      bool is_equal = lists[i].size() == expected[i].size();
      for (std::size_t n = 0; is_equal && n < lists[i].size(); ++n) {
        is_equal = placed.in_flat(lists[i][n].primitive) == expected[i][n].primitive;
      }
      differ += is_equal ? 0 : 1;
    }
    EXPECT_LE(differ, rays.size() / 200);  // Rays that pass an edge, or two faces at one place.
  }
}

TEST_P(PlacedMeshesTest, closed_mesh_lets_no_ray_out_between_its_triangles) {
  Random random(7);
  Placed placed;
  const World ball = closed_sphere(4, Vec3f(0.0f), 1.0f, 0.02f);
  placed.rest.positions = ball.positions;
  placed.meshes.push_back(ball.triangles);
  MeshPlace place;
  place.linear =
      rotation(random) * Mat3d(Vec3d(3, 0, 0), Vec3d(0, 0.2, 0), Vec3d(0, 0, 1)) * rotation(random);
  place.offset_m = {1000.3, -2000.7, 300.1};
  placed.places.push_back(place);
  const World flat = placed.flat();
  const auto accelerator = build_accelerator(GetParam(), placed.spans());
  const std::vector<Ray> rays =
      rays_at_edges(random, flat, Vec3f(place.offset_m), 0.05f, fewer(200000) + 1600);
  std::vector<Hit> hits(rays.size());
  accelerator->closest_hits(std::span<const Ray>(rays), kAllBits, std::span<Hit>(hits));
  EXPECT_EQ(std::count_if(hits.begin(), hits.end(), [](const Hit& h) { return !h.is_hit(); }), 0);
  std::vector<RayPacket> packets;
  for (std::size_t i = 0; i + 16 <= rays.size(); i += 16) {
    packets.push_back(make_packet(std::span(rays).subspan(i, 16)));
  }
  std::vector<std::uint32_t> any(packets.size());
  accelerator->any_hits(std::span<const RayPacket>(packets), kAllBits,
                        std::span<std::uint32_t>(any));
  for (const std::uint32_t lanes : any) EXPECT_EQ(lanes, 0xffffu);
}

TEST(PlacedNumbers, place_and_triangle_of_a_number_lead_back_to_it) {
  const std::vector<TriangleRange> counts{{0, 3}, {3, 5}, {8, 2}};
  std::vector<MeshPlace> places(9);
  for (std::size_t i = 0; i < places.size(); ++i) places[i].mesh = i < 4 ? 0 : i < 6 ? 1 : 2;
  const PlacedNumbers numbers(counts, places, 100);
  std::uint32_t next = 100;
  for (std::uint32_t place = 0; place < places.size(); ++place) {
    EXPECT_EQ(numbers.first_primitive(place), next);
    for (std::uint32_t triangle = 0; triangle < counts[places[place].mesh].count;
         ++triangle, ++next) {
      EXPECT_EQ(numbers.triangle_of(next).place, place);
      EXPECT_EQ(numbers.triangle_of(next).triangle, triangle);
    }
  }
}

}  // namespace
}  // namespace abbe::test
