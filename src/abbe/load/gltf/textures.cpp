#include "abbe/load/gltf/textures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "abbe/base/error.h"
#include "abbe/load/gltf/document/check.h"
#include "abbe/load/gltf/document/images.h"

namespace abbe::gltf {
namespace {

// uv' = T·R·S·uv: the textures of KHR_texture_transform turn counter-clockwise as seen, and v runs
// downwards, so a positive angle has sin beside v in the first row.
void apply_transform(const Fields& transform, TextureUse& use) {
  const double angle_rad = transform.number("rotation", 0.0, {-1e6, 1e6});
  const auto pair = [&transform](const char* name, double otherwise) {
    if (!transform.has(name)) return std::vector<double>(2, otherwise);
    return transform.numbers(name, 2, 2, {-1e6, 1e6});
  };
  const std::vector<double> offset = pair("offset", 0.0), scale = pair("scale", 1.0);
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  use.uv_linear = {static_cast<float>(c * scale[0]), static_cast<float>(s * scale[1]),
                   static_cast<float>(-s * scale[0]), static_cast<float>(c * scale[1])};
  use.uv_offset = Vec2f(static_cast<float>(offset[0]), static_cast<float>(offset[1]));
}

}  // namespace

std::optional<TextureUse> Textures::use(const Fields& fields, const char* name) {
  const auto info = fields.object(name);
  if (!info) return std::nullopt;
  const std::size_t count = model_.textures.size();
  const double index = info->required_number("index", {0.0, static_cast<double>(count) - 1.0});
  if (index != std::floor(index)) throw_input_error(info->where("index"), "a fraction", "an index");
  TextureUse use;
  double uv_set = info->number("texCoord", 0.0, {0.0, 1e6});
  if (const auto extensions = info->object("extensions")) {
    if (const auto transform = extensions->object("KHR_texture_transform")) {
      apply_transform(*transform, use);
      uv_set = transform->number("texCoord", uv_set, {0.0, 1e6});
    }
  }
  if (uv_set > 1.0) {
    document_.notes().warn(info->where("texCoord"),
                           fmt::format("texture coordinates {:g}: only sets 0 and 1 are read; the "
                                       "texture is ignored",
                                       uv_set));
    return std::nullopt;
  }
  use.uv_set = static_cast<std::uint32_t>(uv_set);
  const auto found = texture(static_cast<int>(index), info->pointer());
  if (!found) return std::nullopt;
  use.texture = *found;
  return use;
}

std::optional<std::uint32_t> Textures::texture(int index, const std::string& pointer) {
  const auto known = textures_.find(index);
  if (known != textures_.end()) return known->second;

  const tinygltf::Texture& source = model_.textures[at(index)];
  std::optional<std::uint32_t> result;
  if (const auto found = image_of(index, pointer)) {
    Texture texture;
    texture.image = *found;
    if (source.sampler >= 0) {
      const tinygltf::Sampler& sampler = model_.samplers[at(source.sampler)];
      const std::string place = fmt::format("/samplers/{}", source.sampler);
      texture.wrap_s = wrap(sampler.wrapS, place + "/wrapS");
      texture.wrap_t = wrap(sampler.wrapT, place + "/wrapT");
      if (sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST) {
        texture.filter = TextureFilter::Nearest;
      } else if (sampler.magFilter != -1 && sampler.magFilter != TINYGLTF_TEXTURE_FILTER_LINEAR) {
        document_.notes().warn(document_.where(place + "/magFilter"),
                               fmt::format("unknown filter {}; linear is used (known: 9728 "
                                           "nearest, 9729 linear)",
                                           sampler.magFilter));
      }
    }
    result = static_cast<std::uint32_t>(scene_.textures.size());
    scene_.textures.push_back(texture);
  }
  textures_.emplace(index, result);
  return result;
}

std::optional<std::uint32_t> Textures::image_of(int texture, const std::string& user) {
  const std::string pointer = fmt::format("/textures/{}", texture);
  if (const Json* webp = find_extension(document_, "textures", texture, "EXT_texture_webp")) {
    return image((*webp)["source"].get<int>(), user);
  }
  const int source = model_.textures[at(texture)].source;
  if (source >= 0) return image(source, user);
  if (find_extension(document_, "textures", texture, "KHR_texture_basisu") != nullptr) {
    throw_input_error(document_.where(pointer), "KHR_texture_basisu, a KTX2 image, alone",
                      "a source that is a PNG, JPEG or WebP image beside it");
  }
  document_.notes().warn(document_.where(pointer),
                         "no source, so the texture used by " + user + " is ignored");
  return std::nullopt;
}

TextureWrap Textures::wrap(int value, const std::string& pointer) {
  switch (value) {
    case TINYGLTF_TEXTURE_WRAP_REPEAT:
      return TextureWrap::Repeat;
    case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
      return TextureWrap::MirroredRepeat;
    case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
      return TextureWrap::ClampToEdge;
    default:
      document_.notes().warn(document_.where(pointer),
                             fmt::format("unknown wrapping {}; repeat is used (known: 10497 "
                                         "repeat, 33071 clamp, 33648 mirror)",
                                         value));
      return TextureWrap::Repeat;
  }
}

std::optional<std::uint32_t> Textures::image(int index, const std::string& user) {
  const auto known = images_.find(index);
  if (known != images_.end()) return known->second;

  const std::string pointer = fmt::format("/images/{}", index);
  // Images that share their bytes share their pixels: a small file must not fill the memory.
  const auto of_file = decoded_files_.find(image_file(document_, index));
  if (of_file != decoded_files_.end()) return images_.emplace(index, of_file->second).first->second;
  const auto found = image_bytes(document_, accessors_, index, "the texture used by " + user);
  if (!found) return images_.emplace(index, std::nullopt).first->second;
  const auto same = decoded_.find(found->bytes.data());
  if (same != decoded_.end()) return images_.emplace(index, same->second).first->second;
  DecodedTexture decoded = decode_texture(found->bytes, document_.where(pointer));
  constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 29;
  pixels_ += static_cast<std::uint64_t>(decoded.width) * static_cast<std::uint64_t>(decoded.height);
  if (pixels_ > kMaxPixels) {
    throw_input_error(document_.where(pointer), fmt::format("{} pixels in all images", pixels_),
                      fmt::format("at most {}", kMaxPixels));
  }
  const Json& source = document_.json()["images"][at(index)];
  const Json* name = find(&source, "name");
  TextureImage image = keep(std::move(decoded));
  image.name = name != nullptr ? name->get<std::string>() : fmt::format("image {}", index);
  const auto result = static_cast<std::uint32_t>(scene_.images.size());
  scene_.images.push_back(std::move(image));
  images_.emplace(index, result);
  if (found->file.empty()) {
    decoded_.emplace(found->bytes.data(), result);
  } else {
    decoded_files_.emplace(found->file, result);
  }
  return result;
}

TextureImage Textures::keep(DecodedTexture decoded) {
  TextureImage image;
  image.width = decoded.width;
  image.height = decoded.height;
  // Smaller levels take half as much of it (world/texture.h). Of the memory one half is for what
  // stays, one for the pages of what does not.
  const std::uint64_t bytes = decoded.rgba8.size() + 2 * decoded.rgba16.size();
  bytes_ += bytes + bytes / 2;
  if (bytes_ > memory_ / 2 && !store_) store_ = PageStore::open(memory_ / 2);
  const std::shared_ptr<PageStore> store = bytes_ > memory_ / 2 ? store_ : nullptr;
  image.rgba8 = SharedValues<std::uint8_t>(std::move(decoded.rgba8), store);
  image.rgba16 = SharedValues<std::uint16_t>(std::move(decoded.rgba16), store);
  return image;
}

void Textures::check_uris() const {
  const Json* images = find(&document_.json(), "images");
  if (images == nullptr) return;
  for (std::size_t i = 0; i < images->size(); ++i) {
    const Json* uri = find(&(*images)[i], "uri");
    if (uri == nullptr) continue;
    const auto& text = uri->get_ref<const std::string&>();
    if (is_data(text)) continue;
    document_.check_uri(text, fmt::format("/images/{}/uri", i));
  }
}

}  // namespace abbe::gltf
