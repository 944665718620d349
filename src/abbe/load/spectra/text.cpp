#include "abbe/load/spectra/text.h"

#include <fmt/format.h>

#include <algorithm>

#include "abbe/base/error.h"
#include "abbe/base/text.h"

namespace abbe {

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  constexpr std::string_view kBlank = " \t";
  std::size_t begin = text.find_first_not_of(kBlank);
  while (begin != std::string_view::npos) {
    const std::size_t end = std::min(text.find_first_of(kBlank, begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    begin = text.find_first_not_of(kBlank, end);
  }
  return words;
}

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    lines.push_back(line);
  }
  return lines;
}

std::vector<double> numbers_of(const std::vector<std::string_view>& words, std::size_t first,
                               const std::string& where) {
  std::vector<double> numbers;
  for (std::size_t i = first; i < words.size(); ++i) {
    const auto number = finite_number_of(words[i]);
    if (!number) throw_input_error(where, "\"" + std::string(words[i]) + "\"", "a finite number");
    numbers.push_back(*number);
  }
  return numbers;
}

void add_rising(double wavelength_nm, const std::string& where,
                std::vector<double>& wavelengths_nm) {
  if (!wavelengths_nm.empty() && wavelength_nm <= wavelengths_nm.back()) {
    throw_input_error(where, fmt::format("{} nm after {} nm", wavelength_nm, wavelengths_nm.back()),
                      "rising wavelengths");
  }
  wavelengths_nm.push_back(wavelength_nm);
}

std::optional<double> finite_number_of(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  return number_of(word);
}

}  // namespace abbe
