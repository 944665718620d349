#include <fmt/format.h>

#include <cmath>

#include "abbe/base/constants.h"
#include "abbe/cli/describe/describe.h"
#include "abbe/load/spectra/range_notes.h"
#include "abbe/scene/scene.h"
#include "abbe/world/light/lights.h"

namespace abbe {
namespace {

constexpr double kDegrees = 180.0 / kPi;

// What is missing of the visible was a warning already.
void note_range(const std::string& id, const std::optional<Vec2d>& stated_nm,
                const std::string& quantity, const std::string& what_happens, Notes& notes) {
  if (!stated_nm || misses_the_visible(*stated_nm)) return;
  const std::string missing = missing_range_text(*stated_nm);
  if (missing.empty()) return;
  notes.info(id, fmt::format("{} is stated for {:g}-{:g} nm; {} at {}", quantity, stated_nm->x,
                             stated_nm->y, what_happens, missing));
}

void describe_index(const Material& material, Notes& notes, Description& out) {
  if (!material.index_id.empty()) out["glass"] = material.index_id;
  if (material.index_range_nm) {
    out["stated_range_nm"] =
        fmt::format("{:g}-{:g}", material.index_range_nm->x, material.index_range_nm->y);
  }
  const bool is_table = std::holds_alternative<TabulatedIndex>(material.index);
  note_range(material.index_id, material.index_range_nm,
             is_table ? "the table of n" : "the formula of n",
             is_table ? "held constant" : "extrapolated", notes);
  if (material.index_is_infinite) {
    out["n_d"] = "infinite";
    return;
  }
  out["n_d"] = refractive_index(material.index, kLine_d_nm);
  if (is_dispersive(material.index)) out["V_d"] = abbe_number(material.index);
}

std::string kind_of(const Material& material) {
  if (material.unlit) return "unlit";
  if (material.conductor) return "metal with n and k";
  if (material.transmission > 0.0f && material.metallic < 1.0f) {
    return material.has_volume ? "transparent body" : "thin transparent sheet";
  }
  if (material.metallic >= 1.0f) return "metal by colour";
  return material.metallic > 0.0f ? "partly metal" : "opaque";
}

void describe_emission(const Material& material, Description& out) {
  if (material.emission) {
    const std::string& id = material.emission->spectrum.id;
    out["emission"] = fmt::format("{:g} cd/m2 of {}", material.emission->luminance_cd_per_m2,
                                  id.empty() ? "its own spectrum" : id);
  } else if (material.emissive_rec709 != Vec3f(0.0f)) {
    out["emission_rec709_cd_per_m2"] = triple(material.emissive_rec709);
  }
}

Description describe_film(const ThinFilm& film, Notes& notes) {
  Description out;
  if (!film.index_id.empty()) out["material"] = film.index_id;
  note_range(film.index_id, film.index_range_nm, "the index of the film", "continued", notes);
  out["n_d"] = refractive_index(film.index, kLine_d_nm);
  if (film.thickness_texture) out["thickness_min_nm"] = short_decimal(film.thickness_min_nm);
  out[film.thickness_texture ? "thickness_max_nm" : "thickness_nm"] =
      short_decimal(film.thickness_max_nm);
  if (film.factor < 1.0f || film.factor_texture) out["factor"] = short_decimal(film.factor);
  if (film.factor_texture) out["factor_texture"] = film.factor_texture->texture;
  if (film.thickness_texture) out["thickness_texture"] = film.thickness_texture->texture;
  return out;
}

// A number, and the texture that it multiplies.
void describe_textured(const char* name, float value, const std::optional<TextureUse>& texture,
                       Description& out) {
  out[name] = short_decimal(value);
  if (texture) out[std::string(name) + "_texture"] = texture->texture;
}

void describe_textured(const char* name, const Vec3f& rec709,
                       const std::optional<TextureUse>& texture, Description& out) {
  out[std::string(name) + "_rec709"] = triple(rec709);
  if (texture) out[std::string(name) + "_texture"] = texture->texture;
}

// What is on the surface, and what it does besides glTF's core.
void describe_layers(const Material& material, Description& out) {
  if (material.clearcoat) {
    const Clearcoat& coat = *material.clearcoat;
    Description part;
    part["kind"] = coat.roughness >= kSmoothRoughness ? "rough layer of index 1.5 on top"
                                                      : "smooth layer of index 1.5 on top";
    describe_textured("factor", coat.factor, coat.factor_texture, part);
    describe_textured("roughness", coat.roughness, coat.roughness_texture, part);
    if (coat.normal_texture) part["normal_texture"] = coat.normal_texture->texture;
    out["clearcoat"] = part;
  }
  if (material.sheen) {
    Description part;
    describe_textured("color", material.sheen->color_rec709, material.sheen->color_texture, part);
    describe_textured("roughness", material.sheen->roughness, material.sheen->roughness_texture,
                      part);
    out["sheen"] = part;
  }
  if (material.anisotropy) {
    Description part;
    describe_textured("strength", material.anisotropy->strength, material.anisotropy->texture,
                      part);
    part["rotation_deg"] = static_cast<double>(material.anisotropy->rotation_rad) * kDegrees;
    out["anisotropy"] = part;
  }
  if (material.specular && !material.specular->is_plain() && material.metallic < 1.0f) {
    const SpecularPart& specular = *material.specular;
    Description part;
    describe_textured("factor", specular.factor, specular.factor_texture, part);
    describe_textured("color", specular.color_rec709, specular.color_texture, part);
    out["specular"] = part;
  }
  if (material.diffuse_transmission) {
    const DiffuseTransmission& through = *material.diffuse_transmission;
    Description part;
    describe_textured("factor", through.factor, through.factor_texture, part);
    describe_textured("color", through.color_rec709, through.color_texture, part);
    out["diffuse_transmission"] = part;
  }
}

void note_approximations(const Material& material, const std::string& name, Notes& notes) {
  if (material.unlit) return;
  const bool has_reflection =
      material.index_is_infinite || refractive_index(material.index, kLine_d_nm) != 1.0;
  if (material.roughness >= kSmoothRoughness && has_reflection && material.metallic < 1.0f &&
      material.transmission == 0.0f && !material.clearcoat) {
    notes.info("material " + name,
               "rough and opaque: it shows the highlights of lamps, and a blurred reflection of "
               "what is around it only where something besides lamps shines");
  }
  if (material.transmission > 0.0f && !material.has_volume && is_dispersive(material.index)) {
    notes.warn("material " + name, "a sheet without volume does not refract: no dispersion");
  }
}

}  // namespace

Description triple(const Vec3d& v) {
  return {v.x, v.y, v.z};
}

double short_decimal(float value) {
  return std::stod(fmt::format("{}", value));
}

Description describe_material(const Material& material, Notes& notes) {
  Description out;
  const std::string name = material.name.empty() ? "(nameless)" : material.name;
  out["name"] = name;
  out["kind"] = kind_of(material);
  if (material.reflectance) {
    const std::string& id = material.reflectance->id;
    out["reflectance"] = id.empty() ? "its own spectrum" : id;
  } else if (!material.conductor) {
    out["base_color_rec709"] = triple(Vec3f(material.base_color_rec709));
  }
  if (material.base_color_texture) out["base_color_texture"] = material.base_color_texture->texture;
  if (material.conductor) {
    const Conductor& conductor = *material.conductor;
    out["conductor"] = conductor.id.empty() ? "its own n and k" : conductor.id;
    out["n_d"] = conductor.n.value(kLine_d_nm);
    out["k_d"] = conductor.k.value(kLine_d_nm);
    note_range(conductor.id, conductor.range_nm, "the table of n and k", "held constant", notes);
  } else {
    if (material.metallic > 0.0f) out["metallic"] = short_decimal(material.metallic);
    if (material.metallic < 1.0f && !material.unlit) {
      describe_index(material, notes, out);
    }
  }
  if (!material.unlit) out["roughness"] = short_decimal(material.roughness);
  if (material.metallic_roughness_texture) {
    out["metallic_roughness_texture"] = material.metallic_roughness_texture->texture;
  }
  if (material.glossiness_texture) {
    out["glossiness_texture"] = material.glossiness_texture->texture;
  }
  if (material.normal_texture) out["normal_texture"] = material.normal_texture->texture;
  if (material.transmission > 0.0f) out["transmission"] = short_decimal(material.transmission);
  if (material.absorption_per_m) {
    out["absorption_per_m_at_d"] = material.absorption_per_m->value(kLine_d_nm);
  } else if (material.has_volume && std::isfinite(material.attenuation_distance_m)) {
    out["attenuation_color_rec709"] = triple(material.attenuation_color_rec709);
    out["attenuation_distance_m"] = material.attenuation_distance_m;
  }
  if (material.film) out["film"] = describe_film(*material.film, notes);
  if (!material.unlit) describe_layers(material, out);
  describe_emission(material, out);
  if (material.emissive_texture) out["emissive_texture"] = material.emissive_texture->texture;
  if (material.alpha_mode == AlphaMode::Mask)
    out["alpha_cutoff"] = short_decimal(material.alpha_cutoff);
  if (material.alpha_mode == AlphaMode::Blend) out["alpha"] = "blend";
  if (material.ambient_factor) out["ambient_factor"] = *material.ambient_factor;
  if (material.priority != 0) out["priority"] = material.priority;
  note_approximations(material, name, notes);
  return out;
}

Description describe_light(const Light& light, const Vec3d& origin_m) {
  Description out;
  out["name"] = light.name.empty() ? "(nameless)" : light.name;
  const LightKind kind = kind_of(light);
  out["type"] = kind.name;
  out[kind.intensity] = light.intensity;
  if (light.spectrum) {
    out["spectrum"] = light.spectrum->id.empty() ? "its own" : light.spectrum->id;
    if (!light.spectrum->spectrum.lines().empty()) {
      out["spectral_lines"] = light.spectrum->spectrum.lines().size();
    }
  } else {
    out["spectrum"] = "illuminant/D65";
    out["color_rec709"] = triple(light.color_rec709);
  }
  if (kind.has_position) {
    out["position_m"] = triple(origin_m + Vec3d(light.to_world[3]));
    if (std::isfinite(light.range_m)) out["range_m"] = light.range_m;
  }
  if (kind.has_direction) {
    out["shines_along"] = triple(-glm::normalize(Vec3d(light.to_world[2])));
  }
  if (kind.has_cone) {
    out["inner_cone_deg"] = light.inner_cone_rad * kDegrees;
    out["outer_cone_deg"] = light.outer_cone_rad * kDegrees;
  }
  return out;
}

}  // namespace abbe
