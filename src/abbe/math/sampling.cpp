#include "abbe/math/sampling.h"

#include <array>
#include <cstddef>

namespace abbe {
namespace {

using DirectionNumbers = std::array<std::uint32_t, 32>;

// Primitive polynomial of degree s with inner coefficients a, and initial odd numbers m.
DirectionNumbers direction_numbers(int s, std::uint32_t a, std::array<std::uint32_t, 3> m) {
  DirectionNumbers v{};
  for (int i = 0; i < s; ++i) v[i] = m[i] << (31 - i);
  for (int i = s; i < 32; ++i) {
    v[i] = v[i - s] ^ (v[i - s] >> s);
    for (int k = 1; k < s; ++k) {
      if ((a >> (s - 1 - k)) & 1u) v[i] ^= v[i - k];
    }
  }
  return v;
}

}  // namespace

std::uint32_t sobol(std::uint32_t index, int dimension) {
  static const std::array<DirectionNumbers, 3> kNumbers = {direction_numbers(1, 0, {1, 0, 0}),
                                                           direction_numbers(2, 1, {1, 3, 0}),
                                                           direction_numbers(3, 1, {1, 3, 1})};
  if (dimension == 0) return reverse_bits(index);
  const DirectionNumbers& v = kNumbers[static_cast<std::size_t>(dimension - 1)];
  std::uint32_t result = 0;
  for (int bit = 0; index != 0; ++bit, index >>= 1) {
    if (index & 1u) result ^= v[static_cast<std::size_t>(bit)];
  }
  return result;
}

std::uint32_t owen_scrambled(std::uint32_t fraction, std::uint32_t seed) {
  // A hash in which each bit is changed only by lower bits, applied to the reversed number, is a
  // nested scramble of the number itself.
  std::uint32_t x = reverse_bits(fraction);
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return reverse_bits(x);
}

}  // namespace abbe
