#include "abbe/caustics/flat/arrangement.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "abbe/math/polygon.h"

namespace abbe {
namespace {

using Polygon = std::vector<Vec3d>;

// Faces within four roundings of single precision coincide, of the larger of their coordinates.
constexpr double kRounding = 4.0 * 0x1p-23;

/// A closed box.
struct Box {
  Vec3d low{std::numeric_limits<double>::infinity()};
  Vec3d high{-std::numeric_limits<double>::infinity()};

  void extend(const Polygon& polygon) {
    for (const Vec3d& corner : polygon) {
      low = glm::min(low, corner);
      high = glm::max(high, corner);
    }
  }
  bool touches(const Box& other, double slack) const {
    return glm::all(glm::lessThanEqual(low, other.high + slack)) &&
           glm::all(glm::lessThanEqual(other.low, high + slack));
  }
  double largest() const {
    double most = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      most = std::max({most, std::abs(low[axis]), std::abs(high[axis])});
    }
    return most;
  }
};

/// Where a facet or a body is, and what is so near it that it touches.
struct Extent {
  Box box;
  double slack_m = 0.0;

  double slack_with(const Extent& other) const { return std::max(slack_m, other.slack_m); }
  bool touches(const Extent& other) const { return box.touches(other.box, slack_with(other)); }
};

bool holds(const std::vector<Facet>& facets, const Vec3d& point) {
  double turns = 0.0;
  for (const Facet& facet : facets) {
    for (std::size_t i = 2; i < facet.corners.size(); ++i) {
      turns += turns_about_origin(facet.corners[0] - point, facet.corners[i - 1] - point,
                                  facet.corners[i] - point);
    }
  }
  return turns > 0.5;
}

/// A body as a whole.
struct Whole {
  Extent extent;
  std::vector<Extent> facets;
  double volume = 0.0, volume_slack = 0.0;

  explicit Whole(const BodyFacets& body) {
    for (const Facet& facet : body.facets) extent.box.extend(facet.corners);
    extent.slack_m = kRounding * extent.box.largest();
    for (const Facet& facet : body.facets) {
      Extent& own = facets.emplace_back();
      own.box.extend(facet.corners);
      own.slack_m = body.is_exact_shape ? extent.slack_m : kRounding * own.box.largest();
      const double area = area_of(facet.corners);
      volume += facet.distance * area / 3.0;
      volume_slack += own.slack_m * area;
    }
  }
};

Vec3d middle_of(const Polygon& polygon) {
  return std::accumulate(polygon.begin(), polygon.end(), Vec3d(0.0)) /
         static_cast<double>(polygon.size());
}

class Arranger {
 public:
  explicit Arranger(std::vector<BodyFacets>& bodies) : bodies_(bodies) {
    for (const BodyFacets& body : bodies_) wholes_.emplace_back(body);
  }

  std::vector<SharedSpace> run() {
    std::vector<std::vector<Facet>> results(bodies_.size());
    for (std::size_t a = 0; a < bodies_.size(); ++a) {
      near_.clear();
      for (std::size_t b = 0; b < bodies_.size(); ++b) {
        if (b != a && !bodies_[b].body.is_mirror && wholes_[a].extent.touches(wholes_[b].extent)) {
          near_.push_back(b);
        }
      }
      crossed_.assign(bodies_.size(), {});
      is_covered_ = !bodies_[a].body.is_mirror;
      for (std::size_t i = 0; i < bodies_[a].facets.size(); ++i) add_pieces(a, i, results[a]);
      bodies_[a].body.is_covered = is_covered_;
      for (const std::size_t b : near_) {
        if (crossed_[b].in && crossed_[b].out && !bodies_[a].body.is_mirror) tell(a, b);
      }
    }
    if (!troubles_.empty()) return with_neighbours();
    for (std::size_t a = 0; a < bodies_.size(); ++a) bodies_[a].facets = std::move(results[a]);
    return {};
  }

 private:
  struct Crossed {
    bool in = false, out = false;
  };

  /// What lies in front of a piece, if it is a boundary at all.
  struct Side {
    bool is_boundary = false;
    std::optional<std::uint32_t> beyond;

    bool operator==(const Side&) const = default;
  };

  void tell(std::size_t a, std::size_t b) {
    for (const auto& [one, other] : {std::pair(a, b), std::pair(b, a)}) {
      const bool known = std::any_of(troubles_.begin(), troubles_.end(),
                                     [&](const SharedSpace& t) { return t.body == one; });
      if (known) continue;
      troubles_.push_back({one, "its faces go through those of " + bodies_[other].body.name});
    }
  }

