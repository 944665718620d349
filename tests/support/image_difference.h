/// How far apart two renders are, as seen.
#pragma once

#include "abbe/image/image.h"

namespace abbe::test {

/// Mean CIEDE2000 over the pixels of two images, of their R, G, B under a D65 white of 1.
double mean_delta_e2000(const Image& first, const Image& second);

}  // namespace abbe::test
