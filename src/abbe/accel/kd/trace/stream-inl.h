/// Independent rays, several in flight at a time so that the memory and the pipelines of one are
/// busy while another waits. Compiled once for each instruction set level.

#if defined(ABBE_ACCEL_KD_TRACE_STREAM_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_ACCEL_KD_TRACE_STREAM_INL_H_
#undef ABBE_ACCEL_KD_TRACE_STREAM_INL_H_
#else
#define ABBE_ACCEL_KD_TRACE_STREAM_INL_H_
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "abbe/accel/kd/trace/lanes-inl.h"
#include "abbe/accel/kd/trace/state.h"
#include "abbe/accel/kd/trace/step-inl.h"
#include "abbe/accel/leaf/corners-inl.h"
#include "abbe/accel/leaf/solids-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// What one ray and sixteen triangles come to: everything but the division, for those that may be
// hit. Kept while the next rays are tested, so that no processor has to guess at the end of so long
// a chain of operations whether there is a hit.
struct alignas(64) BlockResult {
  float scaled_t[kBlockTriangles];
  float determinant[kBlockTriangles];
  float v[kBlockTriangles], w[kBlockTriangles];
  std::uint32_t candidates;
};

// One ray against sixteen triangles.
template <bool kLoose>
HWY_INLINE void TestBlockOf(const TriangleBlock& block, const RayState& ray, BlockResult& result) {
  const LaneF d;
  using V = hn::Vec<LaneF>;
  const Corners<kLoose> corners(
      block, ray.axes, {ray.origin_x, ray.origin_y, ray.origin_z, ray.shear_x, ray.shear_y});
  std::uint32_t candidates = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(kBlockTriangles); i += hn::Lanes(d)) {
    V ax, ay, az, bx, by, bz, cx, cy, cz;
    corners.get(i, 0, ax, ay, az);
    corners.get(i, 1, bx, by, bz);
    corners.get(i, 2, cx, cy, cz);
    const V u = hn::Sub(hn::Mul(cx, by), hn::Mul(cy, bx));
    const V v = hn::Sub(hn::Mul(ax, cy), hn::Mul(ay, cx));
    const V w = hn::Sub(hn::Mul(bx, ay), hn::Mul(by, ax));
    const V zero = hn::Zero(d);
    const V determinant = hn::Add(hn::Add(u, v), w);
    const V weighted_z = hn::Add(hn::Add(hn::Mul(u, az), hn::Mul(v, bz)), hn::Mul(w, cz));
    const V scaled_t = hn::Mul(weighted_z, hn::Set(d, ray.shear_z));
    // Without the division, and a little too generous.
    const V size = hn::Abs(determinant);
    const V forward = hn::CopySign(hn::Abs(scaled_t), hn::Xor(scaled_t, determinant));
    const auto is_inside =
        hn::Or(hn::Ge(hn::Min(hn::Min(u, v), w), zero), hn::Le(hn::Max(hn::Max(u, v), w), zero));
    const auto is_near = hn::And(hn::Ge(forward, zero),
                                 hn::Le(forward, hn::Mul(size, hn::Set(d, ray.hit.t * 1.00001f))));
    const auto is_candidate = hn::And(hn::And(is_inside, is_near), hn::Gt(size, zero));
    candidates |= BitsOf(d, is_candidate, i);
    hn::Store(scaled_t, d, result.scaled_t + i);
    hn::Store(determinant, d, result.determinant + i);
    hn::Store(v, d, result.v + i);
    hn::Store(w, d, result.w + i);
  }
  result.candidates = candidates;
}

HWY_INLINE void TestBlock(const TriangleBlock& block, const RayState& ray, BlockResult& result) {
  if (HWY_LIKELY(block.is_loose == 0)) {
    TestBlockOf<false>(block, ray, result);
  } else {
    TestBlockOf<true>(block, ray, result);
  }
}

// Takes the nearest of the candidates, if it is nearer than what the ray has met.
HWY_INLINE void AcceptCandidates(const KdView& view, const TriangleBlock& block,
                                 VisibilityMask mask, const BlockResult& result, RayState& ray) {
  for (std::uint32_t bits = result.candidates; bits != 0; bits &= bits - 1) {
    const auto lane = hwy::Num0BitsBelowLS1Bit_Nonzero32(bits);
    const float inverse = 1.0f / result.determinant[lane];
    ray.accept(result.scaled_t[lane] * inverse, block.id[lane], result.v[lane] * inverse,
               result.w[lane] * inverse, view, mask);
  }
}

// Rays in flight at a time.
inline constexpr std::size_t kInterleaved = 32;
// So many rays after its own step what follows from it is done.
inline constexpr std::size_t kLag = 3;

HWY_INLINE void TestMixedLeaf(const KdView& view, VisibilityMask mask, RayState& ray) {
  const MixedLeaf& mixed = view.mixed_leaves[ray.current & kIndexMask];
  BlockResult result;
  for (KdChild leaf = mixed.triangles; leaf != kEmptyChild;) {
    const TriangleBlock& block = view.block(leaf);
    TestBlock(block, ray, result);
    AcceptCandidates(view, block, mask, result, ray);
    leaf = next_block(block, leaf);
  }
  for (std::uint32_t s = 0; s < mixed.solid_count; ++s) {
    const std::uint32_t solid = view.solids[mixed.first_solid + s];
    if (MeetsBox(ray.beam, BoundsOfSolid(view, solid), ray.hit.t)) {
      ray.test_solid(solid, view, mask);
    }
  }
}

