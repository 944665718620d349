#include "abbe/render/extra_channels.h"

#include <algorithm>
#include <array>

#include "abbe/image/exr/exr.h"

namespace abbe {
namespace {

/// Depth of pixels that see nothing: far, but finite, so that it can be averaged and displayed.
constexpr float kNoDepth = 1e10f;

// Names of extra channels that are parts of the light, in the order of LightPart.
constexpr std::array<const char*, kLightParts> kLightPartNames{"direct", "ambient", "emitted",
                                                               "reflected", "refracted"};

}  // namespace

std::optional<std::size_t> light_part_named(const std::string& group) {
  const auto* found = std::find(kLightPartNames.begin(), kLightPartNames.end(), group);
  if (found == kLightPartNames.end()) return std::nullopt;
  return static_cast<std::size_t>(found - kLightPartNames.begin());
}

std::vector<std::string> aov_channel_names(const std::string& group,
                                           const RenderSettings& settings) {
  if (light_part_named(group)) return {group + ".R", group + ".G", group + ".B"};
  if (group == "spectralAlbedo") {
    std::vector<std::string> names;
    for (const double nm : settings.wavelengths.exact_nm) {
      names.push_back(reflective_channel_name(nm));
    }
    if (!settings.bands || !names.empty()) return names;
    for (int band = 0; band < settings.bands->count(); ++band) {
      names.push_back(reflective_channel_name(settings.bands->center_nm(band)));
    }
    return names;
  }
  if (group == "P" || group == "N") return {group + ".X", group + ".Y", group + ".Z"};
  if (group == "albedo") return {"albedo.R", "albedo.G", "albedo.B"};
  if (group == "UV") return {"UV.U", "UV.V"};
  if (group == "cost") return {"cost.nodes", "cost.triangles"};
  return {group};
}

void append_aov(const std::string& group, const FirstHit& hit, const Viewpoint& view,
                std::vector<float>& out) {
  const auto append3 = [&](const Vec3f& v) { out.insert(out.end(), {v.x, v.y, v.z}); };
  if (group == "Z") {
    out.push_back(hit.is_hit ? glm::dot(hit.position - view.eye, view.forward) : kNoDepth);
  } else if (group == "P") {
    append3(hit.is_hit ? Vec3f(view.origin_m + Vec3d(hit.position)) : hit.position);
  } else if (group == "N") {
    append3(hit.normal);
  } else if (group == "albedo") {
    append3(hit.albedo_rec709);
  } else if (group == "UV") {
    out.insert(out.end(), {hit.uv.x, hit.uv.y});
  } else if (group == "cost") {
    out.insert(out.end(),
               {static_cast<float>(hit.cost.nodes), static_cast<float>(hit.cost.primitives)});
  } else if (group == "objectId") {
    // 0 is nothing; floats hold whole numbers up to 2^24 exactly.
    out.push_back(hit.is_hit ? static_cast<float>(hit.object + 1) : 0.0f);
  } else if (group == "materialId") {
    out.push_back(hit.is_hit ? static_cast<float>(hit.material + 1) : 0.0f);
  } else {
    out.push_back(0.0f);  // `samples` are counted by the film.
  }
}

}  // namespace abbe
