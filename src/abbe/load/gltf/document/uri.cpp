
#include <algorithm>
#include <array>
#include <iterator>
#include <system_error>

#include "abbe/base/error.h"
#include "abbe/base/file.h"
#include "abbe/load/gltf/document/document.h"

namespace abbe::gltf {
namespace {

namespace fs = std::filesystem;

constexpr const char* kInsideFolder = "a relative path inside the scene's folder";

int hex_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

constexpr std::string_view kData = "data:";

// Whether a path, followed name by name, is outside of where it starts at any time.
bool leaves(const fs::path& relative) {
  int depth = 0;
  for (const fs::path& name : relative) {
    if (name == "..") {
      if (--depth < 0) return true;
    } else if (!name.empty() && name != ".") {
      ++depth;
    }
  }
  return false;
}

// Whether a URI begins with a scheme such as http: or file:.
bool has_scheme(const std::string& uri) {
  const std::size_t end = uri.find_first_of(":/?#");
  if (end == std::string::npos || end == 0 || uri[end] != ':' || !is_letter(uri[0])) return false;
  for (std::size_t i = 0; i < end; ++i) {
    const char c = uri[i];
    if (!is_letter(c) && !(c >= '0' && c <= '9') && c != '+' && c != '-' && c != '.') return false;
  }
  return true;
}

std::string quoted(const std::string& text) {
  constexpr std::size_t kLongest = 120;
  return text.size() > kLongest ? "\"" + text.substr(0, kLongest) + "...\"" : "\"" + text + "\"";
}

}  // namespace

bool is_data(const std::string& uri) {
  const auto is_same = [](char letter, char c) { return c == letter || c == letter - 'a' + 'A'; };
  return uri.size() >= kData.size() && std::equal(kData.begin(), kData.end(), uri.begin(), is_same);
}

std::string percent_decoded(const std::string& text, const std::string& where) {
  std::string result;
  result.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      result += text[i];
      continue;
    }
    const int high = i + 2 < text.size() ? hex_value(text[i + 1]) : -1;
    const int low = i + 2 < text.size() ? hex_value(text[i + 2]) : -1;
    if (high < 0 || low < 0) {
      throw_input_error(where, "the broken escape " + quoted(text.substr(i, 3)),
                        "% and two hex digits");
    }
    result += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return result;
}

std::vector<std::uint8_t> base64_decoded(std::string_view given, const std::string& where) {
  // Lines may be broken, as in mail.
  constexpr std::string_view kBlank = " \t\r\n";
  std::string without_blanks;
  std::string_view text = given;
  if (given.find_first_of(kBlank) != std::string_view::npos) {
    std::copy_if(given.begin(), given.end(), std::back_inserter(without_blanks),
                 [&](char c) { return kBlank.find(c) == std::string_view::npos; });
    text = without_blanks;
  }
  static const std::array<std::int8_t, 256> kValues = [] {
    std::array<std::int8_t, 256> values{};
    values.fill(-1);
    constexpr std::string_view kAlphabet =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (std::size_t i = 0; i < kAlphabet.size(); ++i) {
      values[static_cast<unsigned char>(kAlphabet[i])] = static_cast<std::int8_t>(i);
    }
    return values;
  }();
  std::size_t padding = 0;
  while (padding < 2 && !text.empty() && text.back() == '=') {
    text.remove_suffix(1);
    ++padding;
  }
  if (text.size() % 4 == 1 || (padding > 0 && (text.size() + padding) % 4 != 0)) {
    throw_input_error(where, "base64 data of a wrong length", "a multiple of 4 characters");
  }
  // Six bits a character, most significant first; what is left of a last group is dropped.
  std::vector<std::uint8_t> bytes(text.size() * 3 / 4);
  std::uint32_t bits = 0;
  int bit_count = 0;
  std::size_t written = 0;
  for (const char c : text) {
    const int value = kValues[static_cast<unsigned char>(c)];
    if (value < 0) {
      throw_input_error(where, "the character " + quoted(std::string(1, c)) + " in base64 data",
                        "A-Z, a-z, 0-9, + and /");
    }
    bits = bits << 6 | static_cast<std::uint32_t>(value);
    bit_count += 6;
    if (bit_count >= 8) {
      bit_count -= 8;
      bytes[written++] = static_cast<std::uint8_t>(bits >> bit_count);
    }
  }
  return bytes;
}

