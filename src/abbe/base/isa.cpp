#include "abbe/base/isa.h"

#include <hwy/highway.h>
#include <hwy/targets.h>

#include <cstdlib>

#include "abbe/base/error.h"

namespace abbe {
namespace {

// A level allows itself and every lower one; in Highway a better target has a lower bit.
constexpr std::int64_t kSse4 = HWY_SSE4 | HWY_SSSE3;
constexpr std::int64_t kAvx2 = HWY_AVX2 | kSse4;
constexpr std::int64_t kAvx512 = HWY_AVX3 | kAvx2;

}  // namespace

void apply_isa_from_environment() {
  const char* const name = std::getenv("ABBE_ISA");
  if (name == nullptr || *name == '\0') return;
  const std::string level = name;
  std::int64_t allowed = 0;
  std::int64_t needed = 0;
  if (level == "sse4") {
    allowed = kSse4;
    needed = HWY_SSE4;
  } else if (level == "avx2") {
    allowed = kAvx2;
    needed = HWY_AVX2;
  } else if (level == "avx512") {
    allowed = kAvx512;
    needed = HWY_AVX3;
  } else {
    throw_usage_error("ABBE_ISA", level, "an instruction set level", {"sse4", "avx2", "avx512"});
  }
  const std::int64_t machine = hwy::SupportedTargets();
  if ((machine & needed) == 0) {
    throw_usage_error("ABBE_ISA", level,
                      "a level this machine has (its best is " + isa_level() + ")");
  }
  // DisableTargets, not the mock for tests: it cannot be undone by other code of the process.
  hwy::DisableTargets(~allowed);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

std::string isa_level() {
  const std::int64_t targets = hwy::SupportedTargets();
  if (targets & HWY_AVX3) return "avx512";
  if (targets & HWY_AVX2) return "avx2";
  return "sse4";
}

}  // namespace abbe
