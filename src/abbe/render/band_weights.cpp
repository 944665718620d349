#include "abbe/render/band_weights.h"

#include <algorithm>
#include <map>

namespace abbe {
namespace {

/// A wavelength at which light is known.
struct Node {
  double nm = 0.0;
  int set = 0;
  int lane = 0;
};

// ∫ over [a, b] of the hat that is 1 at `here` and 0 at `other`, both ends of it within them.
double part_of_hat(double here, double other, double a, double b) {
  const double width = other - here;
  const auto height = [&](double nm) { return 1.0 - (nm - here) / width; };
  return 0.5 * (height(a) + height(b)) * (b - a);
}

}  // namespace

BandWeights::BandWeights(const WavelengthQuadrature& quadrature, const BandOptions& bands,
                         std::span<const int> sets) {
  std::map<int, int> uses;
  for (const int set : sets) ++uses[set];
  std::vector<Node> nodes;
  entries_.resize(static_cast<std::size_t>(quadrature.set_count()));
  const auto samples = static_cast<double>(sets.size());
  for (const auto& [set, count] : uses) {
    const std::span<const float> nm = quadrature.wavelengths_nm(set);
    for (int lane = 0; lane < quadrature.lane_count(); ++lane) {
      const double at_nm = static_cast<double>(nm[static_cast<std::size_t>(lane)]);
      if (quadrature.kinds()[static_cast<std::size_t>(lane)] == LaneKind::Continuous) {
        nodes.push_back({at_nm, set, lane});
      } else if (const auto band = bands.index_of(at_nm)) {
        // Every sample has every line: the mean over the samples is the line.
        entries_[static_cast<std::size_t>(set)].push_back(
            {lane, *band,
             static_cast<float>(1.0 / bands.step_nm) *
                 quadrature.weights_nm(set)[static_cast<std::size_t>(lane)]});
      }
    }
  }
  std::sort(nodes.begin(), nodes.end(), [](const Node& a, const Node& b) { return a.nm < b.nm; });

  // Adds `share(low, high)`, an integral, of a node to all bands that [from, to] meets.
  const auto add = [&](const Node& node, double from, double to, const auto& share) {
    from = std::max(from, bands.low_nm(0));
    to = std::min(to, bands.low_nm(bands.count()));
    for (int band = bands.index_of(from).value_or(bands.count()); band < bands.count(); ++band) {
      const double low = std::max(from, bands.low_nm(band));
      const double high = std::min(to, bands.low_nm(band + 1));
      if (!(low < high)) break;
      const double weight = share(low, high) / bands.step_nm * samples / uses[node.set];
      auto& entries = entries_[static_cast<std::size_t>(node.set)];
      if (!entries.empty() && entries.back().lane == node.lane && entries.back().band == band) {
        entries.back().weight += static_cast<float>(weight);
      } else {
        entries.push_back({node.lane, band, static_cast<float>(weight)});
      }
    }
  };
  const auto whole = [](double low, double high) { return high - low; };
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Node& node = nodes[i];
    if (i == 0) {
      add(node, quadrature.range_min_nm(), node.nm, whole);
    } else {
      add(node, nodes[i - 1].nm, node.nm, [&](double low, double high) {
        return part_of_hat(node.nm, nodes[i - 1].nm, low, high);
      });
    }
    if (i + 1 == nodes.size()) {
      add(node, node.nm, quadrature.range_max_nm(), whole);
    } else {
      add(node, node.nm, nodes[i + 1].nm, [&](double low, double high) {
        return part_of_hat(node.nm, nodes[i + 1].nm, low, high);
      });
    }
  }
}

void BandWeights::apply(int set, std::span<const float> radiance, std::span<float> bands) const {
  std::fill(bands.begin(), bands.end(), 0.0f);
  for (const Entry& entry : entries_[static_cast<std::size_t>(set)]) {
    bands[static_cast<std::size_t>(entry.band)] +=
        entry.weight * radiance[static_cast<std::size_t>(entry.lane)];
  }
}

}  // namespace abbe
