/// Extra channels of a render: what they are called, and what a camera sample adds to them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "abbe/integrate/integrator.h"
#include "abbe/render/settings.h"

namespace abbe {

/// The part of the light that a group of channels is, if it is one.
std::optional<std::size_t> light_part_named(const std::string& group);

/// The channels of a group of aov_names().
std::vector<std::string> aov_channel_names(const std::string& group,
                                           const RenderSettings& settings);

/// From where a camera looks.
struct Viewpoint {
  Vec3d origin_m{0.0};  ///< Scene::origin_m.
  Vec3f eye{0.0f}, forward{0.0f, 0.0f, -1.0f};
};

/// Appends what a camera ray met first to values of channels, for groups that are no light and no
/// spectrum.
void append_aov(const std::string& group, const FirstHit& hit, const Viewpoint& view,
                std::vector<float>& out);

}  // namespace abbe
