/// The paths on which light of a lamp comes to what a pixel shows, as a drawing.
#pragma once

#include <string>

#include "abbe/report/figures/rays.h"
#include "abbe/session/lit_place.h"
#include "abbe/spectrum/observer.h"

namespace abbe {

/// Chains in the colours of their wavelengths, numbered facets and a table of the middle one's
/// angles. `observer` is whose colours they are.
RayFigure light_figure(const LitPlace& lit, const std::string& title, const Observer& observer);

}  // namespace abbe
