/// The figures of a render, for --stats and the line at its end.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "abbe/render/render.h"
#include "abbe/world/world.h"

namespace abbe {

/// What the parts of a render took.
struct RenderTimes {
  double load_seconds = 0.0;
  double build_seconds = 0.0;
  double render_seconds = 0.0;
  double write_seconds = 0.0;
  double total_seconds = 0.0;
};

/// Rays of every kind.
std::uint64_t total_rays(const IntegratorStats& stats);
double rays_per_second(const IntegratorStats& stats, double render_seconds);

/// What `--stats` writes.
nlohmann::json stats_json(const LitWorld& world, const Film& film, const RenderResult& result,
                          const RenderTimes& times, int threads);

}  // namespace abbe
