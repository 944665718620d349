/// The one way in which things go wrong: an exception that says what was found, what was expected
/// and where. It is thrown below, caught once in cli/ and printed there.
#pragma once

#include <exception>
#include <string>
#include <vector>

namespace abbe {

/// What kind of mistake it was; cli/ maps it to an exit code.
enum class ErrorKind {
  Usage,   ///< A wrong option or argument: exit code 2.
  Input,   ///< A file or scene that cannot be understood: exit code 3.
  Output,  ///< A result that cannot be written: exit code 4.
};

/// The parts of a message. Empty parts are left out of it.
struct ErrorDetail {
  ErrorKind kind = ErrorKind::Input;
  std::string where;     ///< File, and JSON pointer or line: `a.gltf: /materials/2/ior`.
  std::string found;     ///< What is there: `ior -1.5`.
  std::string expected;  ///< What should be: `0 or at least 1`.
  std::vector<std::string> choices = {};  ///< The valid names, when there are few; or the nearest.
};

/// What every function here throws, and nothing else: libraries' own exceptions are translated.
class Error : public std::exception {
 public:
  explicit Error(ErrorDetail detail);
  const ErrorDetail& detail() const { return detail_; }
  /// One line: `WHERE: found FOUND, expected EXPECTED (one of A, B, C)`.
  const char* what() const noexcept override { return message_.c_str(); }

 private:
  ErrorDetail detail_;
  std::string message_;
};

/// Throws an Error of the given kind.
[[noreturn]] void throw_input_error(std::string where, std::string found, std::string expected,
                                    std::vector<std::string> choices = {});
[[noreturn]] void throw_usage_error(std::string where, std::string found, std::string expected,
                                    std::vector<std::string> choices = {});
[[noreturn]] void throw_output_error(std::string where, std::string found, std::string expected);

/// The place of a name among those that there are.
/// Errors: a usage Error that lists them, for any other name.
std::size_t check_choice(const std::string& where, const std::string& name,
                         const std::string& expected, const std::vector<std::string>& choices);

/// The `count` names most like `name`, best first, for "did you mean" lists.
std::vector<std::string> nearest_names(const std::string& name,
                                       const std::vector<std::string>& names,
                                       std::size_t count = 5);

}  // namespace abbe
