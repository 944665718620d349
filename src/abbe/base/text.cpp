#include "abbe/base/text.h"

#include <charconv>
#include <cmath>

namespace abbe {
namespace {

template <typename T>
std::optional<T> all_of(std::string_view text) {
  T value{};
  const char* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stopped != end) return std::nullopt;
  return value;
}

}  // namespace

std::optional<double> number_of(std::string_view text) {
  const std::optional<double> number = all_of<double>(text);
  return number && std::isfinite(*number) ? number : std::nullopt;
}

std::optional<int> whole_number_of(std::string_view text) {
  return all_of<int>(text);
}

std::optional<std::uint32_t> whole_u32_of(std::string_view text) {
  return all_of<std::uint32_t>(text);
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  while (true) {
    const std::size_t end = text.find(separator, begin);
    parts.push_back(text.substr(begin, end - begin));
    if (end == std::string::npos) return parts;
    begin = end + 1;
  }
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return lower;
}

std::string in_quotes(std::string_view text) {
  return '"' + std::string(text) + '"';
}

std::string printable(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  }
  return text;
}

}  // namespace abbe
