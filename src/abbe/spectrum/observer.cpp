#include "abbe/spectrum/observer.h"

#include "abbe/base/constants.h"

namespace abbe {

Vec3d xyz_of(const Spectrum& spectrum, const Observer& observer) {
  return observer.responses_to_xyz * responses_of(spectrum, observer);
}

Vec3d responses_of(const Spectrum& spectrum, const Observer& observer) {
  return kLuminousEfficacy_lm_per_W * Vec3d(integral(spectrum, observer.x_bar),
                                            integral(spectrum, observer.y_bar),
                                            integral(spectrum, observer.z_bar));
}

}  // namespace abbe
