/// A scene made ready to trace: every spectrum tabulated for the lanes of the render, shapes
/// flattened into arrays and put into an accelerator.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "abbe/accel/accelerator.h"
#include "abbe/accel/touching.h"
#include "abbe/scene/scene.h"
#include "abbe/world/geometry.h"
#include "abbe/world/lanes.h"
#include "abbe/world/light/environment.h"
#include "abbe/world/light/lights.h"
#include "abbe/world/light/surroundings.h"
#include "abbe/world/materials.h"
#include "abbe/world/rows.h"
#include "abbe/world/texture.h"

namespace abbe {

class WorldEmitters;

/// What a scene is made of and what lights it, every spectrum a row of one value per lane.
struct TabulatedScene {
  LaneModel lanes;
  Rows rows;
  std::vector<float> xyz_weights;        ///< set_count × 3 × lane_stride
  std::vector<float> luminance_weights;  ///< set_count × lane_stride

  std::vector<SurfaceMaterial> materials;
  std::vector<WorldTexture> textures;
  std::vector<WorldLight> lights;
  std::optional<RowId> ambient;                         ///< Not beside an environment.
  std::shared_ptr<const WorldEnvironment> environment;  ///< Null: none.
  std::optional<WorldFog> fog;
  /// THE decision whether rough opaque dielectrics reflect what is around them by a sampled ray, as
  /// metals and glass always do: where there is an environment, or surfaces shine, which no
  /// highlight shows.
  bool shines_all_around = false;

  RowId d65 = 0;                 ///< Emission of D65 at 1 cd/m², for textured emission.
  RowId inverse_wavelength = 0;  ///< 1/λ of each lane in nm⁻¹, for the phases of thin films.
  /// For textured colours (color/uplift.h): s of each lane's wavelength, and the three curves of
  /// Mallett and Yuksel where they are used.
  RowId uplift_abscissa = 0;
  std::array<RowId, 3> uplift_basis{};

  const float* row(RowId id, int set) const { return rows.at(id, set); }
};

/// Errors: an input Error that names the scene where it has too many materials.
TabulatedScene tabulate(const Scene& scene, const WorldOptions& options, const Observer& observer,
                        const Spectrum& d65);

/// Mask of surfaces that let light pass and at which straight light of some lamps ends all the
/// same, because what passes them is found in another way; transparent for that of the others.
inline constexpr VisibilityMask kExactGlassBit = 4;

/// Everything that rays meet; nothing in it changes while they are traced.
struct World : TabulatedScene {
  Geometry geometry;
  std::unique_ptr<const Accelerator> accelerator;
  /// Which kinds of surfaces there are, as bits of the accelerator's masks.
  VisibilityMask visibility_bits = 0;
  /// Of each surface that bounds a medium, and of all of them.
  std::vector<Box3f> medium_boxes = {};
  Box3f media_bounds = {};
  /// Per primitive but those of shared meshes, which touch nothing; empty where nothing may touch
  /// anything.
  std::vector<Touching> touching = {};
  /// Surfaces that light others (world/emitters.h). Null: none.
  std::shared_ptr<const WorldEmitters> emitters = {};

  const Touching& touching_of(std::uint32_t primitive) const {
    static constexpr Touching kNothing{};
    return primitive < touching.size() ? touching[primitive] : kNothing;
  }
};

/// Puts what a scene is made of into an accelerator of that name.
/// Shape:  `ends_light` has a value per surface: other than 0, it gets kExactGlassBit.
/// Errors: those of build_accelerator.
World make_world(TabulatedScene tables, Geometry geometry, std::span<const std::uint8_t> ends_light,
                 const std::string& accelerator);

/// The emission spectra of a scene, scaled to what they contribute: for the wavelength density.
std::vector<Spectrum> lamp_spectra(const Scene& scene, const Spectrum& d65);

}  // namespace abbe
