/// All modes of a scene beside each other, and why they differ.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "abbe/session/comparison/causes.h"
#include "abbe/session/comparison/difference.h"
#include "abbe/session/study.h"

namespace abbe {

/// Renders with several values of one setting, each held against the last.
struct SweepPlan {
  std::string parameter;    ///< "wavelengths" or "spp".
  std::vector<int> values;  ///< Two or more, rising.
};

/// The settings of one render of a sweep.
RenderSettings with_value(RenderSettings settings, const SweepPlan& plan, int value);

/// A render of a sweep against its finest one.
struct SweepRun {
  int value = 0;
  MapStatistics delta_e2000;
  double rmse = 0.0;
  double seconds = 0.0;
};
/// A sweep, run.
struct Sweep {
  std::string parameter;
  int finest = 0;
  std::vector<SweepRun> runs;  ///< By rising value, without the finest.
};

/// What is compared.
struct ModesPlan {
  RenderSettings settings;  ///< Of the spectral mode; the others are without its bands.
  AttributionMethod method = AttributionMethod::FirstAndLast;
  std::vector<SweepPlan> sweeps;
  std::optional<double> exposure_ev;  ///< At which colours are compared; none: by the image.
};

/// What came of it.
struct ModesCompared {
  RenderSettings settings;
  double exposure_ev = 0.0;
  std::map<std::string, StudyImage> modes;            ///< rgb, rgb3, spectral.
  std::map<std::string, ModeDifference> differences;  ///< rgb, rgb3.
  Causes causes;
  std::vector<Sweep> sweeps;
};

/// Renders every mode, every set of causes and every sweep into the study's folder. Nothing when
/// interrupted; what is whole by then is used again the next time.
/// Errors: as Study::render.
std::optional<ModesCompared> compare_modes(Study& study, const ModesPlan& plan);

}  // namespace abbe
