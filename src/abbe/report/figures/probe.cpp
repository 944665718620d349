#include "abbe/report/figures/probe.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/report/figures/svg.h"

namespace abbe {
namespace {

// More numbers than this are a thicket.
constexpr std::size_t kMaxCrossings = 14;
constexpr const char* kWhiteLight = "#6a6a6a";

const ProbeLane& middle_of(const ProbeNode& node) {
  return node.lanes[node.lanes.size() / 2];
}

const ProbeLane* lane_of(const ProbeNode& node, int lane) {
  for (const ProbeLane& candidate : node.lanes) {
    if (candidate.lane == lane) return &candidate;
  }
  return nullptr;
}

bool refracts(const ProbeNode& node) {
  return node.is_hit && (node.side == "entering" || node.side == "leaving");
}

// The extent of what happens: of the boundaries between media, or of all hits where there are none.
// Rays that come from the camera, leave the scene or fly far are drawn as long as that.
double size_of(std::span<const ProbeNode* const> shown, const Vec3d& eye) {
  const bool any_refracts = std::any_of(shown.begin(), shown.end(),
                                        [](const ProbeNode* node) { return refracts(*node); });
  std::vector<Vec3d> places;
  for (const ProbeNode* node : shown) {
    if (!node->is_hit || (any_refracts && !refracts(*node))) continue;
    for (const ProbeLane& lane : node->lanes) places.push_back(lane.position);
  }
  if (places.empty()) return 1.0;
  Vec3d low = places.front(), high = places.front();
  for (const Vec3d& place : places) {
    low = glm::min(low, place);
    high = glm::max(high, place);
  }
  const double extent = glm::length(high - low);
  const double distance = glm::length(places.front() - eye);
  return extent > 1e-4 * distance ? extent : 0.3 * distance;
}

std::vector<std::string> row_of(const ProbeNode& node) {
  const ProbeLane& middle = middle_of(node);
  std::string angles = fmt::format("{:.4f}°", middle.incidence_deg);
  if (middle.refraction_deg) {
    angles += fmt::format(" → {:.4f}°", *middle.refraction_deg);
  } else if (middle.is_totally_reflected) {
    angles += " total";
  }
  std::string indices = "-";
  if (middle.n2) {
    indices = fmt::format("{:.5g} → {:.5f}", middle.n1, *middle.n2);
    if (middle.k2) indices += fmt::format(" + {:.3f}i", *middle.k2);
    const ProbeLane& first = node.lanes.front();
    const ProbeLane& last = node.lanes.back();
    const double spread = std::abs(first.n2.value_or(0.0) - last.n2.value_or(0.0));
    const double spread_before = std::abs(first.n1 - last.n1);
    if (spread > 1e-5 && !middle.k2) {
      indices += fmt::format(" ({:.4f} to {:.4f})", *first.n2, *last.n2);
    } else if (spread_before > 1e-5) {
      indices = fmt::format("{:.5f} ({:.4f} to {:.4f}) → {:.5g}", middle.n1, first.n1, last.n1,
                            *middle.n2);
    }
  }
  return {fmt::format("{}, {}", node.instance, node.side),
          angles,
          indices,
          fmt::format("{:.4f}", middle.k_r),
          fmt::format("{:.4f}", middle.k_t),
          fmt::format("{:.3g}", node.weight)};
}

class FigureMaker {
 public:
  FigureMaker(std::span<const ProbeNode> nodes, const Vec3d& eye, const FigureView& view,
              const Observer& observer)
      : nodes_(nodes), eye_(eye), colors_(observer) {
    for (const ProbeNode& node : nodes) {
      if (node.weight >= view.least_weight || !node.parent) shown_.push_back(&node);
    }
    size_m_ = size_of(shown_, eye);
    figure_.title = view.title;
  }

  RayFigure make() {
    for (const ProbeNode* node : shown_) add_rays(*node);
    add_crossings();
    const ProbeNode& root = *shown_.front();
    if (root.lanes.front().wavelength_nm) {
      for (const ProbeLane& lane : root.lanes) {
        figure_.key.emplace_back(*lane.wavelength_nm, color_of(lane));
      }
      figure_.notes.push_back(
          fmt::format("Angles and the table: {:.4g} nm. Grey: all wavelengths together.",
                      *middle_of(root).wavelength_nm));
    } else {
      figure_.notes.push_back("Angles and the table: the green channel. Grey: all three together.");
    }
    const std::size_t left_out = nodes_.size() - shown_.size();
    if (left_out > 0) {
      figure_.notes.push_back(
          fmt::format("{} fainter {} left out.", left_out, left_out == 1 ? "ray is" : "rays are"));
    }
    return std::move(figure_);
  }

