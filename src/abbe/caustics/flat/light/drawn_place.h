/// Which place of lamps with an extent a path gets light from over flat facets.
#pragma once

#include <algorithm>
#include <cstdint>

#include "abbe/caustics/flat/flat_caustics.h"
#include "abbe/math/random.h"

namespace abbe {

/// A number of FlatCaustics::near_places. As many samples of a pixel as there are places draw each
/// once. Domain: there are such places.
inline std::uint32_t drawn_place(const FlatCaustics& caustics, const SampleChance& sample,
                                 std::uint64_t path) {
  // Apart from the lamps and surfaces whose straight light is drawn there.
  constexpr std::uint32_t kItem = 0xffffffffu;
  const auto count = static_cast<std::uint32_t>(caustics.near_places.size());
  const float u = random_1d(sample, path, Purpose::LightPoint, kItem);
  return std::min(static_cast<std::uint32_t>(u * static_cast<float>(count)), count - 1);
}

}  // namespace abbe
