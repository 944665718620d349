#include "abbe/caustics/flat/bodies.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "abbe/caustics/flat/arrangement.h"
#include "abbe/caustics/flat/flat_material.h"
#include "abbe/caustics/flat/inclusions.h"
#include "abbe/caustics/flat/mesh_facets.h"
#include "abbe/math/polygon.h"

namespace abbe {
namespace {

// A ball about the corners of some facets, for what has a centre and a radius.
template <typename Bounded>
void bound(std::span<const Facet> facets, Bounded& result) {
  std::vector<Vec3d> corners;
  for (const Facet& facet : facets) {
    corners.insert(corners.end(), facet.corners.begin(), facet.corners.end());
  }
  const Ball ball = ball_about(corners);
  result.center = ball.center;
  result.radius_m = ball.radius_m;
}

// Numbers the facets of the last body and joins those of one plane, which follow each other.
void finish(FlatBodies& found, FlatBody& body, std::vector<Facet> facets) {
  body.first_facet = static_cast<std::uint32_t>(found.facets.size());
  body.facet_count = static_cast<std::uint32_t>(facets.size());
  body.first_face = static_cast<std::uint32_t>(found.faces.size());
  const auto number = static_cast<std::uint32_t>(found.bodies.size());
  for (std::size_t i = 0; i < facets.size();) {
    std::size_t end = i;
    while (end < facets.size() && facets[end].normal == facets[i].normal &&
           facets[end].distance == facets[i].distance && facets[end].beyond == facets[i].beyond) {
      facets[end].body = number;
      bound(std::span<const Facet>(&facets[end], 1), facets[end]);
      ++end;
    }
    Face face;
    face.first_facet = body.first_facet + static_cast<std::uint32_t>(i);
    face.facet_count = static_cast<std::uint32_t>(end - i);
    face.body = number;
    face.beyond = facets[i].beyond;
    bound(std::span<const Facet>(&facets[i], end - i), face);
    found.faces.push_back(face);
    i = end;
  }
  body.face_count = static_cast<std::uint32_t>(found.faces.size()) - body.first_face;
  std::move(facets.begin(), facets.end(), std::back_inserter(found.facets));
  found.bodies.push_back(std::move(body));
}

/// A body that is left to straight rays.
struct LeftOut {
  std::string name, why;
  bool is_mirror = false;
};

// A word on each; where they are many, one on all of a kind.
void tell(const std::vector<LeftOut>& left_out, bool of_mirrors, Notes& notes) {
  constexpr std::size_t kFew = 2;
  std::vector<const LeftOut*> bodies;
  for (const LeftOut& body : left_out) {
    if (body.is_mirror == of_mirrors) bodies.push_back(&body);
  }
  const bool is_few = bodies.size() <= kFew;
  for (std::size_t i = 0; i < (is_few ? bodies.size() : 1); ++i) {
    const LeftOut& body = *bodies[i];
    notes.warn(is_few ? body.name : fmt::format("{} bodies, e.g. {}", bodies.size(), body.name),
               (of_mirrors ? "light of lamps that it reflects is left out: "
                           : "light through it goes straight: ") +
                   body.why);
  }
}

std::vector<Facet> facets_of(const ConvexShape& shape, const Mat4d& to_world) {
  const Mat3d for_normals = glm::transpose(glm::inverse(Mat3d(to_world)));
  std::vector<Vec4d> planes;
  for (const Vec4d& source : shape.planes) {
    const Vec3d normal = for_normals * Vec3d(source);
    const double length = glm::length(normal);
    if (!(length > 0.0)) continue;
    const Vec3d unit = normal / length;
    planes.emplace_back(unit, (source.w + glm::dot(normal, Vec3d(to_world[3]))) / length);
  }
  double reach = 1.0;
  for (const Vec4d& plane : planes) reach = std::max(reach, std::abs(plane.w));
  std::vector<Facet> facets;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    // The same plane given twice is one facet.
    const bool again =
        std::any_of(planes.begin(), planes.begin() + static_cast<long>(i),
                    [&](const Vec4d& p) { return glm::distance(p, planes[i]) < 1e-12; });
    if (again) continue;
    const Vec3d normal(planes[i]);
    std::vector<Vec3d> polygon = large_square(normal, planes[i].w, 1e4 * reach);
    for (std::size_t j = 0; j < planes.size() && !polygon.empty(); ++j) {
      if (j != i) polygon = clipped(polygon, Vec3d(planes[j]), planes[j].w);
    }
    // Where more than three planes meet, rounding makes several corners of one.
    polygon = without_short_edges(polygon, 1e-9 * reach);
    if (polygon.empty() || !(area_of(polygon) > 1e-12 * reach * reach)) continue;
    Facet facet{.normal = normal, .distance = planes[i].w, .corners = std::move(polygon)};
    facets.push_back(std::move(facet));
  }
  return facets;
}

// What is nearer than this touches.
double slack_m(const std::vector<Facet>& facets) {
  Vec3d low(1e300);
  Vec3d high(-1e300);
  double rounding_m = 0.0;
  for (const Facet& facet : facets) {
    for (const Vec3d& corner : facet.corners) {
      low = glm::min(low, corner);
      high = glm::max(high, corner);
    }
    rounding_m = std::max(rounding_m, facet.rounding_m);
  }
  return 1e-6 * glm::distance(low, high) + 2.0 * rounding_m;
}

// Whether an edge of one facet goes through the inside of another.
bool meets_itself(const std::vector<Facet>& facets) {
  const double slack = slack_m(facets);
  for (const Facet& facet : facets) {
    for (std::size_t i = 0; i < facet.corners.size(); ++i) {
      const Vec3d& a = facet.corners[i];
      const Vec3d& b = facet.corners[(i + 1) % facet.corners.size()];
      for (const Facet& other : facets) {
        const double da = glm::dot(other.normal, a) - other.distance;
        const double db = glm::dot(other.normal, b) - other.distance;
        if ((da > -slack && db > -slack) || (da < slack && db < slack)) continue;
        const Vec3d crossing = a + (da / (da - db)) * (b - a);
        if (distance_inside(other.corners, other.normal, crossing) > slack) return true;
      }
    }
  }
  return false;
}

bool is_convex(const std::vector<Facet>& facets) {
  const double slack = slack_m(facets);
  for (const Facet& facet : facets) {
    for (const Facet& other : facets) {
      for (const Vec3d& corner : other.corners) {
        if (glm::dot(facet.normal, corner) > facet.distance + slack) return false;
      }
    }
  }
  return true;
}

// The facets of a flat mesh, or why it has none that are worth having.
struct MeshOutcome {
  std::vector<Facet> facets;
  std::string trouble;
  bool is_hopeless = false;  ///< However it is placed.
};

MeshOutcome mesh_outcome(const Mesh& mesh, const MeshFacets& mesh_facets, bool is_mirror) {
  // Grouping and the test for crossings are only tried where the answer can be useful.
  constexpr std::size_t kMaxTriangles = 64 * kMaxFacets;
  if (mesh.triangles.size() > kMaxTriangles) {
    return {{}, fmt::format("it has {} triangles", mesh.triangles.size())};
  }
  std::vector<Facet> facets = mesh_facets.facets();
  if (!is_mirror && facets.size() > kMaxFacets) {
    // Elsewhere rounding may make a few more of them one.
    return {{},
            fmt::format("it has {} facets, more than {}", facets.size(), kMaxFacets),
            facets.size() > 2 * kMaxFacets};
  }
  if (is_mirror || facets.empty()) return {std::move(facets), ""};
  if (!mesh_facets.is_closed())
    return {{}, "its mesh is open, or has edges that do not meet corner to corner"};
  if (meets_itself(facets)) return {{}, "its mesh meets itself"};
  return {std::move(facets), ""};
}

// Few flat faces with normals that turn between them are more often an export that smoothed a box
// than a curved thing.
void tell_if_few(const Mesh& mesh, const MeshFacets& mesh_facets, const FlatBody& body,
                 std::vector<LeftOut>& left_out) {
  constexpr std::size_t kFewFaces = 64;
  if (mesh.triangles.size() > 2 * kFewFaces) return;
  const std::size_t faces = mesh_facets.facets().size();
  if (faces == 0 || faces > kFewFaces) return;
  left_out.push_back({body.name, fmt::format("its normals make {} flat faces look curved", faces),
                      body.is_mirror});
}

// Adds an instance if it is a flat body. Of meshes with far too many facets, `hopeless` says why:
// they are not counted again at each of their places.
void add_instance(const Scene& scene, std::uint32_t number, std::vector<LeftOut>& left_out,
                  std::vector<BodyFacets>& bodies, std::map<std::uint32_t, std::string>& hopeless) {
  const Instance& instance = scene.instances[number];
  const auto* mesh_number = std::get_if<std::uint32_t>(&instance.what);
  const Mesh* mesh = mesh_number != nullptr ? &scene.meshes[*mesh_number] : nullptr;
  const Shape* shape = mesh == nullptr ? &std::get<Shape>(instance.what) : nullptr;
  FlatBody body;
  body.name = !instance.name.empty() ? instance.name : mesh != nullptr ? mesh->name : shape->name;
  if (body.name.empty()) body.name = fmt::format("object {}", number);
  body.instance = number;
  body.material = mesh != nullptr ? mesh->material : shape->material;
  const Material& material = scene.materials[body.material];
  const FlatMaterial flat = flat_material(scene, material, mesh);
  if (flat.kind == FlatMaterial::Kind::None) return;
  body.is_mirror = flat.kind == FlatMaterial::Kind::Mirror;
  body.is_front_only = mesh != nullptr && material.is_front_only();
  body.priority = material.priority;
  MeshOutcome outcome;
  outcome.trouble = flat.trouble;
  if (shape != nullptr) {
    const auto* convex = std::get_if<ConvexShape>(&shape->geometry);
    if (convex == nullptr) return;
    outcome.facets = facets_of(*convex, instance.to_world);
    body.is_convex = true;
  } else {
    if (const auto known = hopeless.find(*mesh_number); known != hopeless.end()) {
      left_out.push_back({body.name, known->second, body.is_mirror});
      return;
    }
    MeshFacets mesh_facets(*mesh, instance.to_world);
    if (!mesh_facets.is_flat()) {
      tell_if_few(*mesh, mesh_facets, body, left_out);
      return;
    }
    if (outcome.trouble.empty()) {
      outcome = mesh_outcome(*mesh, mesh_facets, body.is_mirror);
      if (outcome.facets.empty() && outcome.trouble.empty()) return;
      if (outcome.is_hopeless) hopeless[*mesh_number] = outcome.trouble;
      body.is_convex = is_convex(outcome.facets);
    }
  }
  if (outcome.trouble.empty()) {
    bodies.push_back({body, std::move(outcome.facets), shape != nullptr});
  } else {
    left_out.push_back({body.name, outcome.trouble, body.is_mirror});
  }
}

// Whether light that comes down on a mirror is thrown off it for good: its normals, or those of its
// other side, lie within 22.5° of their mean, so that what one facet reflects goes up more steeply
// than any other one rises.
bool is_gentle(const std::vector<Facet>& facets) {
  constexpr double kCos = 0.9238795325112867;
  Vec3d sum(0.0);
  for (const Facet& facet : facets) {
    sum += glm::dot(facet.normal, facets[0].normal) < 0.0 ? -facet.normal : facet.normal;
  }
  const double length = glm::length(sum);
  return std::all_of(facets.begin(), facets.end(), [&](const Facet& facet) {
    return std::abs(glm::dot(facet.normal, sum)) >= kCos * length;
  });
}

// Rays from every facet are asked of every other, and where facets light each other more and more
// of them are sent: the time grows as the square of their number, to a minute and a half for wavy
// mirrors of 4096 facets together. Gentle ones of 30 000 take six seconds. Those of the most facets
// are left out, all of as many alike, until the others are few enough.
void leave_out_largest_mirrors(std::vector<BodyFacets>& bodies, std::vector<LeftOut>& left_out) {
  constexpr std::size_t kMaxSteep = 4096, kMaxGentle = 64 * kMaxFacets;
  std::vector<std::uint8_t> is_steep;
  is_steep.reserve(bodies.size());
  for (const BodyFacets& body : bodies) is_steep.push_back(is_gentle(body.facets) ? 0 : 1);
  for (const bool steep : {true, false}) {
    const std::size_t most = steep ? kMaxSteep : kMaxGentle;
    std::map<std::size_t, std::size_t> facets_by_size;
    std::size_t all = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      if (!bodies[i].body.is_mirror || (is_steep[i] != 0) != steep) continue;
      facets_by_size[bodies[i].facets.size()] += bodies[i].facets.size();
      all += bodies[i].facets.size();
    }
    std::size_t largest = 0, kept = 0;
    for (const auto& [size, facets] : facets_by_size) {
      kept += facets;
      if (kept > most) break;
      largest = size;
    }
    if (kept <= most) continue;
    std::vector<BodyFacets> rest;
    std::vector<std::uint8_t> rest_is_steep;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      BodyFacets& body = bodies[i];
      if (!body.body.is_mirror || (is_steep[i] != 0) != steep || body.facets.size() <= largest) {
        rest.push_back(std::move(body));
        rest_is_steep.push_back(is_steep[i]);
        continue;
      }
      left_out.push_back({body.body.name,
                          fmt::format("{} mirrors have {} facets together, more than {}",
                                      steep ? "wavy" : "gently curved", all, most),
                          true});
    }
    bodies = std::move(rest);
    is_steep = std::move(rest_is_steep);
  }
}

