#include "abbe/accel/instances/numbers.h"

#include <fmt/format.h>

#include "abbe/accel/query.h"
#include "abbe/base/error.h"

namespace abbe {

PlacedNumbers::PlacedNumbers(std::span<const TriangleRange> meshes,
                             std::span<const MeshPlace> places, std::size_t first) {
  std::size_t next = first;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::uint32_t count = meshes[places[i].mesh].count;
    if (count == 0) continue;
    if (i == 0 || places[i].mesh != places[i - 1].mesh) {
      groups_.push_back({static_cast<std::uint32_t>(next), static_cast<std::uint32_t>(i), count});
    }
    next += count;
    if (next >= kNoPrimitive) {
      throw_input_error("", fmt::format("more than {} triangles, instances counted", kNoPrimitive),
                        fmt::format("at most {}", kNoPrimitive - 1));
    }
  }
}

}  // namespace abbe