  // What touches a body that goes straight cannot tell the medium before its facets.
  std::vector<SharedSpace> with_neighbours() {
    for (std::size_t i = 0; i < troubles_.size(); ++i) {
      const std::size_t body = troubles_[i].body;
      for (std::size_t b = 0; b < bodies_.size(); ++b) {
        const bool known = std::any_of(troubles_.begin(), troubles_.end(),
                                       [&](const SharedSpace& t) { return t.body == b; });
        if (known || bodies_[b].body.is_mirror) continue;
        if (!wholes_[b].extent.touches(wholes_[body].extent)) continue;
        troubles_.push_back({b, "it touches " + bodies_[body].body.name});
      }
    }
    return std::move(troubles_);
  }

  void add_pieces(std::size_t a, std::size_t number, std::vector<Facet>& result) {
    const Facet& facet = bodies_[a].facets[number];
    const Extent& extent = wholes_[a].facets[number];
    std::vector<Facet> ways{facet};
    if (bodies_[a].body.is_mirror && !bodies_[a].body.is_front_only) {
      Facet& back = ways.emplace_back(facet);
      back.normal = -back.normal;
      back.distance = -back.distance;
      std::reverse(back.corners.begin(), back.corners.end());
    }
    std::vector<Polygon> pieces{facet.corners};
    for (const std::size_t b : near_) pieces = cut(std::move(pieces), facet, extent, b);
    for (const Facet& way : ways) {
      std::vector<Side> sides;
      for (const Polygon& piece : pieces)
        sides.push_back(side_of(a, way, extent, middle_of(piece)));
      const bool is_one = std::equal(sides.begin() + 1, sides.end(), sides.begin());
      for (std::size_t i = 0; i < (is_one ? 1 : pieces.size()); ++i) {
        if (!sides[i].is_boundary) continue;
        Facet& kept = result.emplace_back(way);
        kept.beyond = sides[i].beyond;
        if (is_one) continue;
        kept.corners = pieces[i];
        if (way.normal != facet.normal) std::reverse(kept.corners.begin(), kept.corners.end());
      }
    }
  }

  Side side_of(std::size_t a, const Facet& facet, const Extent& extent, const Vec3d& middle) {
    const bool is_mirror = bodies_[a].body.is_mirror;
    std::optional<std::size_t> front, back;
    if (!is_mirror) back = a;
    bool touches = false;
    bool back_ends = false;
    for (const std::size_t b : near_) {
      double slack_m = extent.slack_m;
      for (const Extent& other : wholes_[b].facets) {
        if (extent.touches(other)) slack_m = std::max(slack_m, other.slack_m);
      }
      const Vec3d off = 2.0 * slack_m * facet.normal;
      const bool is_before = holds(bodies_[b].facets, middle + off);
      const bool is_behind = holds(bodies_[b].facets, middle - off);
      crossed_[b].in |= is_before && is_behind;
      crossed_[b].out |= !is_before && !is_behind;
      // Between a mirror and glass that it touches is air.
      if (is_mirror && is_before != is_behind) continue;
      if (is_before && (!front || is_inner(b, *front))) {
        front = b;
        touches = !is_behind;
      }
      if (is_behind && (!back || is_inner(b, *back))) {
        back = b;
        back_ends = !is_before;
      }
    }
    is_covered_ &= back_ends;
    if (is_mirror) return {true, number_of(front)};
    const bool is_twin = touches && *front < a;
    return {back == a && front != back && !is_twin, number_of(front)};
  }

  // Which of two bodies that hold a place has it. Of equal ones in one place that with the later
  // primitives, as cross() has it for rays that enter both at once.
  bool is_inner(std::size_t a, std::size_t b) const {
    const int over = bodies_[a].body.priority - bodies_[b].body.priority;
    if (over != 0) return over > 0;
    const double larger = wholes_[a].volume - wholes_[b].volume;
    if (std::abs(larger) > wholes_[a].volume_slack + wholes_[b].volume_slack) return larger < 0.0;
    return std::pair(bodies_[a].is_exact_shape, a) > std::pair(bodies_[b].is_exact_shape, b);
  }

  static std::optional<std::uint32_t> number_of(const std::optional<std::size_t>& body) {
    if (!body) return std::nullopt;
    return static_cast<std::uint32_t>(*body);
  }

