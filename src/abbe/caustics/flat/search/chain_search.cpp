#include "abbe/caustics/flat/search/chain_search.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace abbe {

std::vector<MaterialRange> material_ranges(const TabulatedScene& tables, double first,
                                           double last) {
  // The numbers of the waves by wavelength, those of all sets together.
  const auto lanes = static_cast<std::size_t>(tables.lanes.lane_count());
  std::vector<std::pair<std::size_t, int>> waves;
  for (int set = 0; set < tables.lanes.set_count(); ++set) {
    for (std::size_t lane = 0; lane < lanes; ++lane) waves.emplace_back(lane, set);
  }
  const auto inverse = [&](const auto& wave) {
    return tables.row(tables.inverse_wavelength, wave.second)[wave.first];
  };
  std::stable_sort(waves.begin(), waves.end(),
                   [&](const auto& a, const auto& b) { return inverse(a) > inverse(b); });
  const auto place = [&](double share) {
    return static_cast<std::size_t>(std::lround(share * static_cast<double>(waves.size())));
  };
  const std::span part = std::span(waves).subspan(place(first), place(last) - place(first));
  std::vector<MaterialRange> ranges;
  if (part.empty()) return ranges;
  for (const SurfaceMaterial& material : tables.materials) {
    const auto extent = [&](RowId row) {
      const auto value = [&](const auto& wave) { return tables.row(row, wave.second)[wave.first]; };
      auto found = std::pair(value(part.front()), value(part.front()));
      for (const auto& wave : part) {
        found = {std::min(found.first, value(wave)), std::max(found.second, value(wave))};
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

bool ChainSearch::has_separate_waves() const {
  const auto is_grey = [&](const FlatBody& body) { return ranges[body.material].is_grey; };
  return tables.lanes.are_followed_apart() &&
         !std::all_of(flat.bodies.begin(), flat.bodies.end(), is_grey);
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
