#include "abbe/scene/texture_uses.h"

namespace abbe {

std::vector<const TextureUse*> texture_uses(const Material& material) {
  std::vector<const TextureUse*> uses;
  const auto add = [&](const auto&... all) {
    for (const std::optional<TextureUse>* use : {&all...}) {
      if (*use) uses.push_back(&**use);
    }
  };
  add(material.base_color_texture, material.metallic_roughness_texture, material.glossiness_texture,
      material.normal_texture, material.emissive_texture, material.transmission_texture);
  if (const auto& film = material.film) add(film->factor_texture, film->thickness_texture);
  if (const auto& coat = material.clearcoat) {
    add(coat->factor_texture, coat->roughness_texture, coat->normal_texture);
  }
  if (const auto& sheen = material.sheen) add(sheen->color_texture, sheen->roughness_texture);
  if (const auto& anisotropy = material.anisotropy) add(anisotropy->texture);
  if (const auto& specular = material.specular) {
    add(specular->factor_texture, specular->color_texture);
  }
  if (const auto& through = material.diffuse_transmission) {
    add(through->factor_texture, through->color_texture);
  }
  return uses;
}

}  // namespace abbe
