#include "abbe/load/gltf/document/document.h"

#include <fmt/format.h>

#include <algorithm>

#include "abbe/base/error.h"
#include "abbe/base/file.h"

namespace abbe::gltf {
namespace {

// Far above what glTF needs (about 10); far below what overflows a recursive reader's stack.
constexpr std::size_t kMaxNesting = 256;
// A tree takes up to ten times its text, so the text is bounded apart from the file.
constexpr std::uint64_t kMaxJsonBytes = std::uint64_t{1} << 30;

std::uint32_t u32_at(Bytes bytes, std::size_t offset) {
  return bytes[offset] | bytes[offset + 1] << 8 | bytes[offset + 2] << 16 |
         static_cast<std::uint32_t>(bytes[offset + 3]) << 24;
}

bool starts_with(Bytes bytes, std::initializer_list<int> prefix) {
  return bytes.size() >= prefix.size() && std::equal(prefix.begin(), prefix.end(), bytes.begin());
}

Json parse(std::string_view text, const std::string& file_name) {
  const std::size_t depth = nesting_depth(text);
  if (depth > kMaxNesting) {
    throw_input_error(file_name, fmt::format("JSON nested {} deep", depth),
                      fmt::format("at most {} levels", kMaxNesting));
  }
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    const std::size_t at = std::min(error.byte == 0 ? 0 : error.byte - 1, text.size());
    const auto line =
        1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    const std::size_t line_start = at == 0 ? std::string_view::npos : text.rfind('\n', at - 1);
    const std::size_t column = line_start == std::string_view::npos ? at + 1 : at - line_start;
    // The library's text names its exception and the place first; the cause stands behind.
    std::string cause = error.what();
    const std::size_t colon = cause.rfind("; expected");
    if (colon != std::string::npos) cause.resize(colon);
    const std::size_t start = cause.find(" - ");
    if (start != std::string::npos) cause = cause.substr(start + 3);
    throw_input_error(fmt::format("{}: line {}, column {}", file_name, line, column), cause,
                      "JSON");
  } catch (const Json::exception& error) {
    std::string cause = error.what();
    const std::size_t bracket = cause.find("] ");
    if (bracket != std::string::npos) cause = cause.substr(bracket + 2);
    throw_input_error(file_name, cause, "JSON with numbers in the range of double precision");
  }
}

}  // namespace

std::size_t nesting_depth(std::string_view json) {
  std::size_t depth = 0;
  std::size_t deepest = 0;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (c == '"') {
      for (++i; i < json.size() && json[i] != '"'; ++i) {
        if (json[i] == '\\') ++i;
      }
    } else if (c == '[' || c == '{') {
      deepest = std::max(deepest, ++depth);
    } else if ((c == ']' || c == '}') && depth > 0) {
      --depth;
    }
  }
  return deepest;
}

Document::Document(const std::filesystem::path& file, Notes& notes, bool strict)
    : file_name_(file.string()), notes_(notes), is_strict_(strict) {
  Bytes bytes = keep(read_file(file, file_name_, kMaxFileBytes));
  std::error_code error;
  folder_ = std::filesystem::canonical(file.has_parent_path() ? file.parent_path() : ".", error);
  if (error) throw_input_error(file_name_, "no such folder", "an existing folder");

  if (bytes.empty()) throw_input_error(file_name_, "an empty file", "a glTF file");
  // gzip, and zlib at its levels of compression.
  for (const int level : {0x01, 0x5e, 0x9c, 0xda}) {
    if (starts_with(bytes, {0x1f, 0x8b}) || starts_with(bytes, {0x78, level})) {
      throw_input_error(file_name_, "compressed data", "an uncompressed .gltf or .glb file");
    }
  }
  if (starts_with(bytes, {0xff, 0xfe}) || starts_with(bytes, {0xfe, 0xff}) ||
      starts_with(bytes, {'{', 0})) {
    throw_input_error(file_name_, "UTF-16 text", "JSON in UTF-8");
  }
  if (starts_with(bytes, {'g', 'l', 'T', 'F'})) bytes = split_glb(bytes);
  if (starts_with(bytes, {0xef, 0xbb, 0xbf})) {
    notes_.warn(file_name_, "a byte order mark stands before the JSON; glTF allows none");
    bytes = bytes.subspan(3);
  }
  if (bytes.size() > kMaxJsonBytes) {
    throw_input_error(file_name_, fmt::format("{} bytes of JSON", bytes.size()),
                      fmt::format("at most {}", kMaxJsonBytes));
  }
  json_ = parse({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file_name_);
  if (!binary_chunk_) kept_.clear();  // The tree has it all.
}

void Document::fault(const std::string& pointer, const std::string& found,
                     const std::string& expected, const std::string& consequence) {
  if (is_strict_) throw_input_error(where(pointer), found, expected);
  if (!first_fault_) {
    first_fault_ = Error({.where = where(pointer), .found = found, .expected = expected});
  }
  notes_.warn(where(pointer), fmt::format("{}, expected {}; {}", found, expected, consequence));
}

Bytes Document::split_glb(Bytes file) {
  constexpr std::uint32_t kJsonChunk = 0x4e4f534a;
  constexpr std::uint32_t kBinaryChunk = 0x004e4942;
  if (file.size() < 20) {
    throw_input_error(file_name_, fmt::format("{} bytes", file.size()),
                      "a .glb header and a JSON chunk header, 20 bytes");
  }
  if (u32_at(file, 4) != 2) {
    throw_input_error(file_name_, fmt::format("container version {}", u32_at(file, 4)),
                      "version 2");
  }
  const std::uint64_t length = u32_at(file, 8);
  if (length > file.size()) {
    throw_input_error(file_name_, fmt::format("{} bytes, cut short", file.size()),
                      fmt::format("the {} that the header states", length));
  }
  if (length < file.size()) {
    notes_.warn(file_name_, fmt::format("{} bytes behind the stated end of the file are ignored",
                                        file.size() - length));
    file = file.first(static_cast<std::size_t>(length));
  }
  Bytes json;
  std::size_t offset = 12;
  for (int chunk = 0; offset + 8 <= file.size(); ++chunk) {
    const std::uint64_t size = u32_at(file, offset);
    const std::uint32_t type = u32_at(file, offset + 4);
    const std::string place = fmt::format("{}: chunk {}", file_name_, chunk);
    if (size > file.size() - offset - 8) {
      throw_input_error(place, fmt::format("a length of {} bytes", size),
                        fmt::format("at most the {} that are left", file.size() - offset - 8));
    }
    if (size % 4 != 0) notes_.warn(place, "its length is not a multiple of 4");
    const Bytes content = file.subspan(offset + 8, static_cast<std::size_t>(size));
    if (chunk == 0) {
      if (type != kJsonChunk) {
        throw_input_error(place, fmt::format("type 0x{:08x}", type), "JSON, 0x4e4f534a");
      }
      json = content;
    } else if (type == kBinaryChunk && !binary_chunk_) {
      binary_chunk_ = content;
    }
    offset += 8 + static_cast<std::size_t>(size);
  }
  return json;
}

void Document::count(Bytes bytes) {
  bytes_read_ += bytes.size();
  hash_ = hash_bytes(bytes.data(), bytes.size(), hash_);
}

Bytes Document::keep(std::vector<std::uint8_t> bytes) {
  count(bytes);
  kept_.push_back(std::move(bytes));
  return kept_.back();
}

std::string Document::content_hash() const {
  return fmt::format("{:016x}", hash_);
}

}  // namespace abbe::gltf
