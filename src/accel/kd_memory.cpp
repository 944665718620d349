#include "accel/kd_memory.h"

#include <sys/mman.h>

#include <cstdlib>
#include <cstring>
#include <new>

namespace abbe {

void* allocate_zeroed(std::size_t bytes) {
  constexpr std::size_t kCacheLine = 64;
  constexpr std::size_t kLargePage = std::size_t{2} << 20;
  if (bytes == 0) return nullptr;
  const std::size_t alignment = bytes >= kLargePage ? kLargePage : kCacheLine;
  const std::size_t size = (bytes + kCacheLine - 1) / kCacheLine * kCacheLine;
  void* const memory =
      std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
  if (memory == nullptr) throw std::bad_alloc();
  // A tree of 100 MB has 25 000 small pages, more than any TLB holds. A refusal costs only speed.
  if (alignment == kLargePage) madvise(memory, bytes, MADV_HUGEPAGE);
  std::memset(memory, 0, size);
  return memory;
}

void release_memory(void* memory) noexcept {
  std::free(memory);
}

}  // namespace abbe
