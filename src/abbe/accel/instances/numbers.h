/// The numbers of primitives of placed meshes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "abbe/accel/shapes.h"

namespace abbe {

/// Primitives are numbered place by place, behind all others. Places of a mesh lie behind each
/// other, so that numbers are found by a division.
class PlacedNumbers {
 public:
  PlacedNumbers() = default;
  /// Shape: places sorted by mesh; `first` is the number of the first primitive.
  /// Errors: an input Error where the numbers do not suffice.
  PlacedNumbers(std::span<const TriangleRange> meshes, std::span<const MeshPlace> places,
                std::size_t first);

  struct PlacedTriangle {
    std::uint32_t place;
    std::uint32_t triangle;  ///< Of the mesh.
  };
  /// Domain: the number of a primitive of a placed mesh.
  PlacedTriangle triangle_of(std::uint32_t primitive) const {
    const auto behind = std::upper_bound(
        groups_.begin(), groups_.end(), primitive,
        [](std::uint32_t number, const Group& group) { return number < group.first_primitive; });
    const Group& group = *(behind - 1);
    const std::uint32_t number = primitive - group.first_primitive;
    const std::uint32_t place = number / group.triangle_count;
    return {group.first_place + place, number - place * group.triangle_count};
  }
  /// Domain: a place.
  std::uint32_t first_primitive(std::uint32_t place) const {
    const auto behind = std::upper_bound(
        groups_.begin(), groups_.end(), place,
        [](std::uint32_t number, const Group& group) { return number < group.first_place; });
    const Group& group = *(behind - 1);
    return group.first_primitive + (place - group.first_place) * group.triangle_count;
  }

 private:
  struct Group {
    std::uint32_t first_primitive, first_place, triangle_count;
  };
  std::vector<Group> groups_;
};

}  // namespace abbe
