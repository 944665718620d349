#include "abbe/caustics/flat/arrangement.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "abbe/math/polygon.h"

namespace abbe {
namespace {

using Polygon = std::vector<Vec3d>;

// Faces within four roundings of single precision coincide.
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

Box box_of(const Polygon& polygon) {
  Box box;
  box.extend(polygon);
  return box;
}

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

double volume_of(const std::vector<Facet>& facets) {
  double volume = 0.0;
  for (const Facet& facet : facets) volume += facet.distance * area_of(facet.corners) / 3.0;
  return volume;
}

Vec3d middle_of(const Polygon& polygon) {
  return std::accumulate(polygon.begin(), polygon.end(), Vec3d(0.0)) /
         static_cast<double>(polygon.size());
}

class Arranger {
 public:
  explicit Arranger(std::vector<BodyFacets>& bodies) : bodies_(bodies) {
    for (const BodyFacets& body : bodies_) {
      Box& box = boxes_.emplace_back();
      for (const Facet& facet : body.facets) box.extend(facet.corners);
      volumes_.push_back(body.body.is_mirror ? 0.0 : volume_of(body.facets));
      reach_ = std::max(reach_, box.largest());
    }
    slack_m_ = kRounding * reach_;
  }

  std::vector<SharedSpace> run() {
    std::vector<std::vector<Facet>> results(bodies_.size());
    for (std::size_t a = 0; a < bodies_.size(); ++a) {
      near_.clear();
      for (std::size_t b = 0; b < bodies_.size(); ++b) {
        if (b != a && !bodies_[b].body.is_mirror && boxes_[a].touches(boxes_[b], slack_m_)) {
          near_.push_back(b);
        }
      }
      crossed_.assign(bodies_.size(), {});
      for (const Facet& facet : bodies_[a].facets) add_pieces(a, facet, results[a]);
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
        if (!boxes_[b].touches(boxes_[body], slack_m_)) continue;
        troubles_.push_back({b, "it touches " + bodies_[body].body.name});
      }
    }
    return std::move(troubles_);
  }

  void add_pieces(std::size_t a, const Facet& facet, std::vector<Facet>& result) {
    std::vector<Facet> ways{facet};
    if (bodies_[a].body.is_mirror) {
      Facet& back = ways.emplace_back(facet);
      back.normal = -back.normal;
      back.distance = -back.distance;
      std::reverse(back.corners.begin(), back.corners.end());
    }
    std::vector<Polygon> pieces{facet.corners};
    for (const std::size_t b : near_) pieces = cut(std::move(pieces), facet, bodies_[b].facets);
    for (const Facet& way : ways) {
      std::vector<Side> sides;
      for (const Polygon& piece : pieces) sides.push_back(side_of(a, way, middle_of(piece)));
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

  Side side_of(std::size_t a, const Facet& facet, const Vec3d& middle) {
    const Vec3d off = 2.0 * slack_m_ * facet.normal;
    const bool is_mirror = bodies_[a].body.is_mirror;
    std::optional<std::size_t> front, back;
    if (!is_mirror) back = a;
    bool touches = false;
    for (const std::size_t b : near_) {
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
      if (is_behind && (!back || is_inner(b, *back))) back = b;
    }
    if (is_mirror) return {true, number_of(front)};
    const bool is_twin = touches && *front < a;
    return {back == a && front != back && !is_twin, number_of(front)};
  }

  // Which of two bodies that hold a place has it.
  bool is_inner(std::size_t a, std::size_t b) const {
    const int over = bodies_[a].body.priority - bodies_[b].body.priority;
    return over != 0 ? over > 0 : volumes_[a] < volumes_[b];
  }

  static std::optional<std::uint32_t> number_of(const std::optional<std::size_t>& body) {
    if (!body) return std::nullopt;
    return static_cast<std::uint32_t>(*body);
  }

  std::vector<Polygon> cut(std::vector<Polygon> pieces, const Facet& plane,
                           const std::vector<Facet>& by) const {
    const Box box = box_of(plane.corners);
    for (const Facet& facet : by) {
      if (!box.touches(box_of(facet.corners), slack_m_)) continue;
      double low = std::numeric_limits<double>::infinity();
      double high = -low;
      for (const Vec3d& corner : facet.corners) {
        const double height = glm::dot(plane.normal, corner) - plane.distance;
        low = std::min(low, height);
        high = std::max(high, height);
      }
      std::vector<Polygon> next;
      for (const Polygon& piece : pieces) {
        if (low >= -slack_m_ && high <= slack_m_) {
          cut_out(piece, facet, next);
        } else if (low < -slack_m_ && high > slack_m_ && goes_through(piece, plane, facet)) {
          keep(clipped(piece, facet.normal, facet.distance), next);
          keep(clipped(piece, -facet.normal, -facet.distance), next);
        } else {
          next.push_back(piece);
        }
      }
      pieces = std::move(next);
    }
    return pieces;
  }

  // The part of a piece that a facet in its plane covers, and what is left around it.
  void cut_out(Polygon piece, const Facet& facet, std::vector<Polygon>& pieces) const {
    for (std::size_t i = 0; i < facet.corners.size() && !piece.empty(); ++i) {
      const Vec3d& from = facet.corners[i];
      const Vec3d edge = facet.corners[(i + 1) % facet.corners.size()] - from;
      const double length = glm::length(edge);
      if (!(length > slack_m_)) continue;
      const Vec3d outwards = glm::cross(edge, facet.normal) / length;
      const double at = glm::dot(outwards, from);
      keep(clipped(piece, -outwards, -at), pieces);
      piece = clipped(piece, outwards, at);
    }
    keep(std::move(piece), pieces);
  }

  // Whether the line in which a facet meets the plane of a piece runs over the piece.
  bool goes_through(const Polygon& piece, const Facet& plane, const Facet& facet) const {
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
    return (end - begin) * glm::length(along) > slack_m_;
  }

  // Slivers that rounding makes are no pieces.
  void keep(Polygon piece, std::vector<Polygon>& pieces) const {
    if (piece.size() < 3) return;
    double around = 0.0;
    for (std::size_t i = 0; i < piece.size(); ++i) {
      around += glm::distance(piece[i], piece[(i + 1) % piece.size()]);
    }
    if (area_of(piece) > 0.5 * slack_m_ * around) pieces.push_back(std::move(piece));
  }

  std::vector<BodyFacets>& bodies_;
  std::vector<Box> boxes_;
  std::vector<double> volumes_;
  double reach_ = 0.0, slack_m_ = 0.0;
  std::vector<std::size_t> near_;
  std::vector<Crossed> crossed_;
  std::vector<SharedSpace> troubles_;
};

}  // namespace

std::vector<SharedSpace> arrange(std::vector<BodyFacets>& bodies) {
  return Arranger(bodies).run();
}

}  // namespace abbe