bool is_within(const Box3d& box, const Box3d& other) {
  return glm::all(glm::lessThanEqual(other.low, box.low)) &&
         glm::all(glm::lessThanEqual(box.high, other.high));
}

const Material& material_of(const Scene& scene, const Instance& instance) {
  const auto* mesh = std::get_if<std::uint32_t>(&instance.what);
  return scene.materials[mesh != nullptr ? scene.meshes[*mesh].material
                                         : std::get<Shape>(instance.what).material];
}

// Leaves out bodies that may lie in a medium whose boundary is not flat; by boxes.
void leave_out_enclosed(const Scene& scene, std::vector<BodyFacets>& bodies,
                        std::vector<LeftOut>& left_out) {
  std::vector<Box3d> boxes;
  std::vector<std::uint32_t> others;
  std::vector<bool> is_flat(scene.instances.size(), false);
  for (const BodyFacets& body : bodies) is_flat[body.body.instance] = true;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    boxes.push_back(bounds_of(scene, scene.instances[i]));
    if (!is_flat[i] && material_of(scene, scene.instances[i]).has_volume) others.push_back(i);
  }
  std::erase_if(bodies, [&](const BodyFacets& candidate) {
    const FlatBody& body = candidate.body;
    const Box3d& own = boxes[body.instance];
    const auto around = std::find_if(others.begin(), others.end(),
                                     [&](std::uint32_t i) { return is_within(own, boxes[i]); });
    if (around != others.end() && !body.is_mirror) {
      left_out.push_back({body.name, "it may lie in " + scene.instances[*around].name});
      return true;
    }
    return false;
  });
}

}  // namespace

