#include "abbe/caustics/flat/search/cones.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "abbe/base/constants.h"
#include "abbe/caustics/flat/facet_optics.h"
#include "abbe/math/polygon.h"
#include "abbe/optics/snell.h"

namespace abbe {
namespace {

// Cones of a lamp are cut until they are narrower than this where they fall on a face, and smaller
// than a share of the body, and until what they become is narrow enough to bound it well.
constexpr double kNarrow_rad = 0.005;
constexpr double kShareOfBody = 0.03;
constexpr double kStillNarrow_rad = 0.2;
// How often a face may be halved for the first reason, and for the second.
constexpr int kMaxCuts = 10;
constexpr int kMaxFurtherCuts = 4;
// Ways that may be found, and faces that cones may meet, before a body counts as too large: some
// hundred megabytes and about ten seconds.
constexpr std::size_t kMaxCones = 1000000;
constexpr std::size_t kMaxMeetings = 20000000;

struct IndexRange {
  double low = 1.0, high = 1.0;
};

class Searcher {
 public:
  Searcher(const ChainSearch& search, const Light& light)
      : options_(search.options),
        source_(light),
        tables_(search.tables),
        flat_(search.flat),
        lamp_(light.to_world[3]) {
    for (const SurfaceMaterial& material : tables_.materials) {
      IndexRange range{std::numeric_limits<double>::infinity(), 0.0};
      for (int set = 0; set < tables_.lanes.set_count(); ++set) {
        for (int lane = 0; lane < tables_.lanes.lane_count(); ++lane) {
          const double n = static_cast<double>(tables_.row(material.index, set)[lane]);
          range.low = std::min(range.low, n);
          range.high = std::max(range.high, n);
        }
      }
      indices_.push_back(range);
    }
  }

  ConeSearch run() {
    const std::optional<std::uint32_t> around = body_around_lamp();
    for (std::uint32_t face = 0; face < flat_.faces.size() && !too_large(); ++face) {
      const FlatBody& body = body_of(face);
      const Facet& plane = plane_of(face);
      const double height = glm::dot(plane.normal, lamp_) - plane.distance;
      const bool from_inside = around == flat_.faces[face].body;
      if (around && !from_inside) continue;
      if (!from_inside && (body.is_mirror ? height == 0.0 : height <= 0.0)) continue;
      if (from_inside && height >= 0.0) continue;
      body_ = flat_.faces[face].body;
      body_radius_m_ = 0.0;
      for (std::uint32_t f = body.first_face; f < body.first_face + body.face_count; ++f) {
        body_radius_m_ = std::max(body_radius_m_, flat_.faces[f].radius_m);
      }
      for (std::uint32_t i = 0; i < flat_.faces[face].facet_count; ++i) {
        cut(flat_.facets[flat_.faces[face].first_facet + i].corners, face, from_inside, 0);
      }
    }
    return std::move(result_);
  }

 private:
  const Facet& plane_of(std::uint32_t face) const {
    return flat_.facets[flat_.faces[face].first_facet];
  }
  const FlatBody& body_of(std::uint32_t face) const { return flat_.bodies[flat_.faces[face].body]; }
  const SurfaceMaterial& material_of(std::uint32_t face) const {
    return tables_.materials[body_of(face).material];
  }
  IndexRange index_of(std::uint32_t face) const { return indices_[body_of(face).material]; }
  bool too_large() const { return result_.yield.too_large.has_value(); }

  // The body that the lamp is in, if any: a line from it leaves that one once more than it enters.
  std::optional<std::uint32_t> body_around_lamp() const {
    const Vec3d direction = glm::normalize(Vec3d(0.5773, 0.6114, 0.5411));
    for (std::uint32_t b = 0; b < flat_.bodies.size(); ++b) {
      const FlatBody& body = flat_.bodies[b];
      if (body.is_mirror) continue;
      int crossings = 0;
      for (std::uint32_t f = body.first_facet; f < body.first_facet + body.facet_count; ++f) {
        const Facet& facet = flat_.facets[f];
        const double slope = glm::dot(facet.normal, direction);
        const double t = (facet.distance - glm::dot(facet.normal, lamp_)) / slope;
        if (!(t > 0.0) || slope == 0.0) continue;
        if (distance_inside(facet.corners, facet.normal, lamp_ + t * direction) >= 0.0) ++crossings;
      }
      if (crossings % 2 == 1) return b;
    }
    return std::nullopt;
  }

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

