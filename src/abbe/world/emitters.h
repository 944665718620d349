/// Surfaces that shine on others, ready to be sampled.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "abbe/math/vec.h"
#include "abbe/world/geometry.h"

namespace abbe {

struct World;

/// The surfaces of a world whose material lights others: triangles, faces of polyhedra and
/// ellipsoids, in a tree by place, power and the side that shines.
///
/// One is chosen by what its power, distance and side may bring to a place, a spot on it by solid
/// angle. Densities are per area of the emitter, so that all lanes of a fan may share a spot.
/// Source: Conty Estevez & Kulla, Importance Sampling of Many Lights with Adaptive Tree Splitting,
///         HPG 2018.
class WorldEmitters {
 public:
  explicit WorldEmitters(const World& world);

  bool is_empty() const { return nodes_.empty(); }
  std::size_t piece_count() const { return pieces_.size(); }
  std::size_t bytes() const;  ///< Memory held.

  /// A place on an emitter.
  struct Spot {
    Vec3f position{0.0f};
    Vec3f normal{0.0f};  ///< Geometric, of unit length, pointing out of the front.
    std::uint32_t primitive = 0;
    Vec2f weights = Vec2f(0.0f);  ///< Barycentric, as in Hit::u and Hit::v.
    float per_m2 = 0.0f;          ///< Its density, > 0.
    bool two_sided = false;       ///< Whether the back shines, too.
  };
  /// A place to be lit: light comes from above its plane; from all around where `normal` is 0.
  struct Place {
    Vec3f position{0.0f};
    Vec3f normal{0.0f};
  };
  /// A spot drawn for a place. Absent where none of it can shine there.
  /// Domain: u in [0, 1)².
  std::optional<Spot> draw(const Place& place, const Vec2f& u) const;

  /// The density with which draw() finds a place on a primitive; 0 where it never does.
  /// Domain: `at` on the primitive, as rays find it.
  float density(const Place& place, std::uint32_t primitive, const Vec3f& at) const;

 private:
  struct Piece {
    std::uint32_t primitive = 0;
    std::array<Vec3f, 3> corners{};
    // Of the corners, in the primitive.
    std::array<Vec2f, 3> weights{};
    std::optional<std::uint32_t> ellipsoid;  ///< Into ellipsoids_; otherwise a triangle.
    bool two_sided = false;
    float area_m2 = 0.0f;
  };
  struct Node {
    Box3f bounds;
    float power = 0.0f;
    // All normals are within an angle of that cosine of the axis; −1: anywhere, or both sides.
    Vec3f axis{0.0f};
    float cos_cone = -1.0f;
    std::uint32_t parent = 0;
    std::uint32_t second = 0;  ///< Its other child; the first follows it. 0: a leaf.
    std::uint32_t piece = 0;   ///< Of a leaf.
  };
  struct RoundEmitter {
    Mat3d to_world{1.0}, to_unit{1.0};
    Vec3d unit_offset{0.0};
  };
  struct Leaf {
    Node node;
    Vec3f center{0.0f};
  };

  void add_triangle(const std::array<Vec3f, 3>& corners, const Piece& like);
  void add_polyhedron(const World& world, const ConvexPolyhedron& polyhedron, const Piece& like);
  void build(const World& world);
  std::uint32_t build(std::vector<Leaf>& leaves, std::size_t first, std::size_t last,
                      std::uint32_t parent);
  float chance_of_first(std::uint32_t node, const Place& place) const;
  std::optional<Spot> draw_on_triangle(const Piece& piece, const Vec3f& from,
                                       const Vec2f& where) const;
  std::optional<Spot> draw_on_ellipsoid(const Piece& piece, const Vec3f& from,
                                        const Vec2f& where) const;
  float density_on(const Piece& piece, const Vec3f& from, const Vec3f& at) const;
  float chance_of_leaf(std::uint32_t leaf, const Place& place) const;

  std::vector<Piece> pieces_;
  std::vector<RoundEmitter> ellipsoids_;
  std::vector<std::uint32_t> leaf_of_piece_;
  std::vector<Node> nodes_;
};

}  // namespace abbe
