/// What `abbe compare` writes about its images: stats.json and the page.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "abbe/cli/compare_difference.h"
#include "abbe/cli/study.h"
#include "abbe/spectrum/observer.h"

namespace abbe {

/// A render of a sweep against its finest one.
struct SweepRun {
  int value = 0;
  MapStatistics delta_e2000;
  double rmse = 0.0;
  double seconds = 0.0;
};
struct Sweep {
  std::string parameter;  ///< "wavelengths" or "spp".
  int finest = 0;
  std::vector<SweepRun> runs;  ///< By rising value, without the finest.
};

/// The ray tree of a pixel, as text.
struct KeptTree {
  Vec2i pixel;
  std::string text;
};

/// Everything that a report is made of.
struct CompareResult {
  std::string scene;  ///< Its name for people.
  RenderSettings settings;
  double exposure_ev = 0.0;
  std::map<std::string, StudyImage> modes;            ///< rgb, rgb3, spectral.
  std::map<std::string, ModeDifference> differences;  ///< rgb, rgb3.
  Causes causes;
  std::vector<Sweep> sweeps;
  std::vector<KeptTree> trees;
  std::map<std::string, double> render_seconds;  ///< By file, for the next run.
  int rendered = 0, reused = 0;
};

/// stats.json.
nlohmann::ordered_json compare_stats(const CompareResult& result);

/// What page/ shows: stats and what pictures it needs. `pictures` are PNG or JPEG files' bytes as
/// data URIs, by mode; `observer` colours the spectrum. The page stays below `most_bytes`: maps and
/// spectra are then means over blocks of pixels, which the page says.
std::string compare_page(const CompareResult& result,
                         const std::map<std::string, std::string>& pictures,
                         const Observer& observer, std::size_t most_bytes);

}  // namespace abbe
