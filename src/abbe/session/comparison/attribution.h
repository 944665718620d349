/// Who did it: a difference shared out among its causes.
///
/// The causes are players of a game whose value v(S), per pixel, is the difference between the
/// image with the causes S switched on and the one with none. Their shares are Shapley values: the
/// mean of what a cause adds over all orders in which the causes could be switched on. They add up
/// to v(all), and a cause that changes nothing has none of it. Source: Shapley, A value for
/// n-person games, Contributions to the Theory of Games II, 1953.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

namespace abbe {

/// Players that are switched on, a bit for each.
using Coalition = std::uint32_t;

/// From which coalitions shares are made.
enum class AttributionMethod {
  /// From each cause alone and all causes but each: the mean of its first and its last effect. That
  /// is the Shapley value where causes act on each other in pairs, and in any game of up to two
  /// players; with three, all coalitions are at hand and the value is exact. What is left over is
  /// the interaction of more.
  FirstAndLast,
  Shapley,  ///< From all 2^n coalitions: nothing is left over.
};

/// The coalitions whose values are needed, none and all left out, in rising order.
/// Domain: up to 16 players.
std::vector<Coalition> coalitions_needed(int players, AttributionMethod method);

/// Per player and pixel; may be negative where a cause makes the images more alike.
struct Attribution {
  std::vector<std::vector<float>> shares;
  std::vector<float> interaction;  ///< v(all) less all shares.
};

/// Shape:  a value per pixel for no player (0), all players, and coalitions_needed.
Attribution attribute(int players, AttributionMethod method,
                      const std::map<Coalition, std::vector<float>>& values);

/// The player with the largest share of each pixel, −1 where the whole is below `least`.
std::vector<int> dominant_players(const Attribution& attribution, const std::vector<float>& whole,
                                  double least);

}  // namespace abbe
