#include "abbe/base/flat_array.h"

#include <sys/mman.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>

namespace abbe {

namespace {

constexpr std::size_t kCacheLine = 64;
constexpr std::size_t kLargePage = std::size_t{2} << 20;

std::size_t round_up(std::size_t bytes, std::size_t unit) {
  return (bytes + unit - 1) / unit * unit;
}

// Whole large pages, straight from the system. A tree of 100 MB has 25 000 small pages, more than
// any TLB holds; and memory that malloc hands out again keeps the small pages of its first use.
void* map_large_pages(std::size_t size) {
  // Room for an aligned part; what lies around it is given back.
  void* const room =
      mmap(nullptr, size + kLargePage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (room == MAP_FAILED) throw std::bad_alloc();
  auto* const begin = static_cast<std::byte*>(room);
  const auto address = reinterpret_cast<std::uintptr_t>(room);
  const std::size_t before = round_up(address, kLargePage) - address;
  const std::size_t behind = kLargePage - before;
  if (before > 0) munmap(begin, before);
  if (behind > 0) munmap(begin + before + size, behind);
  madvise(begin + before, size, MADV_HUGEPAGE);  // A refusal costs only speed.
  return begin + before;
}

}  // namespace

void* allocate_zeroed(std::size_t bytes) {
  if (bytes == 0) return nullptr;
  if (bytes >= kLargePage) return map_large_pages(round_up(bytes, kLargePage));
  const std::size_t size = round_up(bytes, kCacheLine);
  void* const memory = std::aligned_alloc(kCacheLine, size);
  if (memory == nullptr) throw std::bad_alloc();
  std::memset(memory, 0, size);
  return memory;
}

void release_memory(void* memory, std::size_t bytes) noexcept {
  if (bytes >= kLargePage) {
    munmap(memory, round_up(bytes, kLargePage));
  } else {
    std::free(memory);
  }
}

}  // namespace abbe
