/// The commands of the program `abbe`, and the one place where errors become messages.
#pragma once

namespace abbe {

/// Runs the program; every exception ends here, as one line on stderr.
/// Errors: none; the exit code says what happened.
int run_program(int argc, const char* const* argv);

}  // namespace abbe
