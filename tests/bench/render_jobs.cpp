#include "bench/render_jobs.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>

#include "support/scene_builder.h"

namespace abbe::bench {

double cpu_seconds(int who) {
  rusage usage{};
  getrusage(who, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

std::vector<double> least_seconds(const std::vector<Job>& jobs, int repeats) {
  std::vector<double> least(jobs.size(), 1e30);
  for (int r = 0; r < repeats; ++r) {
    for (std::size_t j = 0; j < jobs.size(); ++j) least[j] = std::min(least[j], jobs[j].run());
  }
  return least;
}

Timed timed_render(const LitWorld& world, const Camera& camera, const RenderSettings& settings) {
  const ThreadLimit limit(settings.threads);
  const double start = cpu_seconds(RUSAGE_SELF);
  const test::Rendered result = test::render(world, camera, settings);
  return {result.stats, result.queue_capacity, cpu_seconds(RUSAGE_SELF) - start, result.seconds};
}

RenderSettings settings_of(Mode mode, const Vec2i& size, int samples) {
  RenderSettings settings;
  settings.mode = mode;
  settings.size = size;
  settings.samples_per_pixel = samples;
  settings.threads = 1;
  return settings;
}

Job job(const std::string& name, const Subject& subject, const RenderSettings& settings) {
  auto world = std::make_shared<LitWorld>(test::make_world(subject.scene, settings));
  return {name, [world, &subject, settings] {
            return timed_render(*world, subject.camera, settings).cpu_seconds;
          }};
}

double Bench::compare(const std::string& key, const std::string& what,
                      const std::vector<Job>& pair) {
  const std::vector<double> seconds = least_seconds(pair, repeats_);
  report(key, what, seconds[0] / seconds[1], pair, seconds);
  return seconds[0] / seconds[1];
}

void Bench::report(const std::string& key, const std::string& what, double ratio,
                   const std::vector<Job>& jobs, const std::vector<double>& seconds) {
  fmt::print("{:58} {:7.3f}", what, ratio);
  for (std::size_t j = 0; j < jobs.size(); ++j) {
    fmt::print("   {} {:.3f} s", jobs[j].name, seconds[j]);
    json_[key]["seconds"][jobs[j].name] = seconds[j];
  }
  fmt::print("\n");
  std::fflush(stdout);
  json_[key]["ratio"] = ratio;
}

void Bench::write() const {
  const std::filesystem::path out = out_;
  if (out.has_parent_path()) std::filesystem::create_directories(out.parent_path());
  std::ofstream(out) << json_.dump(2) << '\n';
}

}  // namespace abbe::bench
