/// Values over time, as the samplers of glTF's animations have them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace abbe::gltf {

/// What stands between two keys.
enum class Interpolation : std::uint8_t { Step, Linear, CubicSpline };

/// Keys and their values.
/// Shape:  `width` values a key; of a CubicSpline three times as many: in-tangent, value,
///         out-tangent.
/// Units:  seconds; tangents per second; rotations are quaternions x, y, z, w of any length.
/// Domain: at least one key, times that do not fall; a rotation has a width of 4.
struct Curve {
  Interpolation interpolation = Interpolation::Linear;
  bool is_rotation = false;
  std::size_t width = 1;
  std::vector<float> times_s;
  std::vector<float> values;
};

/// The values at a time; before the first key and after the last those of that key. Rotations come
/// out with length 1 between keys: along the shorter arc at an even rate, or as a spline of four
/// numbers that is then normalised.
/// Shape:  `width` numbers.
/// Source: glTF 2.0, appendix C.
std::vector<double> value_at(const Curve& curve, double time_s);

}  // namespace abbe::gltf
