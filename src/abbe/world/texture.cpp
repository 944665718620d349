#include "abbe/world/texture.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "abbe/base/paged.h"
#include "abbe/color/color.h"

namespace abbe {
namespace {

// Of as many codes.
std::vector<float> srgb_decode_table(int size) {
  std::vector<float> table(static_cast<std::size_t>(size));
  for (int i = 0; i < size; ++i) {
    table[static_cast<std::size_t>(i)] = static_cast<float>(srgb_decode(i / (size - 1.0)));
  }
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
    : encoding_(encoding), codes8_(image.rgba8), codes16_(image.rgba16) {
  levels_.push_back({image.width, image.height, 0});
  const std::size_t count = static_cast<std::size_t>(image.width) * image.height;
  const auto look = [&](auto& codes, int opaque) {
    bool is_uniform = true;
    for (std::size_t i = 0; i < count; ++i) {
      const auto* const texel = codes.data() + 4 * i;
      is_opaque_ = is_opaque_ && texel[3] == opaque;
      is_uniform = is_uniform && std::equal(texel, texel + 4, codes.data());
    }
    // One texel shows the same.
    if (is_uniform) {
      levels_.front() = {1, 1, 0};
      codes = {codes[0], codes[1], codes[2], codes[3]};
    }
  };
  if (codes16_.empty()) {
    look(codes8_, 255);
  } else {
    look(codes16_, 65535);
  }
  if (has_mipmaps) add_mipmaps();
  let_go_of_pages();
}

// Each texel is the mean of the texels it covers, so that odd sizes keep their mean, too.
void TexturePyramid::add_mipmaps() {
  const std::size_t channels = is_opaque_ ? 3 : 4;
  std::size_t offset = 0;
  for (Level level = levels_.back(); level.width > 1 || level.height > 1;) {
    level = {std::max(1, level.width / 2), std::max(1, level.height / 2), offset, true};
    offset += static_cast<std::size_t>(level.width) * level.height;
    levels_.push_back(level);
  }
  std::vector<std::uint16_t> mipmaps(channels * offset);
  smaller_ = mipmaps.data();
  auto next = mipmaps.begin();
  for (std::size_t i = 1; i < levels_.size(); ++i) {
    const Level above = levels_[i - 1], level = levels_[i];
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
        const Vec4f mean = sum / static_cast<float>((x1 - x0) * (y1 - y0));
        for (std::size_t c = 0; c < channels; ++c) {
          *next++ = static_cast<std::uint16_t>(mean[static_cast<int>(c)] * 65535.0f + 0.5f);
        }
      }
    }
  }
  const auto store = codes8_.empty() ? codes16_.store() : codes8_.store();
  mipmaps_ = SharedValues<std::uint16_t>(std::move(mipmaps), store);
  smaller_ = mipmaps_.data();
}

Vec4f TexturePyramid::texel(const Level& level, int x, int y) const {
  const std::size_t number = level.offset + static_cast<std::size_t>(y) * level.width + x;
  const auto share = [](std::uint16_t code) { return static_cast<float>(code) / 65535.0f; };
  if (level.is_mipmap) {
    const std::uint16_t* const value = smaller_ + (is_opaque_ ? 3 : 4) * number;
    return {share(value[0]), share(value[1]), share(value[2]), is_opaque_ ? 1.0f : share(value[3])};
  }
  const bool is_data = encoding_ == TextureEncoding::Data;
  if (codes8_.empty()) {
    static const std::vector<float> kDecoded = srgb_decode_table(65536);
    const std::uint16_t* const code = codes16_.data() + 4 * number;
    if (is_data) return {share(code[0]), share(code[1]), share(code[2]), share(code[3])};
    return {kDecoded[code[0]], kDecoded[code[1]], kDecoded[code[2]], share(code[3])};
  }
  static const std::vector<float> kDecoded = srgb_decode_table(256);
  const std::uint8_t* const code = codes8_.data() + 4 * number;
  const auto plain = [&](int c) { return static_cast<float>(code[c]) / 255.0f; };
  if (is_data) return {plain(0), plain(1), plain(2), plain(3)};
  return {kDecoded[code[0]], kDecoded[code[1]], kDecoded[code[2]], plain(3)};
}

std::size_t TexturePyramid::bytes() const {
  return codes8_.size() + (codes16_.size() + mipmaps_.size()) * sizeof(std::uint16_t);
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
