#include "abbe/caustics/flat/search/regions.h"

#include <cmath>
#include <limits>

namespace abbe {
namespace {

constexpr std::uint32_t kNoFacet = std::numeric_limits<std::uint32_t>::max();
// What places on a facet may be off by, in its radii.
constexpr double kClose = 1e-6;

// Whether facets that meet lie in one plane, seen from whichever side.
bool is_in_plane(const Facet& a, const Facet& b) {
  return std::abs(glm::dot(a.normal, b.normal)) > 1.0 - 1e-12;
}

}  // namespace

Regions::Regions(const FlatBodies& flat) : flat_(flat), borders_(flat.bodies.size() + 1) {
  for (const FlatBody& body : flat.bodies) {
    std::vector<std::vector<FacetSide>> found(borders_.size());
    for (std::uint32_t f = body.first_facet; f < body.first_facet + body.facet_count; ++f) {
      const Facet& facet = flat.facets[f];
      found[facet.beyond ? *facet.beyond + 1 : 0].push_back({f, false});
      if (!body.is_mirror) found[facet.body + 1].push_back({f, true});
    }
    for (std::size_t region = 0; region < found.size(); ++region) {
      if (found[region].empty()) continue;
      std::vector<Vec3d> corners;
      for (const FacetSide& side : found[region]) {
        const std::vector<Vec3d>& own = flat.facets[side.facet].corners;
        corners.insert(corners.end(), own.begin(), own.end());
      }
      borders_[region].push_back({ball_about(corners), std::move(found[region])});
    }
  }
}

std::optional<FacetHit> Regions::first_hit(Region region, const Vec3d& origin,
                                           const Vec3d& direction, std::uint32_t from) const {
  FacetHit hit{{}, std::numeric_limits<double>::infinity()};
  for (const Group& group : border(region)) {
    const Vec3d v = group.ball.center - origin;
    const double along = glm::dot(v, direction);
    const double reach2 = group.ball.radius_m * group.ball.radius_m;
    if (along < -group.ball.radius_m || glm::dot(v, v) - along * along > 1.000001 * reach2)
      continue;
    for (const FacetSide& side : group.sides) {
      if (side.facet == from) continue;
      const Facet& facet = flat_.facets[side.facet];
      const double slope = glm::dot(facet.normal, direction);
      if (side.from_inside ? slope <= 0.0 : slope >= 0.0) continue;
      const double ahead_m = facet.distance - glm::dot(facet.normal, origin);
      const double t = ahead_m / slope;
      // What touches the facet it comes from is met there, but not the back of a mirror.
      const bool is_own = from != kNoFacet && flat_.facets[from].body == facet.body;
      const double least = (is_own ? 1e-9 : -1e-9) * facet.radius_m;
      if (!(t > least && t < hit.distance_m)) continue;
      // Nor a plane that it has just left: its pieces, or its other side.
      const bool is_left = is_own && std::abs(ahead_m) < kClose * facet.radius_m &&
                           is_in_plane(facet, flat_.facets[from]);
      if (is_left) continue;
      if (distance_inside(facet.corners, facet.normal, origin + t * direction) < 0.0) continue;
      hit = {side, t};
    }
  }
  if (hit.distance_m == std::numeric_limits<double>::infinity()) return std::nullopt;
  return hit;
}

Region Regions::at(const Vec3d& place) const {
  // The first facet on a line from there tells: in no likely direction, so that it meets no edge.
  const Vec3d direction = glm::normalize(Vec3d(0.5773, 0.6114, 0.5411));
  FacetHit nearest{{}, std::numeric_limits<double>::infinity()};
  Region result;
  for (std::size_t region = 0; region < borders_.size(); ++region) {
    const Region candidate =
        region == 0 ? Region() : Region(static_cast<std::uint32_t>(region - 1));
    const auto hit = first_hit(candidate, place, direction, kNoFacet);
    if (!hit || hit->distance_m >= nearest.distance_m) continue;
    nearest = *hit;
    result = candidate;
  }
  return result;
}

}  // namespace abbe
