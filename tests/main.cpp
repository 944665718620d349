#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "abbe/base/error.h"
#include "abbe/base/isa.h"

namespace {

// ctest reads this exit code as "skipped" (tests/isa/CMakeLists.txt).
constexpr int kSkipped = 77;

bool is_known_level(const std::string& level) {
  constexpr std::array<const char*, 3> kLevels = {"sse4", "avx2", "avx512"};
  return std::find(kLevels.begin(), kLevels.end(), level) != kLevels.end();
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  const char* requested = std::getenv("ABBE_ISA");
  try {
    abbe::apply_isa_from_environment();
  } catch (const abbe::Error& error) {
    std::printf("%s\n", error.what());
    // A level that this machine lacks is no failure; a misspelt one is.
    return requested != nullptr && is_known_level(requested) ? kSkipped : 1;
  }
  if (requested != nullptr && abbe::isa_level() != requested) {
    std::printf("ABBE_ISA=%s was asked for, the program runs at %s\n", requested,
                abbe::isa_level().c_str());
    return 1;
  }
  return RUN_ALL_TESTS();
}
