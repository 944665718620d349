#include "abbe/session/exposure.h"

#include <algorithm>
#include <cmath>

#include "abbe/display/display.h"
#include "abbe/render/render.h"

namespace abbe {

double metered_exposure_ev(const PreparedScene& prepared, const RenderSettings& settings,
                           const LitWorld& world) {
  constexpr int kWidth = 96, kSamples = 4;
  RenderSettings coarse = settings;
  coarse.crop.reset();
  coarse.aovs.clear();
  coarse.bands.reset();
  coarse.noise = 0.0;
  coarse.samples_per_pixel = kSamples;
  if (settings.size.x > kWidth) {
    coarse.size = {kWidth,
                   std::max(1, static_cast<int>(std::lround(static_cast<double>(settings.size.y) *
                                                            kWidth / settings.size.x)))};
  }
  Film film(film_options(coarse));
  (void)render(world, prepared.chosen_camera(), coarse, film);
  const Image image = film.develop({.xyz_to_rec709 = world.lanes.film_to_rec709()});
  return std::round(100.0 * auto_exposure_ev(image)) / 100.0;
}

}  // namespace abbe
