/// Which colours a reflectance can have.
#pragma once

#include "abbe/math/vec.h"

namespace abbe {

/// Whether some reflectance in [0, 1] has this colour under D65 for the CIE 1931 observer: whether
/// it lies in the object-colour solid, whose surface are MacAdam's optimal colours. All of Rec.709
/// does; of wider gamuts the bright saturated corners do not.
/// Domain: any finite colour.
/// Source: MacAdam, JOSA 25(11), 1935.
bool is_object_color(const Vec3d& rgb_rec709);

}  // namespace abbe
