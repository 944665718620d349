/// Arrays that lie in a file and come into memory page by page, where they are read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace abbe {

/// Bytes of a PageStore; they are there as long as this is.
struct PagedBytes;

/// A file without a name in the folder that TMPDIR names, or /var/tmp, which keeps what there is no
/// memory for. What is read of it costs memory until let_go_of_pages() finds too much of it there;
/// what is read is the same, whenever that is. All functions may be called by any thread.
class PageStore : public std::enable_shared_from_this<PageStore> {
 public:
  /// At most about so many bytes of pages are left in memory by let_go_of_pages().
  /// Errors: an output Error when the folder takes no file.
  static std::shared_ptr<PageStore> open(std::uint64_t resident_bytes);
  ~PageStore();
  PageStore(const PageStore&) = delete;
  PageStore& operator=(const PageStore&) = delete;

  /// Writes bytes to the file.
  /// Errors: an output Error when the folder has no room for them.
  std::shared_ptr<const PagedBytes> keep(const void* bytes, std::size_t count);

  /// Forgets all pages in memory.
  void let_go() const;

 private:
  PageStore() = default;
  void forget(const void* data, std::size_t count);
  friend void let_go_of_pages();
  friend struct PagedBytes;

  struct State;
  std::unique_ptr<State> state_;
};

struct PagedBytes {
  PagedBytes() = default;
  PagedBytes(const PagedBytes&) = delete;
  PagedBytes& operator=(const PagedBytes&) = delete;
  ~PagedBytes();

  std::shared_ptr<PageStore> store;
  const void* data = nullptr;
  std::size_t count = 0;
};

/// Lets every store forget its pages where too many are in memory: to be called now and then.
void let_go_of_pages();

}  // namespace abbe
