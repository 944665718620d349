/// Parallel loops over TBB, and the flag by which a long loop is asked to stop.
#pragma once

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <atomic>
#include <cstddef>

namespace abbe {

/// Set from a signal handler or another thread; read by loops between two pieces of work.
using CancelFlag = std::atomic<bool>;

/// Calls body(i) for i in [begin, end), in parallel, each index once.
/// Domain: body must not depend on the order of calls.
/// Errors: the first exception thrown by body is rethrown here, after all running bodies end.
template <typename Body>
void parallel_for(std::size_t begin, std::size_t end, std::size_t grain, const Body& body) {
  oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(begin, end, grain),
                            [&](const oneapi::tbb::blocked_range<std::size_t>& range) {
                              for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
                            });
}

/// Limits all parallel loops of the process to `threads` while it lives; 0 means all cores.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads)
      : control_(oneapi::tbb::global_control::max_allowed_parallelism,
                 threads > 0
                     ? static_cast<std::size_t>(threads)
                     : static_cast<std::size_t>(oneapi::tbb::this_task_arena::max_concurrency())) {}

 private:
  oneapi::tbb::global_control control_;
};

}  // namespace abbe
