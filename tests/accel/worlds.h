/// Geometry and rays for the accelerator's tests.
#pragma once

#include <random>
#include <vector>

#include "accel/judge.h"

namespace abbe::test {

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  float uniform(float low, float high);
  std::size_t below(std::size_t count);
  Vec3f in_cube(float half);
  Vec3f direction();

 private:
  std::mt19937 engine_;
};

World random_triangles(Random& random, int count, float size);

/// A closed mesh: an icosahedron whose triangles are split in four `levels` times, its corners
/// pushed out to the given radius times 1 ± roughness. Corners are shared, so it has no gap.
World closed_sphere(int levels, const Vec3f& center, float radius, float roughness);

/// Sixteen by sixteen rays: unrelated, of one origin, of one origin and nearly one direction, and
/// of nearly one origin and direction, with and without an end.
std::vector<Ray> random_rays(Random& random, int count, float half = 1.5f);

/// Rays from points near `origin` exactly (as floats allow) to corners and edge points of the
/// triangles, sixteen neighbours each.
std::vector<Ray> rays_at_edges(Random& random, const World& world, const Vec3f& origin,
                               float spread, int count);

/// Scales directions and replaces components by zeros, denormals and tiny numbers.
void make_directions_awkward(Random& random, std::vector<Ray>& rays);

}  // namespace abbe::test
