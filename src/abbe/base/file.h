/// Reading files that may be hostile, and writing files that are always whole.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace abbe {

/// The bytes of a regular file.
/// Errors: input Error at `where` when missing, not a regular file (a FIFO or device would block or
///         never end) or larger than `max_bytes`.
std::vector<std::uint8_t> read_file(const std::filesystem::path& file, const std::string& where,
                                    std::uint64_t max_bytes);

/// Calls `write` with the path of a temporary file beside the target (same suffix), then renames it
/// over the target; on an exception the temporary is removed and the target untouched.
/// Errors: output Error when the folder is missing or not writable, or the target is a folder.
void write_atomically(const std::filesystem::path& target,
                      const std::function<void(const std::filesystem::path& temporary)>& write);

/// A whole text file, or none. Errors: output Error.
void write_text(const std::filesystem::path& target, const std::string& text);

/// Checks, before minutes of work, that write_atomically could succeed. Errors: output Error.
void check_writable(const std::filesystem::path& target);

/// 64-bit FNV-1a, to be continued from a previous result.
std::uint64_t hash_bytes(const void* data, std::size_t size,
                         std::uint64_t previous = 0xcbf29ce484222325ull);

/// Folder of the running program.
std::filesystem::path program_folder();

}  // namespace abbe
