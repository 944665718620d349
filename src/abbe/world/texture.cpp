#include "abbe/world/texture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "abbe/color/color.h"

namespace abbe {
namespace {

std::array<float, 256> srgb_decode_table() {
  std::array<float, 256> table{};
  for (int i = 0; i < 256; ++i) table[i] = static_cast<float>(srgb_decode(i / 255.0));
  return table;
}

float wrapped(float x, TextureWrap wrap) {
  switch (wrap) {
    case TextureWrap::Repeat:
      return x - std::floor(x);
    case TextureWrap::MirroredRepeat: {
      const float period = x - 2.0f * std::floor(0.5f * x);
      return period > 1.0f ? 2.0f - period : period;
    }
    case TextureWrap::ClampToEdge:
      break;
  }
  return std::clamp(x, 0.0f, 1.0f);
}

int wrapped_index(int i, int size, TextureWrap wrap) {
  if (i >= 0 && i < size) return i;
  if (wrap == TextureWrap::Repeat) return i < 0 ? i + size : i - size;
  return std::clamp(i, 0, size - 1);  // Mirrored: the edge texel meets itself.
}

}  // namespace

WorldTexture::WorldTexture(const TextureImage& image, const Texture& texture,
                           TextureEncoding encoding, RgbSpace space)
    : wrap_s_(texture.wrap_s), wrap_t_(texture.wrap_t), filter_(texture.filter) {
  static const std::array<float, 256> kDecoded = srgb_decode_table();
  const std::size_t count = static_cast<std::size_t>(image.width) * image.height;
  texels_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    for (int c = 0; c < 4; ++c) {
      const bool decode = encoding == TextureEncoding::Srgb && c < 3;
      if (!image.rgba8.empty()) {
        const std::uint8_t code = image.rgba8[4 * i + c];
        texels_[i][c] = decode ? kDecoded[code] : static_cast<float>(code) / 255.0f;
      } else {
        const float code = image.rgba_float[4 * i + c];
        texels_[i][c] = decode ? static_cast<float>(srgb_decode(code)) : code;
      }
    }
  }
  if (encoding == TextureEncoding::Srgb && space != RgbSpace::Rec709) {
    const glm::mat3 to_rec709(rgb_to_rec709(space));
    for (Vec4f& texel : texels_) texel = Vec4f(to_rec709 * Vec3f(texel), texel.w);
  }
  levels_.push_back({image.width, image.height, 0});
  while (filter_ == TextureFilter::Linear &&
         (levels_.back().width > 1 || levels_.back().height > 1)) {
    const Level above = levels_.back();
    const Level level{std::max(1, above.width / 2), std::max(1, above.height / 2), texels_.size()};
    texels_.resize(level.offset + static_cast<std::size_t>(level.width) * level.height);
    // Each texel is the mean of the texels it covers, so that odd sizes keep their mean, too.
    for (int y = 0; y < level.height; ++y) {
      const int y0 = y * above.height / level.height;
      const int y1 = std::max(y0 + 1, (y + 1) * above.height / level.height);
      for (int x = 0; x < level.width; ++x) {
        const int x0 = x * above.width / level.width;
        const int x1 = std::max(x0 + 1, (x + 1) * above.width / level.width);
        Vec4f sum(0.0f);
        for (int v = y0; v < y1; ++v) {
          for (int u = x0; u < x1; ++u) sum += texel(above, u, v);
        }
        texels_[level.offset + static_cast<std::size_t>(y) * level.width + x] =
            sum / static_cast<float>((x1 - x0) * (y1 - y0));
      }
    }
    levels_.push_back(level);
  }
}

const Vec4f& WorldTexture::texel(const Level& level, int x, int y) const {
  return texels_[level.offset + static_cast<std::size_t>(y) * level.width + x];
}

Vec4f WorldTexture::bilinear(const Level& level, const Vec2f& uv) const {
  const float x = uv.x * static_cast<float>(level.width) - 0.5f;
  const float y = uv.y * static_cast<float>(level.height) - 0.5f;
  const int x0 = static_cast<int>(std::floor(x));
  const int y0 = static_cast<int>(std::floor(y));
  const float fx = x - static_cast<float>(x0);
  const float fy = y - static_cast<float>(y0);
  const int xa = wrapped_index(x0, level.width, wrap_s_);
  const int xb = wrapped_index(x0 + 1, level.width, wrap_s_);
  const int ya = wrapped_index(y0, level.height, wrap_t_);
  const int yb = wrapped_index(y0 + 1, level.height, wrap_t_);
  const Vec4f& aa = texel(level, xa, ya);
  const Vec4f& ba = texel(level, xb, ya);
  const Vec4f& ab = texel(level, xa, yb);
  const Vec4f& bb = texel(level, xb, yb);
  // Exactly that value where all have it: what is flat stays flat, and has one spectrum.
  if (aa == ba && aa == ab && aa == bb) return aa;
  return (1.0f - fy) * ((1.0f - fx) * aa + fx * ba) + fy * ((1.0f - fx) * ab + fx * bb);
}

Vec4f WorldTexture::value(const Vec2f& uv, float footprint_uv) const {
  // Beyond 2^20 a float has no place left for a texel; such coordinates are mistakes.
  const auto sane = [](float x) { return std::abs(x) < 1048576.0f ? x : 0.0f; };
  const Vec2f at{wrapped(sane(uv.x), wrap_s_), wrapped(sane(uv.y), wrap_t_)};
  const Level& base = levels_.front();
  if (filter_ == TextureFilter::Nearest) {
    const int x = std::min(static_cast<int>(at.x * static_cast<float>(base.width)), base.width - 1);
    const int y =
        std::min(static_cast<int>(at.y * static_cast<float>(base.height)), base.height - 1);
    return texel(base, x, y);
  }
  const float texels_wide = footprint_uv * static_cast<float>(std::max(base.width, base.height));
  if (!(texels_wide > 1.0f)) return bilinear(base, at);
  const float lod = std::min(std::log2(texels_wide), static_cast<float>(levels_.size() - 1));
  const std::size_t lower = static_cast<std::size_t>(lod);
  const float f = lod - static_cast<float>(lower);
  const Vec4f fine = bilinear(levels_[lower], at);
  if (f == 0.0f || lower + 1 >= levels_.size()) return fine;
  const Vec4f coarse = bilinear(levels_[lower + 1], at);
  return fine == coarse ? fine : (1.0f - f) * fine + f * coarse;
}

}  // namespace abbe
