#include "abbe/cli/cli.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <new>
#include <string>
#include <vector>

#include "abbe/base/error.h"
#include "abbe/base/isa.h"
#include "abbe/cli/commands/commands.h"
#include "abbe/cli/options/fields.h"
#include "abbe/cli/print/console.h"

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

// The command whose options were being read.
const CLI::App& current_command(const CLI::App& program) {
  const CLI::App* command = &program;
  while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
  return *command;
}

std::string path_of(const CLI::App& command) {
  if (command.get_parent() == nullptr) return "abbe";
  return path_of(*command.get_parent()) + " " + command.get_name();
}

// What CLI11 says about words it cannot place names neither the option nor its neighbours.
[[noreturn]] void throw_unknown_argument(const CLI::App& program) {
  const CLI::App& command = current_command(program);
  const std::vector<std::string> rest = program.remaining(true);
  const auto is_option = [](const std::string& word) { return word.starts_with("-"); };
  const auto option = std::find_if(rest.begin(), rest.end(), is_option);
  if (option == rest.end()) {
    throw_usage_error(path_of(command), "\"" + (rest.empty() ? "" : rest.front()) + "\"",
                      "no further argument");
  }
  std::vector<std::string> names;
  for (const CLI::Option* known : command.get_options()) {
    if (known->nonpositional()) names.push_back("--" + known->get_lnames().front());
  }
  throw_usage_error(path_of(command), "unknown option " + *option,
                    "its options, of which these are nearest", nearest_names(*option, names, 3));
}

void check_command(const CLI::App& program, int argc, const char* const* argv) {
  std::vector<std::string> names;
  for (const CLI::App* command : program.get_subcommands({})) names.push_back(command->get_name());
  const std::string word = argc > 1 ? argv[1] : "";
  if (word.starts_with("-")) return;
  if (std::find(names.begin(), names.end(), word) != names.end()) return;
  throw_usage_error("abbe", word.empty() ? "no command" : "\"" + word + "\"", "a command", names);
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
  add_compare_command(program, code);
  add_diff_command(program, code);
  add_golden_command(program, code);
  add_inspect_command(program, code);
  add_probe_command(program, code);
  add_spectra_command(program, code);
  check_command(program, argc, argv);
  try {
    program.parse(argc, argv);
  } catch (const CLI::Success& answer) {
    return static_cast<ExitCode>(program.exit(answer));
  } catch (const CLI::ExtrasError&) {
    throw_unknown_argument(program);
  } catch (const CLI::ParseError& error) {
    print_error(std::string(error.what()) + " (see " + path_of(current_command(program)) +
                " --help)");
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
    print_error(with_options(error).what());
    code = exit_code_of(error.detail().kind);
  } catch (const std::bad_alloc&) {
    print_error("out of memory");
  } catch (const std::exception& error) {
    print_error(error.what());
  }
  return static_cast<int>(code);
}

}  // namespace abbe
