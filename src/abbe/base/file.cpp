#include "abbe/base/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <fstream>
#include <system_error>

#include "abbe/base/error.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

std::string reason(int error_number) {
  return std::generic_category().message(error_number);
}

// A file descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int value) : value_(value) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (value_ >= 0) ::close(value_);
  }
  int get() const { return value_; }

 private:
  int value_;
};

std::string kind_of(const struct stat& status) {
  if (S_ISDIR(status.st_mode)) return "a folder";
  if (S_ISFIFO(status.st_mode)) return "a named pipe";
  if (S_ISCHR(status.st_mode) || S_ISBLK(status.st_mode)) return "a device";
  if (S_ISSOCK(status.st_mode)) return "a socket";
  return "no regular file";
}

// The target's folder must exist, and what stands at the target may only be a file.
// Returns the path that will be renamed over: behind a symbolic link, not the link itself.
fs::path checked_target(const fs::path& target) {
  const std::string where = target.string();
  if (target.filename().empty()) throw_output_error(where, "no file name", "a file");
  std::error_code error;
  fs::path resolved = target;
  if (fs::is_symlink(target, error)) {
    const fs::path behind = fs::weakly_canonical(target, error);
    if (!error) resolved = behind;
  }
  const fs::path folder = resolved.has_parent_path() ? resolved.parent_path() : fs::path(".");
  const fs::file_status folder_status = fs::status(folder, error);
  if (!fs::exists(folder_status)) {
    throw_output_error(where, "no folder " + folder.string(), "an existing folder");
  }
  if (!fs::is_directory(folder_status)) {
    throw_output_error(where, folder.string() + ", which is no folder", "a folder");
  }
  const fs::file_status status = fs::status(resolved, error);
  if (fs::is_directory(status)) throw_output_error(where, "a folder", "a file to write");
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw_output_error(where, "a device or pipe", "a file to write");
  }
  return resolved;
}

// Hidden, of the same suffix (writers choose the format by it), unique among processes and threads.
fs::path temporary_beside(const fs::path& target) {
  static std::atomic<unsigned> counter{0};
  const std::string name = "." + target.stem().string() + "." + std::to_string(::getpid()) + "-" +
                           std::to_string(counter.fetch_add(1)) + target.extension().string();
  return target.has_parent_path() ? target.parent_path() / name : fs::path(name);
}

// Takes a temporary file away unless it became the target.
struct Remover {
  fs::path file;
  ~Remover() {
    if (!file.empty()) ::unlink(file.c_str());
  }
};

}  // namespace

std::vector<std::uint8_t> read_file(const fs::path& file, const std::string& where,
                                    std::uint64_t max_bytes) {
  // Without O_NONBLOCK, opening a named pipe would wait for a writer for ever.
  const Descriptor descriptor(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY));
  if (descriptor.get() < 0) {
    const int error_number = errno;
    if (error_number == ENOENT || error_number == ENOTDIR) {
      throw_input_error(where, "no file " + file.string(), "an existing file");
    }
    throw_input_error(where, file.string() + " (" + reason(error_number) + ")", "a readable file");
  }
  struct stat status {};
  if (::fstat(descriptor.get(), &status) != 0) {
    throw_input_error(where, file.string() + " (" + reason(errno) + ")", "a readable file");
  }
  if (!S_ISREG(status.st_mode)) {
    throw_input_error(where, file.string() + ", " + kind_of(status), "a regular file");
  }
  const auto size = static_cast<std::uint64_t>(status.st_size);
  if (size > max_bytes) {
    throw_input_error(where, file.string() + " of " + std::to_string(size) + " bytes",
                      "at most " + std::to_string(max_bytes) + " bytes");
  }
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(size));
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got = ::read(descriptor.get(), bytes.data() + done, bytes.size() - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) {
      throw_input_error(where, file.string() + " (" + reason(errno) + ")", "a readable file");
    }
    if (got == 0) break;  // The file shrank meanwhile: what there is decides.
    done += static_cast<std::size_t>(got);
  }
  bytes.resize(done);
  return bytes;
}

void write_atomically(const fs::path& target, const std::function<void(const fs::path&)>& write) {
  const fs::path resolved = checked_target(target);
  Remover temporary{temporary_beside(resolved)};
  write(temporary.file);
  {
    const Descriptor descriptor(::open(temporary.file.c_str(), O_RDONLY | O_CLOEXEC));
    // Renamed before its bytes are on disk, the file could come out of a crash empty.
    if (descriptor.get() < 0 || ::fsync(descriptor.get()) != 0) {
      throw_output_error(target.string(), reason(errno), "a written file");
    }
  }
  if (::rename(temporary.file.c_str(), resolved.c_str()) != 0) {
    throw_output_error(target.string(), reason(errno), "a writable folder");
  }
  temporary.file.clear();
}

void write_text(const fs::path& target, const std::string& text) {
  write_atomically(target, [&](const fs::path& temporary) {
    std::ofstream stream(temporary, std::ios::binary | std::ios::trunc);
    stream << text;
    stream.close();
    if (!stream) {
      throw_output_error(target.string(), "a file that could not be written to its end",
                         "a place with room for it");
    }
  });
}

void check_writable(const fs::path& target) {
  const fs::path resolved = checked_target(target);
  // Permissions, read-only mounts and full disks all show when a file is made; access() lies to
  // root.
  const Remover temporary{temporary_beside(resolved)};
  const Descriptor descriptor(
      ::open(temporary.file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
  if (descriptor.get() < 0) throw_output_error(target.string(), reason(errno), "a writable folder");
}

std::uint64_t hash_bytes(const void* data, std::size_t size, std::uint64_t previous) {
  constexpr std::uint64_t kPrime = 0x100000001b3ull;
  const auto* bytes = static_cast<const unsigned char*>(data);
  std::uint64_t hash = previous;
  for (std::size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * kPrime;
  return hash;
}

fs::path program_folder() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  return error ? fs::current_path() : program.parent_path();
}

}  // namespace abbe
