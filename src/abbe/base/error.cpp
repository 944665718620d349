#include "abbe/base/error.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace abbe {
namespace {

// Names come from files: a control character must not reach a terminal, nor break the one line.
std::string printable(const std::string& text) {
  constexpr std::size_t kLongest = 300;
  std::string result;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    result += byte < 0x20 || byte == 0x7f ? '?' : c;
    if (result.size() >= kLongest) return result + "...";
  }
  return result;
}

std::string message_of(const ErrorDetail& detail) {
  std::string text;
  if (!detail.where.empty()) text += printable(detail.where) + ": ";
  if (!detail.found.empty()) text += "found " + printable(detail.found);
  if (!detail.expected.empty()) {
    if (!detail.found.empty()) text += ", ";
    text += "expected " + printable(detail.expected);
  }
  if (!detail.choices.empty()) {
    text += " (one of ";
    for (std::size_t i = 0; i < detail.choices.size(); ++i) {
      text += (i == 0 ? "" : ", ") + printable(detail.choices[i]);
    }
    text += ")";
  }
  return text;
}

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({substituted, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

Error::Error(ErrorDetail detail) : detail_(std::move(detail)), message_(message_of(detail_)) {}

void throw_input_error(std::string where, std::string found, std::string expected,
                       std::vector<std::string> choices) {
  throw Error({ErrorKind::Input, std::move(where), std::move(found), std::move(expected),
               std::move(choices)});
}

void throw_usage_error(std::string where, std::string found, std::string expected,
                       std::vector<std::string> choices) {
  throw Error({ErrorKind::Usage, std::move(where), std::move(found), std::move(expected),
               std::move(choices)});
}

void throw_output_error(std::string where, std::string found, std::string expected) {
  throw Error({ErrorKind::Output, std::move(where), std::move(found), std::move(expected)});
}

std::size_t check_choice(const std::string& where, const std::string& name,
                         const std::string& expected, const std::vector<std::string>& choices) {
  const auto found = std::find(choices.begin(), choices.end(), name);
  if (found == choices.end()) throw_usage_error(where, "\"" + name + "\"", expected, choices);
  return static_cast<std::size_t>(found - choices.begin());
}

std::vector<std::string> nearest_names(const std::string& name,
                                       const std::vector<std::string>& names, std::size_t count) {
  std::vector<std::pair<std::size_t, std::string>> ranked;
  ranked.reserve(names.size());
  for (const std::string& candidate : names) {
    // An id is a path; people misspell its last part.
    const std::string tail = candidate.substr(candidate.find_last_of('/') + 1);
    ranked.emplace_back(std::min(edit_distance(name, candidate), edit_distance(name, tail)),
                        candidate);
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> result;
  for (std::size_t i = 0; i < std::min(count, ranked.size()); ++i) {
    result.push_back(ranked[i].second);
  }
  return result;
}

}  // namespace abbe
