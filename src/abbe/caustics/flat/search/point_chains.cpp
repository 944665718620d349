#include "abbe/caustics/flat/search/point_chains.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "abbe/caustics/flat/search/cones.h"

namespace abbe {
namespace {

// Bounds are widened by this share, for what is rounded up to there.
constexpr double kSlack = 1e-5;
constexpr float kNoBound = 1e30f;
constexpr double kPathRounding = 4e-6;
constexpr double kShort = 1e-9;
// Parts that the light of a chain is bounded in; of more, neighbours share their bounds.
constexpr std::size_t kMaxCones = 64;
// Of those, so many neighbours are passed by at once.
constexpr std::size_t kConesInBunch = 8;

bool comes_first(const Vec2d& a, const Vec2d& b) {
  return a.x != b.x ? a.x < b.x : a.y < b.y;
}

// An edge that has the same numbers whichever piece asks for it, but for the sign.
Vec3f edge_between(const Vec2d& a, const Vec2d& b) {
  const bool swapped = comes_first(b, a);
  const Vec2d& first = swapped ? b : a;
  const Vec2d along = glm::normalize((swapped ? a : b) - first);
  // To the left of the line from the first to the second.
  const Vec2d left(-along.y, along.x);
  const Vec3f edge(Vec3d(left, -glm::dot(left, first)));
  return swapped ? -edge : edge;
}

FaceFrame frame_of(const FlatBodies& flat, const Face& face, const Vec3d& body_center) {
  const Facet& plane = flat.facets[face.first_facet];
  FaceFrame frame;
  frame.normal = plane.normal;
  frame.origin =
      body_center + (plane.distance - glm::dot(plane.normal, body_center)) * plane.normal;
  const Vec3d helper = std::abs(plane.normal.x) < 0.6 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
  frame.u = glm::normalize(glm::cross(helper, plane.normal));
  frame.v = glm::cross(plane.normal, frame.u);
  for (std::uint32_t i = 0; i < face.facet_count; ++i) {
    const std::vector<Vec3d>& corners = flat.facets[face.first_facet + i].corners;
    const auto flattened = [&](const Vec3d& corner) {
      return Vec2d(glm::dot(frame.u, corner - frame.origin),
                   glm::dot(frame.v, corner - frame.origin));
    };
    std::vector<Vec3f> edges;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Vec2d a = flattened(corners[k]);
      const Vec2d b = flattened(corners[(k + 1) % corners.size()]);
      // A shorter edge is made by rounding, and has any direction.
      if (glm::distance(a, b) > kShort * face.radius_m) edges.push_back(edge_between(a, b));
    }
    frame.pieces.push_back(std::move(edges));
  }
  return frame;
}

std::vector<FaceFrame> frames_of(const FlatBodies& flat) {
  std::vector<FaceFrame> frames;
  for (const FlatBody& body : flat.bodies) {
    Vec3d sum(0.0);
    for (std::uint32_t f = body.first_face; f < body.first_face + body.face_count; ++f) {
      sum += flat.faces[f].center;
    }
    const Vec3d center = sum / static_cast<double>(body.face_count);
    for (std::uint32_t f = body.first_face; f < body.first_face + body.face_count; ++f) {
      frames.push_back(frame_of(flat, flat.faces[f], center));
    }
  }
  return frames;
}

using Bounds = BoundsOf<double>;

ConeBounds rounded(const Bounds& bounds) {
  ConeBounds result;
  for (std::size_t k = 0; k < 8; ++k) {
    const double reach = bounds.reach[k];
    result.reach[k] = static_cast<float>(reach + kSlack * (1.0 + std::abs(reach)));
    const double steepest = bounds.slope[k] + kSlack * (1.0 + std::abs(bounds.slope[k]));
    result.slope[k] = steepest < 1e6 ? static_cast<float>(steepest) : kNoBound;
  }
  return result;
}

/// What is known of a chain from the cones that took it.
struct Gathered {
  std::vector<Bounds> cones;
  std::uint32_t last_part = 0;  ///< The last of the cones is of this part of the light.
  std::size_t parts_in_last = 0, parts_in_cone = 1;  ///< Parts of it, and that any may be of.
  LaneMask lanes;
  double flux = 0.0, sent = 0.0;
  std::vector<Vec3d> axes;
};

/// Makes chains of one light from what was gathered.
class Maker {
 public:
  Maker(const ChainSearch& search, const Light& light, std::uint32_t source, PointChains& chains)
      : flat_(search.flat),
        obstacles_(search.obstacles),
        chains_(chains),
        source_(source),
        lamp_(light.to_world[3]) {}

  // The normal of the last face, to the side that is lit.
  Vec3d lit_normal(const std::vector<FaceEvent>& path) const {
    const Vec3d& normal = chains_.frames[path.back().face].normal;
    return goes_on_inside(path.back().event) ? -normal : normal;
  }

