/// The files of `abbe compare` beside its renders, and what it keeps of rays.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "abbe/display/display.h"
#include "abbe/image/raster/raster.h"
#include "abbe/report/comparison/page.h"

namespace abbe {

/// Most bytes of the page; its parts are made smaller until it fits.
inline constexpr std::size_t kMaxPageBytes = 7'900'000;

/// What renders took, by file, as an earlier stats.json says; empty without one.
std::map<std::string, double> earlier_seconds(const std::filesystem::path& stats_file);

/// Writes a PNG of each mode; returns what the page shows of them, by mode.
std::map<std::string, std::string> write_pictures(DisplayOptions display,
                                                  const RasterOptions& raster,
                                                  const std::filesystem::path& folder,
                                                  const CompareResult& result);

/// Writes every map of ΔE2000 as a channel of delta_e2000.exr and as a picture.
void write_maps(const std::filesystem::path& folder, const CompareResult& result);

/// The ray trees of pixels on a grid, as `abbe probe` prints them.
std::vector<KeptTree> kept_trees(const PreparedScene& prepared, const Standards& standards,
                                 const RenderSettings& settings);

}  // namespace abbe
