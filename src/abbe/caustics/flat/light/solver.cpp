#include "abbe/caustics/flat/light/solver.h"

#include <algorithm>
#include <cmath>

#include <glm/mat2x2.hpp>
#include <glm/matrix.hpp>

namespace abbe {
namespace {

using Mat2d = glm::dmat2;

constexpr int kMaxSteps = 40;
// A segment this much shorter than the whole path has shrunk to a point: an edge.
constexpr double kVanished = 1e-7;

/// A sequence of planes with light crossing them, and the first two derivatives of its optical
/// length.
class PlaneSequence {
 public:
  PlaneSequence(const PointChain& chain, std::span<const double> n, const Vec3d& place)
      : chain_(chain), n_(n), place_(place), count_(chain.crossings.size()) {}

  std::size_t count() const { return count_; }
  const UnfoldedFace& face(std::size_t k) const { return chain_.faces[chain_.crossings[k]]; }

  // Goes to crossings; returns the optical length.
  double look_at(const Crossings& at) {
    double length = 0.0;
    Vec3d from = chain_.lamp;
    shortest_ = 1e300;
    total_m_ = 0.0;
    for (std::size_t j = 0; j <= count_; ++j) {
      const Vec3d to = j < count_ ? on_face(face(j), at[j]) : place_;
      const Vec3d offset = to - from;
      length_m_[j] = glm::length(offset);
      direction_[j] = offset / length_m_[j];
      length += n_[j] * length_m_[j];
      total_m_ += length_m_[j];
      shortest_ = std::min(shortest_, length_m_[j]);
      from = to;
    }
    return length;
  }
  double shortest() const { return shortest_; }
  double total_m() const { return total_m_; }

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
  double shortest_ = 0.0, total_m_ = 0.0;
};

// Back from the place along typical directions, as if the light were parallel, and not far from
// the faces.
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

}  // namespace

bool solve_crossings(const PointChain& chain, std::span<const double> n, const Vec3d& place,
                     Crossings& crossings) {
  PlaneSequence planes(chain, n, place);
  if (planes.count() == 0) return true;
  guess(chain, place, crossings);
  double length = planes.look_at(crossings);
  bool is_edge_ruled_out = false;
  for (int i = 0; i < kMaxSteps; ++i) {
    const double scale = planes.shortest();
    if (!(scale > kVanished * planes.total_m())) return false;
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
    // Where steps are small they converge quadratically, and lengths no longer tell.
    if (size < 1e-3 * scale) {
      crossings = moved(step);
      length = planes.look_at(crossings);
      if (size < 1e-5 * scale) return planes.shortest() > kVanished * planes.total_m();
      continue;
    }
    const Crossings there = moved(step);
    const double there_length = size < 1e30 ? planes.look_at(there) : 1e300;
    if (there_length < length) {
      crossings = there;
      length = there_length;
      continue;
    }
    if (!is_edge_ruled_out && is_least_at_edge(chain, n, place)) return false;
    is_edge_ruled_out = true;
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
