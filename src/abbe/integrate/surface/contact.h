/// Faces in contact: what a ray meets where several surfaces lie closer to each other than rays can
/// step off them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "abbe/accel/query.h"
#include "abbe/integrate/surface/media.h"
#include "abbe/integrate/surface/point.h"
#include "abbe/world/world.h"

namespace abbe {

/// Where rays graze surfaces more than this, what is nearby is not looked for any farther.
inline constexpr float kLeastCosine = 1e-3f;

/// What lies so near on one side of a surface that the step off it would jump over it.
enum class Nearby : std::uint8_t { Nothing, Passing, Opaque };

/// A surface that is not alone where a ray met it.
struct Contact {
  static constexpr std::size_t kMaxFaces = 8;

  std::array<MetFace, kMaxFaces> faces;  ///< Of bodies in contact, the surface's own first.
  std::size_t face_count = 0;
  Nearby arrival = Nearby::Nothing;  ///< On the side that the ray came from.
  Nearby beyond = Nearby::Nothing;   ///< On the other.
  float spread_m = 0.0f;             ///< The faces lie no farther apart.
  float reach_m = 0.0f;              ///< What is nearby is no farther from the surface.

  std::span<const MetFace> all_faces() const { return {faces.data(), face_count}; }
  bool is_like(const Contact& other) const {
    return face_count == other.face_count && arrival == other.arrival && beyond == other.beyond &&
           faces == other.faces;
  }
};

/// How a ray starts that leaves a surface on a side where something is nearby: on the surface
/// itself, not a step off it.
struct Departure {
  static constexpr std::uint32_t kNoSurface = 0xffffffffu;

  std::uint32_t surface = kNoSurface;  ///< Index into Geometry::surfaces.
  float reach_m = 0.0f;                ///< What is nearby is no farther along the ray.

  bool is_crowded() const { return surface != kNoSurface; }
};

/// What is nearby a ray that leaves a surface in a direction is no farther along it than this.
inline float reach_along(const Contact& contact, float cosine) {
  return contact.reach_m / std::max(std::abs(cosine), kLeastCosine);
}

/// One surface, or several in contact, as a ray along a line meets them.
struct Interface {
  Hit hit;                    ///< Of the surface that shades, t from the line's origin.
  double t = 0.0;             ///< The same in double precision.
  double first_t = 0.0;       ///< Of the first of its faces.
  double last_t = 0.0;        ///< Of the last.
  double cosine = 1.0;        ///< Of the line with the surface's normal, never negative.
  std::uint32_t surface = 0;  ///< Index into Geometry::surfaces.
  bool is_opaque = false;
  std::uint32_t first_face = 0, face_count = 0;  ///< In InterfaceList::faces.
};

/// The surfaces that a line meets, in the order in which light meets them. Positions decide, in
/// double precision, not distances as rays measure them. Faces that coincide within 4 units in the
/// last place of the positions involved, floats, are in contact:
/// - Of closed dielectrics they are one interface, from the medium before to the medium behind. The
///   surface of the highest priority shades, among equals that of the lowest primitive.
/// - Around a sheet, or an opaque surface, there is a thin gap: what is left of bodies comes before
///   it, what is entered behind it. A sheet lies on the front of an opaque surface.
class InterfaceList {
 public:
  explicit InterfaceList(const World& world) : world_(world) {}

  /// Sorts what a line meets.
  /// Shape: `hits` in any order.
  void sort(const Ray& line, std::span<const Hit> hits);

  std::span<const Interface> all() const { return interfaces_; }
  /// The bodies that an interface has faces of, that of its own surface first; empty where that is
  /// of no body.
  std::span<const MetFace> faces(const Interface& interface) const {
    return {media_.data() + interface.first_face, interface.face_count};
  }
  /// Which interface has the face nearest to t of those that `is_meant` says yes to, of a surface
  /// and a primitive; none: all().size().
  template <class IsMeant>
  std::size_t find(double t, const IsMeant& is_meant) const {
    std::size_t nearest = interfaces_.size();
    double distance = std::numeric_limits<double>::infinity();
    for (const Face& face : faces_) {
      if (!is_meant(face.surface, face.hit.primitive) || !(std::abs(face.t - t) < distance)) {
        continue;
      }
      distance = std::abs(face.t - t);
      nearest = face.interface;
    }
    return nearest;
  }

 private:
  enum class Kind : std::uint8_t { Body, Sheet, Opaque };
  struct Face {
    Hit hit;
    double t = 0.0;
    double cosine = 0.0;  ///< Of the line with the normal; negative where met from the front.
    double size_m = 0.0;  ///< The largest coordinate that the face was made from.
    std::uint32_t surface = 0;
    Kind kind = Kind::Opaque;
    std::size_t interface = 0;

    bool front() const { return cosine < 0.0; }
  };

  Face face_of(const Ray& line, const Hit& hit) const;
  void add_group(std::span<Face> group);
  void add_interface(std::span<Face> faces);

  const World& world_;
  std::vector<Face> faces_;
  std::vector<Interface> interfaces_;
  std::vector<MetFace> media_;
};

/// Answers what rays meet where surfaces may touch others, given the nearest hits.
class ContactFinder {
 public:
  explicit ContactFinder(const World& world) : world_(world), list_(world) {}

  /// What a ray whose nearest hit that is meets there: changes the hit where another surface comes
  /// first. None: the surface is alone.
  std::optional<Contact> meet(const Ray& ray, Hit& hit);

  /// What comes next on a ray that has left a surface with something nearby, and starts on it:
  /// nearby things as meet() has them, or whatever is farther.
  std::optional<Contact> leave(const Ray& ray, const Departure& departure, Hit& hit);

 private:
  void look_around(const Ray& ray, double t, double along_m, QueryMask seen);
  std::size_t look_around(const Ray& ray, const Hit& hit);
  std::optional<Contact> contact_at(std::size_t number) const;
  Hit hit_along(const Ray& ray, const Interface& interface) const;
  bool is_culled(const Interface& met) const;
  Vec3f start_behind(const Ray& ray, const Interface& left) const;

  const World& world_;
  InterfaceList list_;  ///< Along line_.
  Ray line_;
  float reach_m_ = 0.0f;
  HitLists found_;
};

}  // namespace abbe
