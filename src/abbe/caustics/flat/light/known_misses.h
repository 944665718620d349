/// Where chains of point lights are known to light nothing: most places lie close to others that
/// were asked about.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "abbe/math/vec.h"

namespace abbe {

/// How a path to a place leaves the outline of a face that it ought to cross, and what becomes of
/// that nearby.
struct Miss {
  float outside_m = 0.0f;  ///< By so much; 0: not known.
  Vec3f per_m{0.0f};       ///< How that grows with the place.
  float stretch = 0.0f;    ///< The most that the crossing moves per metre of the place.
  float even_m = 0.0f;     ///< A distance over which these change as a whole.

  /// Whether paths to all places of a ball at an offset certainly leave it, too. What is not even
  /// is taken six times.
  bool holds(const Vec3f& offset_m, float radius_m) const {
    const float far_m = glm::length(offset_m) + radius_m;
    if (!(far_m < 0.5f * even_m)) return false;
    const float uneven_m = stretch * (radius_m + 6.0f * far_m * far_m / even_m);
    return outside_m + glm::dot(per_m, offset_m) > uneven_m;
  }
};

/// The last misses of each of some chains. One thread's.
class KnownMisses {
 public:
  /// Forgets all; chains have numbers below `chains`.
  void start(std::size_t chains) {
    if (of_chains_.size() != chains) of_chains_.assign(chains, {});
    for (const std::uint32_t chain : known_) of_chains_[chain].count = 0;
    known_.clear();
  }

  void add(std::uint32_t chain, const Vec3f& place, const Miss& miss) {
    if (!(miss.outside_m > 0.0f)) return;
    OfChain& of_chain = of_chains_[chain];
    if (of_chain.count == 0) known_.push_back(chain);
    of_chain.last[of_chain.count++ % kKept] = {place, miss};
  }

  /// Whether a chain certainly lights no place of a ball.
  bool hold(std::uint32_t chain, const Vec3f& center, float radius_m) const {
    const OfChain& of_chain = of_chains_[chain];
    const std::size_t count = std::min<std::size_t>(of_chain.count, kKept);
    for (std::size_t i = 0; i < count; ++i) {
      const Known& known = of_chain.last[i];
      if (known.miss.holds(center - known.place, radius_m)) return true;
    }
    return false;
  }

 private:
  // Places that are asked about one after the other go to and fro.
  static constexpr std::size_t kKept = 8;

  struct Known {
    Vec3f place{0.0f};
    Miss miss;
  };
  struct OfChain {
    std::uint32_t count = 0;  ///< Of all that were added.
    std::array<Known, kKept> last;
  };

  std::vector<OfChain> of_chains_;
  std::vector<std::uint32_t> known_;
};

}  // namespace abbe
