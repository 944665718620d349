#include "cli/cli.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <new>
#include <string>

#include "base/error.h"
#include "base/isa.h"
#include "cli/commands.h"
#include "cli/console.h"

namespace abbe {
namespace {

ExitCode exit_code_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::Usage:
      return ExitCode::Usage;
    case ErrorKind::Output:
      return ExitCode::OutputFailed;
    case ErrorKind::Input:
      break;
  }
  return ExitCode::BadInput;
}

ExitCode parse_and_run(int argc, const char* const* argv) {
  ExitCode code = ExitCode::Done;
  CLI::App program("abbe: a spectral Whitted renderer with colour management", "abbe");
  program.set_version_flag("--version", std::string("abbe ") + ABBE_VERSION, "print the version");
  program.set_help_flag("-h,--help", "print this text");
  program.require_subcommand(1);
  program.get_formatter()->column_width(32);
  add_render_command(program, code);
  add_display_command(program, code);
  try {
    program.parse(argc, argv);
  } catch (const CLI::Success& answer) {
    return static_cast<ExitCode>(program.exit(answer));
  } catch (const CLI::ParseError& error) {
    print_error(std::string(error.what()) + " (see abbe --help)");
    return ExitCode::Usage;
  }
  return code;
}

}  // namespace

int run_program(int argc, const char* const* argv) {
  ExitCode code = ExitCode::BadInput;
  try {
    apply_isa_from_environment();
    code = parse_and_run(argc, argv);
  } catch (const Error& error) {
    print_error(error.what());
    code = exit_code_of(error.detail().kind);
  } catch (const std::bad_alloc&) {
    print_error("out of memory");
  } catch (const std::exception& error) {
    print_error(error.what());
  }
  return static_cast<int>(code);
}

}  // namespace abbe