  static std::pair<std::vector<Vec3d>, std::vector<Vec3d>> halves(const std::vector<Vec3d>& polygon,
                                                                  const Vec3d& center) {
    Vec3d longest(0.0);
    for (const Vec3d& corner : polygon) {
      if (glm::length(corner - center) > glm::length(longest)) longest = corner - center;
    }
    const Vec3d along = glm::normalize(longest);
    const double middle = glm::dot(along, center);
    return {clipped(polygon, along, middle), clipped(polygon, -along, -middle)};
  }

  void cut(const std::vector<Vec3d>& polygon, std::uint32_t face, bool from_inside, int cuts) {
    if (polygon.size() < 3 || too_large()) return;
    const BeamCone cone = cone_of(polygon);
    if (!(cone.radius_m > 0.0) ||
        !may_shine_on(source_, cone.center, cone.radius_m, cone.axis, cone.angle_rad))
      return;
    const bool is_wide =
        cone.angle_rad > kNarrow_rad || cone.radius_m > kShareOfBody * body_radius_m_;
    bool again = is_wide && cuts < kMaxCuts;
    // A mirror's pyramid is bounded well by any cone that is not too wide.
    if (body_of(face).is_mirror && cone.angle_rad < 0.1) again = false;
    if (!again) {
      pending_.clear();
      cut_sr_ = 0.0;
      widest_rad_ = 0.0;
      const Vec3d to_center = cone.center - lamp_;
      const double distance2 = glm::dot(to_center, to_center);
      flux_sr_ =
          area_of(polygon) * std::abs(glm::dot(cone.axis, plane_of(face).normal)) / distance2;
      axes_.assign(1, cone.axis);
      if (from_inside) {
        arrive_inside(cone, face, 1.0, true, options_.inner_reflections, kMaxChainBodies - 1);
      } else {
        arrive_outside(cone, face, 1.0, true, kMaxChainBodies);
      }
      again = widest_rad_ > kStillNarrow_rad && cuts < kMaxCuts + kMaxFurtherCuts &&
              cone.radius_m > 0.02 * body_radius_m_;
    }
    if (again && !too_large()) {
      const auto [a, b] = halves(polygon, cone.center);
      cut(a, face, from_inside, cuts + 1);
      cut(b, face, from_inside, cuts + 1);
      return;
    }
    result_.yield.started += flux_sr_;
    result_.yield.cut += cut_sr_;
    std::move(pending_.begin(), pending_.end(), std::back_inserter(result_.found));
    pending_.clear();
    if (result_.found.size() > kMaxCones) result_.yield.too_large = body_;
  }

  // Shares of power over the range of angles and wavelengths, and the largest of
  // share·cosθ_i/cosθ_t, by which a beam's irradiance changes.
  struct Shares {
    double most = 0.0, most_irradiance = 0.0, middle = 0.0;
  };

  Shares transmitted(const BeamCone& cone, std::uint32_t face, FacetSide side) const {
    const AngleRange range = angles_with(cone, plane_of(face).normal);
    const double n = 0.5 * (index_of(face).low + index_of(face).high);
    const double eta = side == FacetSide::Outside ? n : 1.0 / n;
    Shares shares;
    const double middle_rad = 0.5 * (range.low_rad + range.high_rad);
    for (const double angle : {range.low_rad, middle_rad, range.high_rad}) {
      const double cosine = std::cos(angle);
      const double share = share_of(face, side, cosine, false);
      const double sine = std::sin(angle) / eta;
      const double cos_out = std::sqrt(std::max(0.0, 1.0 - sine * sine));
      // Where cosθ_t goes to 0, τ·cosθ_i/cosθ_t goes to at most 2(n + 1/n).
      const double limit = 2.0 * (n + 1.0 / n);
      shares.most = std::max(shares.most, share);
      const double ratio = cos_out > 1e-3 ? share * cosine / cos_out : limit;
      shares.most_irradiance = std::max(shares.most_irradiance, std::min(ratio, limit));
      if (angle == middle_rad) shares.middle = share;
    }
    if (side == FacetSide::Inside && std::sin(range.high_rad) * n > 1.0) {
      shares.most_irradiance = std::max(shares.most_irradiance, 2.0 * (n + 1.0 / n));
      shares.most = 1.0;
    }
    return shares;
  }

