#include "abbe/integrate/surface/contact.h"

#include <tuple>

namespace abbe {
namespace {

// Faces are in contact within so many units in the last place of the positions they are made from.
constexpr double kContactUlps = 4.0;
constexpr double kUlp = std::numeric_limits<float>::epsilon();

double largest(const Vec3d& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

}  // namespace

// The face of a hit in double precision.
InterfaceList::Face InterfaceList::face_of(const Ray& line, const Hit& hit) const {
  const Geometry& geometry = world_.geometry;
  const Vec3d origin(line.origin);
  const Vec3d direction(line.direction);
  Face face;
  face.hit = hit;
  face.t = static_cast<double>(hit.t);
  face.surface = geometry.surface_of(hit.primitive);
  Vec3d normal;
  std::size_t index = hit.primitive;
  const auto meet_plane = [&](double height) {
    face.cosine = glm::dot(direction, normal);
    if (face.cosine != 0.0) face.t = -height / face.cosine;
  };
  if (geometry.is_triangle(hit.primitive)) {
    const auto [a, b, c] = geometry.corners_of(hit.primitive);
    normal = glm::normalize(glm::cross(b - a, c - a));
    face.size_m = std::max({largest(a), largest(b), largest(c)});
    meet_plane(glm::dot(normal, origin - a));
  } else if ((index -= geometry.triangles.size()) < geometry.ellipsoids.size()) {
    const Ellipsoid& ellipsoid = geometry.ellipsoids[index];
    const Vec3d o = ellipsoid.world_to_unit_linear * origin + ellipsoid.world_to_unit_offset;
    const Vec3d v = ellipsoid.world_to_unit_linear * direction;
    const double half = -glm::dot(o, v) / glm::dot(v, v);
    const Vec3d foot = o + half * v;
    const double root = std::sqrt(std::max(0.0, (1.0 - glm::dot(foot, foot)) / glm::dot(v, v)));
    face.t = face.t < half ? half - root : half + root;
    face.size_m =
        std::max(largest(Vec3d(ellipsoid.bounds.low)), largest(Vec3d(ellipsoid.bounds.high)));
    normal = glm::transpose(ellipsoid.world_to_unit_linear) * (o + face.t * v);
    face.cosine = glm::dot(direction, glm::normalize(normal));
  } else {
    const ConvexPolyhedron& polyhedron = geometry.polyhedra[index - geometry.ellipsoids.size()];
    const Plane& plane =
        geometry.planes[polyhedron.first_plane + static_cast<std::uint32_t>(hit.u)];
    normal = plane.normal;
    face.size_m =
        std::max(largest(Vec3d(polyhedron.bounds.low)), largest(Vec3d(polyhedron.bounds.high)));
    meet_plane(glm::dot(normal, origin) - plane.distance);
  }
  const SurfaceMaterial& material = world_.materials[geometry.surfaces[face.surface].material];
  if (material.bounds_clear_medium()) {
    face.kind = Kind::Body;
  } else if (material.lets_light_pass() && (material.alpha_mode != AlphaMode::Opaque ||
                                            material.transmission == Transmission::ThinSheet)) {
    face.kind = Kind::Sheet;
  }
  return face;
}

void InterfaceList::sort(const Ray& line, std::span<const Hit> hits) {
  faces_.clear();
  interfaces_.clear();
  media_.clear();
  for (const Hit& hit : hits) faces_.push_back(face_of(line, hit));
  std::sort(faces_.begin(), faces_.end(), [](const Face& a, const Face& b) {
    return std::tie(a.t, a.hit.primitive) < std::tie(b.t, b.hit.primitive);
  });
  // Along the line, faces in contact lie apart by more the more it grazes them; what another face
  // grazed by it has between them is not in contact with either.
  const auto touch = [](const Face& a, const Face& b) {
    return (b.t - a.t) * std::max(std::abs(a.cosine), std::abs(b.cosine)) <=
           kContactUlps * kUlp * std::max(a.size_m, b.size_m);
  };
  for (std::size_t begin = 0, end = 0; begin < faces_.size(); begin = end) {
    end = begin + 1;
    while (end < faces_.size() && touch(faces_[end - 1], faces_[end])) ++end;
    add_group({faces_.data() + begin, end - begin});
  }
}

// Faces in contact, as the interfaces that light meets.
void InterfaceList::add_group(std::span<Face> group) {
  const Face* between = nullptr;
  for (const Face& face : group) {
    const auto rank = [](const Face& f) {
      return std::tuple(f.kind != Kind::Opaque, f.hit.primitive);
    };
    if (face.kind == Kind::Body) continue;
    if (between == nullptr || rank(face) < rank(*between)) between = &face;
  }
  if (between == nullptr) return add_interface(group);
  const bool from_front = between->front();
  const auto order = [&](const Face& face) {
    const bool is_body = face.kind == Kind::Body;
    const int place = is_body                     ? (face.front() ? 4 : 0)
                      : face.kind == Kind::Opaque ? 2
                      : from_front                ? 1
                                                  : 3;
    const auto number = static_cast<std::int64_t>(face.hit.primitive);
    return std::tuple(place, place == 3 ? -number : number);
  };
  std::sort(group.begin(), group.end(),
            [&](const Face& a, const Face& b) { return order(a) < order(b); });
  for (std::size_t begin = 0, end = 0; begin < group.size(); begin = end) {
    const int place = std::get<0>(order(group[begin]));
    const bool is_sheet = place == 1 || place == 3;
    end = begin + 1;
    while (end < group.size() && std::get<0>(order(group[end])) == place &&
           (!is_sheet || group[end].surface == group[begin].surface)) {
      ++end;
    }
    add_interface(group.subspan(begin, end - begin));
  }
}

void InterfaceList::add_interface(std::span<Face> faces) {
  const auto priority = [&](const Face& face) {
    return world_.materials[world_.geometry.surfaces[face.surface].material].priority;
  };
  const auto shades_before = [&](const Face& a, const Face& b) {
    return std::tuple(-priority(a), a.hit.primitive) < std::tuple(-priority(b), b.hit.primitive);
  };
  const Face& shading = *std::min_element(faces.begin(), faces.end(), shades_before);
  Interface interface;
  interface.hit = shading.hit;
  interface.t = interface.first_t = interface.last_t = shading.t;
  interface.cosine = std::abs(shading.cosine);
  interface.surface = shading.surface;
  interface.is_opaque = shading.kind == Kind::Opaque;
  interface.first_face = static_cast<std::uint32_t>(media_.size());
  const auto add = [&](const Face& face) {
    media_.push_back(
        {world_.geometry.surfaces[face.surface].material, priority(face), face.front()});
  };
  add(shading);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    Face& face = faces[i];
    face.interface = interfaces_.size();
    interface.first_t = std::min(interface.first_t, face.t);
    interface.last_t = std::max(interface.last_t, face.t);
    // Triangles of one surface meet in an edge: it counts once.
    const auto is_same = [&](const Face& other) {
      return other.surface == face.surface && other.front() == face.front();
    };
    const bool is_new =
        !is_same(shading) &&
        std::none_of(faces.begin(), faces.begin() + static_cast<std::ptrdiff_t>(i), is_same);
    if (face.kind == Kind::Body && is_new) add(face);
  }
  interface.face_count = static_cast<std::uint32_t>(
      std::min(media_.size() - interface.first_face, Contact::kMaxFaces));
  interfaces_.push_back(interface);
}

// Puts what the line through a place of the ray meets into the list.
void ContactFinder::look_around(const Ray& ray, double t, double along_m, QueryMask seen) {
  line_ = ray;
  line_.origin = Vec3f(Vec3d(ray.origin) + (t - along_m) * Vec3d(ray.direction));
  line_.t_max = static_cast<float>(2.0 * along_m);
  found_.clear();
  world_.accelerator->all_hits(std::span<const Ray>(&line_, 1), seen, 0, found_);
  list_.sort(line_, found_[0]);
}

// The same about a hit, as far as a ray that leaves there steps off, and as rays err in what comes
// first. Returns the interface that the hit belongs to.
std::size_t ContactFinder::look_around(const Ray& ray, const Hit& hit) {
  const SurfacePoint point = surface_point(world_, ray.origin, ray.direction, hit);
  reach_m_ =
      2.0f * (point.offset_m + rounding_bound(12) * hit.t) +
      static_cast<float>(2.0 * kContactUlps * kUlp) * world_.touching_of(hit.primitive).size_m;
  const double along_m = static_cast<double>(
      reach_m_ / std::max(std::abs(glm::dot(ray.direction, point.normal)), kLeastCosine));
  look_around(ray, static_cast<double>(hit.t), along_m, kAllBits | kCullBack);
  const std::size_t own = list_.find(
      along_m, [&](std::uint32_t, std::uint32_t primitive) { return primitive == hit.primitive; });
  if (own < list_.all().size()) return own;
  // On an edge the line, rounded elsewhere, may meet only the triangle next to it.
  return list_.find(along_m, [&](std::uint32_t surface, std::uint32_t) {
    return surface == world_.geometry.surface_of(hit.primitive);
  });
}

Hit ContactFinder::hit_along(const Ray& ray, const Interface& interface) const {
  Hit hit = interface.hit;
  const Vec3d behind = Vec3d(line_.origin) - Vec3d(ray.origin);
  hit.t = static_cast<float>(std::max(0.0, interface.t + glm::dot(behind, Vec3d(ray.direction))));
  return hit;
}

std::optional<Contact> ContactFinder::contact_at(std::size_t number) const {
  const std::span<const Interface> all = list_.all();
  if (number == all.size()) return std::nullopt;
  const Interface& here = all[number];
  const auto nearby = [](const Interface& next) {
    return next.is_opaque ? Nearby::Opaque : Nearby::Passing;
  };
  Contact contact;
  const std::span<const MetFace> faces = list_.faces(here);
  std::copy(faces.begin(), faces.end(), contact.faces.begin());
  contact.face_count = faces.size();
  if (number > 0) contact.arrival = nearby(all[number - 1]);
  if (number + 1 < all.size()) contact.beyond = nearby(all[number + 1]);
  const bool is_alone =
      faces.size() == 1 && contact.arrival == Nearby::Nothing && contact.beyond == Nearby::Nothing;
  if (is_alone) return std::nullopt;
  contact.spread_m = static_cast<float>((here.last_t - here.first_t) * here.cosine);
  contact.reach_m = reach_m_;
  return contact;
}

std::optional<Contact> ContactFinder::meet(const Ray& ray, Hit& hit) {
  const std::size_t found = look_around(ray, hit);
  const std::span<const Interface> all = list_.all();
  if (found == all.size()) return std::nullopt;
  // What a ray has left lies behind its start.
  const Vec3d origin(ray.origin);
  const double start = glm::dot(origin - Vec3d(line_.origin), Vec3d(ray.direction)) +
                       kUlp * largest(origin) / std::max(all[found].cosine, double{kLeastCosine});
  std::size_t first = 0;
  while (first < found && !(all[first].last_t > start)) ++first;
  if (all[first].hit.primitive != hit.primitive) hit = hit_along(ray, all[first]);
  return contact_at(first == found ? found : look_around(ray, hit));
}

std::optional<Contact> ContactFinder::leave(const Ray& ray, const Departure& departure, Hit& hit) {
  const double along_m = static_cast<double>(departure.reach_m);
  // What the ray leaves it has behind it, and so from behind.
  look_around(ray, 0.0, along_m, kAllBits);
  const std::span<const Interface> all = list_.all();
  const std::size_t left = list_.find(
      along_m, [&](std::uint32_t surface, std::uint32_t) { return surface == departure.surface; });
  std::size_t next = left + 1;
  while (next < all.size() && is_culled(all[next])) ++next;
  if (next < all.size()) {
    hit = hit_along(ray, all[next]);
    return contact_at(look_around(ray, hit));
  }
  Ray beyond = ray;
  beyond.origin = left < all.size() ? start_behind(ray, all[left])
                                    : Vec3f(Vec3d(ray.origin) + along_m * Vec3d(ray.direction));
  world_.accelerator->closest_hits(std::span<const Ray>(&beyond, 1), kAllBits | kCullBack,
                                   std::span<Hit>(&hit, 1));
  std::optional<Contact> contact;
  if (hit.is_hit()) {
    const Vec3f place = beyond.origin + hit.t * beyond.direction;
    if (world_.touching_of(hit.primitive).holds(place, hit.t)) contact = meet(beyond, hit);
  }
  hit.t += glm::dot(beyond.origin - ray.origin, ray.direction);
  return contact;
}

// Whether an interface is not there for the ray, which comes to it from behind.
bool ContactFinder::is_culled(const Interface& met) const {
  const MetFace& face = list_.faces(met).front();
  return world_.geometry.is_triangle(met.hit.primitive) &&
         world_.materials[face.material].is_front_only && !face.front;
}

// A step off an interface, on its far side.
Vec3f ContactFinder::start_behind(const Ray& ray, const Interface& left) const {
  SurfacePoint point = surface_point(world_, line_.origin, line_.direction, left.hit);
  point.offset_m += static_cast<float>((left.last_t - left.first_t) * left.cosine);
  return off_surface(point, ray.direction);
}

}  // namespace abbe
