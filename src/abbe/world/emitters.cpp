#include "abbe/world/emitters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "abbe/base/constants.h"
#include "abbe/math/polygon.h"
#include "abbe/math/spherical_triangle.h"
#include "abbe/scene/scene.h"
#include "abbe/world/world.h"

namespace abbe {
namespace {

// Of luminance, what a texture may hide between the places where it is looked at.
constexpr float kUnseen = 0.05f;

// Of a piece without power.
constexpr std::uint32_t kNoLeaf = 0xffffffffu;

float luminance_of(const World& world, const SurfaceMaterial& material) {
  const float* row = world.row(*material.emission, 0);
  float luminance = 0.0f;
  for (int lane = 0; lane < world.lanes.lane_count(); ++lane) {
    luminance += world.luminance_weights[static_cast<std::size_t>(lane)] * row[lane];
  }
  return std::max(luminance, 0.0f);
}

float luminance_of(const Vec4f& rec709) {
  return std::max(0.2126f * rec709.x + 0.7152f * rec709.y + 0.0722f * rec709.z, 0.0f);
}

// What share of its untextured light a triangle emits, seen at some places of it.
float texture_share(const World& world, const SurfaceMaterial& material,
                    const LocatedTriangle& triangle) {
  if (!material.emissive_texture) return 1.0f;
  const TextureUse& use = *material.emissive_texture;
  const Surface& surface = world.geometry.surfaces[triangle.surface];
  const auto& offset = surface.uv_offset[use.uv_set];
  if (!offset) return 1.0f;
  constexpr int kSide = 6;
  float sum = 0.0f;
  int count = 0;
  const auto uv = [&](std::size_t corner) {
    return world.geometry.uv[triangle.corners[corner] + *offset - surface.first_vertex];
  };
  const Vec2f a = uv(0), b = uv(1), c = uv(2);
  const Vec2f ab = b - a, ac = c - a;
  const float footprint_uv = std::sqrt(std::abs(ab.x * ac.y - ab.y * ac.x)) / kSide;
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; i + j < kSide; ++j, ++count) {
      const float u = (static_cast<float>(i) + 1.0f / 3.0f) / kSide;
      const float v = (static_cast<float>(j) + 1.0f / 3.0f) / kSide;
      sum += luminance_of(world.textures[use.texture].value(
          transformed_uv(use, (1.0f - u - v) * a + u * b + v * c), footprint_uv));
    }
  }
  return kUnseen + (1.0f - kUnseen) * sum / static_cast<float>(count);
}

Vec3f unit_normal(const std::array<Vec3f, 3>& corners) {
  const Vec3d a(corners[0]);
  return Vec3f(glm::normalize(glm::cross(Vec3d(corners[1]) - a, Vec3d(corners[2]) - a)));
}

float half_diagonal(const Box3f& box) {
  return 0.5f * glm::length(box.size());
}

// What a part may bring to a place, but for what stands between.
float importance(float power, const Box3f& bounds, const Vec3f& axis, float cos_cone,
                 const Vec3f& from) {
  const Vec3f way = from - bounds.center();
  const float radius = half_diagonal(bounds);
  const float distance2 = glm::dot(way, way);
  const float near2 = std::max(distance2, radius * radius);
  if (!(near2 > 0.0f)) return power;
  if (cos_cone <= -1.0f || distance2 <= radius * radius) return power / near2;
  // The least angle that any normal of it may have with a direction to the place.
  const float distance = std::sqrt(distance2);
  const float turned = std::acos(std::clamp(glm::dot(axis, way) / distance, -1.0f, 1.0f)) -
                       std::acos(std::clamp(cos_cone, -1.0f, 1.0f)) -
                       std::asin(std::min(radius / distance, 1.0f));
  // A little above 0 where rounding decides.
  const float facing = std::cos(std::max(turned, 0.0f));
  return turned > 1.5708f ? 0.0f : power * std::max(facing, 1e-4f) / near2;
}

}  // namespace

