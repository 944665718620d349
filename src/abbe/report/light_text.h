/// The paths of a lamp's light to a place, as text for people and as JSON for programs.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "abbe/session/lit_place.h"

namespace abbe {

/// The first, the middle and the last wavelength of every chain; angles in degrees.
std::string light_text(const LitPlace& lit);

/// All of them; angles in degrees, positions in metres.
nlohmann::ordered_json light_json(const LitPlace& lit);

}  // namespace abbe
