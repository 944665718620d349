/// Textures ready for look-up: linear, with mipmaps.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "abbe/math/vec.h"
#include "abbe/scene/scene.h"

namespace abbe {

/// How texels are to be understood.
enum class TextureEncoding : std::uint8_t {
  Srgb,  ///< RGB is encoded with sRGB's curve and becomes linear Rec.709; alpha is linear.
  Data,  ///< Plain numbers.
};

/// An image's texels, at its own size and at halves of it down to one. The first level are the
/// image's codes, in memory that they share with the scene; smaller levels are linear, of 16 bits:
/// a mean of texels is off by at most 2^-17 a level.
class TexturePyramid {
 public:
  struct Level {
    int width = 0, height = 0;
    std::size_t offset = 0;  ///< Of its first texel among those of all smaller levels.
    bool is_mipmap = false;
  };

  TexturePyramid(const TextureImage& image, TextureEncoding encoding, bool has_mipmaps);

  const std::vector<Level>& levels() const { return levels_; }
  /// Channels in [0, 1], linear.
  Vec4f texel(const Level& level, int x, int y) const;
  /// Memory held, that shared with the scene included.
  std::size_t bytes() const;

 private:
  void add_mipmaps();

  std::vector<Level> levels_;
  TextureEncoding encoding_;
  SharedValues<std::uint8_t> codes8_;  // Of the first level; one of these two is empty.
  SharedValues<std::uint16_t> codes16_;
  bool is_opaque_ = true;  // Alpha is 1 everywhere: mipmaps_ has three values a texel.
  SharedValues<std::uint16_t> mipmaps_;     // Where the codes are: in memory, or in a store.
  const std::uint16_t* smaller_ = nullptr;  // mipmaps_, also while they are made.
};

/// A texture, mipmapped where it is filtered.
/// Colours are filtered as linear RGB and uplifted after filtering: a mix of two texels is then the
/// same colour in all modes.
class WorldTexture {
 public:
  /// Colours are those of `space`; beyond Rec.709 they have channels outside [0, 1].
  WorldTexture(const TextureImage& image, const Texture& texture, TextureEncoding encoding,
               RgbSpace space = RgbSpace::Rec709);
  /// Of a pyramid that others may share, made for the encoding, for uses whose transform has this
  /// scale.
  WorldTexture(std::shared_ptr<const TexturePyramid> pyramid, const Texture& texture,
               TextureEncoding encoding, RgbSpace space, float uv_scale = 1.0f);

  /// Trilinear (or nearest) look-up. `footprint_uv` is the width of what is seen, in units of uv
  /// before a use's transform; `uv` is after it.
  /// Domain: any uv; not-a-number counts as 0.
  Vec4f value(const Vec2f& uv, float footprint_uv) const;

  std::size_t bytes() const { return pyramid_->bytes(); }

 private:
  using Level = TexturePyramid::Level;
  Vec4f filtered(const Vec2f& uv, float footprint_uv) const;
  Vec4f bilinear(const Level& level, const Vec2f& uv) const;

  std::shared_ptr<const TexturePyramid> pyramid_;
  TextureWrap wrap_s_, wrap_t_;
  TextureFilter filter_;
  float uv_scale_;
  std::optional<glm::mat3> to_rec709_;  // Of colours of another space.
};

/// uv' = linear·uv + offset of a texture use.
inline Vec2f transformed_uv(const TextureUse& use, const Vec2f& uv) {
  return {use.uv_linear[0] * uv.x + use.uv_linear[1] * uv.y + use.uv_offset.x,
          use.uv_linear[2] * uv.x + use.uv_linear[3] * uv.y + use.uv_offset.y};
}

/// By how much a use's transform widens: the root of what it makes of an area.
inline float uv_scale(const TextureUse& use) {
  const auto& m = use.uv_linear;
  return std::sqrt(std::abs(m[0] * m[3] - m[1] * m[2]));
}

}  // namespace abbe
