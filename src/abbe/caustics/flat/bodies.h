/// Bodies with flat faces, found in a scene: the ones that light is followed through exactly.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "abbe/base/notes.h"
#include "abbe/math/vec.h"
#include "abbe/scene/scene.h"

namespace abbe {

/// One convex piece of a flat face that light sees. A face that is not convex, or of which parts
/// touch different media, is several of them.
struct Facet {
  Vec3d normal{0.0, 0.0, 1.0};  ///< Unit length, pointing out of the body.
  double distance = 0.0;        ///< n·x on the plane, metres.
  std::vector<Vec3d> corners;   ///< Counter-clockwise seen from outside.
  Vec3d center{0.0};            ///< Of a sphere about the corners.
  double radius_m = 0.0;
  double rounding_m = 0.0;  ///< How far its corners may be off it, or the numbers of a file off.
  std::uint32_t body = 0;
  /// The body whose medium lies in front of it; none: air.
  std::optional<std::uint32_t> beyond = {};
};

/// Facets of a body that lie in one plane before one medium: a flat face, convex or not.
struct Face {
  std::uint32_t first_facet = 0, facet_count = 0;
  std::uint32_t body = 0;
  std::optional<std::uint32_t> beyond = {};
  Vec3d center{0.0};  ///< Of a sphere about the corners.
  double radius_m = 0.0;
};

/// A closed body of smooth glass, or a smooth flat mirror.
struct FlatBody {
  std::string name;
  std::uint32_t instance = 0;  ///< Number in the scene, which is that of its surface, too.
  std::uint32_t material = 0;
  int priority = 0;  ///< Of closed bodies that overlap the higher one has the place.
  std::uint32_t first_facet = 0, facet_count = 0;
  std::uint32_t first_face = 0, face_count = 0;
  bool is_mirror = false;       ///< Opaque metal: it only reflects.
  bool is_front_only = false;   ///< A mirror that is not there from behind.
  bool is_convex = false;       ///< Straight lines inside meet no other facet.
  bool has_inclusions = false;  ///< Another object may lie in it or reach into it.
  /// One on which light shows: no smooth glass with flat faces or flat mirror.
  bool has_lit_inclusions = false;
  bool is_covered = false;  ///< It has no facets: those of bodies in its place stand for them.
};

/// All flat bodies of a scene, with their facets and faces in the order of the bodies.
struct FlatBodies {
  std::vector<FlatBody> bodies;
  std::vector<Facet> facets;
  std::vector<Face> faces;
  /// Glass that had to be left to the straight shadow ray, each as "name: why".
  std::vector<std::string> fallbacks;
};

/// Most facets of a body of glass whose chains are worth counting out. Mirrors may have as many as
/// the triangles that are tried, 64 times more: light meets them once.
inline constexpr std::size_t kMaxFacets = 512;

/// Whether two boxes have no place in common.
bool are_apart(const Box3d& a, const Box3d& b);

/// Finds smooth untextured dielectrics with flat faces (convex shapes, closed meshes) and smooth
/// mirrors with flat faces; thin films without textures may be on them. Coplanar triangles that
/// touch become one facet where their union is convex. Meshes whose normals make flat triangles
/// look curved are no flat bodies.
/// Errors: none; a mesh that is open, meets itself or has more than kMaxFacets facets is left out,
///         with one warning that names it, or of many one.
FlatBodies find_flat_bodies(const Scene& scene, Notes& notes);

}  // namespace abbe
