/// Pieces of the text formats of spectra.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

/// The words between blanks and tabs.
std::vector<std::string_view> words_of(std::string_view text);

/// The lines, without what ends them.
std::vector<std::string_view> lines_of(std::string_view text);

/// The numbers that words are, from one of them on.
/// Errors: an input Error at `where` for a word that is no finite number.
std::vector<double> numbers_of(const std::vector<std::string_view>& words, std::size_t first,
                               const std::string& where);

/// Appends the wavelength of the next row of a table.
/// Errors: an input Error at `where` when it is not above the one before.
void add_rising(double wavelength_nm, const std::string& where,
                std::vector<double>& wavelengths_nm);

/// One finite number, all of the word; a leading plus is allowed.
std::optional<double> finite_number_of(std::string_view word);

}  // namespace abbe
