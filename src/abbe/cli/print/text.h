/// Results on stdout.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace abbe {

/// Errors: an output Error when stdout takes no more (a full disk).
void print(const std::string& text);

/// JSON with line breaks. Bytes of names that are no UTF-8 become the replacement character.
std::string json_text(const nlohmann::ordered_json& json);

/// JSON for people: indented names and values, small objects on one line.
std::string plain_text(const nlohmann::ordered_json& json);

}  // namespace abbe