WorldEmitters::WorldEmitters(const World& world) {
  const Geometry& geometry = world.geometry;
  for (std::size_t i = 0; i < geometry.primitive_surface.size(); ++i) {
    const auto primitive = static_cast<std::uint32_t>(i);
    const Surface& surface = geometry.surfaces[geometry.primitive_surface[i]];
    const SurfaceMaterial& material = world.materials[surface.material];
    if (!material.lights_others || !material.emission) continue;
    Piece piece;
    piece.primitive = primitive;
    // Exact shapes are there from within, too.
    piece.two_sided = !material.is_front_only || i >= geometry.triangles.size();
    piece.weights = {Vec2f(0.0f), Vec2f(1.0f, 0.0f), Vec2f(0.0f, 1.0f)};
    std::size_t index = i;
    if (index < geometry.triangles.size()) {
      const Triangle& corners = geometry.triangles[index];
      add_triangle({geometry.positions[corners[0]], geometry.positions[corners[1]],
                    geometry.positions[corners[2]]},
                   piece);
      continue;
    }
    index -= geometry.triangles.size();
    if (index < geometry.ellipsoids.size()) {
      const Ellipsoid& ellipsoid = geometry.ellipsoids[index];
      piece.ellipsoid = static_cast<std::uint32_t>(ellipsoids_.size());
      ellipsoids_.push_back({geometry.ellipsoid_to_world[index], ellipsoid.world_to_unit_linear,
                             ellipsoid.world_to_unit_offset});
      // Of a ball of the same volume: only the choice among emitters looks at it.
      const double volume = std::abs(glm::determinant(geometry.ellipsoid_to_world[index]));
      piece.area_m2 = static_cast<float>(4.0 * kPi * std::pow(volume, 2.0 / 3.0));
      pieces_.push_back(piece);
      continue;
    }
    add_polyhedron(world, geometry.polyhedra[index - geometry.ellipsoids.size()], piece);
  }
  for (std::size_t i = 0; i < geometry.places.size(); ++i) {
    const Surface& surface = geometry.surfaces[geometry.place_surface[i]];
    const SurfaceMaterial& material = world.materials[surface.material];
    if (!material.lights_others || !material.emission) continue;
    Piece piece;
    piece.primitive = geometry.numbers.first_primitive(static_cast<std::uint32_t>(i));
    piece.two_sided = !material.is_front_only;
    piece.weights = {Vec2f(0.0f), Vec2f(1.0f, 0.0f), Vec2f(0.0f, 1.0f)};
    const std::uint32_t count = geometry.meshes[geometry.places[i].mesh].count;
    for (std::uint32_t triangle = 0; triangle < count; ++triangle, ++piece.primitive) {
      const std::array<Vec3d, 3> corners = geometry.corners_of(piece.primitive);
      add_triangle({Vec3f(corners[0]), Vec3f(corners[1]), Vec3f(corners[2])}, piece);
    }
  }
  build(world);
}

std::size_t WorldEmitters::bytes() const {
  const auto bytes = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
  return bytes(pieces_) + bytes(ellipsoids_) + bytes(leaf_of_piece_) + bytes(nodes_);
}

void WorldEmitters::add_triangle(const std::array<Vec3f, 3>& corners, const Piece& like) {
  Piece piece = like;
  piece.corners = corners;
  const Vec3d a(corners[0]);
  piece.area_m2 = static_cast<float>(
      0.5 * glm::length(glm::cross(Vec3d(corners[1]) - a, Vec3d(corners[2]) - a)));
  if (piece.area_m2 > 0.0f) pieces_.push_back(piece);
}

void WorldEmitters::add_polyhedron(const World& world, const ConvexPolyhedron& polyhedron,
                                   const Piece& like) {
  const Plane* const planes = world.geometry.planes.data() + polyhedron.first_plane;
  const double half_m =
      2.0 * static_cast<double>(glm::length(
                glm::max(glm::abs(polyhedron.bounds.low), glm::abs(polyhedron.bounds.high))));
  for (std::uint32_t face = 0; face < polyhedron.plane_count; ++face) {
    std::vector<Vec3d> polygon = large_square(planes[face].normal, planes[face].distance, half_m);
    for (std::uint32_t other = 0; other < polyhedron.plane_count; ++other) {
      if (other != face) polygon = clipped(polygon, planes[other].normal, planes[other].distance);
    }
    Piece piece = like;
    // As a ray that meets it says: which face.
    piece.weights.fill(Vec2f(static_cast<float>(face), 0.0f));
    for (std::size_t k = 2; k < polygon.size(); ++k) {
      std::array<Vec3f, 3> corners{Vec3f(polygon[0]), Vec3f(polygon[k - 1]), Vec3f(polygon[k])};
      const Vec3d across = glm::cross(polygon[k - 1] - polygon[0], polygon[k] - polygon[0]);
      if (glm::dot(across, planes[face].normal) < 0.0) std::swap(corners[1], corners[2]);
      add_triangle(corners, piece);
    }
  }
}

