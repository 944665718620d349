#include "abbe/report/probe_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "abbe/base/constants.h"
#include "abbe/report/json.h"

namespace abbe {
namespace {

constexpr double kDegrees = 180.0 / kPi;

/// Levels that are shown by indentation.
constexpr int kMaxIndents = 8;

std::string indent(int depth) {
  return std::string(2 * std::min(depth, kMaxIndents), ' ');
}

std::vector<const ProbeLane*> shown_lanes(const ProbeNode& node, bool all) {
  std::vector<const ProbeLane*> lanes;
  const std::size_t count = node.lanes.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (all || count <= 3 || i == 0 || i == count / 2 || i + 1 == count) {
      lanes.push_back(&node.lanes[i]);
    }
  }
  return lanes;
}

// `0.364119 0.000000 -0.931352`.
std::string direction_text(const Vec3d& direction) {
  // Rounded first: what rounds to zero is shown without a sign.
  const Vec3d d = glm::round(direction * 1e6) / 1e6 + 0.0;
  return fmt::format("{:.6f} {:.6f} {:.6f}", d.x, d.y, d.z);
}

// Far from the origin, too, digits are for what is small.
std::string position_text(const Vec3d& p, int digits) {
  const auto number = [&](double x) {
    return std::abs(x) < 1e4 ? fmt::format("{:.{}g}", x, digits) : fmt::format("{:.4f}", x);
  };
  return number(p.x) + " " + number(p.y) + " " + number(p.z);
}

std::string index_text(const ProbeLane& lane) {
  if (!lane.n2) return "-";
  if (!lane.k2) return fmt::format("{:.5f}", *lane.n2);
  return fmt::format("{:.3f}+{:.3f}i", *lane.n2, *lane.k2);
}

std::string refraction_text(const ProbeLane& lane) {
  if (lane.is_totally_reflected) return "total";
  return lane.refraction_deg ? fmt::format("{:.4f}", *lane.refraction_deg) : "-";
}

void append_lanes(const ProbeNode& node, const ProbeView& view, const std::string& margin,
                  std::string& out) {
  const std::vector<const ProbeLane*> lanes = shown_lanes(node, view.all_lanes);
  const std::string head = node.lanes.front().wavelength_nm ? "nm" : "lane";
  if (!node.is_hit) {
    out += fmt::format("{}{:>9} {:>9} {:>10}  {}\n", margin, head, "deviation", "throughput",
                       "direction");
    for (const ProbeLane* lane : lanes) {
      out += fmt::format("{}{:>9} {:>9.4f} {:>10.4g}  {}\n", margin, lane->name,
                         lane->deviation_deg, lane->throughput, direction_text(lane->direction));
    }
    return;
  }
  out += fmt::format("{}{:>9} {:>9} {:>10} {:>8} {:>12} {:>8} {:>8} {:>9} {:>10}  {}\n", margin,
                     head, "incidence", "refraction", "n1", "n2", "k_r", "k_t", "deviation",
                     "throughput", "position");
  for (const ProbeLane* lane : lanes) {
    out += fmt::format(
        "{}{:>9} {:>9.4f} {:>10} {:>8.5f} {:>12} {:>8.6f} {:>8.6f} {:>9.4f} {:>10.4g}  {}\n",
        margin, lane->name, lane->incidence_deg, refraction_text(*lane), lane->n1,
        index_text(*lane), lane->k_r, lane->k_t, lane->deviation_deg, lane->throughput,
        position_text(lane->position, 5));
  }
}

std::string heading(const ProbeNode& node) {
  std::string text = fmt::format("{}, {}, ", node.made_by, node.is_spread ? "spread" : "united");
  const std::size_t count = node.lanes.size();
  const bool has_wavelengths = node.lanes.front().wavelength_nm.has_value();
  text += fmt::format("{} {}{}, weight {:.4g}", count, has_wavelengths ? "wavelength" : "channel",
                      count == 1 ? "" : "s", node.weight);
  if (!node.is_hit) return text + ": leaves the scene";
  text += fmt::format(": {} {} ({})", node.side, node.instance, node.material);
  if (node.direct_light > 0.0) text += fmt::format(", light from lamps {:.4g}", node.direct_light);
  const auto total = std::count_if(node.lanes.begin(), node.lanes.end(),
                                   [](const ProbeLane& lane) { return lane.is_totally_reflected; });
  if (total > 0) {
    text += static_cast<std::size_t>(total) == count
                ? ", total internal reflection"
                : fmt::format(", total internal reflection of {}", total);
  }
  return text;
}

struct Printer {
  std::span<const ProbeNode> nodes;
  const ProbeView& view;
  std::string out;
  std::size_t hidden = 0;

