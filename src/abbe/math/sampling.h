/// Sample sequences and hashes, of which random.h makes the numbers of each use.
#pragma once

#include <cstdint>

namespace abbe {

/// A well-mixed 32-bit hash. Source: Wellons, "Prospecting for hash functions" (lowbias32).
inline std::uint32_t hash32(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  x ^= x >> 16;
  return x;
}

inline std::uint32_t hash32(std::uint32_t a, std::uint32_t b) {
  return hash32(a ^ (hash32(b) + 0x9e3779b9u + (a << 6) + (a >> 2)));
}

/// A well-mixed 64-bit hash. Source: Steele, Lea & Flood, SplitMix64 finaliser.
inline std::uint64_t hash64(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

/// The upper 24 bits as a number in [0, 1).
inline float unit_float(std::uint32_t bits) {
  return static_cast<float>(bits >> 8) * 0x1p-24f;
}

inline std::uint32_t reverse_bits(std::uint32_t x) {
  x = (x << 16) | (x >> 16);
  x = ((x & 0x00ff00ffu) << 8) | ((x & 0xff00ff00u) >> 8);
  x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);
  x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);
  x = ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);
  return x;
}

/// Point `index` of dimension 0 to 3 of Sobol's sequence, as a 32-bit fraction. Dimension 0 is van
/// der Corput's. Source: Joe & Kuo's primitive polynomials, ACM TOMS 29(1), 2003.
std::uint32_t sobol(std::uint32_t index, int dimension);

/// The fraction after a nested uniform (Owen) scramble chosen by `seed`: every power-of-two
/// stratification is kept. Source: Laine & Karras, CGF 30(4), 2011; Burley, JCGT 9(4), 2020.
std::uint32_t owen_scrambled(std::uint32_t fraction, std::uint32_t seed);

}  // namespace abbe