void WorldEmitters::build(const World& world) {
  std::vector<Leaf> leaves;
  leaf_of_piece_.assign(pieces_.size(), kNoLeaf);
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    const Piece& piece = pieces_[i];
    const SurfaceMaterial& material =
        world.materials[world.geometry.surfaces[world.geometry.surface_of(piece.primitive)]
                            .material];
    Leaf leaf;
    leaf.node.piece = static_cast<std::uint32_t>(i);
    float luminance = 0.0f;
    if (!material.emission_is_textured || material.emission_is_spectrum) {
      luminance = luminance_of(world, material);
    } else {
      luminance = luminance_of(Vec4f(material.emissive_rec709, 1.0f));
    }
    if (piece.ellipsoid) {
      leaf.node.bounds = world.geometry.bounds_of(piece.primitive);
    } else {
      for (const Vec3f& corner : piece.corners) leaf.node.bounds.extend(corner);
      if (material.emission_is_textured && world.geometry.is_triangle(piece.primitive)) {
        luminance *= texture_share(world, material, world.geometry.located(piece.primitive));
      }
      if (!piece.two_sided) {
        leaf.node.axis = unit_normal(piece.corners);
        leaf.node.cos_cone = 1.0f;
      }
    }
    const bool shines_twice = piece.two_sided && world.geometry.is_triangle(piece.primitive);
    leaf.node.power = luminance * piece.area_m2 * (shines_twice ? 2.0f : 1.0f);
    leaf.center = leaf.node.bounds.center();
    if (leaf.node.power > 0.0f) leaves.push_back(leaf);
  }
  if (leaves.empty()) return;
  nodes_.reserve(2 * leaves.size());
  build(leaves, 0, leaves.size(), 0);
}

std::uint32_t WorldEmitters::build(std::vector<Leaf>& leaves, std::size_t first, std::size_t last,
                                   std::uint32_t parent) {
  const auto number = static_cast<std::uint32_t>(nodes_.size());
  if (last - first == 1) {
    nodes_.push_back(leaves[first].node);
    nodes_[number].parent = parent;
    leaf_of_piece_[leaves[first].node.piece] = number;
    return number;
  }
  nodes_.emplace_back();
  Box3f centers;
  for (std::size_t i = first; i < last; ++i) centers.extend(leaves[i].center);
  const Vec3f size = centers.size();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::size_t middle = (first + last) / 2;
  using Step = std::vector<Leaf>::difference_type;
  std::nth_element(leaves.begin() + static_cast<Step>(first),
                   leaves.begin() + static_cast<Step>(middle),
                   leaves.begin() + static_cast<Step>(last), [&](const Leaf& a, const Leaf& b) {
                     return a.center[axis] != b.center[axis] ? a.center[axis] < b.center[axis]
                                                             : a.node.piece < b.node.piece;
                   });
  Node node;
  node.parent = parent;
  bool has_cone = true;
  Vec3d sum(0.0);
  for (std::size_t i = first; i < last; ++i) {
    node.bounds.extend(leaves[i].node.bounds);
    node.power += leaves[i].node.power;
    has_cone &= leaves[i].node.cos_cone > 0.0f;
    sum += Vec3d(leaves[i].node.axis) * static_cast<double>(leaves[i].node.power);
  }
  if (has_cone && glm::length(sum) > 0.0) {
    node.axis = Vec3f(glm::normalize(sum));
    node.cos_cone = 1.0f;
    for (std::size_t i = first; i < last; ++i) {
      node.cos_cone = std::min(node.cos_cone, glm::dot(node.axis, leaves[i].node.axis));
    }
  }
  build(leaves, first, middle, number);
  node.second = build(leaves, middle, last, number);
  nodes_[number] = node;
  return number;
}

float WorldEmitters::chance_of_first(std::uint32_t node, const Place& place) const {
  const auto of = [&](const Node& child) {
    // All of it below the horizon.
    const Vec3f half = 0.5f * child.bounds.size();
    const Vec3f way = child.bounds.center() - place.position;
    const float highest = glm::dot(way, place.normal) + glm::dot(half, glm::abs(place.normal));
    if (highest < 0.0f) return 0.0f;
    return importance(child.power, child.bounds, child.axis, child.cos_cone, place.position);
  };
  const float first = of(nodes_[node + 1]), second = of(nodes_[nodes_[node].second]);
  const float sum = first + second;
  return sum > 0.0f ? first / sum : -1.0f;
}

