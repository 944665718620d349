#include "abbe/cli/options/parse.h"

#include <cmath>

#include "abbe/base/error.h"
#include "abbe/base/text.h"

namespace abbe {
namespace {

// Whole numbers between separators, exactly `count` of them.
std::optional<std::vector<int>> whole_numbers(const std::string& text, char separator,
                                              std::size_t count) {
  std::vector<int> numbers;
  for (const std::string& part : split(text, separator)) {
    const std::optional<int> number = whole_number_of(part);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  if (numbers.size() != count) return std::nullopt;
  return numbers;
}

}  // namespace

template <>
double parse_number<double>(const std::string& option, const std::string& text) {
  const auto number = number_of(text);
  if (!number) throw_usage_error(option, in_quotes(text), "a number");
  return *number;
}

template <>
int parse_number<int>(const std::string& option, const std::string& text) {
  const auto number = whole_number_of(text);
  if (!number) throw_usage_error(option, in_quotes(text), "a whole number");
  return *number;
}

template <>
std::uint32_t parse_number<std::uint32_t>(const std::string& option, const std::string& text) {
  const auto number = whole_u32_of(text);
  if (!number) throw_usage_error(option, in_quotes(text), "a whole number from 0 to 4294967295");
  return *number;
}

Vec2i parse_size(const std::string& text) {
  const auto numbers = whole_numbers(text, 'x', 2);
  if (!numbers) throw_usage_error("--size", in_quotes(text), "WxH in pixels, as in 960x540");
  return {(*numbers)[0], (*numbers)[1]};
}

PixelRect parse_crop(const std::string& text) {
  const auto numbers = whole_numbers(text, ',', 4);
  if (!numbers) throw_usage_error("--crop", in_quotes(text), "X0,Y0,X1,Y1 in pixels, half-open");
  return {(*numbers)[0], (*numbers)[1], (*numbers)[2], (*numbers)[3]};
}

Vec2i parse_pixel(const std::string& text) {
  const auto numbers = whole_numbers(text, ',', 2);
  if (!numbers) throw_usage_error("--pixel", in_quotes(text), "X,Y as in 480,270");
  return {(*numbers)[0], (*numbers)[1]};
}

std::pair<double, double> parse_range(const std::string& text) {
  const std::vector<std::string> parts = split(text, ':');
  if (parts.size() == 2) {
    const auto low = number_of(parts[0]);
    const auto high = number_of(parts[1]);
    if (low && high) return {*low, *high};
  }
  throw_usage_error("--range", in_quotes(text), "A:B in nm, as in 400:700");
}

std::vector<double> parse_lines(const std::string& text) {
  std::vector<double> wavelengths_nm;
  for (const std::string& part : split(text, ',')) {
    const auto number = number_of(part);
    if (!number) {
      throw_usage_error("--lines", in_quotes(text),
                        "wavelengths in nm, as in 486.13,587.56,656.27");
    }
    wavelengths_nm.push_back(*number);
  }
  return wavelengths_nm;
}

std::vector<std::string> parse_names(const std::string& text) {
  return split(text, ',');
}

std::optional<double> parse_exposure(const std::string& text) {
  if (text == "auto") return std::nullopt;
  const auto number = number_of(text);
  if (!number || std::abs(*number) > 100.0) {
    throw_usage_error("--exposure", in_quotes(text), "a number of EV from -100 to 100, or auto");
  }
  return number;
}

}  // namespace abbe
