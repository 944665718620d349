#include "abbe/caustics/flat/search/chain_search.h"

#include <algorithm>
#include <utility>

namespace abbe {

std::vector<MaterialRange> material_ranges(const TabulatedScene& tables) {
  std::vector<MaterialRange> ranges;
  for (const SurfaceMaterial& material : tables.materials) {
    // The least and the greatest of a row over all sets.
    const auto extent = [&](RowId row) {
      auto found = std::pair(tables.row(row, 0)[0], tables.row(row, 0)[0]);
      for (int set = 0; set < tables.lanes.set_count(); ++set) {
        const float* values = tables.row(row, set);
        const auto [low, high] = std::minmax_element(values, values + tables.lanes.lane_count());
        found = {std::min(found.first, *low), std::max(found.second, *high)};
      }
      return found;
    };
    const auto [low, high] = extent(material.index);
    const auto [least, most] = extent(material.base_color);
    ranges.push_back({static_cast<double>(low), static_cast<double>(high),
                      low == high && least == most && !material.film && !material.is_conductor});
  }
  return ranges;
}

Vec3d rounded_to_single(const Vec3d& v) {
  Vec3d result(0.0);
  for (int i = 0; i < 3; ++i) {
    const volatile float single = static_cast<float>(v[i]);
    result[i] = static_cast<double>(single);
  }
  return result;
}

}  // namespace abbe
