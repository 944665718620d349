/// The commands of the program. Each adds its options to a CLI11 subcommand, whose callback runs
/// it.
#pragma once

#include <CLI/CLI.hpp>

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

/// Every function adds one subcommand; when it has run, `code` is its exit code.
void add_render_command(CLI::App& program, ExitCode& code);
void add_compare_command(CLI::App& program, ExitCode& code);
void add_diff_command(CLI::App& program, ExitCode& code);
void add_display_command(CLI::App& program, ExitCode& code);
void add_golden_command(CLI::App& program, ExitCode& code);
void add_inspect_command(CLI::App& program, ExitCode& code);
void add_probe_command(CLI::App& program, ExitCode& code);
void add_spectra_command(CLI::App& program, ExitCode& code);

}  // namespace abbe
