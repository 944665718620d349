/// Numbers in double precision that single precision holds exactly.
#pragma once

#include "abbe/math/vec.h"

namespace abbe {

/// The nearest numbers of single precision. A cast there and back will not do: at -O3 the
/// vectoriser of GCC 12.2 drops such a pair.
inline Vec3d rounded_to_single(const Vec3d& v) {
  Vec3d result(0.0);
  for (int i = 0; i < 3; ++i) {
    const volatile float single = static_cast<float>(v[i]);
    result[i] = static_cast<double>(single);
  }
  return result;
}

}  // namespace abbe
