#include "abbe/cli/light_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/base/constants.h"
#include "abbe/base/error.h"
#include "abbe/cli/print.h"
#include "abbe/cli/probe_figure.h"

namespace abbe {
namespace {

constexpr double kDegrees = 180.0 / kPi;
constexpr const char* kWhiteLight = "#6a6a6a";

const char* event_name(ChainEvent event) {
  switch (event) {
    case ChainEvent::Enter:
      return "enter";
    case ChainEvent::Leave:
      return "leave";
    case ChainEvent::ReflectInside:
      return "reflect inside";
    case ChainEvent::ReflectOutside:
      break;
  }
  return "reflect";
}

std::string body_name(const LightPathCrossing& crossing, const World& world, const Scene& scene) {
  const std::uint32_t instance = world.flat.bodies[crossing.body].instance;
  const std::string name = printable(scene.instances[instance].name);
  return name.empty() ? fmt::format("instance {}", instance) : name;
}

std::optional<double> wavelength_of(const World& world, int set, int lane) {
  const WavelengthQuadrature* quadrature = world.lanes.quadrature();
  if (quadrature == nullptr) return std::nullopt;
  return static_cast<double>(quadrature->wavelengths_nm(set)[lane]);
}

std::string lane_name(const World& world, int set, int lane) {
  if (const auto nm = wavelength_of(world, set, lane)) return fmt::format("{:.4f}", *nm);
  return std::string(1, "RGB"[std::min(lane, 2)]);
}

std::string lamp_name(const World& world, std::size_t light) {
  const std::string name = printable(world.lights[light].name);
  return name.empty() ? fmt::format("#{}", light) : name;
}

const LightPath& middle_of(const LightChain& chain) {
  return chain.paths[chain.paths.size() / 2];
}

bool is_blocked(const LightChain& chain) {
  return std::all_of(chain.paths.begin(), chain.paths.end(),
                     [](const LightPath& path) { return path.is_blocked; });
}

std::string chain_title(const LightChain& chain, const World& world, const Scene& scene) {
  if (chain.events.empty()) return "straight";
  std::string title;
  for (const LightPathCrossing& crossing : middle_of(chain).crossings) {
    title += fmt::format("{}{} {}", title.empty() ? "" : ", ", event_name(crossing.event),
                         body_name(crossing, world, scene));
  }
  return title;
}

}  // namespace

std::uint32_t light_named(const World& world, const std::string& name) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < world.lights.size(); ++i) {
    if (world.lights[i].name == name || fmt::format("#{}", i) == name) {
      return static_cast<std::uint32_t>(i);
    }
    names.push_back(lamp_name(world, i));
  }
  throw_usage_error("--light", printable(name), "a lamp of the scene", names);
}

std::optional<LitPlace> lit_place(std::span<const ProbeNode> nodes, const World& world, int set,
                                  std::uint32_t light) {
  std::optional<std::uint32_t> medium;
  for (const ProbeNode* node = &nodes.front(); node->is_hit;) {
    const bool is_glass = node->side == "entering" || node->side == "leaving";
    if (!is_glass || node->children.empty()) {
      LitPlace lit;
      lit.light = lamp_name(world, light);
      lit.surface = node->instance;
      lit.place = node->lanes[node->lanes.size() / 2].position;
      lit.set = set;
      lit.chains = chains_to_light(world, light, lit.place, set, medium);
      std::erase_if(lit.chains, [](const LightChain& chain) { return chain.paths.empty(); });
      return lit;
    }
    const ProbeNode& child = nodes[node->children.front()];
    if (child.made_by == "refracted") {
      medium = node->side == "entering"
                   ? std::optional(world.geometry.surfaces[node->surface].material)
                   : std::nullopt;
    }
    node = &child;
  }
  return std::nullopt;
}

