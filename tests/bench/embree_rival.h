/// Embree 3.13 over the same triangles and rays.
#pragma once

#include <cstddef>
#include <memory>

#include "bench/bench_scenes.h"
#include "bench/ray_sets.h"

namespace abbe::bench {

class EmbreeScene {
 public:
  /// Builds at quality HIGH; `robust` sets the flag against leaks at edges.
  EmbreeScene(const BenchScene& scene, bool robust);
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  double build_seconds() const { return build_seconds_; }
  std::size_t bytes() const;

  /// Thread CPU seconds of tracing packets [first, last) of a set, `lanes` (1, 8 or 16) at a time.
  double trace(const RaySet& set, std::size_t first, std::size_t last, int lanes);

  /// Number of rays of the last trace() that hit something.
  std::size_t hits() const { return hits_; }

 private:
  struct State;
  std::unique_ptr<State> state_;
  double build_seconds_ = 0.0;
  std::size_t hits_ = 0;
};

/// CPU time of this thread in seconds.
double thread_seconds();

}  // namespace abbe::bench
