#include "abbe/base/paged.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <string>
#include <utility>

#include "abbe/base/error.h"

namespace abbe {
namespace {

// Bytes of files in memory: those of the program and of stores.
std::uint64_t resident_file_bytes() {
  std::FILE* const file = std::fopen("/proc/self/statm", "re");
  if (file == nullptr) return 0;
  unsigned long long size = 0, resident = 0, shared = 0;
  const int read = std::fscanf(file, "%llu %llu %llu", &size, &resident, &shared);
  std::fclose(file);
  return read == 3 ? shared * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) : 0;
}

std::string folder() {
  const char* const named = std::getenv("TMPDIR");
  return named != nullptr && *named != '\0' ? named : "/var/tmp";
}

int open_nameless(const std::string& in) {
  const int direct = ::open(in.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (direct >= 0) return direct;
  std::string name = in + "/abbe-XXXXXX";  // Of file systems that cannot do so.
  const int named = ::mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) ::unlink(name.c_str());
  return named;
}

std::mutex stores_mutex;
std::vector<const PageStore*> stores;
std::atomic<bool> is_any{false};

}  // namespace

struct PageStore::State {
  int file = -1;
  std::uint64_t end = 0;
  std::uint64_t limit = 0;  // Of bytes of files in memory, the program's included.
  mutable std::mutex mutex;
  std::vector<std::pair<void*, std::size_t>> mappings;
};

std::shared_ptr<PageStore> PageStore::open(std::uint64_t resident_bytes) {
  std::shared_ptr<PageStore> store(new PageStore());
  store->state_ = std::make_unique<State>();
  store->state_->file = open_nameless(folder());
  if (store->state_->file < 0) {
    throw_output_error(folder(), std::strerror(errno),
                       "a folder for what there is no memory for; TMPDIR names another");
  }
  store->state_->limit = resident_file_bytes() + resident_bytes;
  const std::lock_guard lock(stores_mutex);
  stores.push_back(store.get());
  is_any = true;
  return store;
}

PageStore::~PageStore() {
  {
    const std::lock_guard lock(stores_mutex);
    std::erase(stores, this);
    is_any = !stores.empty();
  }
  if (state_ && state_->file >= 0) ::close(state_->file);
}

std::shared_ptr<const PagedBytes> PageStore::keep(const void* bytes, std::size_t count) {
  const std::lock_guard lock(state_->mutex);
  const auto page = static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  const std::uint64_t begin = (state_->end + page - 1) / page * page;
  const auto fail = [&] {
    throw_output_error(folder(), std::strerror(errno),
                       fmt::format("room for {} bytes that there is no memory for; TMPDIR names "
                                   "another folder",
                                   begin + count));
  };
  for (std::size_t written = 0; written < count;) {
    const ssize_t now = ::pwrite(state_->file, static_cast<const char*>(bytes) + written,
                                 count - written, static_cast<off_t>(begin + written));
    if (now < 0 && errno == EINTR) continue;
    if (now <= 0) fail();
    written += static_cast<std::size_t>(now);
  }
  void* const data =
      ::mmap(nullptr, count, PROT_READ, MAP_SHARED, state_->file, static_cast<off_t>(begin));
  if (data == MAP_FAILED) fail();
  state_->end = begin + count;
  state_->mappings.emplace_back(data, count);
  auto result = std::make_shared<PagedBytes>();
  result->store = shared_from_this();
  result->data = data;
  result->count = count;
  return result;
}

PagedBytes::~PagedBytes() {
  if (store) store->forget(data, count);
}

void PageStore::forget(const void* data, std::size_t count) {
  const std::lock_guard lock(state_->mutex);
  std::erase_if(state_->mappings, [data](const auto& mapping) { return mapping.first == data; });
  ::munmap(const_cast<void*>(data), count);
}

void PageStore::let_go() const {
  const std::lock_guard lock(state_->mutex);
  // Pages of a file come back with the same bytes when they are read next.
  for (const auto& [data, count] : state_->mappings) ::madvise(data, count, MADV_DONTNEED);
}

void let_go_of_pages() {
  if (!is_any) return;
  const std::lock_guard lock(stores_mutex);
  const std::uint64_t resident = resident_file_bytes();
  for (const PageStore* store : stores) {
    if (resident > store->state_->limit) store->let_go();
  }
}

}  // namespace abbe