float WorldEmitters::chance_of_leaf(std::uint32_t leaf, const Place& place) const {
  float chance = 1.0f;
  for (std::uint32_t node = leaf; node != 0; node = nodes_[node].parent) {
    const std::uint32_t parent = nodes_[node].parent;
    const float first = chance_of_first(parent, place);
    if (first < 0.0f) return 0.0f;
    chance *= node == parent + 1 ? first : 1.0f - first;
  }
  return chance;
}

std::optional<WorldEmitters::Spot> WorldEmitters::draw(const Place& place, const Vec2f& u) const {
  if (nodes_.empty()) return std::nullopt;
  std::uint32_t node = 0;
  // What is left of a number that has decided between two parts is a number again.
  double left = static_cast<double>(u.x);
  double chance = 1.0;
  while (nodes_[node].second != 0) {
    const float part = chance_of_first(node, place);
    if (part < 0.0f) return std::nullopt;
    const auto first = static_cast<double>(part);
    if (left < first) {
      left /= first;
      chance *= first;
      node = node + 1;
    } else {
      left = std::min((left - first) / (1.0 - first), 1.0 - 1e-9);
      chance *= 1.0 - first;
      node = nodes_[node].second;
    }
  }
  const Piece& piece = pieces_[nodes_[node].piece];
  const Vec3f& from = place.position;
  const Vec2f where(static_cast<float>(left), u.y);
  std::optional<Spot> spot = piece.ellipsoid ? draw_on_ellipsoid(piece, from, where)
                                             : draw_on_triangle(piece, from, where);
  if (!spot) return std::nullopt;
  spot->primitive = piece.primitive;
  spot->two_sided = piece.two_sided;
  spot->per_m2 *= static_cast<float>(chance);
  if (!(spot->per_m2 > 0.0f) || !std::isfinite(spot->per_m2)) return std::nullopt;
  return spot;
}

std::optional<WorldEmitters::Spot> WorldEmitters::draw_on_triangle(const Piece& piece,
                                                                   const Vec3f& from,
                                                                   const Vec2f& where) const {
  const Vec3d a = Vec3d(piece.corners[0]) - Vec3d(from);
  const Vec3d ab = Vec3d(piece.corners[1]) - Vec3d(piece.corners[0]);
  const Vec3d ac = Vec3d(piece.corners[2]) - Vec3d(piece.corners[0]);
  const Vec3d normal = glm::normalize(glm::cross(ab, ac));
  const double height = -glm::dot(normal, a);  // Of the place above the front.
  if (height == 0.0 || (height < 0.0 && !piece.two_sided)) return std::nullopt;
  double u = 0.0, v = 0.0;
  Spot spot;
  const double angle_sr = solid_angle(a, a + ab, a + ac);
  if (angle_sr >= kLeastSolidAngle_sr) {
    const Vec3d way = direction_to_triangle(a, a + ab, a + ac, Vec2d(where));
    const Vec3d place = (glm::dot(normal, a) / glm::dot(normal, way)) * way - a;
    const double twice = glm::dot(normal, glm::cross(ab, ac));
    u = glm::dot(normal, glm::cross(place, ac)) / twice;
    v = glm::dot(normal, glm::cross(ab, place)) / twice;
    if (!std::isfinite(u) || !std::isfinite(v)) return std::nullopt;
    u = std::clamp(u, 0.0, 1.0);
    v = std::clamp(v, 0.0, 1.0 - u);
  } else {
    const double root = std::sqrt(static_cast<double>(where.x));
    u = 1.0 - root;
    v = static_cast<double>(where.y) * root;
  }
  spot.position = Vec3f(Vec3d(piece.corners[0]) + u * ab + v * ac);
  spot.normal = Vec3f(normal);
  spot.weights = (1.0f - static_cast<float>(u) - static_cast<float>(v)) * piece.weights[0] +
                 static_cast<float>(u) * piece.weights[1] +
                 static_cast<float>(v) * piece.weights[2];
  spot.per_m2 = density_on(piece, from, spot.position);
  return spot;
}

