#include "accel/kd_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/kd_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "accel/kd_stream-inl.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {

void RaysClosest(const KdView& view, const Ray* rays, std::size_t count, VisibilityMask mask,
                 Hit* hits) {
  TraceStream<false>(view, rays, count, mask, StoreHit{hits});
}

void RaysAny(const KdView& view, const Ray* rays, std::size_t count, VisibilityMask mask,
             std::uint8_t* occluded) {
  TraceStream<true>(view, rays, count, mask, StoreOccluded{occluded});
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace abbe {

HWY_EXPORT(RaysClosest);
HWY_EXPORT(RaysAny);

void trace_closest(const KdView& view, const Ray* rays, std::size_t count, VisibilityMask mask,
                   Hit* hits) {
  HWY_DYNAMIC_DISPATCH(RaysClosest)(view, rays, count, mask, hits);
}

void trace_any(const KdView& view, const Ray* rays, std::size_t count, VisibilityMask mask,
               std::uint8_t* occluded) {
  HWY_DYNAMIC_DISPATCH(RaysAny)(view, rays, count, mask, occluded);
}

}  // namespace abbe
#endif
