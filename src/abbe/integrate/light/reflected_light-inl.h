/// What a surface sends back of the light that arrives from a lamp. Highway code, compiled once per
/// instruction set.

#if defined(ABBE_INTEGRATE_LIGHT_REFLECTED_LIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_INTEGRATE_LIGHT_REFLECTED_LIGHT_INL_H_
#undef ABBE_INTEGRATE_LIGHT_REFLECTED_LIGHT_INL_H_
#else
#define ABBE_INTEGRATE_LIGHT_REFLECTED_LIGHT_INL_H_
#endif

#include <hwy/highway.h>

#include "abbe/integrate/lit_surface.h"
#include "abbe/integrate/surface/scatter-inl.h"
#include "abbe/world/light/lights.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Light that would reach the camera by direct reflection of what arrives from a lamp, per lane,
/// before visibility: throughput/n² · E · f_r · cosθ.
template <class D>
HWY_INLINE void ReflectLight(D d, int stride, const LitSurface& surface,
                             const LightGeometry& geometry, float* contribution) {
  const SurfaceAnswer& answer = surface.shaded.answer;
  const int step = static_cast<int>(hn::Lanes(d));
  for (int i = 0; i < stride; i += step) {
    const auto scattered = ScatteredFrom(d, surface.shaded, i, Load3(d, geometry.direction, i));
    const auto arriving = hn::Mul(hn::Load(d, geometry.irradiance.v + i), scattered.cosine);
    const auto throughput =
        hn::Mul(hn::Load(d, surface.throughput.v + i), hn::Load(d, answer.inverse_n2.v + i));
    const auto light_out =
        hn::Mul(hn::Mul(throughput, arriving), hn::Add(scattered.broad, scattered.rough));
    hn::StoreU(light_out, d, contribution + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif  // ABBE_INTEGRATE_LIGHT_REFLECTED_LIGHT_INL_H_
