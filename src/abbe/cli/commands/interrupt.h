/// Ctrl-C, turned into a request to stop.
#pragma once

#include "abbe/base/parallel.h"

namespace abbe {

/// While it lives, the first SIGINT sets the flag; the second one ends the program at once.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  const CancelFlag& flag() const;
};

}  // namespace abbe