bool are_apart(const Box3d& a, const Box3d& b) {
  return glm::any(glm::lessThan(a.high, b.low)) || glm::any(glm::lessThan(b.high, a.low));
}

FlatBodies find_flat_bodies(const Scene& scene, Notes& notes) {
  FlatBodies found;
  std::vector<LeftOut> left_out;
  std::vector<BodyFacets> bodies;
  std::map<std::uint32_t, std::string> hopeless;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    add_instance(scene, i, left_out, bodies, hopeless);
  }
  leave_out_largest_mirrors(bodies, left_out);
  leave_out_enclosed(scene, bodies, left_out);
  find_inclusions(scene, bodies);
  for (auto troubles = arrange(bodies); !troubles.empty(); troubles = arrange(bodies)) {
    std::sort(troubles.begin(), troubles.end(),
              [](const auto& a, const auto& b) { return a.body > b.body; });
    for (const SharedSpace& trouble : troubles) {
      const FlatBody& body = bodies[trouble.body].body;
      left_out.push_back({body.name, trouble.why, body.is_mirror});
      bodies.erase(bodies.begin() + static_cast<std::ptrdiff_t>(trouble.body));
    }
  }
  for (const bool of_mirrors : {false, true}) tell(left_out, of_mirrors, notes);
  for (const LeftOut& body : left_out) found.fallbacks.push_back(body.name + ": " + body.why);
  for (BodyFacets& body : bodies) finish(found, body.body, std::move(body.facets));
  return found;
}

}  // namespace abbe
