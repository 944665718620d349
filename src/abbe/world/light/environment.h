/// Light from all around, ready to be looked up and sampled.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "abbe/math/vec.h"
#include "abbe/scene/scene.h"
#include "abbe/world/lanes.h"
#include "abbe/world/light/light_cells.h"
#include "abbe/world/rows.h"

namespace abbe {

/// An environment whose texels are light of their own: uplifted each, then filtered bilinearly.
class WorldEnvironment {
 public:
  WorldEnvironment(std::shared_ptr<const Environment> source, const LaneModel& lanes, Rows& rows);

  /// Whether camera rays see it.
  bool is_visible() const { return source_->visible; }

  /// Radiance per lane that arrives from a direction, in the units of LaneModel::emission.
  /// Shape: `out` has lane_stride values.
  void radiance(const LaneModel& lanes, const Rows& rows, int set, const Vec3f& direction,
                float* out) const;

  /// Where its light comes from: by the radiance and the solid angle of the parts of the image
  /// between texel centres.
  const LightCells& cells() const { return cells_; }

 private:
  struct Taps {
    std::size_t texel[4];
    float weight[4];
  };
  Taps taps(const Vec3f& direction) const;
  void tabulate_colors(const LaneModel& lanes);
  void tabulate_cells();

  std::shared_ptr<const Environment> source_;
  int width_ = 0, height_ = 0;
  float turn_ = 0.0f;  ///< Rotation as a share of a full turn.
  bool is_rgb_ = false;
  RowId white_ = 0;  ///< The light that is reflected: of 1 cd/m², or of 1 in every band.
  RowId abscissa_ = 0;
  RowId basis_[3] = {0, 0, 0};
  std::vector<Vec4f> texels_;  ///< Coefficients or channels, and their scale; empty with bands.
  LightCells cells_;
};

/// The environment of a scene. Null where there is none, or it is black by its scale.
std::shared_ptr<const WorldEnvironment> tabulate_environment(const Scene& scene,
                                                             const LaneModel& lanes, Rows& rows);

}  // namespace abbe
