#include "abbe/caustics/flat/light/shooting.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include <glm/mat2x2.hpp>

namespace abbe {
namespace {

using Mat2d = glm::dmat2;

/// A ray from the lamp over the planes of a chain, and how it moves with its first crossing.
struct TracedRay {
  Crossings at{};                                  ///< Where it crosses them.
  std::array<Mat2d, kMaxRefractions> per_first{};  ///< How that moves with the first one.
  Vec2d missed{0.0};  ///< What the first crossing has to move by, to first order.
  double shortest_m = 0.0;
};

/// What moves with the first crossing of a ray, along both coordinates of its plane.
struct RayChange {
  Vec3d place{0.0}, turn{0.0};
};

// Sends a ray from the lamp through a place of the first plane, `from_start` off the chain's start.
// False where it is totally reflected, or planes lie the other way. The lanes have the same in
// single precision (point_shot-inl.h), without the crossings behind the first.
bool trace(const PointChain& chain, std::span<const double> n, const Vec3d& goal,
           const Vec2d& from_start, TracedRay& ray) {
  const std::size_t count = chain.crossings.size();
  const UnfoldedFace* face = &chain.faces[chain.crossings[0]];
  const Vec3d moved = from_start.x * face->u + from_start.y * face->v;
  const Vec3d offset = chain.start_place - chain.lamp + moved;
  Vec3d at = chain.start_place + moved;
  const double length_m = glm::length(offset);
  if (!(length_m > 0.0)) return false;
  Vec3d direction = offset / length_m;
  std::array<RayChange, 2> changes{RayChange{face->u, {}}, RayChange{face->v, {}}};
  for (RayChange& change : changes) {
    change.turn = (change.place - glm::dot(direction, change.place) * direction) / length_m;
  }
  ray.shortest_m = length_m;
  ray.at[0] = chain.start + from_start;
  ray.per_first[0] = Mat2d(1.0);
  for (std::size_t k = 0; k < count; ++k) {
    const double side = chain.steps[chain.crossings[k]].event == ChainEvent::Enter ? -1.0 : 1.0;
    const Vec3d ahead = side * face->normal;
    const double eta = n[k] / n[k + 1];
    const double cosine = glm::dot(ahead, direction);
    const double square = (1.0 - eta) * (1.0 + eta) + eta * eta * cosine * cosine;
    if (!(cosine > 0.0 && square > 0.0)) return false;
    const double cos_after = std::sqrt(square);
    direction = eta * direction + (cos_after - eta * cosine) * ahead;
    // d(cosθ′ − eta·cosθ) = eta·(eta·cosθ/cosθ′ − 1)·d(cosθ).
    const double bend = eta * (eta * cosine / cos_after - 1.0);
    for (RayChange& change : changes) {
      change.turn = eta * change.turn + bend * glm::dot(change.turn, ahead) * ahead;
    }
    if (k + 1 == count) break;
    face = &chain.faces[chain.crossings[k + 1]];
    const double slope = glm::dot(face->normal, direction);
    const double t = glm::dot(face->normal, face->origin - at) / slope;
    if (!(t > 0.0)) return false;
    ray.shortest_m = std::min(ray.shortest_m, t);
    at += t * direction;
    const Vec3d off = at - face->origin;
    ray.at[k + 1] = {glm::dot(face->u, off), glm::dot(face->v, off)};
    for (std::size_t i = 0; i < 2; ++i) {
      RayChange& change = changes[i];
      change.place += t * change.turn;
      change.place -= glm::dot(face->normal, change.place) / slope * direction;
      ray.per_first[k + 1][static_cast<int>(i)] = {glm::dot(face->u, change.place),
                                                   glm::dot(face->v, change.place)};
    }
  }
  const Vec3d left = goal - at;
  const double along = glm::dot(left, direction);
  if (!(along > 0.0)) return false;
  ray.shortest_m = std::min(ray.shortest_m, along);
  const Vec3d miss = left - along * direction;
  for (RayChange& change : changes) change.place += along * change.turn;
  const Vec3d& a = changes[0].place;
  const Vec3d& b = changes[1].place;
  const double area = glm::dot(glm::cross(a, b), direction);
  ray.missed =
      Vec2d(glm::dot(glm::cross(miss, b), direction), glm::dot(glm::cross(a, miss), direction)) /
      area;
  return true;
}

// Where light of the chain typically crosses its first plane, off the chain's start.
Vec2d typical_start(const PointChain& chain) {
  const UnfoldedFace& face = chain.faces[chain.crossings[0]];
  const Vec3d& direction = chain.directions[0];
  const double t =
      glm::dot(face.normal, face.origin - chain.lamp) / glm::dot(face.normal, direction);
  const Vec3d moved = chain.lamp + t * direction - chain.start_place;
  return {glm::dot(face.u, moved), glm::dot(face.v, moved)};
}

}  // namespace

Shooting shoot(const PointChain& chain, std::span<const double> n, const Vec3d& place,
               Crossings& crossings, const GivesUp& gives_up) {
  constexpr int kMaxShots = 12;
  constexpr int kMaxHalves = 3;
  // Where steps have shrunk so much twice they will go on to. Once may be by chance, where the
  // crossings move fast.
  constexpr double kShrinks = 0.2;
  const std::size_t count = chain.crossings.size();
  TracedRay ray;
  Vec2d from_start = crossings[0] - chain.start;
  if (!trace(chain, n, place, from_start, ray)) {
    from_start = typical_start(chain);
    if (!trace(chain, n, place, from_start, ray)) return Shooting::Unknown;
  }
  double before = std::numeric_limits<double>::infinity();
  int shrunk = 0;  // Steps without a break.
  for (int i = 0; i < kMaxShots; ++i) {
    const Vec2d step = ray.missed;
    double square = 0.0;
    for (std::size_t k = 0; k < count; ++k) {
      const Vec2d moves = ray.per_first[k] * step;
      square = std::max(square, glm::dot(moves, moves));
    }
    const double size = std::sqrt(square);
    if (!(size < before)) return Shooting::Unknown;
    shrunk = size < kShrinks * before && i > 0 ? shrunk + 1 : 0;
    const bool is_close = shrunk >= 2;
    if (is_close || size < 1e-5 * ray.shortest_m) {
      for (std::size_t k = 0; k < count; ++k) crossings[k] = ray.at[k] + ray.per_first[k] * step;
      if (size < 1e-5 * ray.shortest_m) return Shooting::Arrives;
      if (gives_up && gives_up(crossings, kSurely * size)) return Shooting::GivenUp;
    }
    before = size;
    bool is_traced = false;
    double share = 1.0;
    for (int half = 0; half <= kMaxHalves && !is_traced; ++half, share *= 0.5) {
      const Vec2d next = from_start + share * step;
      is_traced = trace(chain, n, place, next, ray);
      if (half > 0) shrunk = 0;
      if (is_traced) from_start = next;
    }
    if (!is_traced) return Shooting::Unknown;
  }
  return Shooting::Unknown;
}

}  // namespace abbe
