#include "abbe/caustics/flat/search/cones.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "abbe/base/constants.h"
#include "abbe/math/polygon.h"
#include "abbe/optics/snell.h"
#include "abbe/world/light/lights.h"

namespace abbe {
namespace {

// Cones of a lamp are cut until they are narrower than this where they fall on a face, and smaller
// than a share of the body, and until what they become is narrow enough to bound it well.
constexpr double kNarrow_rad = 0.005;
constexpr double kShareOfBody = 0.03;
constexpr double kStillNarrow_rad = 0.2;
// Close to a lamp, however often that takes, until they are narrower than this.
constexpr double kWide_rad = 0.1;
// How often a face may be halved for the first reason, and for the second.
constexpr int kMaxCuts = 10;
constexpr int kMaxFurtherCuts = 4;
// No more of that once cones have arrived at faces so often in all, about a second: they bound less
// closely then, and rendering asks for more paths.
constexpr std::size_t kMostArrivals = 1000000;
// Of many faces, so many cones are sent at first in all.
constexpr double kFirstCones = 16000.0;
// Where glass disperses, wavelengths are followed in so many parts: a cone widens in all
// directions, a spectrum in one.
constexpr int kSlices = 4;

class Searcher {
 public:
  Searcher(const ChainSearch& search, const PathTree& tree, const Light& light,
           const std::function<void(const ConeOnPath&)>& show)
      : show_(show),
        search_(search),
        tree_(tree),
        source_(light),
        tables_(search.tables),
        flat_(search.flat),
        lamp_(light.to_world[3]) {
    const auto disperses = [](const MaterialRange& range) { return range.disperses(); };
    const bool is_one = std::none_of(search.ranges.begin(), search.ranges.end(), disperses);
    const int slices = is_one ? 1 : kSlices;
    for (int i = 0; i < slices; ++i) {
      std::vector<MaterialRange> ranges = material_ranges(tables_, static_cast<double>(i) / slices,
                                                          static_cast<double>(i + 1) / slices);
      if (!ranges.empty()) slices_.push_back(std::move(ranges));
    }
  }

  void run() {
    for (const std::uint32_t child : tree_.nodes[0].children) {
      const std::uint32_t face = tree_.nodes[child].place;
      const auto known = std::find_if(starts_.begin(), starts_.end(),
                                      [&](const Start& start) { return start.face == face; });
      if (known == starts_.end()) {
        starts_.push_back({face, {child}});
      } else {
        known->nodes.push_back(child);
      }
    }
    max_cuts_ = std::clamp(
        static_cast<int>(
            std::log2(kFirstCones / std::max<double>(1.0, static_cast<double>(starts_.size())))),
        4, kMaxCuts);
    const std::vector<HalfSpace> bounds = spot_bounds(source_);
    for (const Start& start : starts_) {
      const FlatBody& body = body_of(start.face);
      body_radius_m_ = 0.0;
      for (std::uint32_t f = body.first_face; f < body.first_face + body.face_count; ++f) {
        body_radius_m_ = std::max(body_radius_m_, flat_.faces[f].radius_m);
      }
      for (std::uint32_t i = 0; i < flat_.faces[start.face].facet_count; ++i) {
        std::vector<Vec3d> lit = flat_.facets[flat_.faces[start.face].first_facet + i].corners;
        for (const HalfSpace& bound : bounds) lit = clipped(lit, bound.normal, bound.distance);
        cut(lit, start, 0);
      }
    }
  }

 private:
  /// A face that the lamp shines on, and what may happen there.
  struct Start {
    std::uint32_t face = 0;
    std::vector<std::uint32_t> nodes;
  };

  MaterialRange range_of(const SurfaceMaterial* medium) const {
    if (medium == nullptr) return {};
    return (*ranges_)[static_cast<std::size_t>(medium - tables_.materials.data())];
  }

  const Facet& plane_of(std::uint32_t face) const {
    return flat_.facets[flat_.faces[face].first_facet];
  }
  const FlatBody& body_of(std::uint32_t face) const { return flat_.bodies[flat_.faces[face].body]; }

