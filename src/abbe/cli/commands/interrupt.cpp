#include "abbe/cli/commands/interrupt.h"

#include <csignal>

namespace abbe {
namespace {

CancelFlag interrupted{false};
static_assert(CancelFlag::is_always_lock_free, "a signal handler may only touch such a flag");

void request_stop(int) {
  interrupted.store(true);
}

}  // namespace

InterruptGuard::InterruptGuard() {
  interrupted.store(false);
  struct sigaction action {};
  action.sa_handler = request_stop;
  sigemptyset(&action.sa_mask);
  // Interrupted system calls go on; after the first signal the next one kills.
  action.sa_flags = static_cast<int>(SA_RESTART | SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
}

InterruptGuard::~InterruptGuard() {
  std::signal(SIGINT, SIG_DFL);
}

const CancelFlag& InterruptGuard::flag() const {
  return interrupted;
}

}  // namespace abbe
