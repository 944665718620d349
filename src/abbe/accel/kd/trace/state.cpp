#include "abbe/accel/kd/trace/state.h"

#include "abbe/accel/leaf/search.h"

namespace abbe {

void RaySearch::test(std::uint32_t solid) {
  test_solid(view.solids, solid, *ray.ray, *this);
}

}  // namespace abbe
