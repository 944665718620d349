/// How every command adds its options.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <type_traits>

#include "abbe/base/error.h"
#include "abbe/cli/options/parse.h"

namespace abbe {

/// Adds an option whose help shows `placeholder`. An empty text, as from a variable of the shell
/// that is not set, is a usage Error and not the default.
template <typename T>
CLI::Option* add_shown(CLI::App& command, const std::string& name, T& value,
                       const std::string& placeholder, const std::string& description) {
  return command.add_option(name, value, description)
      ->option_text(placeholder)
      ->each([name, placeholder](const std::string& text) {
        if (text.empty()) throw_usage_error(name, "\"\"", placeholder);
      });
}

/// The same for a number or an optional one; what is none becomes a usage Error like all others.
template <typename T>
CLI::Option* add_number(CLI::App& command, const std::string& name, T& value,
                        const std::string& placeholder, const std::string& description) {
  return command
      .add_option_function<std::string>(
          name,
          [&value, name](const std::string& text) {
            if constexpr (std::is_arithmetic_v<T>) {
              value = parse_number<T>(name, text);
            } else {
              value = parse_number<typename T::value_type>(name, text);
            }
          },
          description)
      ->option_text(placeholder);
}

}  // namespace abbe
