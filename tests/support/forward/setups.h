/// Small setups with light through and off flat bodies, made in code.
#pragma once

#include <string>
#include <vector>

#include "support/forward/setup.h"

namespace abbe::test {

/// All of them, each under a directional lamp ("…_sun") and a point lamp ("…_point").
std::vector<OpticalSetup> optical_setups();
/// The one of a name. Errors: std::invalid_argument.
OpticalSetup optical_setup(const std::string& name);

/// A wall at x = 0.5 m, lit from −X, a little from below.
OpticalSetup before_wall(LampKind kind);
/// Panes of N-BK7, 8 mm thick, with gaps between them, before that wall.
OpticalSetup panes(LampKind kind, int count, double gap_m);

}  // namespace abbe::test
