/// A probe as text for people and as JSON for programs.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "abbe/session/lit_place.h"
#include "abbe/session/probe.h"

namespace abbe {

/// What of a probe is told.
struct ProbeView {
  bool all_lanes = false;     ///< Otherwise the first, the middle and the last of each fan.
  double least_weight = 0.0;  ///< Fainter rays are only counted.
  std::string hint = {};      ///< Put behind their number.
};

/// All that is known of a pixel.
struct PixelProbe {
  Vec2i pixel{0}, size{0};
  std::optional<std::uint32_t> sample;  ///< Of the pixel; none: its centre.
  std::string mode, camera;             ///< Names.
  Vec3d origin{0.0};                    ///< Of the camera ray.
  Vec3f direction{0.0f};
  std::span<const ProbeNode> nodes;
  std::optional<LitPlace> lit;
};

/// An indented tree, at most 150 columns wide; deep nodes state their depth instead of more indent.
std::string tree_text(std::span<const ProbeNode> nodes, const ProbeView& view);

/// The camera ray, the tree, and the light if it was looked for.
std::string probe_text(const PixelProbe& probe, const ProbeView& view);

/// Every node and lane; angles in degrees, positions in metres.
std::string probe_json(const PixelProbe& probe);

}  // namespace abbe
