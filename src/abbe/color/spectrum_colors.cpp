#include "abbe/color/spectrum_colors.h"

#include <algorithm>

#include "abbe/base/constants.h"
#include "abbe/color/color.h"

namespace abbe {
namespace {

Vec3d inside_gamut(double wavelength_nm, const Observer& observer) {
  const Vec3d xyz(observer.x_bar.value(wavelength_nm), observer.y_bar.value(wavelength_nm),
                  observer.z_bar.value(wavelength_nm));
  const Vec3d rgb_rec709 = xyz_to_rec709() * xyz;
  return rgb_rec709 - Vec3d(std::min({rgb_rec709.x, rgb_rec709.y, rgb_rec709.z, 0.0}));
}

Vec3d encoded(const Vec3d& rgb_rec709) {
  return {srgb_encode(std::clamp(rgb_rec709.x, 0.0, 1.0)),
          srgb_encode(std::clamp(rgb_rec709.y, 0.0, 1.0)),
          srgb_encode(std::clamp(rgb_rec709.z, 0.0, 1.0))};
}

double highest(const Vec3d& rgb) {
  return std::max({rgb.x, rgb.y, rgb.z});
}

}  // namespace

SpectrumColors::SpectrumColors(const Observer& observer) : observer_(observer) {
  for (double nm = kRangeMin_nm; nm <= kRangeMax_nm; nm += 1.0) {
    brightest_ = std::max(brightest_, highest(inside_gamut(nm, observer)));
  }
}

Vec3d SpectrumColors::at(double wavelength_nm) const {
  return encoded(inside_gamut(wavelength_nm, observer_) / brightest_);
}

Vec3d SpectrumColors::bright_at(double wavelength_nm) const {
  const Vec3d rgb_rec709 = inside_gamut(wavelength_nm, observer_);
  const double high = highest(rgb_rec709);
  return high > 0.0 ? encoded(rgb_rec709 / high) : Vec3d(0.0);
}

}  // namespace abbe
