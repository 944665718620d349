/// A world and the light in it that is found, not sampled: all that the integrator reads.
#pragma once

#include "abbe/base/notes.h"
#include "abbe/caustics/flat/flat_caustics.h"
#include "abbe/world/world.h"

namespace abbe {

/// A world with its caustics. Surfaces that followed light passes have a mask of their own in its
/// accelerator.
struct LitWorld : World {
  FlatCaustics caustics;
  WorldOptions options;  ///< What it was made for.
  CausticOptions caustic_options;
  double build_seconds = 0.0;
};

/// Tabulates, flattens, finds caustics and builds the accelerator.
/// Errors: those of validate, LaneModel, tabulate_materials and flatten.
LitWorld make_lit_world(const Scene& scene, const WorldOptions& options,
                        const CausticOptions& caustics, const Observer& observer,
                        const Spectrum& d65, Notes& notes);

}  // namespace abbe
