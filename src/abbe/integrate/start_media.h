/// The media that a place is in.
#pragma once

#include "abbe/integrate/surface/media.h"
#include "abbe/math/vec.h"

namespace abbe {

/// The media that a ray begins in, by what it would leave on a straight way out: bodies whose backs
/// it meets before their fronts. Open surfaces count where their boxes hold the place.
MediumStack start_media(const World& world, const Vec3f& place, const Vec3f& direction);

}  // namespace abbe