 private:
  std::string color_of(const ProbeLane& lane) const {
    return lane_color(colors_, lane.wavelength_nm, lane.name);
  }

  void add_rays(const ProbeNode& node) {
    const ProbeNode* parent = node.parent ? &nodes_[*node.parent] : nullptr;
    const bool together = !node.is_spread;
    const std::size_t middle = node.lanes.size() / 2;
    for (std::size_t i = 0; i < node.lanes.size(); ++i) {
      if (together && i != middle) continue;
      const ProbeLane& lane = node.lanes[i];
      const ProbeLane* before = parent != nullptr ? lane_of(*parent, lane.lane) : nullptr;
      FigureRay ray;
      ray.to = node.is_hit ? lane.position : lane.position + size_m_ * lane.direction;
      if (before != nullptr) {
        ray.from = before->position;
      } else {
        const double distance = glm::length(lane.position - eye_);
        ray.from = node.is_hit ? lane.position - std::min(distance, size_m_) * lane.direction
                               : lane.position;
      }
      if (is_far(node)) ray.to = ray.from + size_m_ * lane.direction;
      // One lane alone has a colour, too.
      ray.color = together && node.lanes.size() > 1 ? kWhiteLight : color_of(lane);
      ray.width_px = together ? 2.2 : 1.5;
      ray.opacity = std::clamp(std::sqrt(lane.throughput), 0.15, 1.0);
      ray.has_arrow = i == middle;
      figure_.rays.push_back(ray);
    }
  }

  // A hit on the surroundings, too far away to be drawn with the rest.
  bool is_far(const ProbeNode& node) const {
    if (!node.is_hit || !node.parent || refracts(node)) return false;
    const ProbeLane& lane = middle_of(node);
    const ProbeLane* before = lane_of(nodes_[*node.parent], lane.lane);
    return before != nullptr && glm::length(lane.position - before->position) > 3.0 * size_m_;
  }

  void add_crossings() {
    std::vector<const ProbeNode*> hits;
    for (const ProbeNode* node : shown_) {
      if (node->is_hit && !is_far(*node)) hits.push_back(node);
    }
    std::stable_sort(hits.begin(), hits.end(),
                     [](const ProbeNode* a, const ProbeNode* b) { return a->weight > b->weight; });
    if (hits.size() > kMaxCrossings) hits.resize(kMaxCrossings);
    // In the order in which light from the eye would come by.
    std::stable_sort(hits.begin(), hits.end(),
                     [](const ProbeNode* a, const ProbeNode* b) { return a->depth < b->depth; });
    figure_.columns = {"surface", "incidence → refraction", "index", "k_r", "k_t", "weight"};
    for (const ProbeNode* node : hits) {
      const ProbeLane& lane = middle_of(*node);
      FigureCrossing crossing;
      crossing.place = lane.position;
      crossing.normal = lane.normal;
      crossing.arrives = lane.direction;
      crossing.incidence_deg = lane.incidence_deg;
      crossing.refraction_deg = lane.refraction_deg;
      crossing.surface = node->surface;
      if (lane.refraction_deg && lane.n2) {
        const double eta = lane.n1 / *lane.n2;
        const double cos_i = -glm::dot(lane.direction, lane.normal);
        const double cos_t = std::sqrt(std::max(0.0, 1.0 - eta * eta * (1.0 - cos_i * cos_i)));
        crossing.refracted = eta * lane.direction + (eta * cos_i - cos_t) * lane.normal;
      }
      figure_.crossings.push_back(crossing);
      figure_.rows.push_back(row_of(*node));
    }
  }

  std::span<const ProbeNode> nodes_;
  std::vector<const ProbeNode*> shown_;
  Vec3d eye_;
  SpectrumColors colors_;
  double size_m_ = 1.0;
  RayFigure figure_;
};

}  // namespace

RayFigure probe_figure(std::span<const ProbeNode> nodes, const Vec3d& eye, const FigureView& view,
                       const Observer& observer) {
  return FigureMaker(nodes, eye, view, observer).make();
}

std::string lane_color(const SpectrumColors& colors, std::optional<double> wavelength_nm,
                       const std::string& channel) {
  if (wavelength_nm) return svg_color(colors.bright_at(*wavelength_nm));
  return channel == "R" ? "#d02020" : channel == "G" ? "#20a020" : "#2040d0";
}

}  // namespace abbe
