/// How bright a scene is shown.
#pragma once

#include "abbe/caustics/lit_world.h"
#include "abbe/render/settings.h"
#include "abbe/session/prepare.h"

namespace abbe {

/// Attribute of a rendered EXR: the EV at which display images show it unless told otherwise.
inline constexpr const char* kExposureAttribute = "abbe:exposure";

/// auto_exposure_ev() of a small render of the whole image (at most 96 pixels wide, 4 samples), to
/// 0.01 EV, so that a crop is shown as the whole is.
/// Domain: `world` was made of the scene for these settings.
double metered_exposure_ev(const PreparedScene& prepared, const RenderSettings& settings,
                           const LitWorld& world);

}  // namespace abbe
