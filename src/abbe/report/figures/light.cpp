#include "abbe/report/figures/light.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/base/constants.h"
#include "abbe/report/figures/probe.h"

namespace abbe {
namespace {

constexpr double kDegrees = 180.0 / kPi;
constexpr const char* kWhiteLight = "#6a6a6a";

// The extent of the facets and the place; the lamp may be far away.
double size_of(const LitPlace& lit) {
  Vec3d low = lit.place, high = lit.place;
  double length_m = 0.0;
  for (const LitChain& chain : lit.chains) {
    for (const LitPath& path : chain.paths) {
      for (const LitCrossing& crossing : path.crossings) {
        low = glm::min(low, crossing.at.position);
        high = glm::max(high, crossing.at.position);
      }
      length_m = std::max(length_m, glm::length(path.path.start - lit.place));
    }
  }
  const double extent = glm::length(high - low);
  return extent > 0.0 ? extent : length_m > 0.0 ? length_m : 1.0;
}

class LightFigureMaker {
 public:
  LightFigureMaker(const LitPlace& lit, const Observer& observer)
      : lit_(lit), colors_(observer), size_m_(size_of(lit)) {}

  RayFigure make(const std::string& title) {
    figure_.title = title;
    figure_.columns = {"facet", "incidence → exit", "index", "share"};
    std::size_t blocked = 0;
    double most = 0.0;
    for (const LitChain& chain : lit_.chains) {
      for (const LitPath& lit : chain.paths) most = std::max(most, lit.path.irradiance);
    }
    for (const LitChain& chain : lit_.chains) {
      if (chain.is_blocked) {
        ++blocked;
        continue;
      }
      for (const LitPath& path : chain.paths) add_path(chain, path, most);
      add_crossings(chain);
    }
    if (figure_.rays.empty()) figure_.rays.push_back({lit_.place, lit_.place, kWhiteLight});
    figure_.notes.push_back(
        fmt::format("Light of {} on {}; angles and the table: the middle "
                    "wavelength of each path.",
                    lit_.light, lit_.surface));
    if (lit_.chains.empty()) figure_.notes.push_back("None of its light comes here.");
    if (blocked > 0) {
      figure_.notes.push_back(
          fmt::format("Left out: {} on which something stands.",
                      blocked == 1 ? "a path" : fmt::format("{} paths", blocked)));
    }
    for (const double nm : lit_.wavelengths_nm) {
      figure_.key.emplace_back(nm, lane_color(colors_, nm, ""));
    }
    return std::move(figure_);
  }

 private:
  void add_path(const LitChain& chain, const LitPath& lit, double most) {
    const LightPath& path = lit.path;
    const bool is_straight = chain.is_straight;
    const bool is_middle = &lit == &chain.middle();
    // Straight light takes one path for all wavelengths.
    if (is_straight && !is_middle) return;
    FigureRay ray;
    ray.color = is_straight ? kWhiteLight : lane_color(colors_, lit.wavelength_nm, lit.lane);
    ray.width_px = is_straight ? 2.2 : 1.5;
    ray.opacity = most > 0.0 ? std::clamp(std::sqrt(path.irradiance / most), 0.2, 1.0) : 1.0;
    ray.has_arrow = is_middle;
    const Vec3d first = is_straight ? lit_.place : path.crossings.front().position;
    const Vec3d towards = is_straight ? path.arrival : path.crossings.front().direction_before;
    const double length_m = glm::length(first - path.start);
    const bool is_near = length_m > 0.0 && length_m <= 3.0 * size_m_;
    ray.from = is_near ? path.start : first - size_m_ * towards;
    ray.to = first;
    figure_.rays.push_back(ray);
    for (std::size_t i = 0; i < path.crossings.size(); ++i) {
      ray.from = path.crossings[i].position;
      ray.to = i + 1 < path.crossings.size() ? path.crossings[i + 1].position : lit_.place;
      figure_.rays.push_back(ray);
    }
  }

  void add_crossings(const LitChain& chain) {
    for (const LitCrossing& lit : chain.middle().crossings) {
      const LightPathCrossing& at = lit.at;
      FigureCrossing crossing;
      crossing.place = at.position;
      crossing.normal = at.normal;
      crossing.arrives = at.direction_before;
      crossing.incidence_deg = kDegrees * at.incidence_rad;
      if (lit.is_refraction()) {
        crossing.refracted = at.direction_after;
        crossing.refraction_deg = kDegrees * at.exit_rad;
      }
      crossing.surface = lit.surface;
      figure_.crossings.push_back(crossing);
      figure_.rows.push_back(
          {fmt::format("{} {}", lit.event, lit.body),
           fmt::format("{:.4f}° → {:.4f}°", crossing.incidence_deg, kDegrees * at.exit_rad),
           fmt::format("{:.5f} → {:.5f}", at.n_before, at.n_after),
           fmt::format("{:.4f}", at.share)});
    }
  }

  const LitPlace& lit_;
  SpectrumColors colors_;
  double size_m_;
  RayFigure figure_;
};

}  // namespace

RayFigure light_figure(const LitPlace& lit, const std::string& title, const Observer& observer) {
  return LightFigureMaker(lit, observer).make(title);
}

}  // namespace abbe
