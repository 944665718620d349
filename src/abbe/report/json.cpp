#include "abbe/report/json.h"

#include <nlohmann/json.hpp>

namespace abbe {

std::string document_text(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace abbe