  double reflected(const BeamCone& cone, std::uint32_t face, FacetSide side) const {
    const AngleRange range = angles_with(cone, plane_of(face).normal);
    double most = 0.0;
    for (const double angle :
         {range.low_rad, 0.5 * (range.low_rad + range.high_rad), range.high_rad}) {
      most = std::max(most, share_of(face, side, std::cos(angle), true));
    }
    return most;
  }

  // At the first, middle and last lane: materials are smooth in between.
  double share_of(std::uint32_t face, FacetSide side, double cosine, bool of_reflection) const {
    const SurfaceMaterial& material = material_of(face);
    double most = 0.0;
    const int last = tables_.lanes.lane_count() - 1;
    for (const int lane : {0, last / 2, last}) {
      const double reflectance = facet_reflectance(tables_, material, 0, lane, cosine, side);
      const double tint = static_cast<double>(tables_.row(material.base_color, 0)[lane]);
      most = std::max(most, of_reflection ? reflectance : (1.0 - reflectance) * tint);
    }
    return most;
  }

  void record(const BeamCone& cone, bool ends_inside, double largest, bool is_middle) {
    widest_rad_ = std::max(widest_rad_, cone.angle_rad);
    const double flux = is_middle && !ends_inside ? flux_sr_ * largest : 0.0;
    pending_.push_back({path_, axes_, cone, ends_inside, largest, flux});
  }

  void push(std::uint32_t face, ChainEvent event, const Vec3d& axis) {
    path_.push_back({face, event});
    axes_.push_back(axis);
  }
  void pop() {
    path_.pop_back();
    axes_.pop_back();
  }

  // `share` bounds the irradiance that a chain has kept; `is_middle`: the axis itself came here.
  void arrive_outside(const BeamCone& cone, std::uint32_t face, double share, bool is_middle,
                      int bodies_left) {
    const Facet& plane = plane_of(face);
    if (path_.empty()) {
      BeamCone mirrored = cone;
      mirrored.axis = reflected_direction(cone.axis, plane.normal);
      push(face, ChainEvent::ReflectOutside, mirrored.axis);
      record(mirrored, false, share * reflected(cone, face, FacetSide::Outside), is_middle);
      pop();
    }
    if (body_of(face).is_mirror) return;
    const IndexRange n = index_of(face);
    const auto entered = refracted_cone(cone, plane.normal, n.low, n.high);
    if (!entered) return;
    const Shares shares = transmitted(cone, face, FacetSide::Outside);
    push(face, ChainEvent::Enter, entered->axis);
    const double kept = share * std::max(shares.most, shares.most_irradiance);
    record(*entered, true, kept, is_middle);
    follow_inside(*entered, face, kept, is_middle, options_.inner_reflections, bodies_left - 1);
    pop();
  }

  // The cone where it arrives at a face; nothing if it misses it.
  std::optional<BeamCone> arrival(const BeamCone& cone, std::uint32_t face, bool* is_middle) {
    const Face& shape = flat_.faces[face];
    const Facet& plane = plane_of(face);
    if (++meetings_ > kMaxMeetings) {
      result_.yield.too_large = body_;
      return std::nullopt;
    }
    const auto spot = plane_section(cone, plane.normal, plane.distance);
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
      *is_middle = false;
      return arrived;
    }
    double inside = -std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < shape.facet_count; ++i) {
      inside = std::max(inside, distance_inside(flat_.facets[shape.first_facet + i].corners,
                                                plane.normal, spot->center));
    }
    if (inside < -spot->radius_m) return std::nullopt;
    *is_middle = *is_middle && inside >= 0.0;
    const bool is_small = spot->radius_m < shape.radius_m;
    arrived.center = is_small ? spot->center : shape.center;
    arrived.radius_m = is_small ? spot->radius_m : shape.radius_m;
    return arrived;
  }