// Ends the ray where it has met something. Those that any hit will do for are done.
template <bool kAny>
HWY_INLINE void Shorten(RayState& ray) {
  if (kAny && ray.hit.is_hit()) ray.hit.t = -kInfinity;
  ray.stack.drop_behind(ray.hit.t);
}

// Traces the rays source.ray(i), i < source.count, that have met source.found(i) already, and hands
// each to source.finish() when it is done.
template <bool kAny, class Source>
HWY_INLINE void TraceStream(const KdView& view, VisibilityMask mask, const Source& source) {
  RayState states[kInterleaved];
  BlockResult results[kLag + 1];
  WorkLists<kInterleaved> lists{};
  const BeamMaker beams(view.bounds);
  const std::size_t count = source.count;
  for (std::size_t s = 0; s < kInterleaved; ++s) {
    lists.slot[WorkList::kDone][s] = static_cast<std::uint8_t>(s);
    states[s].ray = nullptr;
  }
  lists.count[WorkList::kDone] = kInterleaved;
  std::size_t next = 0;
  while (true) {
    // New rays for those that are done.
    const std::size_t done = lists.count[WorkList::kDone];
    lists.count[WorkList::kDone] = 0;
    for (std::size_t i = 0; i < done; ++i) {
      const std::size_t s = lists.slot[WorkList::kDone][i];
      RayState& ray = states[s];
      if (ray.ray != nullptr) source.finish(ray);
      if (next == count) continue;
      beams.make(source.ray(next), ray.beam);
      ray.start(source.ray(next), source.found(next), next);
      ray.stack.start(view.root, ray.beam);
      ray.pop();
      ++next;
      lists.add(ray.current, s);
    }
    const std::size_t inner = lists.count[WorkList::kInner];
    const std::size_t leaves = lists.count[WorkList::kLeaf];
    if (inner == 0 && leaves == 0) {
      if (lists.count[WorkList::kDone] == 0) break;
      continue;
    }
    // A list that is gone through fills anew from its start.
    if (inner >= leaves) {
      lists.count[WorkList::kInner] = 0;
      ForEachStaggered<kLag>(
          inner,
          [&](std::size_t i) ABBE_INLINE_LAMBDA {
            RayState& ray = states[lists.slot[WorkList::kInner][i]];
            PushChildren(view.nodes[ray.current], ray.beam, ray.t_near, ray.t_far, ray.hit.t,
                         ray.stack);
          },
          [&](std::size_t i) ABBE_INLINE_LAMBDA {
            const std::size_t s = lists.slot[WorkList::kInner][i];
            RayState& ray = states[s];
            ray.pop();
            PrefetchAll(view, ray.current);
            lists.add(ray.current, s);
          });
    } else {
      lists.count[WorkList::kLeaf] = 0;
      ForEachStaggered<kLag>(
          leaves,
          [&](std::size_t i) ABBE_INLINE_LAMBDA {
            const RayState& ray = states[lists.slot[WorkList::kLeaf][i]];
            if (HWY_LIKELY((ray.current & kMixedBit) == 0)) {
              TestBlock(view.block(ray.current), ray, results[i % (kLag + 1)]);
            }
          },
          [&](std::size_t i) ABBE_INLINE_LAMBDA {
            const std::size_t s = lists.slot[WorkList::kLeaf][i];
            RayState& ray = states[s];
            if (HWY_LIKELY((ray.current & kMixedBit) == 0)) {
              const TriangleBlock& block = view.block(ray.current);
              const BlockResult& result = results[i % (kLag + 1)];
              if (result.candidates != 0) {
                AcceptCandidates(view, block, mask, result, ray);
                Shorten<kAny>(ray);
              }
              ray.push_next_block(block.next_lines);
            } else {
              TestMixedLeaf(view, mask, ray);
              Shorten<kAny>(ray);
            }
            ray.pop();
            PrefetchAll(view, ray.current);
            lists.add(ray.current, s);
          });
    }
  }
}

// Rays as the caller gave them.
struct RaySpan {
  const Ray* rays;
  std::size_t count;

  HWY_INLINE const Ray& ray(std::size_t i) const { return rays[i]; }
  HWY_INLINE Hit found(std::size_t i) const { return {rays[i].t_max, kNoPrimitive, 0.0f, 0.0f}; }
};

struct ClosestOfSpan : RaySpan {
  Hit* hits;
  HWY_INLINE void finish(const RayState& ray) const {
    hits[ray.index] = ray.hit.is_hit() ? ray.hit : Hit{};
  }
};

struct AnyOfSpan : RaySpan {
  std::uint8_t* occluded;
  HWY_INLINE void finish(const RayState& ray) const {
    occluded[ray.index] = ray.hit.is_hit() ? 1 : 0;
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif
