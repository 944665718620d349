/// The fans that wait, deepest generation first.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "abbe/integrate/buffers.h"
#include "abbe/integrate/integrator.h"

namespace abbe {

/// Fans of a wave of camera samples that wait for their turn.
///
/// The deepest generation goes first: what waits is at most the children of one batch for every
/// depth. Fans of one sample stay together and in order, and where a sample is cut into batches
/// depends on its own fans alone: what it adds up to does not depend on the others.
class FanQueue {
 public:
  FanQueue(std::vector<FanList>& spare_lists, IntegratorStats& stats)
      : spare_lists_(spare_lists), stats_(stats) {}

  /// An empty list with the memory of one that is done.
  FanList take_list() {
    if (spare_lists_.empty()) return {};
    FanList list = std::move(spare_lists_.back());
    spare_lists_.pop_back();
    list.clear();
    return list;
  }

  /// Runs batches until no fan is left: run_batch(list, first, last, children) takes fans
  /// [first, last) of a list and adds their children to another.
  template <class RunBatch>
  void run(FanList start, RunBatch&& run_batch) {
    std::size_t waiting_fans = start.fans.size();
    std::vector<Generation> waiting;
    waiting.push_back({std::move(start)});
    while (!waiting.empty()) {
      Generation& deepest = waiting.back();
      const std::size_t end = batch_end(deepest.list.fans, deepest.next);
      FanList children = take_list();
      run_batch(deepest.list, deepest.next, end, children);
      waiting_fans += children.fans.size();
      stats_.peak_queued_fans = std::max<std::uint64_t>(stats_.peak_queued_fans, waiting_fans);
      waiting_fans -= end - deepest.next;
      deepest.next = end;
      if (end == deepest.list.fans.size()) {
        give_back(std::move(deepest.list));
        waiting.pop_back();
      }
      if (children.fans.empty()) {
        give_back(std::move(children));
      } else {
        waiting.push_back({std::move(children)});
      }
    }
    std::size_t bytes = 0;
    for (const FanList& spare : spare_lists_) bytes += spare.bytes();
    stats_.peak_queue_bytes = std::max<std::uint64_t>(stats_.peak_queue_bytes, bytes);
  }

 private:
  /// Fans of one generation; those before `next` are done.
  struct Generation {
    FanList list;
    std::size_t next = 0;
  };

  // Whole samples up to kBatchFans; a sample with more is cut at every kBatchFans of its own fans.
  static std::size_t batch_end(const std::vector<Fan>& fans, std::size_t begin) {
    std::size_t end = begin;
    while (end < fans.size() && end - begin < kBatchFans) {
      std::size_t sample_end = end + 1;
      while (sample_end < fans.size() && fans[sample_end].sample == fans[end].sample &&
             sample_end - end < kBatchFans) {
        ++sample_end;
      }
      if (end != begin && sample_end - begin > kBatchFans) break;
      end = sample_end;
    }
    return end;
  }

  void give_back(FanList list) { spare_lists_.push_back(std::move(list)); }

  std::vector<FanList>& spare_lists_;
  IntegratorStats& stats_;
};

}  // namespace abbe