std::string light_text(const LitPlace& lit, const World& world, const Scene& scene) {
  std::string text =
      fmt::format("\nlight of {} on {} at {:.6g} {:.6g} {:.6g}: {}\n", lit.light, lit.surface,
                  lit.place.x, lit.place.y, lit.place.z,
                  lit.chains.empty() ? "none" : fmt::format("{} ways", lit.chains.size()));
  for (const LightChain& chain : lit.chains) {
    text += fmt::format("{}{}\n", chain_title(chain, world, scene),
                        is_blocked(chain) ? ", blocked" : "");
    text += fmt::format("{:>13} {:>13} {:>12}  angles with the normals\n", "nm", "transmittance",
                        "irradiance");
    const std::size_t count = chain.paths.size();
    for (std::size_t i = 0; i < count; ++i) {
      if (count > 3 && i != 0 && i != count / 2 && i + 1 != count) continue;
      const LightPath& path = chain.paths[i];
      std::string angles;
      for (const LightPathCrossing& crossing : path.crossings) {
        angles += fmt::format("{}{:.4f} -> {:.4f}", angles.empty() ? "" : ", ",
                              kDegrees * crossing.incidence_rad, kDegrees * crossing.exit_rad);
      }
      text += fmt::format("{:>13} {:>13.4f} {:>12.4g}  {}\n", lane_name(world, lit.set, path.lane),
                          path.transmittance, path.irradiance, angles);
    }
  }
  return text;
}

nlohmann::ordered_json light_json(const LitPlace& lit, const World& world, const Scene& scene) {
  const auto triple = [](const Vec3d& v) { return std::array<double, 3>{v.x, v.y, v.z}; };
  nlohmann::ordered_json json;
  json["name"] = lit.light;
  json["surface"] = lit.surface;
  json["place_m"] = triple(lit.place);
  json["chains"] = nlohmann::ordered_json::array();
  for (const LightChain& chain : lit.chains) {
    nlohmann::ordered_json one;
    one["events"] = nlohmann::ordered_json::array();
    for (const ChainEvent event : chain.events) one["events"].push_back(event_name(event));
    one["paths"] = nlohmann::ordered_json::array();
    for (const LightPath& path : chain.paths) {
      nlohmann::ordered_json way;
      if (const auto nm = wavelength_of(world, lit.set, path.lane)) {
        way["wavelength_nm"] = *nm;
      } else {
        way["channel"] = lane_name(world, lit.set, path.lane);
      }
      way["transmittance"] = path.transmittance;
      way["irradiance_per_lamp"] = path.irradiance;
      way["blocked"] = path.is_blocked;
      way["arrival"] = triple(path.arrival);
      way["crossings"] = nlohmann::ordered_json::array();
      for (const LightPathCrossing& crossing : path.crossings) {
        way["crossings"].push_back({{"event", event_name(crossing.event)},
                                    {"body", body_name(crossing, world, scene)},
                                    {"position_m", triple(crossing.position)},
                                    {"incidence_deg", kDegrees * crossing.incidence_rad},
                                    {"exit_deg", kDegrees * crossing.exit_rad},
                                    {"n_before", crossing.n_before},
                                    {"n_after", crossing.n_after},
                                    {"share", crossing.share}});
      }
      one["paths"].push_back(std::move(way));
    }
    json["chains"].push_back(std::move(one));
  }
  return json;
}

namespace {

// The extent of the facets and the place; the lamp may be far away.
double size_of(const LitPlace& lit) {
  Vec3d low = lit.place, high = lit.place;
  double way_m = 0.0;
  for (const LightChain& chain : lit.chains) {
    for (const LightPath& path : chain.paths) {
      for (const LightPathCrossing& crossing : path.crossings) {
        low = glm::min(low, crossing.position);
        high = glm::max(high, crossing.position);
      }
      way_m = std::max(way_m, glm::length(path.start - lit.place));
    }
  }
  const double extent = glm::length(high - low);
  return extent > 0.0 ? extent : way_m > 0.0 ? way_m : 1.0;
}

class LightFigureMaker {
 public:
  LightFigureMaker(const LitPlace& lit, const World& world, const Scene& scene,
                   const Observer& observer)
      : lit_(lit), world_(world), scene_(scene), colours_(observer), size_m_(size_of(lit)) {}

