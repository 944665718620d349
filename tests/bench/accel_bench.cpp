/// The k-d tree against Embree: same triangles, same rays, same process, one thread, CPU time, all
/// rivals interleaved chunk by chunk. Prints a table and writes it as JSON.
///
///   abbe_bench [FILE.gltf ...] [--scenes=A,B] [--sets=A,B] [--rivals=A,B] [--width=N] [--passes=N]
///              [--out=FILE] [Google Benchmark's options]
///
/// Google Benchmark names, selects (--benchmark_filter) and runs the pairs of scene and ray set.
/// The clock is our own: Google Benchmark times one thing after the other, and on a machine that
/// others use only what is interleaved can be compared.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "abbe/accel/accelerator.h"
#include "abbe/base/isa.h"
#include "abbe/base/parallel.h"
#include "bench/bench_scenes.h"
#include "bench/embree_rival.h"
#include "bench/ray_sets.h"

namespace abbe::bench {
namespace {

struct Options {
  std::vector<std::string> scenes = scene_names();
  std::vector<std::string> sets;
  std::vector<std::string> rivals;  ///< All when empty; one of ours, default, robust at least.
  int width = 1024;
  int passes = 2;
  std::string out = "out/bench.json";
};

struct Rival {
  std::string name;
  std::string family;  ///< ours, default or robust: the best of each family counts.
  int lanes;           ///< Of one call; 0 for all of a chunk's packets at once.
  std::vector<double> chunk_seconds = {};
  std::size_t hits = 0;

  bool is_wanted(const std::vector<std::string>& names) const {
    return names.empty() || std::find(names.begin(), names.end(), name) != names.end();
  }
};

struct Prepared {
  BenchScene scene;
  std::unique_ptr<const Accelerator> tree;
  double build_seconds = 0.0, embree_build_seconds = 0.0;
  std::unique_ptr<EmbreeScene> fast, robust;
  std::vector<RaySet> sets;
};

constexpr int kBuildThreads = 2;
constexpr std::size_t kBuilds = 3;

/// Builds both trees in turn; times are medians, wall time.
void build(Prepared& p) {
  const ThreadLimit limit(kBuildThreads);  // Embree's tasks are TBB's, too.
  std::array<double, kBuilds> ours, rival;
  for (std::size_t i = 0; i < kBuilds; ++i) {
    const auto start = std::chrono::steady_clock::now();
    p.tree = build_accelerator("kdtree", p.scene.spans());
    ours[i] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    p.fast = std::make_unique<EmbreeScene>(p.scene, false);
    rival[i] = p.fast->build_seconds();
  }
  std::sort(ours.begin(), ours.end());
  std::sort(rival.begin(), rival.end());
  p.build_seconds = ours[kBuilds / 2];
  p.embree_build_seconds = rival[kBuilds / 2];
}

Prepared prepare(const std::string& name, int width) {
  Prepared p;
  p.scene = make_scene(name);
  build(p);
  p.robust = std::make_unique<EmbreeScene>(p.scene, true);
  p.sets = make_ray_sets(p.scene, *p.tree, width);
  fmt::print(
      "{}: {}; build on {} threads {:.2f} s, Embree {:.2f} s, ratio {:.2f}; bytes per triangle "
      "{:.1f}, Embree {:.1f}\n",
      name, p.scene.description, kBuildThreads, p.build_seconds, p.embree_build_seconds,
      p.build_seconds / p.embree_build_seconds,
      static_cast<double>(p.tree->bytes()) / static_cast<double>(p.scene.triangles.size()),
      static_cast<double>(p.fast->bytes()) / static_cast<double>(p.scene.triangles.size()));
  return p;
}

/// Traces packets [first, last) with our tree; `rays` are the active ones of the same packets.
class Ours {
 public:
  Ours(const Accelerator& tree, const RaySet& set)
      : tree_(tree),
        set_(set),
        hits_(set.rays.size()),
        occluded_(set.rays.size()),
        packet_hits_(set.packets.size()),
        packet_occluded_(set.packets.size()),
        first_ray_(set.packets.size() + 1) {
    for (std::size_t p = 0; p < set.packets.size(); ++p) {
      first_ray_[p + 1] =
          first_ray_[p] + static_cast<std::size_t>(__builtin_popcount(set.packets[p].active));
    }
  }

  double packets(std::size_t first, std::size_t last) {
    const std::span rays(set_.packets.data() + first, last - first);
    const double start = thread_seconds();
    if (set_.is_occlusion) {
      tree_.any_hits(rays, kAllBits, {packet_occluded_.data() + first, last - first});
    } else {
      tree_.closest_hits(rays, kAllBits, {packet_hits_.data() + first, last - first});
    }
    return thread_seconds() - start;
  }

