/// What `abbe compare` writes about its images: stats.json and the page.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "abbe/session/comparison/modes.h"
#include "abbe/spectrum/observer.h"

namespace abbe {

/// The ray tree of a pixel, as text.
struct KeptTree {
  Vec2i pixel;
  std::string text;
};

/// Everything that a report is made of.
struct CompareResult : ModesCompared {
  std::string scene;  ///< Its name for people.
  std::vector<KeptTree> trees;
  std::map<std::string, double> render_seconds;  ///< By file, for the next run.
  int rendered = 0, reused = 0;
};

/// The text of stats.json.
std::string compare_stats(const CompareResult& result);

/// What page/ shows: stats and what pictures it needs. `pictures` are PNG or JPEG files' bytes as
/// data URIs, by mode; `observer` colours the spectrum. The page stays below `most_bytes`: maps and
/// spectra are then means over blocks of pixels, which the page says.
std::string compare_page(const CompareResult& result,
                         const std::map<std::string, std::string>& pictures,
                         const Observer& observer, std::size_t most_bytes);

}  // namespace abbe
