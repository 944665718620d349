/// The watertight triangle test over lanes: one ray against the sixteen triangles of a block, or a
/// triangle against the rays of a packet. test_block() in search.h has the same operations in the
/// same order, so that a ray meets the same wherever it is tested: to the bit, since no product is
/// fused with a sum. Compiled once for each instruction set level.

#if defined(ABBE_ACCEL_LEAF_TRIANGLES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_ACCEL_LEAF_TRIANGLES_INL_H_
#undef ABBE_ACCEL_LEAF_TRIANGLES_INL_H_
#else
#define ABBE_ACCEL_LEAF_TRIANGLES_INL_H_
#endif

#include <hwy/highway.h>

#include "abbe/accel/leaf/block.h"
#include "abbe/accel/leaf/corners-inl.h"
#include "abbe/accel/leaf/lanes-inl.h"
#include "abbe/accel/leaf/packet.h"
#include "abbe/accel/leaf/shear.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// The corners of a triangle relative to a ray, x and y sheared, for as many triangles or rays as
// there are lanes.
struct ShearedCorners {
  hn::Vec<LaneF> ax, ay, az, bx, by, bz, cx, cy, cz;
};

// What the test comes to: everything but the division by the determinant.
struct TriangleTest {
  hn::Vec<LaneF> scaled_t, determinant;
  hn::Vec<LaneF> v, w;  // Weights of the second and the third corner, times the determinant.
  hn::Mask<LaneF> is_inside;
};

// The test itself.
// Source: Woop, Benthin & Wald, Watertight Ray/Triangle Intersection, JCGT 2(1), 2013.
HWY_INLINE TriangleTest TestTriangle(const ShearedCorners& c, hn::Vec<LaneF> shear_z) {
  const LaneF d;
  const auto zero = hn::Zero(d);
  const auto u = hn::Sub(hn::Mul(c.cx, c.by), hn::Mul(c.cy, c.bx));
  const auto v = hn::Sub(hn::Mul(c.ax, c.cy), hn::Mul(c.ay, c.cx));
  const auto w = hn::Sub(hn::Mul(c.bx, c.ay), hn::Mul(c.by, c.ax));
  const auto determinant = hn::Add(hn::Add(u, v), w);
  const auto weighted_z = hn::Add(hn::Add(hn::Mul(u, c.az), hn::Mul(v, c.bz)), hn::Mul(w, c.cz));
  return {hn::Mul(weighted_z, shear_z), determinant, v, w,
          hn::Or(hn::Ge(hn::Min(hn::Min(u, v), w), zero), hn::Le(hn::Max(hn::Max(u, v), w), zero))};
}

// Of a distance up to which hits count, what MayBeNear() compares with.
inline constexpr float kNearMargin = 1.00001f;

// Whether t is between 0 and last_t: without the division, and a little too generous.
HWY_INLINE hn::Mask<LaneF> MayBeNear(const TriangleTest& test, hn::Vec<LaneF> last_t) {
  const LaneF d;
  const auto forward =
      hn::CopySign(hn::Abs(test.scaled_t), hn::Xor(test.scaled_t, test.determinant));
  return hn::And(hn::Ge(forward, hn::Zero(d)),
                 hn::Le(forward, hn::Mul(hn::Abs(test.determinant), last_t)));
}

// What one ray and sixteen triangles come to, for those that may be hit. Kept while the next rays
// are tested, so that no processor has to guess at the end of so long a chain of operations whether
// there is a hit.
struct alignas(64) BlockResult {
  float scaled_t[kBlockTriangles];
  float determinant[kBlockTriangles];
  float v[kBlockTriangles], w[kBlockTriangles];
  std::uint32_t candidates;
};

template <bool kLoose>
HWY_INLINE void TestBlockOf(const TriangleBlock& block, const ShearedRay& ray, float t_end,
                            BlockResult& result) {
  const LaneF d;
  const Corners<kLoose> corners(
      block, ray.axes, {ray.origin_x, ray.origin_y, ray.origin_z, ray.shear_x, ray.shear_y});
  std::uint32_t candidates = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(kBlockTriangles); i += hn::Lanes(d)) {
    ShearedCorners c;
    corners.get(i, 0, c.ax, c.ay, c.az);
    corners.get(i, 1, c.bx, c.by, c.bz);
    corners.get(i, 2, c.cx, c.cy, c.cz);
    const TriangleTest test = TestTriangle(c, hn::Set(d, ray.shear_z));
    const auto is_candidate =
        hn::And(hn::And(test.is_inside, MayBeNear(test, hn::Set(d, t_end * kNearMargin))),
                hn::Gt(hn::Abs(test.determinant), hn::Zero(d)));
    candidates |= BitsOf(d, is_candidate, i);
    hn::Store(test.scaled_t, d, result.scaled_t + i);
    hn::Store(test.determinant, d, result.determinant + i);
    hn::Store(test.v, d, result.v + i);
    hn::Store(test.w, d, result.w + i);
  }
  result.candidates = candidates;
}

