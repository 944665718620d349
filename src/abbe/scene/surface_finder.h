/// What a ray meets in a scene as it was described, found without an accelerator: for the few rays
/// by which a scene is judged before anything is built.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "abbe/math/vec.h"
#include "abbe/scene/scene.h"

namespace abbe {

/// Where a ray meets a surface.
struct FoundSurface {
  double distance_m = 0.0;
  std::uint32_t instance = 0;
  std::uint32_t material = 0;
  Vec3d normal{0.0};      ///< Geometric, of unit length, to the front.
  bool is_front = false;  ///< Whether the ray comes from there.
};

/// Asks every shape and every triangle whose instance's box a ray meets, in double precision.
/// Domain: a scene that validate() accepts and that outlives the finder.
class SurfaceFinder {
 public:
  /// Whether a side of a material counts.
  using Counts = std::function<bool(const Material& material, bool is_front)>;

  explicit SurfaceFinder(const Scene& scene);

  /// The nearest surface that counts, beyond `from_m`; direction of unit length.
  std::optional<FoundSurface> first(const Vec3d& origin, const Vec3d& direction, double from_m,
                                    const Counts& counts) const;

  /// Triangles and shapes of all instances: what a ray costs at most.
  std::uint64_t size() const { return size_; }

 private:
  const Scene& scene_;
  std::vector<Box3d> boxes_;
  std::uint64_t size_ = 0;
};

}  // namespace abbe
