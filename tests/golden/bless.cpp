// Renews golden images: all, or the one named by ABBE_BLESS, and prints how far the old one was
// off.

#include <fmt/format.h>

#include <cstdlib>
#include <exception>
#include <string>

#include "golden/golden_cases.h"
#include "image/exr.h"

int main() {
  using namespace abbe;
  try {
    const char* wish = std::getenv("ABBE_BLESS");
    const std::string only = wish != nullptr ? wish : "";
    bool found = false;
    for (const golden::Case& golden : golden::cases()) {
      if (!only.empty() && golden.name != only) continue;
      found = true;
      const bool is_new = !std::filesystem::exists(golden.reference());
      const Image old = is_new ? Image() : read_exr(golden.reference());
      std::filesystem::create_directories(golden.reference().parent_path());
      golden::render_to(golden, golden.reference());
      if (is_new) {
        fmt::print("{}: new\n", golden.name);
        continue;
      }
      const Comparison comparison = compare_images(read_exr(golden.reference()), old);
      fmt::print("{}: {}; rms {:.3g}, max {:.3g}\n", golden.name,
                 comparison.summary(CompareThresholds{}), comparison.rms_error,
                 comparison.max_error);
    }
    if (!found) {
      fmt::print(stderr, "no golden image \"{}\"; there are:", only);
      for (const golden::Case& golden : golden::cases()) fmt::print(stderr, " {}", golden.name);
      fmt::print(stderr, "\n");
      return 2;
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "bless: {}\n", error.what());
    return 1;
  }
  return 0;
}