  double stream(std::size_t first_packet, std::size_t last_packet) {
    const std::size_t first = first_ray_[first_packet];
    const std::size_t count = first_ray_[last_packet] - first;
    const std::span rays(set_.rays.data() + first, count);
    const double start = thread_seconds();
    if (set_.is_occlusion) {
      tree_.any_hits(rays, kAllBits, {occluded_.data() + first, count});
    } else {
      tree_.closest_hits(rays, kAllBits, {hits_.data() + first, count});
    }
    return thread_seconds() - start;
  }

  std::size_t hits(std::size_t first, std::size_t last, bool as_packets) const {
    std::size_t count = 0;
    if (!as_packets) {
      for (std::size_t i = first_ray_[first]; i < first_ray_[last]; ++i) {
        count += set_.is_occlusion ? occluded_[i] : (hits_[i].is_hit() ? 1 : 0);
      }
      return count;
    }
    for (std::size_t p = first; p < last; ++p) {
      for (int lane = 0; lane < kPacketLanes; ++lane) {
        if ((set_.packets[p].active >> lane & 1u) == 0) continue;
        count += set_.is_occlusion ? packet_occluded_[p] >> lane & 1u
                                   : (packet_hits_[p].primitive[lane] != kNoPrimitive ? 1u : 0u);
      }
    }
    return count;
  }

