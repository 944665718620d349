#include "abbe/caustics/flat/light/solver.h"

#include <algorithm>
#include <cmath>

#include <glm/mat2x2.hpp>
#include <glm/matrix.hpp>

namespace abbe {
namespace {

using Mat2d = glm::dmat2;

constexpr int kMaxSteps = 400;
// A step shorter than this share of the shortest segment comes close to the path.
constexpr double kClose = 0.015;
// Of a step, the smallest part that is tried.
constexpr double kLeastStep = 0.01;
// A segment between planes that meet, this much shorter than the whole path, has shrunk to a point:
// their edge. Others may be thin layers, and keep a direction in double precision.
constexpr double kVanished = 1e-7;
constexpr double kNoLength = 1e-14;
// Sine squared of the angle between planes that do not meet anywhere near.
constexpr double kParallel2 = 1e-16;
// Where steps fail, segments between planes that meet are rounded off near their edge, by this
// share of their faces at first and a tenth of it each time after. A path that would need a
// stronger pull than this share of what such a segment has does not end at the edge.
constexpr double kFirstRounding = 0.01;
constexpr double kStrongPull = 0.95;
constexpr double kWeakPull = 0.5;
// With more than this the rounding no longer matters.
constexpr double kClearPull = 0.9999;

/// A sequence of planes with light crossing them, and the first two derivatives of its optical
/// length.
class PlaneSequence {
 public:
  PlaneSequence(const PointChain& chain, std::span<const double> n, const Vec3d& place)
      : chain_(chain), n_(n), place_(place), count_(chain.crossings.size()) {
    for (std::size_t j = 1; j < count_; ++j) {
      const Vec3d cross = glm::cross(face(j - 1).normal, face(j).normal);
      meets_[j] = glm::dot(cross, cross) > kParallel2;
      has_edges_ |= meets_[j];
    }
  }

  // Takes √(length² + (share·radius)²) for the length of segments between planes that meet: the sum
  // is smooth at their edges, too.
  void round_edges(double share) { rounding_ = share; }
  double rounding() const { return rounding_; }
  // What that may move a crossing by: twice what was seen in trials.
  double shifts_by() const {
    double radius_m = 0.0;
    for (std::size_t k = 0; k < count_; ++k) radius_m = std::max(radius_m, face(k).radius_m);
    return 200.0 * rounding_ * radius_m;
  }
  bool has_edges() const { return has_edges_; }
  // The least pull of such a segment, of the most it can have.
  double least_pull() const { return least_pull_; }

  std::size_t count() const { return count_; }
  const UnfoldedFace& face(std::size_t k) const { return chain_.faces[chain_.crossings[k]]; }

  // Goes to crossings; returns the optical length.
  double look_at(const Crossings& at) {
    double length = 0.0;
    Vec3d from = chain_.lamp;
    shortest_ = 1e300;
    is_at_edge_ = false;
    least_pull_ = 1.0;
    total_m_ = 0.0;
    for (std::size_t j = 0; j <= count_; ++j) {
      const Vec3d to = j < count_ ? on_face(face(j), at[j]) : place_;
      const Vec3d offset = to - from;
      double square = glm::dot(offset, offset);
      if (rounding_ > 0.0 && is_between_meeting(j)) {
        const double rounding_m = rounding_ * std::min(face(j - 1).radius_m, face(j).radius_m);
        const double rounded = square + rounding_m * rounding_m;
        least_pull_ = std::min(least_pull_, std::sqrt(square / rounded));
        square = rounded;
      }
      length_m_[j] = std::sqrt(square);
      direction_[j] = offset / length_m_[j];
      length += n_[j] * length_m_[j];
      total_m_ += length_m_[j];
      shortest_ = std::min(shortest_, length_m_[j]);
      from = to;
    }
    for (std::size_t j = 0; j <= count_; ++j) {
      const double least = is_between_meeting(j) ? kVanished : kNoLength;
      is_at_edge_ |= !(length_m_[j] > least * total_m_);
    }
    return length;
  }
  double shortest() const { return shortest_; }
  // Whether a segment has no length: its ends are at an edge, or at one place.
  bool is_at_edge() const { return is_at_edge_; }

  Vec2d in_face(std::size_t k, const Vec3d& v) const {
    return {glm::dot(face(k).u, v), glm::dot(face(k).v, v)};
  }

