#include "abbe/caustics/flat/flat_material.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <limits>
#include <optional>
#include <span>

namespace abbe {
namespace {

enum Channel : std::size_t { R, G, B, A };

// Whether a condition holds for a channel of all texels, as a share of its greatest value.
template <typename Value, typename Condition>
bool holds_for_all(std::span<const Value> rgba, Channel channel, const Condition& condition) {
  constexpr float kGreatest = std::numeric_limits<Value>::max();
  for (std::size_t i = channel; i < rgba.size(); i += 4) {
    if (!condition(static_cast<float>(rgba[i]) / kGreatest)) return false;
  }
  return true;
}

const TextureImage& image_of(const Scene& scene, const TextureUse& use) {
  return scene.images[scene.textures[use.texture].image];
}

template <typename Condition>
bool holds_for_all(const Scene& scene, const TextureUse& use, Channel channel,
                   const Condition& condition) {
  const TextureImage& image = image_of(scene, use);
  return image.rgba8.empty()
             ? holds_for_all(std::span<const std::uint16_t>(image.rgba16), channel, condition)
             : holds_for_all(std::span<const std::uint8_t>(image.rgba8), channel, condition);
}

// Whether channels of a texture are 1 everywhere, or there is none.
bool are_full(const Scene& scene, const std::optional<TextureUse>& use,
              std::initializer_list<Channel> channels) {
  if (!use) return true;
  return std::all_of(channels.begin(), channels.end(), [&](Channel channel) {
    return holds_for_all(scene, *use, channel, [](float value) { return value == 1.0f; });
  });
}

bool is_smooth(const Scene& scene, const Material& material) {
  if (material.glossiness_texture) {
    return material.roughness < kSmoothRoughness &&
           are_full(scene, material.glossiness_texture, {A});
  }
  if (material.roughness < kSmoothRoughness) return true;
  // Most are rough at their first texel.
  return material.metallic_roughness_texture &&
         holds_for_all(scene, *material.metallic_roughness_texture, G,
                       [&](float value) { return material.roughness * value < kSmoothRoughness; });
}

// The least alpha of the vertices of a mesh.
float least_alpha(const Mesh* mesh) {
  float least = 1.0f;
  if (mesh == nullptr) return least;
  for (const Vec4f& color : mesh->colors_rec709) least = std::min(least, color.w);
  return least;
}

bool is_coloured(const Mesh* mesh) {
  return mesh != nullptr &&
         std::any_of(mesh->colors_rec709.begin(), mesh->colors_rec709.end(),
                     [](const Vec4f& color) { return Vec3f(color) != Vec3f(1.0f); });
}

// Whether it is there as a whole.
bool covers(const Scene& scene, const Material& material, const Mesh* mesh) {
  if (material.alpha_mode == AlphaMode::Opaque) return true;
  if (!are_full(scene, material.base_color_texture, {A})) return false;
  const float least = material.base_color_rec709.w * least_alpha(mesh);
  return least >= (material.alpha_mode == AlphaMode::Mask ? material.alpha_cutoff : 1.0f);
}

std::string trouble_of(const Scene& scene, const Material& material, const Mesh* mesh,
                       bool is_mirror) {
  if (!covers(scene, material, mesh)) return "it covers only a part (alphaMode, alpha)";
  if (!are_full(scene, material.base_color_texture, {R, G, B})) return "a texture colours it";
  if (is_coloured(mesh)) return "its vertices colour it";
  if (material.metallic > 0.0f && !material.conductor &&
      !are_full(scene, material.metallic_roughness_texture, {B})) {
    return "a texture says where it is metal";
  }
  if (material.normal_texture && material.normal_scale != 0.0f) return "a normal map bends it";
  if (material.film && material.film->factor > 0.0f &&
      (material.film->factor_texture || material.film->thickness_texture)) {
    return "a texture shapes its thin film";
  }
  if (material.clearcoat && material.clearcoat->factor > 0.0f) return "it has a clearcoat";
  if (material.sheen && material.sheen->color_rec709 != Vec3f(0.0f)) return "it has a sheen";
  if (material.anisotropy && material.anisotropy->strength > 0.0f) {
    return "it is rough along one direction";
  }
  if (is_mirror) {
    if (material.metallic < 1.0f && !material.conductor) {
      return fmt::format("only a part of it is metal (metallicFactor {})", material.metallic);
    }
    return "";
  }
  if (material.specular && !material.specular->is_plain()) {
    return "KHR_materials_specular changes what it reflects";
  }
  if (material.diffuse_transmission && material.diffuse_transmission->factor > 0.0f) {
    return "a part of it scatters light (KHR_materials_diffuse_transmission)";
  }
  if (material.metallic > 0.0f) {
    return fmt::format("a part of it is metal (metallicFactor {})", material.metallic);
  }
  if (material.transmission < 1.0f) {
    return fmt::format("only a part of it lets light through (transmissionFactor {})",
                       material.transmission);
  }
  if (!are_full(scene, material.transmission_texture, {R})) {
    return "a texture says where it lets light through";
  }
  return "";
}

}  // namespace

FlatMaterial flat_material(const Scene& scene, const Material& material, const Mesh* mesh) {
  // Of what is both, the larger part counts.
  const bool is_mirror = material.metallic >= 0.5f || material.conductor;
  const bool is_glass = material.has_volume && material.transmission > 0.0f &&
                        !material.index_is_infinite && !is_mirror;
  if ((!is_mirror && !is_glass) || material.unlit || !is_smooth(scene, material)) return {};
  FlatMaterial result;
  result.kind = is_mirror ? FlatMaterial::Kind::Mirror : FlatMaterial::Kind::Glass;
  result.trouble = trouble_of(scene, material, mesh, is_mirror);
  return result;
}

}  // namespace abbe
