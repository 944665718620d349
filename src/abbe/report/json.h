/// JSON as text, for the files of this module.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace abbe {

/// JSON with line breaks. Bytes of names that are no UTF-8 become the replacement character.
std::string document_text(const nlohmann::ordered_json& json);

}  // namespace abbe
