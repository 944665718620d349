#include "abbe/session/lit_place.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "abbe/base/error.h"
#include "abbe/base/text.h"

namespace abbe {
namespace {

const char* event_name(ChainEvent event) {
  constexpr std::array kNames{"enter", "leave", "reflect inside", "reflect"};
  return kNames.at(static_cast<std::size_t>(event));
}

std::string lamp_name(const LitWorld& world, std::size_t light) {
  const std::string name = printable(world.lights[light].name);
  return name.empty() ? fmt::format("#{}", light) : name;
}

LitCrossing crossing_of(const LightPathCrossing& at, const LitWorld& world, const Scene& scene) {
  const std::uint32_t instance = world.caustics.flat.bodies[at.body].instance;
  std::string name = printable(scene.instances[instance].name);
  if (name.empty()) name = fmt::format("instance {}", instance);
  return {at, event_name(at.event), std::move(name), instance};
}

LitChain chain_of(const LightChain& chain, const LitWorld& world, const Scene& scene, int set) {
  LitChain lit;
  lit.is_straight = chain.events.empty();
  lit.is_blocked = std::all_of(chain.paths.begin(), chain.paths.end(),
                               [](const LightPath& path) { return path.is_blocked; });
  for (const LightPath& path : chain.paths) {
    LitPath one{path, {}, {}, {}};
    for (const LightPathCrossing& at : path.crossings) {
      one.crossings.push_back(crossing_of(at, world, scene));
    }
    one.wavelength_nm = lane_wavelength_nm(world, set, path.lane);
    one.lane = lane_name(one.wavelength_nm, path.lane);
    lit.paths.push_back(std::move(one));
  }
  for (const LitCrossing& crossing : lit.middle().crossings) {
    lit.title +=
        fmt::format("{}{} {}", lit.title.empty() ? "" : ", ", crossing.event, crossing.body);
  }
  if (lit.is_straight) lit.title = "straight";
  return lit;
}

}  // namespace

std::uint32_t light_named(const LitWorld& world, const std::string& name) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < world.lights.size(); ++i) {
    if (world.lights[i].name == name || fmt::format("#{}", i) == name) {
      return static_cast<std::uint32_t>(i);
    }
    names.push_back(lamp_name(world, i));
  }
  throw_usage_error("light", in_quotes(name), "a lamp of the scene", names);
}

std::optional<LitPlace> lit_place(std::span<const ProbeNode> nodes, const LitWorld& world,
                                  const Scene& scene, int set, std::uint32_t light) {
  std::optional<std::uint32_t> medium;
  for (const ProbeNode* node = &nodes.front(); node->is_hit;) {
    const bool is_glass = node->side == "entering" || node->side == "leaving";
    if (!is_glass || node->children.empty()) {
      LitPlace lit;
      lit.light = lamp_name(world, light);
      lit.surface = node->instance;
      lit.place = node->lanes[node->lanes.size() / 2].position;
      for (const LightChain& chain : chains_to_light(world, light, lit.place, set, medium)) {
        if (!chain.paths.empty()) lit.chains.push_back(chain_of(chain, world, scene, set));
      }
      for (int lane = 0; lane < world.lanes.lane_count(); ++lane) {
        if (const auto nm = lane_wavelength_nm(world, set, lane)) lit.wavelengths_nm.push_back(*nm);
      }
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

void move_places(LitPlace& lit, const Vec3d& by) {
  lit.place += by;
  for (LitChain& chain : lit.chains) {
    for (LitPath& path : chain.paths) {
      path.path.start += by;
      for (LitCrossing& crossing : path.crossings) crossing.at.position += by;
    }
  }
}

}  // namespace abbe