std::optional<WorldEmitters::Spot> WorldEmitters::draw_on_ellipsoid(const Piece& piece,
                                                                    const Vec3f& from,
                                                                    const Vec2f& where) const {
  const RoundEmitter& round = ellipsoids_[*piece.ellipsoid];
  const Vec3d place = round.to_unit * Vec3d(from) + round.unit_offset;
  const double distance = glm::length(place);
  // From within, one that shines inwards as well is seen all around.
  const bool inside = distance <= 1.0;
  if (inside && !piece.two_sided) return std::nullopt;
  const double cap = inside ? -1.0 : 1.0 / distance;
  const double cosine = 1.0 - static_cast<double>(where.x) * (1.0 - cap);
  const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
  const double turn = 2.0 * kPi * static_cast<double>(where.y);
  const Vec3d axis = distance > 0.0 ? place / distance : Vec3d(0.0, 0.0, 1.0);
  const Vec3d side = glm::normalize(std::abs(axis.x) < 0.5 ? glm::cross(axis, Vec3d(1, 0, 0))
                                                           : glm::cross(axis, Vec3d(0, 1, 0)));
  const Vec3d q =
      cosine * axis + sine * std::cos(turn) * side + sine * std::sin(turn) * glm::cross(axis, side);
  Spot spot;
  spot.position = Vec3f(round.to_world * (q - round.unit_offset));
  spot.normal = Vec3f(glm::normalize(glm::transpose(round.to_unit) * q));
  spot.per_m2 = density_on(piece, from, spot.position);
  return spot;
}

float WorldEmitters::density_on(const Piece& piece, const Vec3f& from, const Vec3f& at) const {
  if (piece.ellipsoid) {
    const RoundEmitter& round = ellipsoids_[*piece.ellipsoid];
    const Vec3d place = round.to_unit * Vec3d(from) + round.unit_offset;
    const double distance = glm::length(place);
    const double cap = distance <= 1.0 ? -1.0 : 1.0 / distance;
    if (distance <= 1.0 && !piece.two_sided) return 0.0f;
    const Vec3d q = glm::normalize(round.to_unit * Vec3d(at) + round.unit_offset);
    if (distance > 1.0 && glm::dot(q, place) / distance < cap - 1e-6) return 0.0f;
    // An area of the unit ball becomes one of the ellipsoid by the map's cofactors.
    const double stretch =
        std::abs(glm::determinant(round.to_world)) * glm::length(glm::transpose(round.to_unit) * q);
    return static_cast<float>(1.0 / (2.0 * kPi * (1.0 - cap) * stretch));
  }
  const Vec3d a = Vec3d(piece.corners[0]) - Vec3d(from);
  const Vec3d b = Vec3d(piece.corners[1]) - Vec3d(from);
  const Vec3d c = Vec3d(piece.corners[2]) - Vec3d(from);
  const Vec3d normal = glm::normalize(glm::cross(b - a, c - a));
  const double height = -glm::dot(normal, a);
  if (height == 0.0 || (height < 0.0 && !piece.two_sided)) return 0.0f;
  const double angle_sr = solid_angle(a, b, c);
  if (angle_sr < kLeastSolidAngle_sr) return 1.0f / piece.area_m2;
  const Vec3d way = Vec3d(at) - Vec3d(from);
  const double distance2 = glm::dot(way, way);
  return static_cast<float>(std::abs(height) / (distance2 * std::sqrt(distance2) * angle_sr));
}

float WorldEmitters::density(const Place& place, std::uint32_t primitive, const Vec3f& at) const {
  const auto first = std::lower_bound(
      pieces_.begin(), pieces_.end(), primitive,
      [](const Piece& piece, std::uint32_t number) { return piece.primitive < number; });
  auto last = first;
  while (last != pieces_.end() && last->primitive == primitive) ++last;
  if (first == last) return 0.0f;
  // Of a polyhedron, the piece that the place is on: it is farthest inside of that.
  const Piece* found = &*first;
  if (last - first > 1) {
    double best = -std::numeric_limits<double>::infinity();
    for (auto piece = first; piece != last; ++piece) {
      std::vector<Vec3d> polygon;
      for (const Vec3f& corner : piece->corners) polygon.emplace_back(corner);
      const Vec3d normal(unit_normal(piece->corners));
      const double off = std::abs(glm::dot(normal, Vec3d(at) - polygon[0]));
      const double inside = std::min(distance_inside(polygon, normal, Vec3d(at)), 0.0) - off;
      if (inside > best) {
        best = inside;
        found = &*piece;
      }
    }
  }
  const std::uint32_t leaf = leaf_of_piece_[static_cast<std::size_t>(found - pieces_.data())];
  if (leaf == kNoLeaf) return 0.0f;
  return chance_of_leaf(leaf, place) * density_on(*found, place.position, at);
}

}  // namespace abbe
