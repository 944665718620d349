/// Scenes for the accelerator's benchmarks, each made in code from a one-line description.
#pragma once

#include <string>
#include <vector>

#include "abbe/accel/shapes.h"

namespace abbe::bench {

/// A triangle mesh and where to look at it from.
struct BenchScene {
  std::string name;  ///< Of a file: its stem.
  std::string description;
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;
  Vec3f eye{0.0f};
  Vec3f target{0.0f};
  float half_angle_tangent = 0.5f;  ///< Of half the picture's height.
  Vec3f light{0.0f};

  ShapeSpans spans() const { return {positions, triangles, {}, {}, {}, {}}; }
};

/// displaced: a cube-sphere of 1 M triangles with waves on it. inside: the same seen from within.
/// room: a sphere of 200 k triangles in a room of 12. spheres: 80 spheres in a room, half of them
/// displaced, 276 k triangles. huge: as displaced, 10 M triangles; not among scene_names().
/// Any other name is that of a glTF file: its meshes, placed, seen by its first camera (or one that
/// frames it) and lit by its first point or spot light (or one above the camera). Triangles that
/// are degenerate or not finite are dropped, and exact shapes left out; the description counts
/// both. Errors: std::invalid_argument for a name that is neither; what load_gltf() throws.
BenchScene make_scene(const std::string& name);
std::vector<std::string> scene_names();

}  // namespace abbe::bench
