#include "abbe/accel/leaf/search.h"

namespace abbe {

void AllSearch::found(float t, std::uint32_t primitive, float u, float v, int crossing) {
  if (!(t > 0.0f && t < t_max_ && t <= end_)) return;
  const VisibilityMask bits = visibility_.of(primitive);
  if ((bits & mask_) == 0) return;
  found_.push_back({{t, primitive, u, v}, crossing});
  if ((bits & stops_) != 0) end_ = t;
}

void AllSearch::finish(HitLists& lists) {
  std::sort(found_.begin(), found_.end(), [](const Found& a, const Found& b) {
    if (is_nearer(a.hit.t, a.hit.primitive, b.hit)) return true;
    if (is_nearer(b.hit.t, b.hit.primitive, a.hit)) return false;
    return a.crossing < b.crossing;
  });
  const Found* last = nullptr;
  for (const Found& found : found_) {
    const bool is_again = last != nullptr && last->hit.primitive == found.hit.primitive &&
                          last->crossing == found.crossing;
    if (is_again) continue;
    lists.add(found.hit);
    last = &found;
    if ((visibility_.of(found.hit.primitive) & stops_) != 0) break;
  }
  lists.end_list();
}

}  // namespace abbe
