/// Textures ready for look-up: linear, with mipmaps.
#pragma once

#include <cstdint>
#include <vector>

#include "abbe/math/vec.h"
#include "abbe/scene/scene.h"

namespace abbe {

/// How texels are to be understood.
enum class TextureEncoding : std::uint8_t {
  Srgb,  ///< RGB is encoded with sRGB's curve and becomes linear Rec.709; alpha is linear.
  Data,  ///< Plain numbers.
};

/// A mipmapped texture of four float channels.
/// Colours are filtered as linear RGB and uplifted after filtering: a mix of two texels is then the
/// same colour in all modes.
class WorldTexture {
 public:
  /// Colours are those of `space`; beyond Rec.709 they have channels outside [0, 1].
  WorldTexture(const TextureImage& image, const Texture& texture, TextureEncoding encoding,
               RgbSpace space = RgbSpace::Rec709);

  /// Trilinear (or nearest) look-up. `footprint_uv` is the width of what is seen, in units of uv.
  /// Domain: any uv; not-a-number counts as 0.
  Vec4f value(const Vec2f& uv, float footprint_uv) const;

  std::size_t bytes() const { return texels_.size() * sizeof(Vec4f); }

 private:
  struct Level {
    int width = 0, height = 0;
    std::size_t offset = 0;
  };
  Vec4f bilinear(const Level& level, const Vec2f& uv) const;
  const Vec4f& texel(const Level& level, int x, int y) const;

  std::vector<Level> levels_;
  std::vector<Vec4f> texels_;
  TextureWrap wrap_s_, wrap_t_;
  TextureFilter filter_;
};

/// uv' = linear·uv + offset of a texture use.
inline Vec2f transformed_uv(const TextureUse& use, const Vec2f& uv) {
  return {use.uv_linear[0] * uv.x + use.uv_linear[1] * uv.y + use.uv_offset.x,
          use.uv_linear[2] * uv.x + use.uv_linear[3] * uv.y + use.uv_offset.y};
}

}  // namespace abbe