// One ray against the triangles of a block up to a distance.
HWY_INLINE void TestBlock(const TriangleBlock& block, const ShearedRay& ray, float t_end,
                          BlockResult& result) {
  if (HWY_LIKELY(block.is_loose == 0)) {
    TestBlockOf<false>(block, ray, t_end, result);
  } else {
    TestBlockOf<true>(block, ray, t_end, result);
  }
}

// Shows the candidates to a search, as test_block() in search.h does.
template <class Search>
HWY_INLINE void ShowCandidates(const TriangleBlock& block, const BlockResult& result, float shear_z,
                               QueryMask mask, Search& search) {
  for (std::uint32_t bits = result.candidates; bits != 0; bits &= bits - 1) {
    const auto lane = hwy::Num0BitsBelowLS1Bit_Nonzero32(bits);
    if ((block.front_only >> lane & 1) != 0 && is_culled(mask, result.determinant[lane], shear_z)) {
      continue;
    }
    const float inverse = 1.0f / result.determinant[lane];
    search.found(result.scaled_t[lane] * inverse, block.id[lane], result.v[lane] * inverse,
                 result.w[lane] * inverse, 0);
  }
}

// What a packet may meet of a block.
struct alignas(64) CulledBlock {
  float vertices[3][kLooseVertices];  ///< Relative to where all rays begin, if it is one point.
  std::uint32_t near;                 ///< The triangles that the packet's rays may meet.
};

// Triangles that some lane may have hit: what the test came to, the division still to be done. The
// determinant of a lane that is beside the triangle is zero.
template <int kLanes>
struct alignas(64) Candidates {
  float scaled_t[kBlockTriangles][kLanes];
  float determinant[kBlockTriangles][kLanes];
  float v[kBlockTriangles][kLanes], w[kBlockTriangles][kLanes];
  std::uint32_t id[kBlockTriangles];
};

// The coordinates of the vertices of a block along the axes of a ray, and if kRelative relative to
// where it begins. Held by value: what a kernel stores might otherwise change them.
template <bool kRelative>
struct VertexPlaces {
  const float *x, *y, *z;
  ShearAxes axes;

  HWY_INLINE VertexPlaces(const TriangleBlock& block, const CulledBlock& culled,
                          const ShearAxes& to)
      : x(kRelative ? culled.vertices[to.x] : block.row(to.x)),
        y(kRelative ? culled.vertices[to.y] : block.row(to.y)),
        z(kRelative ? culled.vertices[to.z] : block.row(to.z)),
        axes(to) {}
};

// The triangles that culling left against lanes [i, i + Lanes); returns how many may be hit. No
// branch depends on the outcome of a test.
template <bool kAny, bool kCommonOrigin, int kLanes>
HWY_INLINE std::size_t FindCandidates(const TriangleBlock& block, std::uint32_t near,
                                      VertexPlaces<kCommonOrigin> rows, QueryMask mask,
                                      const PacketRays<kLanes>& p, std::size_t i,
                                      Candidates<kLanes>& found) {
  const LaneF d;
  const std::uint32_t one_sided =
      (mask & (kCullBack | kCullFront)) != 0 ? block.front_only : std::uint32_t{0};
  // Positive where fronts are seen.
  const auto seen = hn::Set(d, (mask & kCullBack) != 0 ? 1.0f : -1.0f);
  using V = hn::Vec<LaneF>;
  const V sx = hn::Load(d, p.shear_x + i);
  const V sy = hn::Load(d, p.shear_y + i);
  const V sz = hn::Load(d, p.shear_z + i);
  const V last_t = hn::Mul(hn::Load(d, p.hits.t + i), hn::Set(d, kNearMargin));
  const V ox = hn::Load(d, p.origin[rows.axes.x] + i);
  const V oy = hn::Load(d, p.origin[rows.axes.y] + i);
  const V oz = hn::Load(d, p.origin[rows.axes.z] + i);
  const auto relative = [&](const float* row, std::size_t vertex, V origin) ABBE_INLINE_LAMBDA {
    const V position = hn::Set(d, row[vertex]);
    return kCommonOrigin ? position : hn::Sub(position, origin);
  };
  const auto corner = [&](std::size_t vertex, V& x, V& y, V& z) ABBE_INLINE_LAMBDA {
    z = relative(rows.z, vertex, oz);
    x = hn::Sub(relative(rows.x, vertex, ox), hn::Mul(sx, z));
    y = hn::Sub(relative(rows.y, vertex, oy), hn::Mul(sy, z));
  };
  std::size_t count = 0;
  for (; near != 0; near &= near - 1) {
    const auto k = static_cast<std::size_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(near));
    ShearedCorners c;
    corner(block.corners[0][k], c.ax, c.ay, c.az);
    corner(block.corners[1][k], c.bx, c.by, c.bz);
    corner(block.corners[2][k], c.cx, c.cy, c.cz);
    const TriangleTest test = TestTriangle(c, sz);
    auto is_candidate = test.is_inside;
    // Most triangles near a shadow ray are the one it ends at: a first look without the division
    // saves them. In the search for the closest they are mostly hits.
    if (kAny) is_candidate = hn::And(is_candidate, MayBeNear(test, last_t));
    if ((one_sided >> k & 1) != 0) {
      // As is_culled() has it: from behind the signs differ.
      const auto side = hn::CopySign(seen, hn::Xor(hn::Xor(test.determinant, sz), seen));
      is_candidate = hn::And(is_candidate, hn::Gt(side, hn::Zero(d)));
    }
    hn::Store(test.scaled_t, d, found.scaled_t[count]);
    hn::Store(hn::IfThenElseZero(is_candidate, test.determinant), d, found.determinant[count]);
    if (!kAny) {
      hn::Store(test.v, d, found.v[count]);
      hn::Store(test.w, d, found.w[count]);
      found.id[count] = block.id[k];
    }
    count += hn::AllFalse(d, is_candidate) ? 0u : 1u;
  }
  return count;
}

