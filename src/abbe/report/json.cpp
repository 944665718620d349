#include "abbe/report/json.h"

#include <nlohmann/json.hpp>

namespace abbe {

std::string document_text(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

nlohmann::ordered_json vector_json(const Vec3d& v) {
  return {v.x, v.y, v.z};
}

}  // namespace abbe