fs::path Document::checked_relative(const std::string& path, const std::string& pointer) const {
  const std::string place = where(pointer);
  if (path.empty()) throw_input_error(place, "an empty path", kInsideFolder);
  if (path.find('\0') != std::string::npos) {
    throw_input_error(place, "a path with a NUL byte", kInsideFolder);
  }
  // On the systems glTF is exchanged with a backslash separates folders: refused, not guessed.
  if (path.find('\\') != std::string::npos) {
    throw_input_error(place, quoted(path) + " with a backslash", kInsideFolder);
  }
  if (has_scheme(path)) throw_input_error(place, quoted(path) + " with a scheme", kInsideFolder);
  const fs::path relative(path);
  // By the text alone, before the file system is asked anything.
  if (relative.is_absolute() || leaves(relative)) {
    throw_input_error(place, quoted(path) + ", which leaves the folder", kInsideFolder);
  }
  return relative;
}

bool Document::is_inside(const fs::path& candidate) const {
  const auto [end, ignored] =
      std::mismatch(folder_.begin(), folder_.end(), candidate.begin(), candidate.end());
  return end == folder_.end();
}

fs::path Document::resolve_path(const std::string& path, const std::string& pointer) const {
  const fs::path relative = checked_relative(path, pointer);
  std::error_code error;
  const fs::path canonical = fs::canonical(folder_ / relative, error);
  if (error) throw_input_error(where(pointer), "no file " + quoted(path), "an existing file");
  if (!is_inside(canonical)) {
    throw_input_error(where(pointer), quoted(path) + ", a link out of the folder", kInsideFolder);
  }
  return canonical;
}

std::string Document::decoded_uri(const std::string& uri, const std::string& pointer) const {
  // The scheme is looked for before and after decoding: %66ile: is one as well.
  if (has_scheme(uri)) {
    throw_input_error(where(pointer), quoted(uri) + " with a scheme",
                      std::string("data: or ") + kInsideFolder);
  }
  return percent_decoded(uri, where(pointer));
}

void Document::check_uri(const std::string& uri, const std::string& pointer) const {
  checked_relative(decoded_uri(uri, pointer), pointer);
}

bool Document::has_uri(const std::string& uri, const std::string& pointer) const {
  if (is_data(uri)) return true;
  std::error_code error;
  return fs::exists(folder_ / checked_relative(decoded_uri(uri, pointer), pointer), error);
}

fs::path Document::resolve_uri(const std::string& uri, const std::string& pointer) const {
  return resolve_path(decoded_uri(uri, pointer), pointer);
}

Bytes Document::read_uri(const std::string& uri, const std::string& pointer) {
  if (!is_data(uri)) return read_resolved(resolve_uri(uri, pointer), pointer);

  const std::string place = where(pointer);
  const std::size_t comma = uri.find(',');
  if (comma == std::string::npos) throw_input_error(place, "data: without a comma", "a data: URI");
  const std::string type = uri.substr(kData.size(), comma - kData.size());
  const std::string_view content = std::string_view(uri).substr(comma + 1);
  constexpr std::string_view kBase64 = ";base64";
  const bool is_base64 = type.ends_with(kBase64);
  if (!is_base64) {
    const std::string decoded = percent_decoded(std::string(content), place);
    kept_.emplace_back(decoded.begin(), decoded.end());
    return kept_.back();
  }
  const std::string mime = type.substr(0, type.size() - kBase64.size());
  if (mime != "application/octet-stream" && mime != "application/gltf-buffer" &&
      mime.rfind("image/", 0) != 0) {
    notes_.warn(place, "unusual media type " + quoted(mime) + "; the bytes are used all the same");
  }
  kept_.push_back(base64_decoded(content, place));
  return kept_.back();
}

Bytes Document::read_resolved(const fs::path& file, const std::string& pointer) {
  const auto known = files_.find(file);
  if (known != files_.end()) return known->second;
  const Bytes bytes = keep(read_file(file, where(pointer), kMaxFileBytes));
  files_.emplace(file, bytes);
  return bytes;
}

std::shared_ptr<const std::vector<std::uint8_t>> Document::read_once(const fs::path& file,
                                                                     const std::string& pointer) {
  auto bytes = std::make_shared<const std::vector<std::uint8_t>>(
      read_file(file, where(pointer), kMaxFileBytes));
  if (read_once_.insert(file).second) count(*bytes);
  return bytes;
}

}  // namespace abbe::gltf
