/// What a module has to tell the user without being able to print: warnings and remarks are
/// collected here and shown by cli/.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace abbe {

/// How much a note should worry its reader.
enum class NoteKind {
  Info,     ///< A choice made for the user: a default light rig, an extrapolated formula.
  Warning,  ///< Something ignored, dropped or approximated.
};

/// One thing worth telling.
struct Note {
  NoteKind kind = NoteKind::Info;
  std::string where;  ///< File and place, as in ErrorDetail.
  std::string text;
};

/// Notes in the order in which they were made. Not synchronised: one per thread of work.
class Notes {
 public:
  void info(std::string where, std::string text) {
    notes_.push_back({NoteKind::Info, std::move(where), std::move(text)});
  }
  void warn(std::string where, std::string text) {
    notes_.push_back({NoteKind::Warning, std::move(where), std::move(text)});
  }
  const std::vector<Note>& all() const { return notes_; }

 private:
  std::vector<Note> notes_;
};

}  // namespace abbe
