/// The closed surfaces that a mesh is made of, and which way they face.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "abbe/math/vec.h"
#include "abbe/scene/scene.h"

namespace abbe {

/// A mesh whose vertices at one place are one corner, whatever else they carry.
struct WeldedMesh {
  std::vector<Vec3f> corners;
  /// Those that have three different corners, and the number in the mesh of each.
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> sources;
};
WeldedMesh weld(const Mesh& mesh);

/// What turn_shells_outward() found.
struct ShellCount {
  std::size_t closed = 0, turned = 0;
};

/// Turns the closed shells of a mesh that face the wrong way, with their normals and tangents. A
/// shell is what hangs together by edges; it faces outwards, unless it lies within an odd number of
/// the others: then it is a cavity and faces inwards. Shells that are open, of which parts face
/// either way, or that hold nothing stay as they are.
ShellCount turn_shells_outward(Mesh& mesh);

}  // namespace abbe
