/// What abbe makes of an optical setup.
#pragma once

#include <vector>

#include "abbe/render/settings.h"
#include "support/forward/setup.h"

namespace abbe::test {

/// One wavelength, one pixel a cell, box filter.
RenderSettings setup_settings(const OpticalSetup& setup, double wavelength_nm);

/// Irradiance of each cell, rows from +y to −y, in units of the setup.
std::vector<double> rendered_irradiance(const OpticalSetup& setup, const RenderSettings& settings);

}  // namespace abbe::test