 private:
  const Accelerator& tree_;
  const RaySet& set_;
  std::vector<Hit> hits_;
  std::vector<std::uint8_t> occluded_;
  std::vector<HitPacket> packet_hits_;
  std::vector<std::uint32_t> packet_occluded_;
  std::vector<std::size_t> first_ray_;
};

struct Ratio {
  double value = 0.0;
  double spread = 0.0;  ///< Standard error of the mean over tenths of the chunks.
};

struct Outcome {
  std::map<std::string, double> mrays;  ///< By rival.
  std::string best_ours;
  double ours = 0.0;
  Ratio over_default, over_robust;
  double nodes = 0.0, triangles = 0.0;  ///< Work of a single ray on average.
};

double total(const Rival& r) {
  return std::accumulate(r.chunk_seconds.begin(), r.chunk_seconds.end(), 0.0);
}

Ratio ratio_of(const Rival& ours, const Rival& theirs) {
  constexpr std::size_t kParts = 10;
  Ratio ratio{total(theirs) / total(ours), 0.0};
  std::vector<double> parts;
  for (std::size_t part = 0; part < kParts; ++part) {
    double mine = 0.0, other = 0.0;
    for (std::size_t c = part; c < ours.chunk_seconds.size(); c += kParts) {
      mine += ours.chunk_seconds[c];
      other += theirs.chunk_seconds[c];
    }
    if (mine > 0.0) parts.push_back(other / mine);
  }
  double variance = 0.0;
  for (const double p : parts) variance += (p - ratio.value) * (p - ratio.value);
  if (parts.size() > 1) {
    ratio.spread = std::sqrt(variance / static_cast<double>(parts.size() * (parts.size() - 1)));
  }
  return ratio;
}

Outcome compare(Prepared& p, const RaySet& set, int passes,
                const std::vector<std::string>& wanted) {
  constexpr std::size_t kChunk = 1024;  // Packets: 16384 rays, over 300 µs.
  // No rival follows another over the same tree, whose caches would be warm for the same rays.
  std::vector<Rival> rivals = {{"packets", "ours", 0},     {"embree16", "default", 16},
                               {"robust16", "robust", 16}, {"stream", "ours", 1},
                               {"embree8", "default", 8},  {"robust8", "robust", 8},
                               {"embree1", "default", 1},  {"robust1", "robust", 1}};
  Ours ours(*p.tree, set);
  for (int pass = 0; pass < passes; ++pass) {
    for (std::size_t first = 0; first < set.packets.size(); first += kChunk) {
      const std::size_t last = std::min(first + kChunk, set.packets.size());
      for (Rival& rival : rivals) {
        if (!rival.is_wanted(wanted)) continue;
        if (rival.family == "ours") {
          const bool as_packets = rival.lanes == 0;
          rival.chunk_seconds.push_back(as_packets ? ours.packets(first, last)
                                                   : ours.stream(first, last));
          if (pass == 0) rival.hits += ours.hits(first, last, as_packets);
        } else {
          EmbreeScene& embree = rival.family == "default" ? *p.fast : *p.robust;
          rival.chunk_seconds.push_back(embree.trace(set, first, last, rival.lanes));
          if (pass == 0) rival.hits += embree.hits();
        }
      }
    }
  }
  Outcome outcome;
  std::map<std::string, const Rival*> best;
  for (const Rival& rival : rivals) {
    if (!rival.is_wanted(wanted)) continue;
    outcome.mrays[rival.name] = 1e-6 * static_cast<double>(set.rays.size()) * passes / total(rival);
    const Rival*& b = best[rival.family];
    if (b == nullptr || total(rival) < total(*b)) b = &rival;
    // Rivals that do not answer the same question are not compared.
    const auto difference = static_cast<double>(rival.hits) - static_cast<double>(rivals[0].hits);
    if (std::abs(difference) > 0.001 * static_cast<double>(set.rays.size())) {
      fmt::print("  {} {}: {} hits, ours {}\n", set.name, rival.name, rival.hits, rivals[0].hits);
    }
  }
  constexpr std::size_t kSampled = 97;
  QueryCost cost;
  for (std::size_t i = 0; i < set.rays.size(); i += kSampled) {
    p.tree->closest_hit_with_cost(set.rays[i], kAllBits, cost);
  }
  const auto sampled = static_cast<double>((set.rays.size() + kSampled - 1) / kSampled);
  outcome.nodes = static_cast<double>(cost.nodes) / sampled;
  outcome.triangles = static_cast<double>(cost.primitives) / sampled;
  outcome.best_ours = best["ours"]->name;
  outcome.ours = outcome.mrays[outcome.best_ours];
  if (best["default"]) outcome.over_default = ratio_of(*best["ours"], *best["default"]);
  if (best["robust"]) outcome.over_robust = ratio_of(*best["ours"], *best["robust"]);
  return outcome;
}

std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> parts;
  std::size_t start = 0;
  while (start <= list.size()) {
    const std::size_t comma = std::min(list.find(',', start), list.size());
    parts.push_back(list.substr(start, comma - start));
    start = comma + 1;
  }
  return parts;
}

Options read_options(int& argc, char** argv) {
  Options options;
  std::vector<std::string> files;
  bool names_scenes = false;
  int kept = 1;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const auto value = [&](const std::string& name) -> std::optional<std::string> {
      if (!argument.starts_with(name + "=")) return std::nullopt;
      return argument.substr(name.size() + 1);
    };
    if (const auto v = value("--scenes")) {
      options.scenes = split(*v);
      names_scenes = true;
    } else if (const auto s = value("--sets")) {
      options.sets = split(*s);
    } else if (const auto r = value("--rivals")) {
      options.rivals = split(*r);
    } else if (const auto w = value("--width")) {
      options.width = std::stoi(*w);
    } else if (const auto n = value("--passes")) {
      options.passes = std::stoi(*n);
    } else if (const auto o = value("--out")) {
      options.out = *o;
    } else if (!argument.starts_with("-")) {
      files.push_back(argument);
    } else {
      argv[kept++] = argv[i];
    }
  }
  argc = kept;
  // Files alone replace the scenes made in code.
  if (!files.empty() && !names_scenes) options.scenes.clear();
  options.scenes.insert(options.scenes.end(), files.begin(), files.end());
  return options;
}

double geometric_mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += std::log(v);
  return values.empty() ? 0.0 : std::exp(sum / static_cast<double>(values.size()));
}

