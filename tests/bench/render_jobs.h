/// Renders as jobs whose times are compared, and the report of their ratios.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "abbe/render/render.h"
#include "abbe/scene/scene.h"
#include "abbe/world/world.h"

namespace abbe::bench {

/// CPU time of this process, or of those it waited for: `who` as in getrusage.
double cpu_seconds(int who);

struct Job {
  std::string name;
  std::function<double()> run;  ///< Seconds that count.
};

/// Least times of the jobs, in turn so that a slower minute of the machine meets all of them.
std::vector<double> least_seconds(const std::vector<Job>& jobs, int repeats);

/// A scene and the camera to see it with.
struct Subject {
  std::string name;
  Scene scene;
  Camera camera;
};

struct Timed {
  IntegratorStats stats;
  std::size_t queue_capacity = 0;
  double cpu_seconds = 0.0, wall_seconds = 0.0;
};

Timed timed_render(const LitWorld& world, const Camera& camera, const RenderSettings& settings);

/// On one thread.
RenderSettings settings_of(Mode mode, const Vec2i& size, int samples);

/// CPU time of a render; the world is made beforehand. The subject has to outlive the job.
Job job(const std::string& name, const Subject& subject, const RenderSettings& settings);

/// Prints ratios and keeps them for a JSON file.
class Bench {
 public:
  Bench(int repeats, std::string out) : repeats_(repeats), out_(std::move(out)) {}

  /// CPU time of the first over that of the second; returns it.
  double compare(const std::string& key, const std::string& what, const std::vector<Job>& pair);
  void report(const std::string& key, const std::string& what, double ratio,
              const std::vector<Job>& jobs, const std::vector<double>& seconds);
  nlohmann::json& json() { return json_; }
  void write() const;

 private:
  int repeats_;
  std::string out_;
  nlohmann::json json_;
};

}  // namespace abbe::bench
