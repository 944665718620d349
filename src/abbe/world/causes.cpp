#include "abbe/world/causes.h"

#include <algorithm>
#include <cmath>

#include "abbe/base/constants.h"
#include "abbe/base/error.h"

namespace abbe {
namespace {

bool is_grey(const Vec3d& rgb_rec709) {
  return rgb_rec709.x == rgb_rec709.y && rgb_rec709.y == rgb_rec709.z;
}

bool is_constant(const Spectrum& spectrum) {
  const double first = spectrum.value(kRangeMin_nm);
  for (double nm = kRangeMin_nm; nm <= kRangeMax_nm; nm += 1.0) {
    if (spectrum.value(nm) != first) return false;
  }
  return true;
}

// Whether it is D65 in another scale: the same ratio everywhere, to the rounding of a table.
bool has_shape_of(const Spectrum& lamp, const Spectrum& d65) {
  if (!lamp.lines().empty()) return false;
  const double ratio = lamp.value(kLine_d_nm) / d65.value(kLine_d_nm);
  for (double nm = kRangeMin_nm; nm <= kRangeMax_nm; nm += 1.0) {
    const double expected = ratio * d65.value(nm);
    if (std::abs(lamp.value(nm) - expected) > 1e-9 * std::abs(expected)) return false;
  }
  return true;
}

bool has_spectral_reflectance(const Material& material) {
  if (material.base_color_texture) return true;
  if (material.emission && material.emissive_texture) return true;
  if (material.unlit || material.conductor) return false;
  if (material.reflectance) return !is_constant(material.reflectance->spectrum);
  return !is_grey(Vec3d(Vec3f(material.base_color_rec709)));
}

bool has_spectral_absorption(const Material& material) {
  if (!(material.transmission > 0.0f) || !material.has_volume) return false;
  if (material.absorption_per_m) return !is_constant(*material.absorption_per_m);
  return std::isfinite(material.attenuation_distance_m) &&
         !is_grey(material.attenuation_color_rec709);
}

bool has_spectral_emission(const Material& material, const Spectrum& d65) {
  if (material.emission) return !has_shape_of(material.emission->spectrum.spectrum, d65);
  if (material.unlit) {
    return material.base_color_texture.has_value() ||
           !is_grey(Vec3d(Vec3f(material.base_color_rec709)));
  }
  if (material.emissive_rec709 == Vec3f(0.0f)) return false;
  return material.emissive_texture.has_value() || !is_grey(Vec3d(material.emissive_rec709));
}

bool acts(Cause cause, const Scene& scene, const Spectrum& d65) {
  const auto any_material = [&](const auto& predicate) {
    return std::any_of(scene.materials.begin(), scene.materials.end(), predicate);
  };
  switch (cause) {
    case Cause::IndexDispersion:
      return any_material([](const Material& material) {
        return is_dispersive(material.index) ||
               (material.film && is_dispersive(material.film->index));
      });
    case Cause::Fresnel:
      return any_material(
          [](const Material& material) { return material.conductor || material.film; });
    case Cause::Absorption:
      return any_material(has_spectral_absorption);
    case Cause::Lamps:
      return any_material(
                 [&](const Material& material) { return has_spectral_emission(material, d65); }) ||
             std::any_of(scene.lights.begin(), scene.lights.end(),
                         [&](const Light& light) {
                           return light.spectrum ? !has_shape_of(light.spectrum->spectrum, d65)
                                                 : !is_grey(light.color_rec709);
                         }) ||
             (scene.ambient && scene.ambient->luminance_cd_per_m2 > 0.0 &&
              !has_shape_of(scene.ambient->spectrum.spectrum, d65));
    case Cause::Reflectances:
      break;
  }
  if (scene.fog) {
    const auto* color = std::get_if<RgbRec709>(&scene.fog->albedo);
    if (color ? !is_grey(color->rgb_rec709) : !is_constant(std::get<Spectrum>(scene.fog->albedo))) {
      return true;
    }
  }
  return any_material(has_spectral_reflectance) ||
         std::any_of(scene.meshes.begin(), scene.meshes.end(),
                     [](const Mesh& mesh) { return !mesh.colors_rec709.empty(); });
}

}  // namespace

std::string cause_name(Cause cause) {
  switch (cause) {
    case Cause::IndexDispersion:
      return "dispersion";
    case Cause::Fresnel:
      return "fresnel";
    case Cause::Absorption:
      return "absorption";
    case Cause::Lamps:
      return "lamps";
    case Cause::Reflectances:
      break;
  }
  return "uplift";
}

std::vector<std::string> cause_names() {
  std::vector<std::string> names;
  names.reserve(kCauses.size());
  for (const Cause cause : kCauses) names.push_back(cause_name(cause));
  return names;
}

CauseSet parse_causes(const std::vector<std::string>& names) {
  CauseSet causes;
  for (const std::string& name : names) {
    if (name == "all") {
      causes = CauseSet::all();
      continue;
    }
    const auto found = std::find_if(kCauses.begin(), kCauses.end(),
                                    [&](Cause cause) { return cause_name(cause) == name; });
    if (found == kCauses.end()) {
      std::vector<std::string> choices = cause_names();
      choices.emplace_back("all");
      throw_usage_error("frozen", "\"" + name + "\"", "causes", choices);
    }
    causes.insert(*found);
  }
  return causes;
}

std::string causes_text(const CauseSet& causes) {
  std::string text;
  for (const Cause cause : kCauses) {
    if (causes.contains(cause)) text += (text.empty() ? "" : ",") + cause_name(cause);
  }
  return text;
}

std::vector<Cause> acting_causes(const Scene& scene, const Spectrum& d65) {
  std::vector<Cause> result;
  for (const Cause cause : kCauses) {
    if (acts(cause, scene, d65)) result.push_back(cause);
  }
  return result;
}

}  // namespace abbe