  void print(std::size_t index) {
    const ProbeNode& node = nodes[index];
    if (node.lanes.empty()) return;
    if (node.parent && node.weight < view.least_weight) {
      hide(index);
      return;
    }
    const std::string margin = indent(node.depth);
    const std::string level = node.depth > kMaxIndents ? fmt::format("[{}] ", node.depth) : "";
    out += margin + level + heading(node) + "\n";
    append_lanes(node, view, margin + "  ", out);
    for (const std::size_t child : node.children) print(child);
  }

  void hide(std::size_t index) {
    ++hidden;
    for (const std::size_t child : nodes[index].children) hide(child);
  }
};

nlohmann::ordered_json lane_json(const ProbeLane& lane, bool is_hit) {
  nlohmann::ordered_json json;
  json["lane"] = lane.lane;
  if (lane.wavelength_nm) {
    json["wavelength_nm"] = *lane.wavelength_nm;
  } else {
    json["channel"] = lane.name;
  }
  json[is_hit ? "position_m" : "origin_m"] = vector_json(lane.position);
  json["direction"] = vector_json(lane.direction);
  json["deviation_deg"] = lane.deviation_deg;
  json["throughput"] = lane.throughput;
  if (!is_hit) return json;
  json["incidence_deg"] = lane.incidence_deg;
  if (lane.refraction_deg) json["refraction_deg"] = *lane.refraction_deg;
  json["n1"] = lane.n1;
  if (lane.n2) json["n2"] = *lane.n2;
  if (lane.k2) json["k2"] = *lane.k2;
  json["k_r"] = lane.k_r;
  json["k_t"] = lane.k_t;
  json["total_internal_reflection"] = lane.is_totally_reflected;
  return json;
}

nlohmann::ordered_json nodes_json(std::span<const ProbeNode> nodes) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const ProbeNode& node = nodes[i];
    nlohmann::ordered_json entry;
    entry["ray"] = i;
    if (node.parent) entry["parent"] = *node.parent;
    entry["made_by"] = node.made_by;
    entry["spread"] = node.is_spread;
    entry["depth"] = node.depth;
    entry["weight"] = node.weight;
    entry["hit"] = node.is_hit;
    if (node.is_hit) {
      entry["instance"] = node.instance;
      entry["material"] = node.material;
      entry["side"] = node.side;
      entry["direct_light"] = node.direct_light;
    }
    entry["lanes"] = nlohmann::ordered_json::array();
    for (const ProbeLane& lane : node.lanes) entry["lanes"].push_back(lane_json(lane, node.is_hit));
    json.push_back(std::move(entry));
  }
  return json;
}

// The first, the middle and the last wavelength of every chain; angles in degrees.
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

// All of them; angles in degrees, positions in metres.
nlohmann::ordered_json light_json(const LitPlace& lit) {
  nlohmann::ordered_json json;
  json["name"] = lit.light;
  json["surface"] = lit.surface;
  json["place_m"] = vector_json(lit.place);
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
      entry["arrival"] = vector_json(path.arrival);
      entry["crossings"] = nlohmann::ordered_json::array();
      for (const LitCrossing& crossing : lit_path.crossings) {
        const LightPathCrossing& at = crossing.at;
        entry["crossings"].push_back({{"event", crossing.event},
                                      {"body", crossing.body},
                                      {"position_m", vector_json(at.position)},
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

}  // namespace

std::string tree_text(std::span<const ProbeNode> nodes, const ProbeView& view) {
  Printer printer{nodes, view, {}, 0};
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (!nodes[i].parent) printer.print(i);
  }
  if (printer.hidden > 0) {
    printer.out +=
        fmt::format("{} fainter ray{} of weight below {:g} not shown{}\n", printer.hidden,
                    printer.hidden == 1 ? "" : "s", view.least_weight, view.hint);
  }
  return std::move(printer.out);
}

std::string probe_text(const PixelProbe& probe, const ProbeView& view) {
  const std::string place =
      probe.sample ? fmt::format("sample {}", *probe.sample) : std::string("its centre");
  return fmt::format(
             "pixel {},{} of {}x{}, {}, camera {}, {}\n"
             "from {} along {}; angles in degrees, positions in m\n\n",
             probe.pixel.x, probe.pixel.y, probe.size.x, probe.size.y, place, probe.camera,
             probe.mode, position_text(probe.origin, 6), direction_text(Vec3d(probe.direction))) +
         tree_text(probe.nodes, view) + (probe.lit ? light_text(*probe.lit) : std::string());
}

std::string probe_json(const PixelProbe& probe) {
  nlohmann::ordered_json json;
  json["pixel"] = {probe.pixel.x, probe.pixel.y};
  json["size"] = {probe.size.x, probe.size.y};
  if (probe.sample) json["sample"] = *probe.sample;
  json["mode"] = probe.mode;
  json["camera"] = {{"name", probe.camera},
                    {"origin_m", vector_json(probe.origin)},
                    {"direction", {probe.direction.x, probe.direction.y, probe.direction.z}}};
  json["rays"] = nodes_json(probe.nodes);
  if (probe.lit) json["light"] = light_json(*probe.lit);
  return document_text(json);
}

}  // namespace abbe
