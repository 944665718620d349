/// A probe's tree of rays as a drawing.
#pragma once

#include <span>
#include <string>

#include "abbe/color/spectrum_colors.h"
#include "abbe/report/figures/rays.h"
#include "abbe/session/probe.h"
#include "abbe/spectrum/observer.h"

namespace abbe {

/// What of a probe is drawn.
struct FigureView {
  std::string title;
  double least_weight = 0.0;  ///< Fainter rays are left out.
};

/// Rays in the colours of their wavelengths, grey where all go together; numbers, angles and the
/// table are those of the middle wavelength.
/// Domain: at least one node; `eye` is where the camera ray began.
RayFigure probe_figure(std::span<const ProbeNode> nodes, const Vec3d& eye, const FigureView& view,
                       const Observer& observer);

/// The colour of a lane in a drawing.
std::string lane_color(const SpectrumColors& colors, std::optional<double> wavelength_nm,
                       const std::string& channel);

}  // namespace abbe
