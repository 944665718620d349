#include "abbe/cli/print/console.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <map>
#include <vector>

#include "abbe/base/text.h"

namespace abbe {
namespace {

/// Notes shown before the rest is only counted.
constexpr std::size_t kMaxNotes = 20;

void print_line(const std::string& text) {
  const std::string line = printable(text) + "\n";
  std::fwrite(line.data(), 1, line.size(), stderr);
}

}  // namespace

bool Console::is_live() const {
  return !quiet_ && ::isatty(STDERR_FILENO) == 1;
}

void Console::say(const std::string& text) const {
  if (!quiet_) print_line("abbe: " + text);
}

void Console::show(const Notes& notes) const {
  if (quiet_) return;
  struct Group {
    const Note* first;
    std::size_t count;
  };
  std::vector<Group> groups;
  std::map<std::string, std::size_t> group_of;
  for (const Note& note : notes.all()) {
    const auto [known, is_new] = group_of.emplace(note.text, groups.size());
    if (is_new) {
      groups.push_back({&note, 1});
    } else {
      ++groups[known->second].count;
    }
  }
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (i == kMaxNotes) {
      print_line(fmt::format("abbe: {} more notes; `abbe inspect` lists all", groups.size() - i));
      return;
    }
    const Note& note = *groups[i].first;
    const char* kind = note.kind == NoteKind::Warning ? "warning" : "note";
    std::string line = fmt::format("abbe: {}: ", kind);
    if (!note.where.empty()) line += note.where + ": ";
    line += note.text;
    if (groups[i].count > 1) line += fmt::format(" (and {} more like this)", groups[i].count - 1);
    print_line(line);
  }
}

void print_error(const std::string& text) {
  print_line("abbe: error: " + text);
}

}  // namespace abbe