  void follow_inside(const BeamCone& cone, std::uint32_t from, double share, bool is_middle,
                     int reflections_left, int bodies_left) {
    const FlatBody& body = body_of(from);
    for (std::uint32_t g = body.first_face; g < body.first_face + body.face_count; ++g) {
      if (g == from || too_large()) continue;
      const double cosine = glm::dot(plane_of(g).normal, cone.axis);
      if (cosine <= -std::sin(std::min(cone.angle_rad, 0.5 * kPi))) continue;
      bool middle = is_middle;
      const auto arrived = arrival(cone, g, &middle);
      if (arrived) arrive_inside(*arrived, g, share, middle, reflections_left, bodies_left);
    }
  }

  void arrive_inside(const BeamCone& cone, std::uint32_t face, double share, bool is_middle,
                     int reflections_left, int bodies_left) {
    const Facet& plane = plane_of(face);
    const IndexRange n = index_of(face);
    const auto out = refracted_cone(cone, plane.normal, 1.0 / n.high, 1.0 / n.low);
    const double cosine = glm::dot(plane.normal, cone.axis);
    if (out && (cosine > 0.0 || cone.angle_rad > 0.0)) {
      const Shares shares = transmitted(cone, face, FacetSide::Inside);
      push(face, ChainEvent::Leave, out->axis);
      record(*out, false, share * shares.most_irradiance, is_middle);
      if (bodies_left > 0) {
        enter_others(*out, face, share * shares.most_irradiance, is_middle, bodies_left);
      }
      pop();
    }
    if (reflections_left == 0) return;
    const double kept = share * reflected(cone, face, FacetSide::Inside);
    // Leaving at a grazing angle narrows a beam again.
    const double narrowing = 2.0 * (n.high + 1.0 / n.high);
    if (kept * narrowing < options_.cutoff) {
      if (is_middle) cut_sr_ += flux_sr_ * kept;
      return;
    }
    BeamCone mirrored = cone;
    mirrored.axis = reflected_direction(cone.axis, plane.normal);
    push(face, ChainEvent::ReflectInside, mirrored.axis);
    record(mirrored, true, kept, is_middle);
    follow_inside(mirrored, face, kept, is_middle, reflections_left - 1, bodies_left);
    pop();
  }

  void enter_others(const BeamCone& cone, std::uint32_t from, double share, bool is_middle,
                    int bodies_left) {
    for (std::uint32_t b = 0; b < flat_.bodies.size(); ++b) {
      const FlatBody& body = flat_.bodies[b];
      if (b == flat_.faces[from].body || body.is_mirror) continue;
      for (std::uint32_t f = body.first_face; f < body.first_face + body.face_count; ++f) {
        if (too_large()) return;
        const double cosine = glm::dot(plane_of(f).normal, cone.axis);
        if (cosine >= std::sin(std::min(cone.angle_rad, 0.5 * kPi))) continue;
        bool middle = is_middle;
        const auto arrived = arrival(cone, f, &middle);
        if (arrived) arrive_outside(*arrived, f, share, middle, bodies_left);
      }
    }
  }

  const CausticOptions& options_;
  const Light& source_;
  const TabulatedScene& tables_;
  const FlatBodies& flat_;
  const Vec3d lamp_;
  std::vector<IndexRange> indices_;

  std::uint32_t body_ = 0;
  double body_radius_m_ = 0.0;
  double flux_sr_ = 0.0, cut_sr_ = 0.0, widest_rad_ = 0.0;
  std::vector<FaceEvent> path_;
  std::vector<Vec3d> axes_;
  std::vector<ConeOnPath> pending_;
  std::size_t meetings_ = 0;
  ConeSearch result_;
};

}  // namespace

ConeSearch search_cones(const ChainSearch& search, const Light& light) {
  return Searcher(search, light).run();
}

}  // namespace abbe
