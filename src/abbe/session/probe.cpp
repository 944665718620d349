#include "abbe/session/probe.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "abbe/base/constants.h"
#include "abbe/base/text.h"

namespace abbe {
namespace {

constexpr double kDegrees = 180.0 / kPi;

// Exact for small angles, where an arc cosine is not.
double angle_deg(const Vec3d& a, const Vec3d& b) {
  return kDegrees * std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

std::string origin_name(FanOrigin origin) {
  constexpr std::array kNames{"camera", "reflected", "refracted", "passed"};
  return kNames.at(static_cast<std::size_t>(origin));
}

ProbeLane lane_of(const LaneRecord& record, const SurfaceMaterial* material, const World& world,
                  const CameraSample& sample) {
  ProbeLane lane;
  lane.lane = record.lane;
  const bool has_wavelengths = world.lanes.quadrature() != nullptr;
  if (has_wavelengths) lane.wavelength_nm = static_cast<double>(record.wavelength_nm);
  lane.name = lane_name(lane.wavelength_nm, record.lane);
  lane.position = Vec3d(record.position);
  lane.direction = Vec3d(record.direction);
  lane.normal = Vec3d(record.normal);
  lane.deviation_deg = angle_deg(Vec3d(sample.direction), lane.direction);
  lane.throughput = static_cast<double>(record.throughput);
  if (material == nullptr) return lane;

  lane.incidence_deg = kDegrees * static_cast<double>(record.angle_incident_rad);
  lane.n1 = static_cast<double>(record.n_incident);
  lane.k_r = static_cast<double>(record.k_r);
  lane.k_t = static_cast<double>(record.k_t);
  if (record.angle_refracted_rad) {
    lane.refraction_deg = kDegrees * static_cast<double>(*record.angle_refracted_rad);
  }
  if (material->is_conductor) {
    // The RGB modes know a metal by its colour alone.
    if (has_wavelengths) {
      lane.n2 = static_cast<double>(world.row(material->conductor_n, sample.set)[record.lane]);
      lane.k2 = static_cast<double>(world.row(material->conductor_k, sample.set)[record.lane]);
    }
  } else if (!material->index_is_infinite && material->metallic < 1.0f) {
    lane.n2 = static_cast<double>(record.n_transmitted);
  }
  lane.is_totally_reflected = material->transmission == Transmission::Medium &&
                              !lane.refraction_deg && lane.n2 && lane.n1 > *lane.n2 &&
                              lane.n1 * std::sin(lane.incidence_deg / kDegrees) >= *lane.n2;
  return lane;
}

std::string side_of(const FanRecord& record, const SurfaceMaterial& material) {
  if (material.transmission == Transmission::Medium) return record.enters ? "entering" : "leaving";
  return record.enters ? "front" : "back";
}

}  // namespace

std::optional<double> lane_wavelength_nm(const World& world, int set, int lane) {
  const WavelengthQuadrature* quadrature = world.lanes.quadrature();
  if (quadrature == nullptr) return std::nullopt;
  return static_cast<double>(quadrature->wavelengths_nm(set)[static_cast<std::size_t>(lane)]);
}

std::string lane_name(const std::optional<double>& wavelength_nm, int lane) {
  if (wavelength_nm) return fmt::format("{:.4f}", *wavelength_nm);
  return std::string(1, "RGB"[std::min(lane, 2)]);
}

Probed probe_pixel(const LitWorld& world, const Camera& camera, const RenderSettings& settings,
                   const Vec2i& pixel, std::optional<std::uint32_t> sample) {
  Probed probed;
  const std::optional<Vec2f> place = sample ? std::nullopt : std::optional(Vec2f(0.0f));
  probed.sample = camera_sample(world, camera, settings, pixel, sample.value_or(0), place);
  const IntegratorSettings integrator = integrator_settings(settings);
  std::vector<float> radiance(static_cast<std::size_t>(world.lanes.lane_stride()));
  IntegratorStats stats;
  IntegratorScratch scratch;
  trace_samples(world, integrator, std::span(&probed.sample, 1),
                {.radiance = radiance, .records = &probed.records}, stats, scratch);
  return probed;
}

std::vector<ProbeNode> probe_tree(std::span<const FanRecord> records, const Scene& scene,
                                  const World& world, const CameraSample& sample) {
  std::vector<ProbeNode> nodes;
  nodes.reserve(records.size());
  for (const FanRecord& record : records) {
    ProbeNode node;
    if (record.parent > 0) node.parent = record.parent - 1;
    node.made_by = origin_name(record.made_by);
    node.is_spread = record.was_spread;
    node.depth = record.depth;
    node.weight = static_cast<double>(record.weight);
    node.is_hit = record.is_hit;
    node.direct_light = static_cast<double>(record.direct_light);
    const SurfaceMaterial* material = nullptr;
    if (record.is_hit) {
      const Surface& surface = world.geometry.surfaces[record.surface];
      material = &world.materials[surface.material];
      node.surface = record.surface;
      node.instance = printable(scene.instances[surface.object].name);
      if (node.instance.empty()) node.instance = fmt::format("instance {}", surface.object);
      node.material = printable(material->name);
      if (node.material.empty()) node.material = fmt::format("material {}", surface.material);
      node.side = side_of(record, *material);
    }
    for (const LaneRecord& lane : record.lanes) {
      node.lanes.push_back(lane_of(lane, material, world, sample));
    }
    nodes.push_back(std::move(node));
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i].parent) nodes[*nodes[i].parent].children.push_back(i);
  }
  for (ProbeNode& node : nodes) {
    std::stable_sort(node.children.begin(), node.children.end(), [&](std::size_t a, std::size_t b) {
      return nodes[a].weight > nodes[b].weight;
    });
  }
  return nodes;
}

void move_places(std::vector<ProbeNode>& nodes, const Vec3d& by) {
  for (ProbeNode& node : nodes) {
    for (ProbeLane& lane : node.lanes) lane.position += by;
  }
}

}  // namespace abbe
