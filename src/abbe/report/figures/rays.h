/// Drawings of rays, as SVG: what passes through bodies, in the plane that shows it best.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "abbe/math/vec.h"
#include "abbe/world/world.h"

namespace abbe {

/// A ray, or several on one path, from its start to its end.
struct FigureRay {
  Vec3d from{0.0}, to{0.0};
  std::string color;  ///< `#rrggbb`
  double opacity = 1.0;
  double width_px = 1.6;
  bool has_arrow = false;
};

/// Where a ray meets a surface: its normal, the angles to it, and a number that a row of the table
/// takes up.
struct FigureCrossing {
  Vec3d place{0.0};
  Vec3d normal{0.0};               ///< Unit length, either side.
  Vec3d arrives{0.0};              ///< Unit direction of the ray that comes.
  std::optional<Vec3d> refracted;  ///< Unit direction of the ray that goes on behind.
  double incidence_deg = 0.0;
  std::optional<double> refraction_deg;
  std::uint32_t surface = 0;  ///< Its body is drawn, too.
};

/// A plane to draw in, with axes to the right and up.
struct FigurePlane {
  Vec3d right{1.0, 0.0, 0.0}, up{0.0, 1.0, 0.0};
  Vec3d normal{0.0, 0.0, 1.0};  ///< Towards the reader.
  double distance_m = 0.0;      ///< normal·x of the plane.

  Vec2d project(const Vec3d& p) const { return {glm::dot(right, p), glm::dot(up, p)}; }
};

/// A drawing of rays, as values.
struct RayFigure {
  std::string title;
  std::vector<std::string> notes;  ///< Lines below the title.
  std::vector<FigureRay> rays;
  std::vector<FigureCrossing> crossings;
  /// Wavelengths in nm and their colours, for the key; empty in the RGB modes.
  std::vector<std::pair<double, std::string>> key;
  std::vector<std::string> columns;  ///< Heads of the table after the number of a crossing.
  std::vector<std::vector<std::string>> rows;  ///< One per crossing.
};

/// The plane of incidence, averaged over the crossings; where light meets every surface head on,
/// any plane that holds it. Rays go to the right, and what is up in the scene is up, or the reader
/// looks down from above.
FigurePlane plane_of(const RayFigure& figure);

/// The document.
/// Domain: at least one ray.
std::string figure_svg(const RayFigure& figure, const World& world);

}  // namespace abbe
