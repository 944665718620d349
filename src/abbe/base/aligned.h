/// Vectors whose data start on a cache line, for SIMD loads.
#pragma once

#include <oneapi/tbb/cache_aligned_allocator.h>

#include <vector>

namespace abbe {

template <typename T>
using AlignedVector = std::vector<T, oneapi::tbb::cache_aligned_allocator<T>>;

}  // namespace abbe
