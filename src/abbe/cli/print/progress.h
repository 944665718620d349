/// How far a render is, drawn on a terminal.
#pragma once

#include <chrono>
#include <string>

namespace abbe {

/// `1:05:09`, `5:09`, `0:09`.
std::string clock_text(double seconds);

/// One line that is redrawn a few times a second and wiped at the end.
class ProgressLine {
 public:
  /// Draws nothing unless `is_live`; `what` is being done.
  explicit ProgressLine(bool is_live, std::string what = "rendering");
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void update(double fraction_done);
  void wipe();

 private:
  using Clock = std::chrono::steady_clock;

  bool is_live_;
  std::string what_;
  bool is_drawn_ = false;
  Clock::time_point start_;
  Clock::time_point last_;
};

}  // namespace abbe
