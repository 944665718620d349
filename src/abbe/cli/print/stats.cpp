#include "abbe/cli/print/stats.h"

#include <sys/resource.h>

#include <nlohmann/json.hpp>

#include "abbe/integrate/integrator.h"

namespace abbe {
namespace {

std::uint64_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;  // Linux counts in KiB.
}

double share(double part, double whole) {
  return whole > 0.0 ? part / whole : 0.0;
}

}  // namespace

std::uint64_t total_rays(const IntegratorStats& stats) {
  return stats.camera_rays + stats.reflected_rays + stats.refracted_rays + stats.passed_rays +
         stats.shadow_rays;
}

double rays_per_second(const IntegratorStats& stats, double render_seconds) {
  return share(static_cast<double>(total_rays(stats)), render_seconds);
}

nlohmann::json stats_json(const LitWorld& world, const Film& film, const RenderResult& result,
                          const RenderTimes& times, int threads) {
  const IntegratorStats& stats = result.stats;
  nlohmann::json json;
  json["seconds"] = {{"load", times.load_seconds},
                     {"build", times.build_seconds},
                     {"render", times.render_seconds},
                     {"write", times.write_seconds},
                     {"total", times.total_seconds}};
  json["seconds"]["bent_light"] = stats.bent_light_seconds / threads;
  json["threads"] = threads;
  json["accelerator"] = world.accelerator->name();
  json["rays"] = {{"camera", stats.camera_rays},
                  {"reflected", stats.reflected_rays},
                  {"refracted", stats.refracted_rays},
                  {"passed", stats.passed_rays},
                  {"shadow", stats.shadow_rays}};
  json["rays_per_second"] = rays_per_second(stats, times.render_seconds);
  json["fans"] = {{"united", stats.united_fans},
                  {"spread", stats.spread_fans},
                  {"spread_by_depth", nlohmann::json::array()}};
  double lanes = 0.0;
  for (std::size_t depth = 0; depth < IntegratorStats::kDepths; ++depth) {
    if (stats.spread_fans_at[depth] == 0) continue;
    const auto fans_here = static_cast<double>(stats.spread_fans_at[depth]);
    const auto lanes_here = static_cast<double>(stats.spread_lanes_at[depth]);
    lanes += lanes_here;
    json["fans"]["spread_by_depth"].push_back({{"depth", depth},
                                               {"fans", stats.spread_fans_at[depth]},
                                               {"lanes_per_fan", lanes_here / fans_here}});
  }
  json["fans"]["lanes_per_spread"] = share(lanes, static_cast<double>(stats.spread_fans));
  const SamplingReport& sampling = result.sampling;
  json["sampling"] = {{"passes", sampling.passes},
                      {"samples", sampling.samples},
                      {"samples_per_pixel", sampling.samples_per_pixel}};
  if (sampling.noise > 0.0) {
    json["sampling"]["noise"] = {{"target", sampling.noise},
                                 {"reached", sampling.error},
                                 {"worst_block", sampling.worst_error},
                                 {"unfinished", sampling.unfinished}};
  }
  json["queue"] = {{"peak_fans", stats.peak_queued_fans},
                   {"capacity", result.queue_capacity},
                   {"peak_bytes", stats.peak_queue_bytes}};
  json["energy_lost"] = {{"depth", share(stats.weight_lost_to_depth, stats.weight_started)},
                         {"cutoff", share(stats.weight_lost_to_cutoff, stats.weight_started)}};
  const CausticReport& caustics = world.caustics.report;
  // Shares of the light of lamps that falls on flat bodies, each by the body it falls on first.
  nlohmann::json by_body = nlohmann::json::array();
  for (std::size_t b = 0; b < caustics.by_body.size(); ++b) {
    const BodyLight& light = caustics.by_body[b];
    by_body.push_back({{"name", world.caustics.flat.bodies[b].name},
                       {"on_chains", light.started - light.faint - light.too_long - light.no_room},
                       {"left_out_faint", light.faint},
                       {"left_out_too_long", light.too_long},
                       {"left_out_no_room", light.no_room}});
  }
  json["caustics"] = {{"bodies", caustics.bodies}, {"facets", caustics.facets},
                      {"chains", caustics.chains}, {"share_cut", caustics.share_cut},
                      {"by_body", by_body},        {"straight", caustics.fallbacks}};
  json["bytes"] = {{"geometry", world.geometry.bytes()},
                   {"accelerator", world.accelerator->bytes()},
                   {"chains", world.caustics.parallel.rows.capacity() * sizeof(float)},
                   {"peak_memory", peak_memory_bytes()}};
  json["dropped_samples"] = film.dropped_sample_count();
  json["complete"] = result.complete;
  return json;
}

}  // namespace abbe
