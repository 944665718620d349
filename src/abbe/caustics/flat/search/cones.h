/// The search for the chains of a point or spot light: its light is cut into narrow cones, and each
/// is followed over the faces that it may meet.
#pragma once

#include <cstdint>
#include <functional>
#include <tuple>
#include <vector>

#include "abbe/caustics/flat/search/beam_cone.h"
#include "abbe/caustics/flat/search/paths.h"

namespace abbe {

/// A face on the path of a cone, and what happens there.
struct FaceEvent {
  std::uint32_t face = 0;
  ChainEvent event = ChainEvent::Enter;

  bool operator<(const FaceEvent& other) const {
    return std::tie(face, event) < std::tie(other.face, other.event);
  }
};

/// A narrow cone of light that took a path and leaves from its last face.
struct ConeOnPath {
  std::uint32_t part = 0;  ///< Of the lamp's light; wavelengths of a part follow each other.
  std::vector<FaceEvent> path;
  std::vector<Vec3d> axes;  ///< Before the first face and behind each, in the world.
  BeamCone cone;            ///< Behind the last face; world coordinates.
  LaneMask lanes;           ///< That are followed over the path.
  double flux = 0.0;        ///< Of the whole path.
  double sent = 0.0;        ///< The same before it lost any on its way.
};

/// Follows all light of a point or spot light over the paths of a tree, and shows the cones one
/// after the other: together they would take gigabytes.
void search_cones(const ChainSearch& search, const PathTree& tree, const Light& light,
                  const std::function<void(const ConeOnPath&)>& show);

}  // namespace abbe
