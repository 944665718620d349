/// Sets of wavelength lanes.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "abbe/base/constants.h"

namespace abbe {

/// A set of wavelength lanes.
class LaneMask {
 public:
  static LaneMask first(int count) {
    LaneMask mask;
    for (int lane = 0; lane < count; ++lane) mask.set(lane);
    return mask;
  }
  void set(int lane) { words_[lane >> 6] |= std::uint64_t{1} << (lane & 63); }
  void reset(int lane) { words_[lane >> 6] &= ~(std::uint64_t{1} << (lane & 63)); }
  bool test(int lane) const { return (words_[lane >> 6] >> (lane & 63)) & 1u; }
  bool any() const { return (words_[0] | words_[1]) != 0; }
  int count() const { return std::popcount(words_[0]) + std::popcount(words_[1]); }
  /// Number of the first lane. Domain: any().
  int front() const {
    return words_[0] != 0 ? std::countr_zero(words_[0]) : 64 + std::countr_zero(words_[1]);
  }
  /// Lanes [16·block, 16·block + 16) as bits 0 to 15.
  std::uint32_t block16(int block) const {
    return static_cast<std::uint32_t>(words_[block >> 2] >> ((block & 3) * 16)) & 0xffffu;
  }

  /// Adds the lanes that are set in `bits`, likewise.
  void set_block16(int block, std::uint32_t bits) {
    words_[block >> 2] |= static_cast<std::uint64_t>(bits) << ((block & 3) * 16);
  }
  friend LaneMask operator&(const LaneMask& a, const LaneMask& b) {
    LaneMask both;
    for (std::size_t i = 0; i < 2; ++i) both.words_[i] = a.words_[i] & b.words_[i];
    return both;
  }
  friend LaneMask operator|(const LaneMask& a, const LaneMask& b) {
    LaneMask either;
    for (std::size_t i = 0; i < 2; ++i) either.words_[i] = a.words_[i] | b.words_[i];
    return either;
  }
  /// The lanes of a that are not in b.
  friend LaneMask operator-(const LaneMask& a, const LaneMask& b) {
    LaneMask rest;
    for (std::size_t i = 0; i < 2; ++i) rest.words_[i] = a.words_[i] & ~b.words_[i];
    return rest;
  }
  bool operator==(const LaneMask&) const = default;

 private:
  std::array<std::uint64_t, 2> words_{0, 0};
  static_assert(kMaxLanes <= 128);
};

}  // namespace abbe