  void gather(const ConeOnPath& found, Gathered& into) const {
    const FaceFrame& frame = chains_.frames[found.path.back().face];
    const std::uint32_t face = found.path.back().face;
    const Vec3d normal = lit_normal(found.path);
    into.lanes = found.lanes;
    into.flux = found.flux;
    into.sent = found.sent;
    if (into.axes.empty()) into.axes.resize(found.axes.size(), Vec3d(0.0));
    for (std::size_t i = 0; i < found.axes.size(); ++i) into.axes[i] += found.axes[i];
    Bounds bounds;
    for (std::size_t k = 0; k < 8; ++k) {
      const Vec3d along = static_cast<double>(kBoundCosine[k]) * frame.u +
                          static_cast<double>(kBoundSine[k]) * frame.v;
      // It comes out of the face.
      const double ball_reach =
          glm::dot(along, found.cone.center - frame.origin) + found.cone.radius_m;
      bounds.reach[k] = std::min(ball_reach, reach_of(face, along));
      bounds.slope[k] = largest_slope(found.cone, along, normal);
    }
    if (into.cones.empty() || into.last_part != found.part) add_part(into);
    into.cones.back().include(bounds);
    into.last_part = found.part;
  }

  PointChain make(const std::vector<FaceEvent>& path, const Gathered& gathered) const {
    PointChain chain;
    chain.source = source_;
    chain.lanes = gathered.lanes;
    chain.weight = static_cast<float>(gathered.flux);
    chain.kept = static_cast<float>(gathered.flux / gathered.sent);
    const Vec3d origin = rounded_to_single(chains_.frames[path.front().face].origin);
    chain.origin = Vec3f(origin);
    chain.lamp = lamp_ - origin;
    // Lanes come there from the lamp in single precision.
    chain.drift_m = static_cast<float>(kPathRounding * glm::length(chain.lamp));
    chain.directions.push_back(gathered.axes.front());
    for (std::size_t s = 0; s < path.size(); ++s) {
      add_step(path[s], origin, chain);
      const ChainStep& step = chain.steps.back();
      if (s == 0) chain.media.push_back(step.comes_from());
      if (!step.refracts()) {
        mirror(chain);
        continue;
      }
      chain.crossings.push_back(static_cast<std::uint32_t>(s));
      chain.media.push_back(step.goes_on_in());
      chain.directions.push_back(chain.fold * gathered.axes[s + 1]);
    }
    for (Vec3d& direction : chain.directions) direction = glm::normalize(direction);
    if (!chain.crossings.empty()) set_start(chain);
    obstacles_.mark(chain);
    bound(gathered.cones, chain);
    return chain;
  }

 private:
  // Makes room for the next part of the light. Of too many, neighbours share their bounds at once:
  // what is kept of a chain stays small.
  static void add_part(Gathered& into) {
    if (!into.cones.empty() && into.parts_in_last < into.parts_in_cone) {
      ++into.parts_in_last;
      return;
    }
    if (into.cones.size() == 16 * kMaxCones) {
      for (std::size_t i = 0; i < into.cones.size() / 2; ++i) {
        into.cones[i] = into.cones[2 * i];
        into.cones[i].include(into.cones[2 * i + 1]);
      }
      into.cones.resize(into.cones.size() / 2);
      into.parts_in_cone *= 2;
    }
    into.cones.emplace_back();
    into.parts_in_last = 1;
  }

  // How far a face goes in a direction, from the origin of its frame.
  double reach_of(std::uint32_t number, const Vec3d& along) const {
    const Face& face = flat_.faces[number];
    double most = -std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < face.facet_count; ++i) {
      for (const Vec3d& corner : flat_.facets[face.first_facet + i].corners) {
        most = std::max(most, glm::dot(along, corner - chains_.frames[number].origin));
      }
    }
    return most;
  }

  // The light of a chain, whole and in parts; cones that follow each other are neighbours.
  void bound(const std::vector<Bounds>& cones, PointChain& chain) const {
    std::vector<ConeBounds>& parts = chains_.cones;
    std::vector<ConeBunch>& bunches = chains_.bunches;
    chain.first_bunch = static_cast<std::uint32_t>(bunches.size());
    const std::size_t share = (cones.size() + kMaxCones - 1) / kMaxCones;
    Bounds all;
    for (std::size_t first = 0; first < cones.size();) {
      Bounds bunch;
      const auto first_part = static_cast<std::uint32_t>(parts.size());
      for (std::size_t n = 0; n < kConesInBunch && first < cones.size(); ++n) {
        Bounds part;
        const std::size_t last = std::min(first + share, cones.size());
        for (; first < last; ++first) part.include(cones[first]);
        bunch.include(part);
        parts.push_back(rounded(part));
      }
      all.include(bunch);
      bunches.push_back({rounded(bunch), first_part, static_cast<std::uint32_t>(parts.size())});
    }
    chain.last_bunch = static_cast<std::uint32_t>(bunches.size());
    chain.bounds = rounded(all);
  }

