/// Small setups with light through and off flat bodies, made in code.
#pragma once

#include <string>
#include <vector>

#include "support/forward/setup.h"

namespace abbe::test {

/// Names of all of them, each under a directional lamp ("…_sun") and a point lamp ("…_point").
std::vector<std::string> optical_setup_names();
/// Errors: std::invalid_argument for a name that is none of these.
OpticalSetup optical_setup(const std::string& name);

/// A wall at x = 0.5 m, lit from −X, a little from below.
OpticalSetup before_wall(LampKind kind);
/// Panes of N-BK7, 8 mm thick, with gaps between them, before that wall.
OpticalSetup panes(LampKind kind, int count, double gap_m);

}  // namespace abbe::test
