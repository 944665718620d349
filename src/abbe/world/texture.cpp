#include "abbe/world/texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

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

TexturePyramid::TexturePyramid(const TextureImage& image, TextureEncoding encoding,
                               bool has_mipmaps)
    : encoding_(encoding), codes_(image.rgba8) {
  Level base{image.width, image.height, 0};
  const std::size_t count = static_cast<std::size_t>(image.width) * image.height;
  if (!codes_.empty()) {
    is_opaque_ = true;
    bool is_uniform = true;
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint8_t* const texel = codes_.data() + 4 * i;
      is_opaque_ = is_opaque_ && texel[3] == 255;
      is_uniform = is_uniform && std::equal(texel, texel + 4, codes_.data());
    }
    // One texel shows the same.
    if (is_uniform) {
      base = {1, 1, 0};
      codes_ = SharedValues<std::uint8_t>{codes_[0], codes_[1], codes_[2], codes_[3]};
    }
  } else {
    floats_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      for (int c = 0; c < 4; ++c) {
        const float code = image.rgba_float[4 * i + static_cast<std::size_t>(c)];
        const bool decode = encoding == TextureEncoding::Srgb && c < 3;
        floats_[i][c] = decode ? static_cast<float>(srgb_decode(code)) : code;
      }
    }
  }
  levels_.push_back(base);
  if (!has_mipmaps) return;
  if (codes_.empty()) {
    add_mipmaps([&](const Vec4f& mean) { floats_.push_back(mean); });
    return;
  }
  mipmaps_.reserve((count / 3 + 64) * (is_opaque_ ? 3u : 4u));
  add_mipmaps([&](const Vec4f& mean) {
    for (int c = 0; c < (is_opaque_ ? 3 : 4); ++c) {
      mipmaps_.push_back(static_cast<std::uint16_t>(mean[c] * 65535.0f + 0.5f));
    }
  });
  mipmaps_.shrink_to_fit();
}

// Each texel is the mean of the texels it covers, so that odd sizes keep their mean, too.
template <class Store>
void TexturePyramid::add_mipmaps(const Store& store) {
  std::size_t offset = codes_.empty() ? floats_.size() : 0;
  while (levels_.back().width > 1 || levels_.back().height > 1) {
    const Level above = levels_.back();
    const Level level{std::max(1, above.width / 2), std::max(1, above.height / 2), offset, true};
    offset += static_cast<std::size_t>(level.width) * level.height;
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
        store(sum / static_cast<float>((x1 - x0) * (y1 - y0)));
      }
    }
    levels_.push_back(level);
  }
}

Vec4f TexturePyramid::texel(const Level& level, int x, int y) const {
  static const std::array<float, 256> kDecoded = srgb_decode_table();
  const std::size_t number = level.offset + static_cast<std::size_t>(y) * level.width + x;
  if (codes_.empty()) return floats_[number];
  if (level.is_mipmap) {
    const std::uint16_t* const value = mipmaps_.data() + (is_opaque_ ? 3 : 4) * number;
    const auto share = [&](int c) { return static_cast<float>(value[c]) / 65535.0f; };
    return {share(0), share(1), share(2), is_opaque_ ? 1.0f : share(3)};
  }
  const std::uint8_t* const code = codes_.data() + 4 * number;
  const auto plain = [&](int c) { return static_cast<float>(code[c]) / 255.0f; };
  if (encoding_ == TextureEncoding::Data) return {plain(0), plain(1), plain(2), plain(3)};
  return {kDecoded[code[0]], kDecoded[code[1]], kDecoded[code[2]], plain(3)};
}

std::size_t TexturePyramid::bytes() const {
  return codes_.size() + mipmaps_.size() * sizeof(std::uint16_t) + floats_.size() * sizeof(Vec4f);
}

WorldTexture::WorldTexture(const TextureImage& image, const Texture& texture,
                           TextureEncoding encoding, RgbSpace space)
    : WorldTexture(std::make_shared<const TexturePyramid>(image, encoding,
                                                          texture.filter == TextureFilter::Linear),
                   texture, encoding, space) {}

WorldTexture::WorldTexture(std::shared_ptr<const TexturePyramid> pyramid, const Texture& texture,
                           TextureEncoding encoding, RgbSpace space, float uv_scale)
    : pyramid_(std::move(pyramid)),
      wrap_s_(texture.wrap_s),
      wrap_t_(texture.wrap_t),
      filter_(texture.filter),
      uv_scale_(uv_scale) {
  if (encoding == TextureEncoding::Srgb && space != RgbSpace::Rec709) {
    to_rec709_ = glm::mat3(rgb_to_rec709(space));
  }
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
  const Vec4f aa = pyramid_->texel(level, xa, ya);
  const Vec4f ba = pyramid_->texel(level, xb, ya);
  const Vec4f ab = pyramid_->texel(level, xa, yb);
  const Vec4f bb = pyramid_->texel(level, xb, yb);
  // Exactly that value where all have it: what is flat stays flat, and has one spectrum.
  if (aa == ba && aa == ab && aa == bb) return aa;
  return (1.0f - fy) * ((1.0f - fx) * aa + fx * ba) + fy * ((1.0f - fx) * ab + fx * bb);
}

Vec4f WorldTexture::value(const Vec2f& uv, float footprint_uv) const {
  const Vec4f value = filtered(uv, uv_scale_ * footprint_uv);
  return to_rec709_ ? Vec4f(*to_rec709_ * Vec3f(value), value.w) : value;
}

Vec4f WorldTexture::filtered(const Vec2f& uv, float footprint_uv) const {
  const std::vector<Level>& levels = pyramid_->levels();
  // Beyond 2^20 a float has no place left for a texel; such coordinates are mistakes.
  const auto sane = [](float x) { return std::abs(x) < 1048576.0f ? x : 0.0f; };
  const Vec2f at{wrapped(sane(uv.x), wrap_s_), wrapped(sane(uv.y), wrap_t_)};
  const Level& base = levels.front();
  if (filter_ == TextureFilter::Nearest) {
    const int x = std::min(static_cast<int>(at.x * static_cast<float>(base.width)), base.width - 1);
    const int y =
        std::min(static_cast<int>(at.y * static_cast<float>(base.height)), base.height - 1);
    return pyramid_->texel(base, x, y);
  }
  const float texels_wide = footprint_uv * static_cast<float>(std::max(base.width, base.height));
  if (!(texels_wide > 1.0f)) return bilinear(base, at);
  const float lod = std::min(std::log2(texels_wide), static_cast<float>(levels.size() - 1));
  const std::size_t lower = static_cast<std::size_t>(lod);
  const float f = lod - static_cast<float>(lower);
  const Vec4f fine = bilinear(levels[lower], at);
  if (f == 0.0f || lower + 1 >= levels.size()) return fine;
  const Vec4f coarse = bilinear(levels[lower + 1], at);
  return fine == coarse ? fine : (1.0f - f) * fine + f * coarse;
}

}  // namespace abbe
