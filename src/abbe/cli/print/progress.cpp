#include "abbe/cli/print/progress.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <utility>

namespace abbe {

std::string clock_text(double seconds) {
  const auto whole = static_cast<long long>(std::ceil(seconds));
  const long long hours = whole / 3600;
  const long long minutes = whole / 60 % 60;
  if (hours > 0) return fmt::format("{}:{:02}:{:02}", hours, minutes, whole % 60);
  return fmt::format("{}:{:02}", minutes, whole % 60);
}

ProgressLine::ProgressLine(bool is_live, std::string what)
    : is_live_(is_live), what_(std::move(what)), start_(Clock::now()), last_(start_) {}

ProgressLine::~ProgressLine() {
  wipe();
}

void ProgressLine::update(double fraction_done) {
  if (!is_live_) return;
  const Clock::time_point now = Clock::now();
  if (now - last_ < std::chrono::milliseconds(200)) return;
  last_ = now;
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const double left = elapsed * (1.0 - fraction_done) / fraction_done;
  constexpr int kWidth = 30;
  const int filled = static_cast<int>(fraction_done * kWidth);
  const std::string bar = std::string(filled, '#') + std::string(kWidth - filled, '.');
  const std::string line = fmt::format("\r{} [{}] {:3.0f} %  {} left\033[K", what_, bar,
                                       std::floor(100.0 * fraction_done), clock_text(left));
  std::fwrite(line.data(), 1, line.size(), stderr);
  is_drawn_ = true;
}

void ProgressLine::wipe() {
  if (is_drawn_) std::fputs("\r\033[K", stderr);
  is_drawn_ = false;
}

}  // namespace abbe
