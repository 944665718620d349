/// The flat facets that the triangles of a mesh make.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "abbe/caustics/flat/bodies.h"
#include "abbe/math/vec.h"
#include "abbe/scene/scene.h"

namespace abbe {

/// A mesh welded by position and placed, with what is needed to group its triangles.
class MeshFacets {
 public:
  MeshFacets(const Mesh& mesh, const Mat4d& to_world);

  /// Whether the normals that shade the mesh are those of its triangles.
  bool is_flat() const;
  bool is_closed() const;
  /// Triangles side by side are one facet where they are coplanar but for the rounding of their
  /// corners, and their union is convex.
  std::vector<Facet> facets() const;

 private:
  /// The space between two parallel planes about the corners of triangles.
  struct Layer {
    Vec3d normal{0.0};  ///< Unit length, or 0 of triangles without an area.
    double low = 0.0, high = 0.0;
    double rounding_m = 0.0;  ///< The greatest of the corners.

    bool is_thin() const { return high - low <= 2.0 * rounding_m; }
  };

  void join_close_corners();
  void drop_doubles();
  Vec3d area_of_triangle(std::size_t triangle) const;  ///< Along its normal, twice its area.
  std::vector<std::array<std::size_t, 3>> neighbours() const;
  std::vector<std::vector<std::size_t>> groups() const;
  Layer layer_of(const std::vector<std::size_t>& members) const;
  void extend(Layer& layer, std::size_t triangle) const;
  bool take(std::size_t triangle, std::vector<std::size_t>& members, Layer& layer) const;
  void add_group(const std::vector<std::size_t>& members, std::vector<Facet>& facets) const;

  const Mesh& mesh_;
  std::vector<Vec3d> corners_;
  std::vector<double> rounding_m_;  ///< How far rounding may have moved each corner.
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

}  // namespace abbe
