/// Reports as one HTML file each: no network, no other file.
#pragma once

#include <string>

namespace abbe {

/// The page of a comparison. `json` is its data as text: page/data.js says what it reads.
std::string comparison_page(const std::string& title, const std::string& json);

/// The page of a check of golden images: `summary`, and `images` with name, passed, text, and for
/// failures command and pictures.
std::string golden_page(const std::string& title, const std::string& json);

/// Text between tags, safe whatever it holds.
std::string html_text(const std::string& text);

}  // namespace abbe
