/// What the program says on stderr while it works.
#pragma once

#include <string>

#include "abbe/base/notes.h"

namespace abbe {

/// The messages of a command; a quiet one swallows all but errors.
class Console {
 public:
  explicit Console(bool quiet) : quiet_(quiet) {}

  /// Whether progress may be drawn: stderr is a terminal, and not quiet.
  bool is_live() const;

  /// `abbe: TEXT`.
  void say(const std::string& text) const;
  /// A line for each note; those that say the same about several places become one.
  void show(const Notes& notes) const;

 private:
  bool quiet_;
};

/// `abbe: error: TEXT`, always as one line.
void print_error(const std::string& text);

}  // namespace abbe
