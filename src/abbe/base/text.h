/// Numbers and words out of texts that people type and files hold.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

/// One number, all of the text; finite, independent of the locale.
std::optional<double> number_of(std::string_view text);
std::optional<int> whole_number_of(std::string_view text);
std::optional<std::uint32_t> whole_u32_of(std::string_view text);

/// The parts between separators, one more than there are of them.
std::vector<std::string> split(const std::string& text, char separator);

/// ASCII letters small, all else as it is.
std::string lower_case(std::string_view text);

/// What was found, for a message that must not lose an empty text.
std::string in_quotes(std::string_view text);

/// Text with blanks for what a terminal would obey: names out of a file may hold anything.
std::string printable(std::string text);

}  // namespace abbe