  Vec2d gradient(std::size_t k) const {
    return in_face(k, n_[k] * direction_[k] - n_[k + 1] * direction_[k + 1]);
  }

  // Factors of the matrix of second derivatives, or of Weiszfeld's bound of it.
  void factor(bool is_exact) {
    for (std::size_t k = 0; k < count_; ++k) {
      diagonal_[k] = segment(k, k, k, is_exact) + segment(k + 1, k, k, is_exact);
      if (k + 1 < count_) next_[k] = -segment(k + 1, k, k + 1, is_exact);
      if (k == 0) continue;
      carry_[k] = glm::transpose(next_[k - 1]) * glm::inverse(diagonal_[k - 1]);
      diagonal_[k] -= carry_[k] * next_[k - 1];
    }
  }

  // Solves matrix · x = right.
  void solve(Crossings& right) const {
    for (std::size_t k = 1; k < count_; ++k) right[k] -= carry_[k] * right[k - 1];
    for (std::size_t k = count_; k-- > 0;) {
      if (k + 1 < count_) right[k] -= next_[k] * right[k + 1];
      right[k] = glm::inverse(diagonal_[k]) * right[k];
    }
  }

  const Vec3d& direction(std::size_t j) const { return direction_[j]; }
  double length_m(std::size_t j) const { return length_m_[j]; }
  // Of the factor of crossing k; their product is that of the matrix.
  double determinant(std::size_t k) const { return glm::determinant(diagonal_[k]); }

 private:
  bool is_between_meeting(std::size_t j) const { return j > 0 && j < count_ && meets_[j]; }

  // The part of segment j in the derivative by crossings a and b.
  Mat2d segment(std::size_t j, std::size_t a, std::size_t b, bool is_exact) const {
    const UnfoldedFace& fa = face(a);
    const UnfoldedFace& fb = face(b);
    const double share = n_[j] / length_m_[j];
    const Vec2d da = is_exact ? in_face(a, direction_[j]) : Vec2d(0.0);
    const Vec2d db = is_exact ? in_face(b, direction_[j]) : Vec2d(0.0);
    // GLM's matrices are columns.
    return share * Mat2d(glm::dot(fa.u, fb.u) - da.x * db.x, glm::dot(fa.v, fb.u) - da.y * db.x,
                         glm::dot(fa.u, fb.v) - da.x * db.y, glm::dot(fa.v, fb.v) - da.y * db.y);
  }