  BeamCone cone_of(const std::vector<Vec3d>& polygon) const {
    const Ball ball = ball_about(polygon);
    BeamCone cone;
    cone.center = ball.center;
    cone.radius_m = ball.radius_m;
    const Vec3d to_center = cone.center - lamp_;
    const double distance = glm::length(to_center);
    cone.axis = distance > 0.0 ? to_center / distance : Vec3d(0.0, 0.0, 1.0);
    cone.angle_rad = distance > cone.radius_m ? std::asin(cone.radius_m / distance) : kPi;
    return cone;
  }

  static std::pair<std::vector<Vec3d>, std::vector<Vec3d>> halves(
      const std::vector<Vec3d>& polygon) {
    // Across the line between the two corners that are farthest apart: both parts are shorter.
    std::pair<Vec3d, Vec3d> ends(polygon[0], polygon[0]);
    for (const Vec3d& p : polygon) {
      for (const Vec3d& q : polygon) {
        if (glm::distance(p, q) > glm::distance(ends.first, ends.second)) ends = {p, q};
      }
    }
    const Vec3d along = glm::normalize(ends.second - ends.first);
    const double middle = 0.5 * glm::dot(along, ends.first + ends.second);
    return {clipped(polygon, along, middle), clipped(polygon, -along, -middle)};
  }

  void cut(const std::vector<Vec3d>& polygon, const Start& start, int cuts) {
    if (polygon.size() < 3) return;
    const BeamCone cone = cone_of(polygon);
    if (!(cone.radius_m > 0.0) ||
        !may_shine_on(source_, cone.center, cone.radius_m, cone.axis, cone.angle_rad))
      return;
    const bool is_wide =
        cone.angle_rad > kNarrow_rad || cone.radius_m > kShareOfBody * body_radius_m_;
    const bool is_near = cone.angle_rad > kWide_rad && cuts < 2 * kMaxCuts;
    bool again = is_wide && (cuts < max_cuts_ || is_near);
    // A mirror's pyramid is bounded well by any cone that is not too wide.
    if (body_of(start.face).is_mirror && cone.angle_rad < 0.1) again = false;
    if (!again) {
      pending_.clear();
      widest_rad_ = 0.0;
      axes_.assign(1, cone.axis);
      BeamCone from_lamp{lamp_, 0.0, cone.axis, cone.angle_rad};
      if (!(cone.angle_rad < 0.5 * kPi)) from_lamp = cone;
      ++part_;
      for (const std::vector<MaterialRange>& ranges : slices_) {
        ranges_ = &ranges;
        for (const std::uint32_t node : start.nodes) arrive(from_lamp, cone, node);
      }
      again = widest_rad_ > kStillNarrow_rad && cuts < max_cuts_ + kMaxFurtherCuts &&
              arrivals_ < kMostArrivals && cone.radius_m > 0.02 * body_radius_m_;
    }
    if (again) {
      const auto [a, b] = halves(polygon);
      cut(a, start, cuts + 1);
      cut(b, start, cuts + 1);
      return;
    }
    for (const ConeOnPath& found : pending_) show_(found);
    pending_.clear();
  }

