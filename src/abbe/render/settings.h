/// What shapes an image, resolved: the same settings give the same pixels.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "abbe/caustics/lit_world.h"
#include "abbe/film/bands.h"
#include "abbe/film/film.h"
#include "abbe/math/vec.h"
#include "abbe/spectrum/wavelength_set.h"
#include "abbe/world/lanes.h"

namespace abbe {

/// RenderSettings::noise of a picture that a person takes for finished, and the most samples a
/// pixel takes for it.
inline constexpr double kFinishedNoise = 1.5;
inline constexpr int kMostSamples = 256;

/// Every field has a default; check_settings says what each may be, and its errors name fields.
struct RenderSettings {
  Mode mode = Mode::Spectral;
  Vec2i size{960, 540};
  std::optional<PixelRect> crop;  ///< The pixels rendered; none: all of `size`.
  int samples_per_pixel = 16;     ///< With `noise`: at most so many.
  /// Visible error at which a pixel needs no more samples, CIEDE2000; 0: all have the same number.
  double noise = 0.0;
  double noise_exposure_ev = 0.0;  ///< At which it is judged: the display's.
  WavelengthOptions wavelengths;
  std::optional<BandOptions> bands;  ///< Spectral channels beside R, G and B.
  std::string filter = "gaussian";   ///< Of filter_names().
  int max_depth = 16;                ///< Most surfaces a path may leave.
  double cutoff = 2e-2;              ///< Weight below which a fan no longer branches.
  bool drop = false;  ///< End such fans instead of following one child; loses energy.
  Uplift uplift = Uplift::JakobHanika;  ///< Of the scene's RGB colours, in spectral mode.
  bool caustics = true;        ///< Light bent by flat facets exactly; else straight shadow rays.
  int inner_reflections = 16;  ///< Most of them inside of bodies, on a chain of facets.
  bool multiple_scattering = false;    ///< Of rough metals, among their microfacets.
  std::uint32_t seed = 0;              ///< Of the sampling pattern.
  std::vector<std::string> aovs;       ///< Groups of extra channels, of aov_names().
  int threads = 0;                     ///< 0: all cores. Never shapes the image.
  std::string accelerator = "kdtree";  ///< One of accelerator_names(). Never shapes the image.
  CauseSet frozen;                     ///< Held as the mode `rgb` has them; spectral mode only.
  int cluster_lanes = 0;               ///< IntegratorSettings::cluster_lanes: benchmarks only.
};

/// Groups of extra channels: Z, P, N, albedo, UV, objectId, materialId, cost; direct,
/// ambient, emitted, reflected, refracted: parts of the light; spectralAlbedo; samples.
std::vector<std::string> aov_names();

/// How the world and the light in it have to be made for these settings.
WorldOptions world_options(const RenderSettings& settings);
CausticOptions caustic_options(const RenderSettings& settings);

/// Errors: usage Error for values out of range, unknown names and contradictions.
void check_settings(const RenderSettings& settings);

/// The image size when none is asked for: 540 rows in the camera's shape, 960×540 without one.
Vec2i default_size(const Camera& camera);

}  // namespace abbe
