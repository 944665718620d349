// A whole shared out among its causes: games whose answers are known.

#include "abbe/session/comparison/attribution.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <functional>

namespace abbe {
namespace {

using testing::ElementsAre;

std::map<Coalition, std::vector<float>> values_of(int players, AttributionMethod method,
                                                  const std::function<double(Coalition)>& game) {
  std::map<Coalition, std::vector<float>> values;
  std::vector<Coalition> coalitions = coalitions_needed(players, method);
  coalitions.push_back(0);
  coalitions.push_back((Coalition{1} << players) - 1u);
  for (const Coalition coalition : coalitions) {
    values[coalition] = {static_cast<float>(game(coalition))};
  }
  return values;
}

std::vector<double> shares(int players, AttributionMethod method,
                           const std::function<double(Coalition)>& game) {
  const Attribution result = attribute(players, method, values_of(players, method, game));
  std::vector<double> all;
  for (const auto& share : result.shares) all.push_back(static_cast<double>(share[0]));
  all.push_back(static_cast<double>(result.interaction[0]));
  return all;
}

bool has(Coalition coalition, int player) {
  return (coalition >> player & 1u) != 0;
}

TEST(Attribution, what_adds_up_belongs_to_who_adds_it) {
  const auto game = [](Coalition c) { return 3.0 * has(c, 0) + 5.0 * has(c, 2) - 1.0 * has(c, 3); };
  for (const auto method : {AttributionMethod::Shapley, AttributionMethod::FirstAndLast}) {
    EXPECT_THAT(shares(4, method, game), ElementsAre(3.0, 0.0, 5.0, -1.0, 0.0));
  }
}

TEST(Attribution, what_two_make_together_is_halved) {
  const auto game = [](Coalition c) { return has(c, 0) && has(c, 1) ? 8.0 : 0.0; };
  for (const auto method : {AttributionMethod::Shapley, AttributionMethod::FirstAndLast}) {
    EXPECT_THAT(shares(2, method, game), ElementsAre(4.0, 4.0, 0.0));
    EXPECT_THAT(shares(5, method, game), ElementsAre(4.0, 4.0, 0.0, 0.0, 0.0, 0.0));
  }
}

TEST(Attribution, glove_game_has_the_shares_of_the_textbook) {
  // One owns a left glove, two own right ones; a pair is worth 1: 4/6, 1/6, 1/6.
  const auto game = [](Coalition c) { return has(c, 0) && (has(c, 1) || has(c, 2)) ? 1.0 : 0.0; };
  const std::vector<double> result = shares(3, AttributionMethod::FirstAndLast, game);
  EXPECT_NEAR(result[0], 4.0 / 6.0, 1e-6);  // Single precision.
  EXPECT_NEAR(result[1], 1.0 / 6.0, 1e-6);
  EXPECT_NEAR(result[2], 1.0 / 6.0, 1e-6);
  EXPECT_NEAR(result[3], 0.0, 1e-6);
}

TEST(Attribution, what_four_make_together_is_left_as_interaction_or_shared) {
  const auto game = [](Coalition c) { return c == 15u ? 8.0 : 0.0; };
  // Nothing at first, all of it at last: half of 8 for each of four, 8 too much.
  EXPECT_THAT(shares(4, AttributionMethod::FirstAndLast, game),
              ElementsAre(4.0, 4.0, 4.0, 4.0, -8.0));
  EXPECT_THAT(shares(4, AttributionMethod::Shapley, game), ElementsAre(2.0, 2.0, 2.0, 2.0, 0.0));
}

TEST(Attribution, coalitions_are_few_without_shapley) {
  EXPECT_THAT(coalitions_needed(0, AttributionMethod::Shapley), ElementsAre());
  EXPECT_THAT(coalitions_needed(1, AttributionMethod::Shapley), ElementsAre());
  EXPECT_THAT(coalitions_needed(2, AttributionMethod::FirstAndLast), ElementsAre(1u, 2u));
  EXPECT_EQ(coalitions_needed(5, AttributionMethod::FirstAndLast).size(), 10u);
  EXPECT_EQ(coalitions_needed(5, AttributionMethod::Shapley).size(), 30u);
}

TEST(Attribution, dominant_is_the_largest_where_anything_can_be_seen) {
  Attribution attribution;
  attribution.shares = {{0.1f, 5.0f, -2.0f}, {0.2f, 1.0f, -1.0f}};
  EXPECT_THAT(dominant_players(attribution, {0.3f, 6.0f, 3.0f}, 1.0), ElementsAre(-1, 0, -1));
}

}  // namespace
}  // namespace abbe
