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

#include "abbe/accel/kd/trace/beam-inl.h"
#include "abbe/accel/kd/trace/state.h"
#include "abbe/accel/kd/trace/step-inl.h"
#include "abbe/accel/leaf/triangles-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Rays in flight at a time.
inline constexpr std::size_t kInterleaved = 32;
// So many rays after its own step what follows from it is done.
inline constexpr std::size_t kLag = 3;

HWY_INLINE void TestMixedLeaf(const KdView& view, QueryMask mask, RayState& ray) {
  const MixedLeaf& mixed = view.mixed_leaves[ray.current & kIndexMask];
  RaySearch search{view, mask, ray};
  BlockResult result;
  for (KdChild leaf = mixed.triangles; leaf != kEmptyChild;) {
    const TriangleBlock& block = view.block(leaf);
    TestBlock(block, ray.sheared, ray.hit.t, result);
    ShowCandidates(block, result, ray.sheared.shear_z, mask, search);
    leaf = next_block(block, leaf);
  }
  for (std::uint32_t s = 0; s < mixed.solid_count; ++s) {
    const std::uint32_t solid = view.leaf_solids[mixed.first_solid + s];
    if (MeetsBox(ray.beam, view.solids.bounds_of(solid), ray.hit.t)) search.test(solid);
  }
}

// Ends the ray where it has met something. Those that any hit will do for are done.
template <bool kAny>
HWY_INLINE void Shorten(RayState& ray) {
  if (kAny && ray.hit.is_hit()) ray.hit.t = -kInfinity;
  ray.stack.drop_behind(ray.hit.t);
}

// Hands rays that are done to the source, and starts new ones in their place.
template <class Source>
HWY_INLINE void Refill(const KdView& view, const Source& source, const BeamMaker& beams,
                       RayState* states, WorkLists<kInterleaved>& lists, std::size_t& next) {
  const std::size_t done = lists.count[WorkList::kDone];
  lists.count[WorkList::kDone] = 0;
  for (std::size_t i = 0; i < done; ++i) {
    const std::size_t s = lists.slot[WorkList::kDone][i];
    RayState& ray = states[s];
    if (ray.ray != nullptr) source.finish(ray);
    if (next == source.count) continue;
    beams.make(source.ray(next), ray.beam);
    ray.start(source.ray(next), source.found(next), next);
    ray.stack.start(view.root, ray.beam);
    pop(ray);
    ++next;
    lists.add(ray.current, s);
  }
}

// Traces the rays source.ray(i), i < source.count, that have met source.found(i) already, and hands
// each to source.finish() when it is done.
template <bool kAny, class Source>
HWY_INLINE void TraceStream(const KdView& view, QueryMask mask, const Source& source) {
  RayState states[kInterleaved];
  BlockResult results[kLag + 1];
  WorkLists<kInterleaved> lists{};
  const BeamMaker beams(view.bounds);
  for (std::size_t s = 0; s < kInterleaved; ++s) {
    lists.slot[WorkList::kDone][s] = static_cast<std::uint8_t>(s);
    states[s].ray = nullptr;
  }
  lists.count[WorkList::kDone] = kInterleaved;
  std::size_t next = 0;
  while (true) {
    Refill(view, source, beams, states, lists, next);
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
            pop(ray);
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
              TestBlock(view.block(ray.current), ray.sheared, ray.hit.t, results[i % (kLag + 1)]);
            }
          },
          [&](std::size_t i) ABBE_INLINE_LAMBDA {
            const std::size_t s = lists.slot[WorkList::kLeaf][i];
            RayState& ray = states[s];
            if (HWY_LIKELY((ray.current & kMixedBit) == 0)) {
              const TriangleBlock& block = view.block(ray.current);
              const BlockResult& result = results[i % (kLag + 1)];
              if (result.candidates != 0) {
                RaySearch search{view, mask, ray};
                ShowCandidates(block, result, ray.sheared.shear_z, mask, search);
                Shorten<kAny>(ray);
              }
              push_next_block(ray, block.next_lines, ray.hit.t);
            } else {
              TestMixedLeaf(view, mask, ray);
              Shorten<kAny>(ray);
            }
            pop(ray);
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
