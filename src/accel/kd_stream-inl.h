/// Independent rays, several under way at a time so that the memory and the pipelines of one are
/// busy while another waits. Compiled once for each instruction set level.

#if defined(ABBE_ACCEL_KD_STREAM_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_ACCEL_KD_STREAM_INL_H_
#undef ABBE_ACCEL_KD_STREAM_INL_H_
#else
#define ABBE_ACCEL_KD_STREAM_INL_H_
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "accel/kd_state.h"
#include "accel/kd_step-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// One ray against sixteen triangles.
HWY_INLINE void TestBlock(const KdView& view, const TriangleBlock& block, VisibilityMask mask,
                          RayState& ray) {
  const hn::CappedTag<float, kBlockTriangles> d;
  using V = hn::Vec<decltype(d)>;
  const float* const row_x = block.corners[ray.axes.x];
  const float* const row_y = block.corners[ray.axes.y];
  const float* const row_z = block.corners[ray.axes.z];
  const V ox = hn::Set(d, ray.origin_x);
  const V oy = hn::Set(d, ray.origin_y);
  const V oz = hn::Set(d, ray.origin_z);
  const V sx = hn::Set(d, ray.shear_x);
  const V sy = hn::Set(d, ray.shear_y);
  constexpr int kCorner = 3 * kBlockTriangles;
  for (std::size_t i = 0; i < static_cast<std::size_t>(kBlockTriangles); i += hn::Lanes(d)) {
    const V az = hn::Sub(hn::Load(d, row_z + i), oz);
    const V bz = hn::Sub(hn::Load(d, row_z + kCorner + i), oz);
    const V cz = hn::Sub(hn::Load(d, row_z + 2 * kCorner + i), oz);
    const V ax = hn::Sub(hn::Sub(hn::Load(d, row_x + i), ox), hn::Mul(sx, az));
    const V ay = hn::Sub(hn::Sub(hn::Load(d, row_y + i), oy), hn::Mul(sy, az));
    const V bx = hn::Sub(hn::Sub(hn::Load(d, row_x + kCorner + i), ox), hn::Mul(sx, bz));
    const V by = hn::Sub(hn::Sub(hn::Load(d, row_y + kCorner + i), oy), hn::Mul(sy, bz));
    const V cx = hn::Sub(hn::Sub(hn::Load(d, row_x + 2 * kCorner + i), ox), hn::Mul(sx, cz));
    const V cy = hn::Sub(hn::Sub(hn::Load(d, row_y + 2 * kCorner + i), oy), hn::Mul(sy, cz));
    const V u = hn::Sub(hn::Mul(cx, by), hn::Mul(cy, bx));
    const V v = hn::Sub(hn::Mul(ax, cy), hn::Mul(ay, cx));
    const V w = hn::Sub(hn::Mul(bx, ay), hn::Mul(by, ax));
    const V zero = hn::Zero(d);
    const V determinant = hn::Add(hn::Add(u, v), w);
    const V weighted_z = hn::Add(hn::Add(hn::Mul(u, az), hn::Mul(v, bz)), hn::Mul(w, cz));
    const V scaled_t = hn::Mul(weighted_z, hn::Set(d, ray.shear_z));
    // First without the division, and a little too generous: one branch for most triangles.
    const V size = hn::Abs(determinant);
    const V forward = hn::CopySign(hn::Abs(scaled_t), hn::Xor(scaled_t, determinant));
    const auto is_inside =
        hn::Or(hn::Ge(hn::Min(hn::Min(u, v), w), zero), hn::Le(hn::Max(hn::Max(u, v), w), zero));
    const auto is_near = hn::And(hn::Ge(forward, zero),
                                 hn::Le(forward, hn::Mul(size, hn::Set(d, ray.hit.t * 1.00001f))));
    const auto is_candidate = hn::And(hn::And(is_inside, is_near), hn::Gt(size, zero));
    if (HWY_LIKELY(hn::AllFalse(d, is_candidate))) continue;
    const V inverse = hn::Div(hn::Set(d, 1.0f), determinant);
    const V t = hn::Mul(scaled_t, inverse);
    const auto is_hit =
        hn::And(is_candidate, hn::And(hn::Gt(t, zero), hn::Le(t, hn::Set(d, ray.hit.t))));
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, is_hit, bytes);
    unsigned bits = bytes[0] | static_cast<unsigned>(bytes[1]) << 8;
    if (HWY_UNLIKELY(bits == 0)) continue;
    alignas(64) float ts[kBlockTriangles], vs[kBlockTriangles], ws[kBlockTriangles];
    hn::Store(t, d, ts);
    hn::Store(hn::Mul(v, inverse), d, vs);
    hn::Store(hn::Mul(w, inverse), d, ws);
    do {
      const auto lane = hwy::Num0BitsBelowLS1Bit_Nonzero32(bits);
      ray.accept(ts[lane], block.id[i + lane] & kIdMask, vs[lane], ws[lane], view, mask);
      bits &= bits - 1;
    } while (HWY_UNLIKELY(bits != 0));
  }
}

