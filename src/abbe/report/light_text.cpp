#include "abbe/report/light_text.h"

#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>

#include "abbe/base/constants.h"

namespace abbe {
namespace {

constexpr double kDegrees = 180.0 / kPi;

}  // namespace

std::string light_text(const LitPlace& lit) {
  std::string text =
      fmt::format("\nlight of {} on {} at {:.6g} {:.6g} {:.6g}: {}\n", lit.light, lit.surface,
                  lit.place.x, lit.place.y, lit.place.z,
                  lit.chains.empty() ? "none" : fmt::format("{} paths", lit.chains.size()));
  for (const LitChain& chain : lit.chains) {
    text += fmt::format("{}{}\n", chain.title, chain.is_blocked ? ", blocked" : "");
    text += fmt::format("{:>13} {:>13} {:>12}  angles with the normals\n", "nm", "transmittance",
                        "irradiance");
    const std::size_t count = chain.paths.size();
    for (std::size_t i = 0; i < count; ++i) {
      if (count > 3 && i != 0 && i != count / 2 && i + 1 != count) continue;
      const LitPath& path = chain.paths[i];
      std::string angles;
      for (const LitCrossing& crossing : path.crossings) {
        angles +=
            fmt::format("{}{:.4f} -> {:.4f}", angles.empty() ? "" : ", ",
                        kDegrees * crossing.at.incidence_rad, kDegrees * crossing.at.exit_rad);
      }
      text += fmt::format("{:>13} {:>13.4f} {:>12.4g}  {}\n", path.lane, path.path.transmittance,
                          path.path.irradiance, angles);
    }
  }
  return text;
}

nlohmann::ordered_json light_json(const LitPlace& lit) {
  const auto triple = [](const Vec3d& v) { return std::array<double, 3>{v.x, v.y, v.z}; };
  nlohmann::ordered_json json;
  json["name"] = lit.light;
  json["surface"] = lit.surface;
  json["place_m"] = triple(lit.place);
  json["chains"] = nlohmann::ordered_json::array();
  for (const LitChain& chain : lit.chains) {
    nlohmann::ordered_json one;
    one["events"] = nlohmann::ordered_json::array();
    for (const LitCrossing& crossing : chain.middle().crossings) {
      one["events"].push_back(crossing.event);
    }
    one["paths"] = nlohmann::ordered_json::array();
    for (const LitPath& lit_path : chain.paths) {
      const LightPath& path = lit_path.path;
      nlohmann::ordered_json entry;
      if (lit_path.wavelength_nm) {
        entry["wavelength_nm"] = *lit_path.wavelength_nm;
      } else {
        entry["channel"] = lit_path.lane;
      }
      entry["transmittance"] = path.transmittance;
      entry["irradiance_per_lamp"] = path.irradiance;
      entry["blocked"] = path.is_blocked;
      entry["arrival"] = triple(path.arrival);
      entry["crossings"] = nlohmann::ordered_json::array();
      for (const LitCrossing& crossing : lit_path.crossings) {
        const LightPathCrossing& at = crossing.at;
        entry["crossings"].push_back({{"event", crossing.event},
                                      {"body", crossing.body},
                                      {"position_m", triple(at.position)},
                                      {"incidence_deg", kDegrees * at.incidence_rad},
                                      {"exit_deg", kDegrees * at.exit_rad},
                                      {"n_before", at.n_before},
                                      {"n_after", at.n_after},
                                      {"share", at.share}});
      }
      one["paths"].push_back(std::move(entry));
    }
    json["chains"].push_back(std::move(one));
  }
  return json;
}

}  // namespace abbe
