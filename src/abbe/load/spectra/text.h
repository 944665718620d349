/// Pieces of the text formats of spectra.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace abbe {

/// The words between blanks and tabs.
std::vector<std::string_view> words_of(std::string_view text);

/// The lines, without what ends them.
std::vector<std::string_view> lines_of(std::string_view text);

/// One finite number, all of the word; a leading plus is allowed.
std::optional<double> finite_number_of(std::string_view word);

}  // namespace abbe
