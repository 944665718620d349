/// JSON as text, and vectors in it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "abbe/math/vec.h"

namespace abbe {

/// JSON with line breaks. Bytes of names that are no UTF-8 become the replacement character.
std::string document_text(const nlohmann::ordered_json& json);

/// `[x, y, z]`.
nlohmann::ordered_json vector_json(const Vec3d& v);

}  // namespace abbe