  RayFigure make(const std::string& title) {
    figure_.title = title;
    figure_.columns = {"facet", "incidence → exit", "index", "share"};
    std::size_t blocked = 0;
    double most = 0.0;
    for (const LightChain& chain : lit_.chains) {
      for (const LightPath& path : chain.paths) most = std::max(most, path.irradiance);
    }
    for (const LightChain& chain : lit_.chains) {
      if (is_blocked(chain)) {
        ++blocked;
        continue;
      }
      for (const LightPath& path : chain.paths) add_path(chain, path, most);
      add_crossings(chain);
    }
    if (figure_.rays.empty()) figure_.rays.push_back({lit_.place, lit_.place, kWhiteLight});
    figure_.notes.push_back(
        fmt::format("Light of {} on {}; angles and the table: the middle "
                    "wavelength of each way.",
                    lit_.light, lit_.surface));
    if (lit_.chains.empty()) figure_.notes.push_back("None of its light comes here.");
    if (blocked > 0) {
      figure_.notes.push_back(
          fmt::format("Left out: {} on which something stands.",
                      blocked == 1 ? "a way" : fmt::format("{} ways", blocked)));
    }
    for (int lane = 0; lane < world_.lanes.lane_count(); ++lane) {
      if (const auto nm = wavelength_of(world_, lit_.set, lane)) {
        figure_.key.emplace_back(*nm, colour_of(lane));
      }
    }
    return std::move(figure_);
  }

 private:
  std::string colour_of(int lane) const {
    return lane_colour(colours_, wavelength_of(world_, lit_.set, lane),
                       lane_name(world_, lit_.set, lane));
  }

  void add_path(const LightChain& chain, const LightPath& path, double most) {
    const bool is_straight = chain.events.empty();
    const bool is_middle = &path == &middle_of(chain);
    // Straight light goes one way for all wavelengths.
    if (is_straight && !is_middle) return;
    FigureRay ray;
    ray.colour = is_straight ? kWhiteLight : colour_of(path.lane);
    ray.width_px = is_straight ? 2.2 : 1.5;
    ray.opacity = most > 0.0 ? std::clamp(std::sqrt(path.irradiance / most), 0.2, 1.0) : 1.0;
    ray.has_arrow = is_middle;
    const Vec3d first = is_straight ? lit_.place : path.crossings.front().position;
    const Vec3d towards = is_straight ? path.arrival : path.crossings.front().direction_before;
    const double way_m = glm::length(first - path.start);
    const bool is_near = way_m > 0.0 && way_m <= 3.0 * size_m_;
    ray.from = is_near ? path.start : first - size_m_ * towards;
    ray.to = first;
    figure_.rays.push_back(ray);
    for (std::size_t i = 0; i < path.crossings.size(); ++i) {
      ray.from = path.crossings[i].position;
      ray.to = i + 1 < path.crossings.size() ? path.crossings[i + 1].position : lit_.place;
      figure_.rays.push_back(ray);
    }
  }

  void add_crossings(const LightChain& chain) {
    for (const LightPathCrossing& at : middle_of(chain).crossings) {
      FigureCrossing crossing;
      crossing.place = at.position;
      crossing.normal = at.normal;
      crossing.arrives = at.direction_before;
      crossing.incidence_deg = kDegrees * at.incidence_rad;
      if (at.event == ChainEvent::Enter || at.event == ChainEvent::Leave) {
        crossing.refracted = at.direction_after;
        crossing.refraction_deg = kDegrees * at.exit_rad;
      }
      crossing.surface = world_.flat.bodies[at.body].instance;
      figure_.crossings.push_back(crossing);
      figure_.rows.push_back(
          {fmt::format("{} {}", event_name(at.event), body_name(at, world_, scene_)),
           fmt::format("{:.4f}° → {:.4f}°", crossing.incidence_deg, kDegrees * at.exit_rad),
           fmt::format("{:.5f} → {:.5f}", at.n_before, at.n_after),
           fmt::format("{:.4f}", at.share)});
    }
  }

  const LitPlace& lit_;
  const World& world_;
  const Scene& scene_;
  SpectrumColours colours_;
  double size_m_;
  RayFigure figure_;
};

}  // namespace

RayFigure light_figure(const LitPlace& lit, const World& world, const Scene& scene,
                       const std::string& title, const Observer& observer) {
  return LightFigureMaker(lit, world, scene, observer).make(title);
}

}  // namespace abbe