  const PointChain& chain_;
  std::span<const double> n_;
  const Vec3d place_;
  const std::size_t count_;
  // Not filled before they are needed: clearing them would take as long as a step.
  std::array<double, kMaxRefractions + 1> length_m_;
  std::array<Vec3d, kMaxRefractions + 1> direction_;
  std::array<Mat2d, kMaxRefractions> diagonal_, next_, carry_;
  std::array<bool, kMaxRefractions + 1> meets_;  ///< Whether the planes about a segment meet.
  bool has_edges_ = false;
  double rounding_ = 0.0, least_pull_ = 1.0;
  double shortest_ = 0.0, total_m_ = 0.0;
  bool is_at_edge_ = false;
};

// A lamp so many times closer to its first face than the guess is to its foot there is close.
constexpr double kCloseLamp = 4.0;

// Back from the place along typical directions, as if the light were parallel, and not far from
// the faces. Directions of a lamp that almost touches its face differ too much for that: the path
// is sought from its foot on, where the length grows with the crossing as that of a bowl and not of
// a cone.
void guess(const PointChain& chain, const Vec3d& place, Crossings& at) {
  Vec3d from = place;
  for (std::size_t k = chain.crossings.size(); k-- > 0;) {
    const UnfoldedFace& face = chain.faces[chain.crossings[k]];
    const Vec3d& direction = chain.directions[k + 1];
    const double slope = glm::dot(face.normal, direction);
    const double t = glm::dot(face.normal, from - face.origin) / slope;
    const Vec3d met = from - t * direction - face.origin;
    Vec2d off = Vec2d(glm::dot(face.u, met), glm::dot(face.v, met)) - face.center;
    const double far = glm::length(off);
    if (!(far < 1e30)) {
      off = Vec2d(0.0);
    } else if (far > face.radius_m) {
      off *= face.radius_m / far;
    }
    at[k] = face.center + off;
    from = on_face(face, at[k]);
  }
  const double height_m = glm::distance(chain.lamp, chain.start_place);
  if (glm::distance(at[0], chain.start) > kCloseLamp * height_m) at[0] = chain.start;
}

double size_of(const Crossings& step, std::size_t count) {
  double square = 0.0;
  for (std::size_t k = 0; k < count; ++k) square = std::max(square, glm::dot(step[k], step[k]));
  return std::sqrt(square);
}

// Whether the path over two planes is certainly least where it runs over the edge between them,
// with nothing left of the segment in between: there a vector no longer than that segment's index
// has to balance the pulls of the other two in both planes. A search would creep towards such a
// place. Units:  as solve_crossings; false also where that is not known.
bool is_least_at_edge(const PointChain& chain, std::span<const double> n, const Vec3d& place) {
  if (chain.crossings.size() != 2 || n[0] != n[2]) return false;
  const UnfoldedFace& first = chain.faces[chain.crossings[0]];
  const UnfoldedFace& second = chain.faces[chain.crossings[1]];
  const Vec3d cross = glm::cross(first.normal, second.normal);
  const double sine = glm::length(cross);
  if (!(sine > 1e-6)) return false;
  const Vec3d along = cross / sine;
  // Across the edge in each plane.
  const Vec3d u = glm::cross(first.normal, along);
  const Vec3d v = glm::cross(second.normal, along);
  const double to_second =
      glm::dot(second.normal, second.origin - first.origin) / glm::dot(second.normal, u);
  const Vec3d corner = first.origin + to_second * u;

  // Both paths have the same angle with the edge, as if it were unrolled.
  const auto off_edge = [&](const Vec3d& v_m, double at) { return glm::length(v_m - at * along); };
  const Vec3d lamp = chain.lamp - corner;
  const Vec3d goal = place - corner;
  const double lamp_at = glm::dot(lamp, along);
  const double goal_at = glm::dot(goal, along);
  const double lamp_off = off_edge(lamp, lamp_at);
  const double goal_off = off_edge(goal, goal_at);
  if (!(lamp_off > 0.0 && goal_off > 0.0)) return false;
  const Vec3d least = ((lamp_at * goal_off + goal_at * lamp_off) / (lamp_off + goal_off)) * along;
  const Vec3d pull_in = n[0] * glm::normalize(least - lamp);
  const Vec3d pull_out = n[2] * glm::normalize(goal - least);

  const double in = glm::dot(pull_in, u);
  const double out = glm::dot(pull_out, v);
  const double cosine = glm::dot(u, v);
  const double square = (in * in + out * out - 2.0 * cosine * in * out) / (1.0 - cosine * cosine);
  const double edgewise = glm::dot(pull_in, along);
  return square + edgewise * edgewise < n[1] * n[1] * (1.0 - 1e-6);
}

// A line a·u + b·v + c = 0 between a place and the outline of a face, which lies where that is
// positive: an edge or, where pieces meet, a tangent to the circle about them all.
Vec3d line_before(const FaceFrame& frame, const UnfoldedFace& face, const Vec2d& at) {
  const Vec2d off = at - face.center;
  const double far = glm::length(off);
  Vec3d line(0.0, 0.0, face.radius_m);
  if (far > 0.0) line = {-off / far, face.radius_m + glm::dot(off, face.center) / far};
  if (frame.pieces.size() > 1) return line;
  for (const Vec3f& edge : frame.pieces.front()) {
    const Vec3d other(edge);
    if (glm::dot(Vec2d(other), at) + other.z < glm::dot(Vec2d(line), at) + line.z) line = other;
  }
  return line;
}

// The largest stretch of a map from space to a plane, by its columns.
double most_per_metre(const Vec2d& x, const Vec2d& y, const Vec2d& z) {
  const double a = x.x * x.x + y.x * y.x + z.x * z.x;
  const double b = x.y * x.y + y.y * y.y + z.y * z.y;
  const double c = x.x * x.y + y.x * y.y + z.x * z.y;
  return std::sqrt(0.5 * (a + b) + std::sqrt(0.25 * (a - b) * (a - b) + c * c));
}

}  // namespace

Vec3d off_last_face(const PointChain& chain, const Vec3d& place) {
  if (!chain.steps.back().refracts()) return place;
  const UnfoldedFace& face = chain.faces.back();
  const double side = chain.steps.back().goes_on_inside() ? -1.0 : 1.0;
  const double height = side * glm::dot(face.normal, place - face.origin);
  const double least = 1e-6 * glm::distance(place, chain.lamp);
  return height < least ? place + side * (least - height) * face.normal : place;
}

bool solve_crossings(const PointChain& chain, std::span<const double> n, const Vec3d& place,
                     Crossings& crossings, const GivesUp& gives_up) {
  if (chain.crossings.empty()) return true;
  guess(chain, place, crossings);
  const Shooting shooting = shoot(chain, n, place, crossings, gives_up);
  if (shooting != Shooting::Unknown) return shooting == Shooting::Arrives;
  guess(chain, place, crossings);
  PlaneSequence planes(chain, n, place);
  double length = planes.look_at(crossings);
  int weak_pulls = 0;
  bool has_rounded = false;
  for (int i = 0; i < kMaxSteps; ++i) {
    const double scale = planes.shortest();
    if (planes.is_at_edge()) return false;
    Crossings step{};
    for (std::size_t k = 0; k < planes.count(); ++k) step[k] = -planes.gradient(k);
    const Crossings force = step;
    planes.factor(true);
    planes.solve(step);
    const double size = size_of(step, planes.count());
    const auto moved = [&](const Crossings& by) {
      Crossings there{};
      for (std::size_t k = 0; k < planes.count(); ++k) there[k] = crossings[k] + by[k];
      return there;
    };
    if (gives_up && size < kClose * scale &&
        gives_up(moved(step), kSurely * size + planes.shifts_by())) {
      return false;
    }
    // Where steps are small they converge quadratically, and lengths no longer tell.
    if (size < 1e-3 * scale) {
      crossings = moved(step);
      length = planes.look_at(crossings);
      if (planes.rounding() > 0.0) {
        // A pull that is not strong and stays so as the rounding goes keeps the path at the edge.
        weak_pulls = planes.least_pull() < kStrongPull ? weak_pulls + 1 : 0;
        if (planes.least_pull() < kWeakPull) weak_pulls = 2;
        if (weak_pulls == 2) return false;
        const bool is_clear = planes.least_pull() > kClearPull;
        planes.round_edges(is_clear ? 0.0 : 0.1 * planes.rounding());
        length = planes.look_at(crossings);
      } else if (size < 1e-5 * scale) {
        return !planes.is_at_edge();
      }
      continue;
    }
    // A shorter step where the whole one goes too far.
    bool is_shorter = false;
    for (double share = 1.0; share > kLeastStep && size < 1e30 && !is_shorter; share *= 0.5) {
      Crossings part{};
      for (std::size_t k = 0; k < planes.count(); ++k) part[k] = share * step[k];
      const Crossings there = moved(part);
      const double there_length = planes.look_at(there);
      is_shorter = there_length < length;
      if (!is_shorter) continue;
      crossings = there;
      length = there_length;
    }
    if (i == 1 && planes.has_edges() && is_least_at_edge(chain, n, place)) return false;
    if (is_shorter) continue;
    if (!has_rounded && planes.has_edges()) {
      if (i == 0 && is_least_at_edge(chain, n, place)) return false;
      has_rounded = true;
      planes.round_edges(kFirstRounding);
      length = planes.look_at(crossings);
      continue;
    }
    planes.look_at(crossings);
    planes.factor(false);
    step = force;
    planes.solve(step);
    crossings = moved(step);
    length = planes.look_at(crossings);
  }
  return false;
}

bool goes_ahead(const PointChain& chain, const Crossings& crossings) {
  for (std::size_t k = 0; k + 1 < chain.crossings.size(); ++k) {
    const UnfoldedFace& face = chain.faces[chain.crossings[k]];
    const UnfoldedFace& next = chain.faces[chain.crossings[k + 1]];
    const double side = chain.steps[chain.crossings[k]].event == ChainEvent::Enter ? -1.0 : 1.0;
    const Vec3d offset = on_face(next, crossings[k + 1]) - on_face(face, crossings[k]);
    if (!(side * glm::dot(face.normal, offset) > 0.0)) return false;
  }
  return true;
}

CrossingSlopes crossing_slopes(const PointChain& chain, std::span<const double> n,
                               std::span<const double> n_change, const Vec3d& place,
                               const Crossings& crossings) {
  CrossingSlopes slopes;
  PlaneSequence planes(chain, n, place);
  if (planes.count() == 0) return slopes;
  planes.look_at(crossings);
  planes.factor(true);
  for (std::size_t k = 0; k < planes.count(); ++k) {
    slopes.by_index[k] = -planes.in_face(
        k, n_change[k] * planes.direction(k) - n_change[k + 1] * planes.direction(k + 1));
  }
  planes.solve(slopes.by_index);
  const std::size_t last = planes.count() - 1;
  const Vec3d& d = planes.direction(last + 1);
  for (int axis = 0; axis < 3; ++axis) {
    Vec3d moved(0.0);
    moved[axis] = 1.0;
    const double share = n[last + 1] / planes.length_m(last + 1);
    Crossings& result = slopes.by_place[static_cast<std::size_t>(axis)];
    result[last] = share * planes.in_face(last, moved - glm::dot(d, moved) * d);
    planes.solve(result);
  }
  return slopes;
}

bool may_cross(const PointChains& all, const PointChain& chain, const Crossings& crossings,
               double off_m) {
  return may_cross(all, chain, crossings, CrossingSlopes{}, 0.0, off_m);
}

bool may_cross(const PointChains& all, const PointChain& chain, const Crossings& crossings,
               const CrossingSlopes& slopes, double radius_m, double off_m) {
  for (std::size_t k = 0; k < chain.crossings.size(); ++k) {
    const UnfoldedFace& face = chain.faces[chain.crossings[k]];
    double moves = 0.5 * glm::length(slopes.by_index[k]);
    for (const Crossings& by_place : slopes.by_place) moves += radius_m * glm::length(by_place[k]);
    const double room = 4.0 * moves + 1e-5 * face.radius_m + off_m;
    if (all.frames[face.face].distance_inside(crossings[k]) < -room) return false;
  }
  return true;
}

Miss clearest_miss(const PointChains& all, const PointChain& chain, const Vec3d& place,
                   const Crossings& crossings, const CrossingSlopes& slopes, double off_m) {
  Miss miss;
  // Closer to the last face, and far from where its light goes, crossings move less evenly.
  const UnfoldedFace& end = chain.faces.back();
  const double height_m = std::abs(glm::dot(end.normal, place - end.origin));
  const double even_m = std::min(height_m, 2.0 * end.radius_m);
  for (std::size_t k = 0; k < chain.crossings.size(); ++k) {
    const UnfoldedFace& face = chain.faces[chain.crossings[k]];
    const Vec3d line = line_before(all.frames[face.face], face, crossings[k]);
    const double height = glm::dot(Vec2d(line), crossings[k]) + line.z;
    const double room = 2.0 * glm::length(slopes.by_index[k]) + off_m + 1e-5 * face.radius_m;
    if (!(-height - room > static_cast<double>(miss.outside_m))) continue;
    miss.outside_m = static_cast<float>(-height - room);
    Vec3d per_m(0.0);
    for (int axis = 0; axis < 3; ++axis) {
      per_m[axis] = -glm::dot(Vec2d(line), slopes.by_place[static_cast<std::size_t>(axis)][k]);
    }
    miss.per_m = Vec3f(glm::transpose(chain.fold) * per_m);
    const double stretch =
        most_per_metre(slopes.by_place[0][k], slopes.by_place[1][k], slopes.by_place[2][k]);
    miss.stretch = static_cast<float>(stretch);
    // What is stretched is so because it grazes.
    miss.even_m = static_cast<float>(even_m / std::max(1.0, stretch));
  }
  return miss;
}

double crossing_jacobian(const PointChain& chain, std::span<const double> n, const Vec3d& place,
                         const Crossings& crossings) {
  PlaneSequence planes(chain, n, place);
  planes.look_at(crossings);
  planes.factor(true);
  double result = 1.0 / (n[0] * n[0]);
  for (std::size_t j = 0; j <= planes.count(); ++j) {
    result *= n[j] * n[j] / (planes.length_m(j) * planes.length_m(j));
  }
  for (std::size_t k = 0; k < planes.count(); ++k) {
    result *= std::abs(glm::dot(planes.face(k).normal, planes.direction(k)) *
                       glm::dot(planes.face(k).normal, planes.direction(k + 1)));
    result /= planes.determinant(k);
  }
  return result;
}

}  // namespace abbe