  // The light of a cone behind the face of a node, and from there on. `beam` has gone straight or
  // been reflected since it was refracted last; `spot` is the same light with its ball where it
  // meets the face.
  void arrive(const BeamCone& beam, const BeamCone& spot, std::uint32_t number) {
    ++arrivals_;
    const PathNode& node = tree_.nodes[number];
    const Facet& plane = plane_of(node.place);
    const FacetMedia media = search_.media_of(plane);
    const bool from_inside = comes_from_inside(node.event);
    const BeamCone cone = crossing(spot, from_inside ? plane.normal : -plane.normal);
    BeamCone behind = cone;
    BeamCone goes_on;
    if (refracts(node.event)) {
      MaterialRange before = range_of(media.outside);
      MaterialRange after = range_of(media.inside);
      if (from_inside) std::swap(before, after);
      const auto refracted =
          refracted_cone(cone, plane.normal, after.low / before.high, after.high / before.low);
      if (!refracted) return;
      behind = *refracted;
      goes_on = behind;
    } else {
      // The ball is mirrored rather than where it meets the face: aslant that is larger, each time.
      behind.axis = reflected_direction(cone.axis, plane.normal);
      goes_on = beam;
      goes_on.axis = reflected_direction(beam.axis, plane.normal);
      goes_on.center -= 2.0 * (glm::dot(plane.normal, beam.center) - plane.distance) * plane.normal;
    }
    path_.push_back({node.place, node.event});
    axes_.push_back(behind.axis);
    if (search_.lights_places(node.region)) {
      widest_rad_ = std::max(widest_rad_, behind.angle_rad);
      pending_.push_back({part_, path_, axes_, behind, node.lanes, node.flux, node.sent});
    }
    for (const std::uint32_t child : node.children) {
      const PathNode& next = tree_.nodes[child];
      const bool inside = comes_from_inside(next.event);
      const double cosine = glm::dot(plane_of(next.place).normal, behind.axis);
      if ((inside ? cosine : -cosine) <= -std::sin(std::min(behind.angle_rad, 0.5 * kPi))) continue;
      if (const auto arrived = arrival(goes_on, next.place, inside)) {
        arrive(goes_on, *arrived, child);
      }
    }
    path_.pop_back();
    axes_.pop_back();
  }

  // The cone where it arrives at a face; nothing if it misses it.
  std::optional<BeamCone> arrival(const BeamCone& cone, std::uint32_t face,
                                  bool from_inside) const {
    const Face& shape = flat_.faces[face];
    const Facet& plane = plane_of(face);
    const auto spot = plane_section(cone, from_inside ? plane.normal : -plane.normal,
                                    from_inside ? plane.distance : -plane.distance);
    if (!spot) return std::nullopt;
    BeamCone arrived = cone;
    if (!(spot->radius_m < 1e30)) {
      // Grazing: at least the ball about the face has to be in the cone's reach.
      const Vec3d v = shape.center - cone.center;
      const double along = glm::dot(v, cone.axis);
      const double reach = cone.radius_m + shape.radius_m;
      if (along < -reach) return std::nullopt;
      const double spread = std::tan(std::min(cone.angle_rad, 1.4));
      const double across = std::sqrt(std::max(0.0, glm::dot(v, v) - along * along));
      if (across > reach * (1.0 + spread) + std::max(along, 0.0) * spread) return std::nullopt;
      arrived.center = shape.center;
      arrived.radius_m = shape.radius_m;
      return arrived;
    }
    double inside = -std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < shape.facet_count; ++i) {
      inside = std::max(inside, distance_inside(flat_.facets[shape.first_facet + i].corners,
                                                plane.normal, spot->center));
    }
    if (inside < -spot->radius_m) return std::nullopt;
    const bool is_small = spot->radius_m < shape.radius_m;
    arrived.center = is_small ? spot->center : shape.center;
    arrived.radius_m = is_small ? spot->radius_m : shape.radius_m;
    return arrived;
  }

  const std::function<void(const ConeOnPath&)>& show_;
  const ChainSearch& search_;
  const PathTree& tree_;
  const Light& source_;
  const TabulatedScene& tables_;
  const FlatBodies& flat_;
  const Vec3d lamp_;
  std::vector<Start> starts_;
  int max_cuts_ = kMaxCuts;
  std::vector<std::vector<MaterialRange>> slices_;  ///< Per part of the wavelengths and material.
  const std::vector<MaterialRange>* ranges_ = nullptr;  ///< Of the part at hand.
  std::uint32_t part_ = 0;

  double body_radius_m_ = 0.0;
  double widest_rad_ = 0.0;
  std::size_t arrivals_ = 0;
  std::vector<FaceEvent> path_;
  std::vector<Vec3d> axes_;
  std::vector<ConeOnPath> pending_;
};

}  // namespace

void search_cones(const ChainSearch& search, const PathTree& tree, const Light& light,
                  const std::function<void(const ConeOnPath&)>& show) {
  Searcher(search, tree, light, show).run();
}

}  // namespace abbe