  void add_step(const FaceEvent& at, const Vec3d& origin, PointChain& chain) const {
    const Face& face = flat_.faces[at.face];
    const FaceFrame& frame = chains_.frames[at.face];
    chain.steps.push_back(make_chain_step(flat_, face.first_facet, at.event));
    ChainStep& step = chain.steps.back();
    step.distance_m = static_cast<float>(glm::dot(frame.normal, frame.origin - origin));
    UnfoldedFace unfolded;
    unfolded.face = at.face;
    unfolded.origin = chain.fold * (frame.origin - origin) + chain.fold_shift;
    unfolded.normal = chain.fold * frame.normal;
    unfolded.u = chain.fold * frame.u;
    unfolded.v = chain.fold * frame.v;
    unfolded.radius_m = face.radius_m;
    unfolded.center = {glm::dot(frame.u, face.center - frame.origin),
                       glm::dot(frame.v, face.center - frame.origin)};
    unfolded.to_world = glm::transpose(chain.fold);
    unfolded.shift = -(unfolded.to_world * chain.fold_shift);
    chain.faces.push_back(unfolded);
  }

  // Space behind the last face becomes its mirror image.
  static void mirror(PointChain& chain) {
    const UnfoldedFace& face = chain.faces.back();
    const Vec3d n = face.normal;
    const double distance = glm::dot(n, face.origin);
    // x − 2(n·x − distance)·n of what was unfolded before.
    const Mat3d flip = Mat3d(1.0) - 2.0 * glm::outerProduct(n, n);
    chain.fold = flip * chain.fold;
    chain.fold_shift = flip * chain.fold_shift + 2.0 * distance * n;
  }

  const FlatBodies& flat_;
  Obstacles& obstacles_;
  PointChains& chains_;
  std::uint32_t source_;
  Vec3d lamp_;
};

PointChainGroup group_of(const PointChain& chain, const FaceFrame& frame, const Vec3d& normal) {
  PointChainGroup group;
  group.source = chain.source;
  group.ends_in = chain.ends_in();
  group.origin = Vec3f(frame.origin);
  group.normal = Vec3f(normal);
  group.u = Vec3f(frame.u);
  group.v = Vec3f(frame.v);
  return group;
}

}  // namespace

ChainYield add_point_chains(const ChainSearch& search, const Light& light, std::uint32_t source,
                            PointChains& chains) {
  if (search.flat.faces.empty()) return {};
  const PathTree tree = find_paths(search, light);
  if (chains.frames.empty()) chains.frames = frames_of(search.flat);
  const Maker maker(search, light, source, chains);
  // Paths that end at one face and side follow each other.
  const auto end_of = [](const std::vector<FaceEvent>& path) {
    return std::tuple(path.back().face, path.back().event);
  };
  const auto before = [&](const std::vector<FaceEvent>& a, const std::vector<FaceEvent>& b) {
    if (end_of(a) != end_of(b)) return end_of(a) < end_of(b);
    return a < b;
  };
  std::map<std::vector<FaceEvent>, Gathered, decltype(before)> gathered(before);
  search_cones(search, tree, light,
               [&](const ConeOnPath& found) { maker.gather(found, gathered[found.path]); });
  std::optional<std::tuple<std::uint32_t, ChainEvent>> open;
  for (const auto& [path, what] : gathered) {
    PointChain chain = maker.make(path, what);
    if (!open || *open != end_of(path)) {
      open = end_of(path);
      PointChainGroup& group = chains.groups.emplace_back(
          group_of(chain, chains.frames[path.back().face], maker.lit_normal(path)));
      group.first_chain = static_cast<std::uint32_t>(chains.chains.size());
    }
    PointChainGroup& group = chains.groups.back();
    group.bounds.include(chain.bounds);
    group.weight = std::max(group.weight, chain.weight);
    ++group.chain_count;
    chains.chains.push_back(std::move(chain));
  }
  return {tree.started, tree.cut, tree.by_body};
}

void sort_point_chains(PointChains& all) {
  const auto heavier = [](const auto& a, const auto& b) { return a.weight > b.weight; };
  std::stable_sort(all.groups.begin(), all.groups.end(), heavier);
  for (std::uint32_t number = 0; number < all.groups.size(); ++number) {
    const PointChainGroup& group = all.groups[number];
    const auto first = all.chains.begin() + group.first_chain;
    std::stable_sort(first, first + group.chain_count, heavier);
    for (auto chain = first; chain != first + group.chain_count; ++chain) chain->group = number;
  }
}

}  // namespace abbe
