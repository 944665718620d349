/// Flat aligned arrays of plain records, on large pages where the system grants them.
#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>

namespace abbe {

/// Memory of at least `bytes`, zeroed, aligned to a cache line, or to 2 MiB when it is that large.
/// Errors: std::bad_alloc.
void* allocate_zeroed(std::size_t bytes);
/// Gives back what allocate_zeroed(bytes) returned.
void release_memory(void* memory, std::size_t bytes) noexcept;

/// An array of plain records whose size is fixed when it is made.
template <typename T>
class FlatArray {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  FlatArray() = default;
  explicit FlatArray(std::size_t size)
      : data_(static_cast<T*>(allocate_zeroed(size * sizeof(T))), Release{size * sizeof(T)}),
        size_(size) {}

  T* data() { return data_.get(); }
  const T* data() const { return data_.get(); }
  std::size_t size() const { return size_; }
  std::size_t bytes() const { return size_ * sizeof(T); }
  T& operator[](std::size_t i) { return data_.get()[i]; }
  const T& operator[](std::size_t i) const { return data_.get()[i]; }

 private:
  struct Release {
    std::size_t bytes = 0;
    void operator()(T* memory) const noexcept { release_memory(memory, bytes); }
  };
  std::unique_ptr<T, Release> data_;
  std::size_t size_ = 0;
};

}  // namespace abbe