inline constexpr std::size_t kInterleaved = 24;

// The next block of the ray's leaf; what follows is in ray.current.
template <bool kAny>
HWY_INLINE void TestLeaf(const KdView& view, VisibilityMask mask, RayState& ray) {
  const std::uint32_t index = ray.current & kIndexMask;
  if (HWY_LIKELY((ray.current & kMixedBit) == 0)) {
    const TriangleBlock& block = view.blocks[index];
    TestBlock(view, block, mask, ray);
    ray.push_next_block(block.id[0] >> 31);
    ray.pop();
  } else {
    const MixedLeaf& mixed = view.mixed_leaves[index];
    for (std::uint32_t b = 0; b < mixed.block_count; ++b) {
      TestBlock(view, view.blocks[mixed.first_block + b], mask, ray);
    }
    for (std::uint32_t s = 0; s < mixed.solid_count; ++s) {
      ray.test_solid(view.solids[mixed.first_solid + s], view, mask);
    }
    ray.pop();
  }
  if (kAny && ray.hit.is_hit()) ray.current = kDoneChild;
}

// Traces the rays source.ray(i), i < source.count, that have met source.found(i) already, and hands
// each to source.finish() when it is done.
template <bool kAny, class Source>
HWY_INLINE void TraceStream(const KdView& view, VisibilityMask mask, const Source& source) {
  RayState states[kInterleaved];
  WorkLists<kInterleaved> lists;
  const TubeMaker tubes(view.bounds);
  const std::size_t count = source.count;
  for (std::size_t s = 0; s < count && s < kInterleaved; ++s) {
    lists.slot[WorkList::kDone][s] = static_cast<std::uint8_t>(s);
    ++lists.count[WorkList::kDone];
    states[s].ray = nullptr;
  }
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
      tubes.make(source.ray(next), ray.tube);
      ray.start(source.ray(next), source.found(next), next);
      ray.stack.start(view.root, ray.tube);
      ray.pop();
      ++next;
      lists.add(ray.current, s);
    }
    if (lists.count[WorkList::kInner] >= lists.count[WorkList::kLeaf]) {
      const std::size_t inner = lists.count[WorkList::kInner];
      if (inner == 0) {
        if (lists.count[WorkList::kDone] == 0) break;
        continue;
      }
      lists.count[WorkList::kInner] = 0;
      for (std::size_t i = 0; i < inner; ++i) {
        const std::size_t s = lists.slot[WorkList::kInner][i];
        RayState& ray = states[s];
        PushChildren(view.nodes[ray.current], ray.tube, ray.t_near, ray.t_far, ray.hit.t,
                     ray.stack);
        ray.pop();
        PrefetchCell(view, ray.current);
        lists.add(ray.current, s);
      }
    } else {
      const std::size_t leaves = lists.count[WorkList::kLeaf];
      lists.count[WorkList::kLeaf] = 0;
      for (std::size_t i = 0; i < leaves; ++i) {
        PrefetchBlock(view, states[lists.slot[WorkList::kLeaf][i]].current);
      }
      for (std::size_t i = 0; i < leaves; ++i) {
        const std::size_t s = lists.slot[WorkList::kLeaf][i];
        TestLeaf<kAny>(view, mask, states[s]);
        hwy::Prefetch(view.nodes + (states[s].current & kIndexMask));
        lists.add(states[s].current, s);
      }
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
