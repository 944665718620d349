/// Spectra tabulated for the lanes of a render, all in one table.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace abbe {

/// A spectrum tabulated for every wavelength set: its place in Rows.
using RowId = std::uint32_t;

/// A table that spectra are added to, and looked up in by the id that this gave.
class Rows {
 public:
  /// Domain: lane_stride as the LaneModel has it that makes what is added.
  explicit Rows(int lane_stride) : lane_stride_(static_cast<std::size_t>(lane_stride)) {}

  /// Shape:  set_count × lane_stride, as all rows of a LaneModel.
  RowId add(const std::vector<float>& row) {
    const auto id = static_cast<RowId>(values_.size());
    values_.insert(values_.end(), row.begin(), row.end());
    return id;
  }
  /// A value for each lane of a wavelength set.
  const float* at(RowId id, int set) const {
    return values_.data() + id + static_cast<std::size_t>(set) * lane_stride_;
  }

 private:
  std::size_t lane_stride_;
  std::vector<float> values_;
};

}  // namespace abbe
