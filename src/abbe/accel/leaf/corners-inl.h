/// The corners of a block's triangles as a sheared line sees them, sixteen triangles in as many
/// vectors as the level needs. Compiled once for each instruction set level.

#if defined(ABBE_ACCEL_LEAF_CORNERS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ABBE_ACCEL_LEAF_CORNERS_INL_H_
#undef ABBE_ACCEL_LEAF_CORNERS_INL_H_
#else
#define ABBE_ACCEL_LEAF_CORNERS_INL_H_
#endif

#include <hwy/highway.h>

#include "abbe/accel/leaf/block.h"
#include "abbe/accel/leaf/lanes-inl.h"
#include "abbe/accel/leaf/shear.h"

HWY_BEFORE_NAMESPACE();
namespace abbe {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// A value for each of the sixteen vertices of a block, looked up by the corners of its triangles.
// Lanes [i, i + Lanes) are set at a time.
struct VertexRow {
  static constexpr std::size_t kLanes = hn::MaxLanes(LaneF());

#if HWY_MAX_BYTES >= 32
  hn::Vec<LaneF> part[kPacketLanes / kLanes];

  HWY_INLINE void set(std::size_t i, hn::Vec<LaneF> values) {
    part[i / kLanes] = values;
  }

  HWY_INLINE hn::Vec<LaneF> at(hn::Vec<LaneU> corner) const {
    const LaneF d;
    if constexpr (kLanes == kPacketLanes) {
      return hn::TableLookupLanes(part[0], hn::IndicesFromVec(d, corner));
    } else {
      // The hardware reads three bits of an index; the fourth says which half.
      const auto is_high = hn::BitCast(d, hn::ShiftLeft<28>(corner));
#if HWY_IS_DEBUG_BUILD
      corner = hn::And(corner, hn::Set(LaneU(), 7u));
#endif
      const auto index = hn::IndicesFromVec(d, corner);
      return hn::IfNegativeThenElse(is_high, hn::TableLookupLanes(part[1], index),
                                    hn::TableLookupLanes(part[0], index));
    }
  }
#else
  alignas(16) float value[kPacketLanes];

  HWY_INLINE void set(std::size_t i, hn::Vec<LaneF> values) {
    hn::Store(values, LaneF(), value + i);
  }

  HWY_INLINE hn::Vec<LaneF> at(hn::Vec<LaneU> corner) const {
    const LaneF d;
    return hn::GatherIndex(d, value, hn::BitCast(hn::RebindToSigned<LaneF>(), corner));
  }
#endif
};

// Numbers of the vertices that are one corner of triangles [i, i + Lanes) of a block.
HWY_INLINE hn::Vec<LaneU> CornersOf(const std::uint8_t* row, std::size_t i) {
  const hn::Rebind<std::uint8_t, LaneU> d8;
  return hn::PromoteTo(LaneU(), hn::LoadU(d8, row + i));
}

// A line through a point, sheared along its z.
struct ShearedLine {
  float x, y, z;
  float shear_x, shear_y;
};

// Vertices [i, i + Lanes) relative to the line: z, and x and y beside it, with the operations and
// the order that all tests of a triangle share. `moved`, if given, takes x, y and z before the
// shear.
template <bool kLoose>
struct LineRows {
  static constexpr int kStride = kLoose ? kLooseVertices : kSharedVertices;
  const float *x, *y, *z;
  ShearedLine line;

  LineRows(const TriangleBlock& block, const ShearAxes& axes, const ShearedLine& to)
      : x(block.rows() + axes.x * kStride),
        y(block.rows() + axes.y * kStride),
        z(block.rows() + axes.z * kStride),
        line(to) {}

  HWY_INLINE void get(std::size_t i, hn::Vec<LaneF>& vx, hn::Vec<LaneF>& vy, hn::Vec<LaneF>& vz,
                      float* const* moved) const {
    const LaneF d;
    const auto mx = hn::Sub(hn::Load(d, x + i), hn::Set(d, line.x));
    const auto my = hn::Sub(hn::Load(d, y + i), hn::Set(d, line.y));
    vz = hn::Sub(hn::Load(d, z + i), hn::Set(d, line.z));
    if (moved != nullptr) {
      hn::Store(mx, d, moved[0] + i);
      hn::Store(my, d, moved[1] + i);
      hn::Store(vz, d, moved[2] + i);
    }
    vx = hn::Sub(mx, hn::Mul(hn::Set(d, line.shear_x), vz));
    vy = hn::Sub(my, hn::Mul(hn::Set(d, line.shear_y), vz));
  }
};

// Corners of triangles that share vertices: each vertex is sheared once and looked up.
template <bool kLoose>
class Corners {
 public:
  HWY_INLINE Corners(const TriangleBlock& block, const ShearAxes& axes, const ShearedLine& line,
                     float* const* moved = nullptr)
      : block_(block) {
    const LineRows<kLoose> rows(block, axes, line);
    const LaneF d;
    for (std::size_t i = 0; i < static_cast<std::size_t>(kSharedVertices); i += hn::Lanes(d)) {
      hn::Vec<LaneF> x, y, z;
      rows.get(i, x, y, z, moved);
      x_.set(i, x);
      y_.set(i, y);
      z_.set(i, z);
    }
  }

  // One corner, 0 to 2, of triangles [i, i + Lanes).
  HWY_INLINE void get(std::size_t i, int corner, hn::Vec<LaneF>& x, hn::Vec<LaneF>& y,
                      hn::Vec<LaneF>& z) const {
    const auto vertex = CornersOf(block_.corners[corner], i);
    x = x_.at(vertex);
    y = y_.at(vertex);
    z = z_.at(vertex);
  }

 private:
  const TriangleBlock& block_;
  VertexRow x_, y_, z_;
};

// Corners of triangles that do not: they lie in rows.
template <>
class Corners<true> {
 public:
  HWY_INLINE Corners(const TriangleBlock& block, const ShearAxes& axes, const ShearedLine& line,
                     float* const* moved = nullptr)
      : rows_(block, axes, line), moved_(moved) {}

  HWY_INLINE void get(std::size_t i, int corner, hn::Vec<LaneF>& x, hn::Vec<LaneF>& y,
                      hn::Vec<LaneF>& z) const {
    rows_.get(static_cast<std::size_t>(corner * kBlockTriangles) + i, x, y, z, moved_);
  }

 private:
  LineRows<true> rows_;
  float* const* moved_;
};

}  // namespace HWY_NAMESPACE
}  // namespace abbe
HWY_AFTER_NAMESPACE();

#endif
