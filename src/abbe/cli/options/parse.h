/// Option values as they are typed.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "abbe/film/film.h"
#include "abbe/math/vec.h"

namespace abbe {

/// A number for an option: double, int or std::uint32_t. Errors of this and all that follow: a
/// usage Error that names the option.
template <typename T>
T parse_number(const std::string& option, const std::string& text);

/// `960x540`.
Vec2i parse_size(const std::string& text);
/// `X0,Y0,X1,Y1`, half-open.
PixelRect parse_crop(const std::string& text);
/// `X,Y`.
Vec2i parse_pixel(const std::string& text);
/// `A:B` in nm.
std::pair<double, double> parse_range(const std::string& text);
/// `A,B,C` in nm.
std::vector<double> parse_lines(const std::string& text);
/// `Z,N,albedo`.
std::vector<std::string> parse_names(const std::string& text);
/// A number of EV; none for `auto`.
std::optional<double> parse_exposure(const std::string& text);

}  // namespace abbe
