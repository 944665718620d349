#include "abbe/scene/colors.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "abbe/color/color.h"
#include "abbe/color/uplift/object_colors.h"

namespace abbe {
namespace {

class Counter {
 public:
  void add_reflectance(const Vec3d& rgb_rec709, std::uint64_t times = 1) {
    if (is_in_rec709(rgb_rec709)) return;  // All of Rec.709 is possible.
    count_.outside_rec709 += times;
    if (!is_object_color(rgb_rec709)) count_.impossible += times;
  }

  void add_emission(const Vec3d& rgb_rec709, std::uint64_t times = 1) {
    const double scale = 2.0 * std::max({rgb_rec709.r, rgb_rec709.g, rgb_rec709.b});
    if (scale > 0.0) add_reflectance(rgb_rec709 / scale, times);
  }

  const ColorCount& count() const { return count_; }

 private:
  static bool is_in_rec709(const Vec3d& color) {
    constexpr double kRounding = 1e-6;
    return std::min({color.r, color.g, color.b}) >= -kRounding &&
           std::max({color.r, color.g, color.b}) <= 1.0 + kRounding;
  }
  ColorCount count_;
};

// Calls `use` with each colour of an image as linear Rec.709 and how often it occurs.
template <typename Use>
void for_each_color(const TextureImage& image, const Mat3d& to_rec709, const Use& use) {
  const auto decoded = [&](double r, double g, double b) {
    return to_rec709 * Vec3d(srgb_decode(r), srgb_decode(g), srgb_decode(b));
  };
  const std::size_t count = static_cast<std::size_t>(image.width) * image.height;
  if (image.rgba8.empty()) {
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint16_t* texel = &image.rgba16[4 * i];
      use(decoded(texel[0] / 65535.0, texel[1] / 65535.0, texel[2] / 65535.0), 1);
    }
    return;
  }
  // Photographs have far fewer colours than texels.
  std::unordered_map<std::uint32_t, std::uint64_t> codes;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t* texel = &image.rgba8[4 * i];
    ++codes[texel[0] | texel[1] << 8u | texel[2] << 16u];
  }
  for (const auto& [code, times] : codes) {
    use(decoded((code & 255u) / 255.0, (code >> 8u & 255u) / 255.0, (code >> 16u) / 255.0), times);
  }
}

}  // namespace

void convert_colors_to_rec709(Scene& scene) {
  if (scene.color_space == RgbSpace::Rec709) return;
  const Mat3d to_rec709 = rgb_to_rec709(scene.color_space);
  for (Material& material : scene.materials) {
    Vec4f& base = material.base_color_rec709;
    base = Vec4f(Vec3f(to_rec709 * Vec3d(base)), base.w);
    material.emissive_rec709 = Vec3f(to_rec709 * Vec3d(material.emissive_rec709));
    material.attenuation_color_rec709 = to_rec709 * material.attenuation_color_rec709;
  }
  for (Mesh& mesh : scene.meshes) {
    for (Vec4f& color : mesh.colors_rec709) {
      color = Vec4f(Vec3f(to_rec709 * Vec3d(color)), color.w);
    }
  }
  for (Light& light : scene.lights) light.color_rec709 = to_rec709 * light.color_rec709;
}

ColorCount count_colors(const Scene& scene) {
  if (scene.color_space == RgbSpace::Rec709) return {};
  const Mat3d to_rec709 = rgb_to_rec709(scene.color_space);
  Counter counter;
  const auto image_of = [&scene](const TextureUse& use) -> const TextureImage& {
    return scene.images[scene.textures[use.texture].image];
  };
  for (const Material& material : scene.materials) {
    const Vec3d factor = material.reflectance ? Vec3d(1.0) : Vec3d(material.base_color_rec709);
    if (material.base_color_texture) {
      for_each_color(image_of(*material.base_color_texture), to_rec709,
                     [&](const Vec3d& color, std::uint64_t times) {
                       counter.add_reflectance(factor * color, times);
                     });
    } else if (!material.conductor && !material.reflectance) {
      counter.add_reflectance(factor);
    }
    if (material.has_volume && std::isfinite(material.attenuation_distance_m)) {
      counter.add_reflectance(material.attenuation_color_rec709);
    }
    if (material.emission) continue;
    if (!material.emissive_texture) {
      counter.add_emission(Vec3d(material.emissive_rec709));
      continue;
    }
    for_each_color(image_of(*material.emissive_texture), to_rec709,
                   [&](const Vec3d& color, std::uint64_t times) {
                     counter.add_emission(Vec3d(material.emissive_rec709) * color, times);
                   });
  }
  for (const Mesh& mesh : scene.meshes) {
    const Vec3d factor(scene.materials[mesh.material].base_color_rec709);
    for (const Vec4f& color : mesh.colors_rec709) counter.add_reflectance(factor * Vec3d(color));
  }
  for (const Light& light : scene.lights) {
    if (!light.spectrum) counter.add_emission(light.color_rec709);
  }
  return counter.count();
}

}  // namespace abbe