// Which of lanes [i, i + Lanes) hit any of the candidates. Which of them it is does not matter.
template <int kLanes>
HWY_INLINE std::uint32_t HitsAny(const Candidates<kLanes>& found, std::size_t count,
                                 const PacketRays<kLanes>& p, std::size_t i) {
  const LaneF d;
  const auto best = hn::Load(d, p.hits.t + i);
  auto is_hit = hn::Lt(best, best);
  for (std::size_t c = 0; c < count; ++c) {
    const auto inverse = hn::Div(hn::Set(d, 1.0f), hn::Load(d, found.determinant[c]));
    const auto t = hn::Mul(hn::Load(d, found.scaled_t[c]), inverse);
    is_hit = hn::Or(is_hit, hn::And(hn::Gt(t, hn::Zero(d)), hn::Lt(t, best)));
  }
  return BitsOf(d, is_hit, i);
}

// Sorts the candidates by distance, in registers; returns which of lanes [i, i + Lanes) have a new
// nearest hit. Only lanes of the group take part.
template <int kLanes>
HWY_INLINE std::uint32_t TakeNearest(const Candidates<kLanes>& found, std::size_t count,
                                     const ShearGroup& group, std::size_t i,
                                     PacketRays<kLanes>& p) {
  const LaneF d;
  const LaneU du;
  auto best = hn::Load(d, p.hits.t + i);
  auto best_u = hn::Load(d, p.hits.u + i);
  auto best_v = hn::Load(d, p.hits.v + i);
  auto primitive = hn::Load(du, p.hits.primitive + i);
  const auto in_group = MaskOf(d, group.lanes, i);
  std::uint32_t lanes = 0;
  for (std::size_t c = 0; c < count; ++c) {
    const auto inverse = hn::Div(hn::Set(d, 1.0f), hn::Load(d, found.determinant[c]));
    const auto t = hn::Mul(hn::Load(d, found.scaled_t[c]), inverse);
    const auto ids = hn::Set(du, found.id[c]);
    const auto is_hit =
        hn::And(hn::And(in_group, hn::Gt(t, hn::Zero(d))), IsNearer(t, ids, best, primitive));
    lanes |= BitsOf(d, is_hit, i);
    best = hn::IfThenElse(is_hit, t, best);
    best_u = hn::IfThenElse(is_hit, hn::Mul(hn::Load(d, found.v[c]), inverse), best_u);
    best_v = hn::IfThenElse(is_hit, hn::Mul(hn::Load(d, found.w[c]), inverse), best_v);
    primitive = hn::IfThenElse(hn::RebindMask(du, is_hit), ids, primitive);
  }
  hn::Store(best, d, p.hits.t + i);
  hn::Store(best_u, d, p.hits.u + i);
  hn::Store(best_v, d, p.hits.v + i);
  hn::Store(primitive, du, p.hits.primitive + i);
  return lanes;
}

// The triangles near the packet against the lanes of a group; returns those that met something.
// With kAny hits are not written. First all tests; then what they found.
template <bool kAny, bool kCommonOrigin, int kLanes>
HWY_INLINE std::uint32_t TestTriangles(const TriangleBlock& block, const CulledBlock& culled,
                                       const ShearGroup& group, QueryMask mask,
                                       PacketRays<kLanes>& p, Candidates<kLanes>& found) {
  const VertexPlaces<kCommonOrigin> rows(block, culled, group.axes);
  std::uint32_t lanes = 0;
  for (std::size_t i = 0; i < kLanes; i += hn::Lanes(LaneF())) {
    const std::size_t count =
        FindCandidates<kAny, kCommonOrigin>(block, culled.near, rows, mask, p, i, found);
    if (count == 0) continue;
    if constexpr (kAny) {
      lanes |= HitsAny(found, count, p, i) & group.lanes;
    } else {
      lanes |= TakeNearest(found, count, group, i, p);
    }
  }
  return lanes;
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif
