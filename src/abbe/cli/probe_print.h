/// A probe's tree as text for people and as JSON for programs.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "abbe/cli/probe_tree.h"

namespace abbe {

struct ProbeView {
  bool all_lanes = false;     ///< Otherwise the first, the middle and the last of each fan.
  double least_weight = 0.0;  ///< Fainter rays are only counted.
};

/// An indented tree, at most 150 columns wide; deep nodes state their depth instead of more indent.
std::string probe_text(std::span<const ProbeNode> nodes, const ProbeView& view);

/// `0.364119 0.000000 -0.931352`.
std::string direction_text(const Vec3d& direction);

/// Every node and lane; angles in degrees, positions in metres.
nlohmann::ordered_json probe_json(std::span<const ProbeNode> nodes);

}  // namespace abbe