  // Pieces of a facet, cut where the facets of a body begin.
  std::vector<Polygon> cut(std::vector<Polygon> pieces, const Facet& plane, const Extent& extent,
                           std::size_t body) const {
    for (std::size_t f = 0; f < bodies_[body].facets.size(); ++f) {
      const Facet& facet = bodies_[body].facets[f];
      if (!extent.touches(wholes_[body].facets[f])) continue;
      const double slack_m = extent.slack_with(wholes_[body].facets[f]);
      double low = std::numeric_limits<double>::infinity();
      double high = -low;
      for (const Vec3d& corner : facet.corners) {
        const double height = glm::dot(plane.normal, corner) - plane.distance;
        low = std::min(low, height);
        high = std::max(high, height);
      }
      const bool is_in_plane = low >= -slack_m && high <= slack_m;
      const bool is_across = low < -slack_m && high > slack_m;
      std::vector<Polygon> next;
      for (Polygon& piece : pieces) {
        std::vector<Polygon> parts;
        if (is_in_plane) {
          parts = cut_out(piece, facet, slack_m);
        } else if (is_across && goes_through(piece, plane, facet, slack_m)) {
          parts = {clipped(piece, facet.normal, facet.distance),
                   clipped(piece, -facet.normal, -facet.distance)};
        }
        std::erase_if(parts, [&](const Polygon& part) { return is_sliver(part, slack_m); });
        // What would be nothing but slivers is thin itself, and stays.
        if (parts.empty()) parts.push_back(std::move(piece));
        std::move(parts.begin(), parts.end(), std::back_inserter(next));
      }
      pieces = std::move(next);
    }
    return pieces;
  }

  // The part of a piece that a facet in its plane covers, and what is left around it.
  static std::vector<Polygon> cut_out(Polygon piece, const Facet& facet, double slack_m) {
    std::vector<Polygon> parts;
    for (std::size_t i = 0; i < facet.corners.size() && !piece.empty(); ++i) {
      const Vec3d& from = facet.corners[i];
      const Vec3d edge = facet.corners[(i + 1) % facet.corners.size()] - from;
      const double length = glm::length(edge);
      if (!(length > slack_m)) continue;
      const Vec3d outwards = glm::cross(edge, facet.normal) / length;
      const double at = glm::dot(outwards, from);
      parts.push_back(clipped(piece, -outwards, -at));
      piece = clipped(piece, outwards, at);
    }
    parts.push_back(std::move(piece));
    return parts;
  }

  // Whether the line in which a facet meets the plane of a piece runs over the piece.
  static bool goes_through(const Polygon& piece, const Facet& plane, const Facet& facet,
                           double slack_m) {
    Polygon line;
    for (std::size_t i = 0; i < facet.corners.size(); ++i) {
      const Vec3d& p = facet.corners[i];
      const Vec3d& q = facet.corners[(i + 1) % facet.corners.size()];
      const double hp = glm::dot(plane.normal, p) - plane.distance;
      const double hq = glm::dot(plane.normal, q) - plane.distance;
      if ((hp <= 0.0) != (hq <= 0.0)) line.push_back(p + (hp / (hp - hq)) * (q - p));
    }
    if (line.size() < 2) return false;
    double begin = 0.0;
    double end = 1.0;
    const Vec3d along = line[1] - line[0];
    for (std::size_t i = 0; i < piece.size(); ++i) {
      const Vec3d inwards = glm::cross(plane.normal, piece[(i + 1) % piece.size()] - piece[i]);
      const double height = glm::dot(inwards, line[0] - piece[i]);
      const double rise = glm::dot(inwards, along);
      if (rise > 0.0) begin = std::max(begin, -height / rise);
      if (rise < 0.0) end = std::min(end, -height / rise);
      if (rise == 0.0 && height < 0.0) return false;
    }
    return (end - begin) * glm::length(along) > slack_m;
  }

  // Slivers that rounding makes are no pieces.
  static bool is_sliver(const Polygon& piece, double slack_m) {
    if (piece.size() < 3) return true;
    double around = 0.0;
    for (std::size_t i = 0; i < piece.size(); ++i) {
      around += glm::distance(piece[i], piece[(i + 1) % piece.size()]);
    }
    return area_of(piece) <= 0.5 * slack_m * around;
  }

  std::vector<BodyFacets>& bodies_;
  std::vector<Whole> wholes_;
  std::vector<std::size_t> near_;
  std::vector<Crossed> crossed_;
  bool is_covered_ = false;
  std::vector<SharedSpace> troubles_;
};

}  // namespace

std::vector<SharedSpace> arrange(std::vector<BodyFacets>& bodies) {
  return Arranger(bodies).run();
}

}  // namespace abbe