int run(int argc, char** argv) {
  const Options options = read_options(argc, argv);
  apply_isa_from_environment();
  nlohmann::json json;
  json["isa"] = isa_level();
  std::map<std::string, std::vector<double>> over_default, over_robust;
  std::pair<double, std::string> worst_over_default{kInfinity, ""},
      worst_over_robust{kInfinity, ""};
  std::map<std::string, std::shared_ptr<Prepared>> prepared;
  for (const std::string& name : options.scenes) {
    for (const std::string set_name :
         {"primary", "shadow", "bounce", "second_bounce", "fan", "fan_after"}) {
      if (!options.sets.empty() &&
          std::find(options.sets.begin(), options.sets.end(), set_name) == options.sets.end()) {
        continue;
      }
      ::benchmark::RegisterBenchmark(
          (name + "/" + set_name).c_str(),
          [&, name, set_name](::benchmark::State& state) {
            if (!prepared.contains(name)) {
              prepared.clear();  // One scene in memory at a time.
              prepared[name] = std::make_shared<Prepared>(prepare(name, options.width));
              Prepared& p = *prepared[name];
              auto& j = json["scenes"][name];
              const auto triangles = static_cast<double>(p.scene.triangles.size());
              j = {{"description", p.scene.description},
                   {"triangles", p.scene.triangles.size()},
                   {"build_seconds", p.build_seconds},
                   {"embree_build_seconds", p.embree_build_seconds},
                   {"build_threads", kBuildThreads},
                   {"build_ratio", p.build_seconds / p.embree_build_seconds},
                   {"bytes_per_triangle", static_cast<double>(p.tree->bytes()) / triangles},
                   {"embree_bytes_per_triangle", static_cast<double>(p.fast->bytes()) / triangles}};
            }
            Prepared& p = *prepared[name];
            const RaySet& set = *std::find_if(p.sets.begin(), p.sets.end(),
                                              [&](const RaySet& s) { return s.name == set_name; });
            Outcome o;
            for (auto _ : state) {
              o = compare(p, set, options.passes, options.rivals);
              state.SetIterationTime(1e-6 * static_cast<double>(set.rays.size()) / o.ours);
            }
            state.counters["Mrays/s"] = o.ours;
            state.counters["over_default"] = o.over_default.value;
            state.counters["over_robust"] = o.over_robust.value;
            fmt::print("{:10} {:14} {:>8}", p.scene.name, set_name, o.best_ours);
            for (const char* rival : {"packets", "stream", "embree1", "embree8", "embree16",
                                      "robust1", "robust8", "robust16"}) {
              fmt::print(" {:7.2f}", o.mrays[rival]);
            }
            fmt::print(" {:5.1f} {:5.1f}", o.nodes, o.triangles);
            fmt::print("  over default {:.3f} ±{:.3f}  over robust {:.3f} ±{:.3f}\n",
                       o.over_default.value, o.over_default.spread, o.over_robust.value,
                       o.over_robust.spread);
            std::fflush(stdout);
            const std::string pair = name + " " + set_name;
            worst_over_default = std::min(worst_over_default, {o.over_default.value, pair});
            worst_over_robust = std::min(worst_over_robust, {o.over_robust.value, pair});
            over_default[set_name].push_back(o.over_default.value);
            over_robust[set_name].push_back(o.over_robust.value);
            json["scenes"][name]["sets"][set_name] = {
                {"mrays", o.mrays},
                {"best", o.best_ours},
                {"ours_mrays", o.ours},
                {"embree_mrays",
                 std::max({o.mrays["embree1"], o.mrays["embree8"], o.mrays["embree16"]})},
                {"embree_robust_mrays",
                 std::max({o.mrays["robust1"], o.mrays["robust8"], o.mrays["robust16"]})},
                {"default", o.over_default.value},
                {"default_spread", o.over_default.spread},
                {"robust", o.over_robust.value},
                {"robust_spread", o.over_robust.spread}};
          })
          ->Iterations(1)
          ->UseManualTime()
          ->Unit(::benchmark::kMillisecond);
    }
  }
  fmt::print(
      "{:10} {:14} {:>8} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} nodes  tris (Mrays/s; "
      "isa {})\n",
      "scene", "rays", "best", "packets", "stream", "emb1", "emb8", "emb16", "rob1", "rob8",
      "rob16", isa_level());
  ::benchmark::Initialize(&argc, argv);
  if (::benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  class Silent : public ::benchmark::BenchmarkReporter {
    bool ReportContext(const Context&) override { return true; }
    void ReportRuns(const std::vector<Run>&) override {}
  } silent;
  ::benchmark::RunSpecifiedBenchmarks(&silent);
  for (const auto& [set, ratios] : over_default) {
    const double d = geometric_mean(ratios), r = geometric_mean(over_robust[set]);
    fmt::print("geometric mean {:14} over default {:.3f}, over robust {:.3f}\n", set, d, r);
    json["geomean"][set] = {{"default", d}, {"robust", r}};
  }
  for (const auto* const worst : {&worst_over_default, &worst_over_robust}) {
    fmt::print("lowest ratio of a scene over {}: {:.3f}, {}\n",
               worst == &worst_over_default ? "default" : "robust", worst->first, worst->second);
  }
  json["lowest"] = {{"default", worst_over_default.first}, {"robust", worst_over_robust.first}};
  const std::filesystem::path out = options.out;
  if (out.has_parent_path()) std::filesystem::create_directories(out.parent_path());
  std::ofstream(out) << json.dump(2) << '\n';
  return 0;
}

}  // namespace
}  // namespace abbe::bench

int main(int argc, char** argv) {
  try {
    return abbe::bench::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "abbe_bench: {}\n", error.what());
    return 2;
  }
}
