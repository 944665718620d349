/// The commands of the program `abbe`, and the one place where errors become messages.
#pragma once

namespace abbe {

/// Exit codes of the program.
enum class ExitCode : int {
  Done = 0,
  Exceeded = 1,      ///< A comparison went past its threshold.
  Usage = 2,         ///< A wrong option or argument.
  BadInput = 3,      ///< A file or scene that cannot be understood.
  OutputFailed = 4,  ///< A result that cannot be written.
  Interrupted = 130,
};

/// Runs the program; every exception ends here, as one line on stderr.
/// Errors: none; the exit code says what happened.
int run_program(int argc, const char* const* argv);

}  // namespace abbe
