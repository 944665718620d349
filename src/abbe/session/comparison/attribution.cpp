#include "abbe/session/comparison/attribution.h"

#include <bit>
#include <cstddef>

namespace abbe {
namespace {

Coalition all_of(int players) {
  return (Coalition{1} << players) - 1u;
}

bool has_all_coalitions(int players, AttributionMethod method) {
  return method == AttributionMethod::Shapley || players <= 3;
}

/// A coalition, and how much its value counts in the share of a player.
struct Term {
  Coalition coalition = 0;
  double weight = 0.0;
};

std::vector<Term> terms_of(int player, int players, AttributionMethod method) {
  const Coalition own = Coalition{1} << player;
  const Coalition all = all_of(players);
  if (!has_all_coalitions(players, method)) {
    return {{own, 0.5}, {0, -0.5}, {all, 0.5}, {all & ~own, -0.5}};
  }
  // |S|! (n − |S| − 1)!/n! = 1/(n · C(n − 1, |S|)).
  std::vector<double> weight(static_cast<std::size_t>(players));
  double choices = 1.0;
  for (int size = 0; size < players; ++size) {
    weight[static_cast<std::size_t>(size)] = 1.0 / (players * choices);
    choices *= static_cast<double>(players - 1 - size) / (size + 1);
  }
  std::vector<Term> terms;
  for (Coalition coalition = 0; coalition <= all; ++coalition) {
    if ((coalition & own) != 0) continue;
    const double here = weight[static_cast<std::size_t>(std::popcount(coalition))];
    terms.push_back({coalition | own, here});
    terms.push_back({coalition, -here});
  }
  return terms;
}

}  // namespace

std::vector<Coalition> coalitions_needed(int players, AttributionMethod method) {
  const Coalition all = all_of(players);
  std::vector<Coalition> needed;
  for (Coalition coalition = 1; coalition < all; ++coalition) {
    const int size = std::popcount(coalition);
    if (has_all_coalitions(players, method) || size == 1 || size == players - 1) {
      needed.push_back(coalition);
    }
  }
  return needed;
}

Attribution attribute(int players, AttributionMethod method,
                      const std::map<Coalition, std::vector<float>>& values) {
  const std::vector<float>& whole = values.at(all_of(players));
  const std::size_t pixels = whole.size();
  Attribution result;
  std::vector<double> rest(whole.begin(), whole.end());
  for (int player = 0; player < players; ++player) {
    std::vector<double> sum(pixels, 0.0);
    for (const Term& term : terms_of(player, players, method)) {
      const std::vector<float>& value = values.at(term.coalition);
      for (std::size_t p = 0; p < pixels; ++p)
        sum[p] += term.weight * static_cast<double>(value[p]);
    }
    for (std::size_t p = 0; p < pixels; ++p) rest[p] -= sum[p];
    result.shares.emplace_back(sum.begin(), sum.end());
  }
  // Without a player the whole, noise, belongs to nobody.
  result.interaction.assign(rest.begin(), rest.end());
  return result;
}

std::vector<int> dominant_players(const Attribution& attribution, const std::vector<float>& whole,
                                  double least) {
  std::vector<int> result(whole.size(), -1);
  for (std::size_t p = 0; p < whole.size(); ++p) {
    if (!(static_cast<double>(whole[p]) >= least)) continue;
    float largest = 0.0f;
    for (std::size_t player = 0; player < attribution.shares.size(); ++player) {
      if (attribution.shares[player][p] > largest) {
        largest = attribution.shares[player][p];
        result[p] = static_cast<int>(player);
      }
    }
  }
  return result;
}

}  // namespace abbe
