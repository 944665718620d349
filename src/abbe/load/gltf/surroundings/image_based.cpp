#include "abbe/load/gltf/surroundings/image_based.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <memory>
#include <optional>
#include <utility>

#include "abbe/base/error.h"
#include "abbe/color/color.h"
#include "abbe/image/raster/raster.h"
#include "abbe/load/cube_map.h"
#include "abbe/load/environment.h"
#include "abbe/load/gltf/document/check.h"
#include "abbe/load/gltf/document/fields.h"
#include "abbe/load/gltf/document/images.h"

namespace abbe::gltf {
namespace {

struct Face {
  int size = 0;
  bool is_hdr = false;
  std::vector<Vec3f> texels;
};

// RGBD: colours of gamma 2.2 divided by alpha, which an image has where it is not 1 everywhere.
// Others are codes of sRGB.
Face read_face(const DecodedTexture& image, const std::string& where) {
  if (image.width != image.height) {
    throw_input_error(where, fmt::format("{}x{} pixels", image.width, image.height), "a square");
  }
  Face face{image.width, false, {}};
  const std::size_t count = static_cast<std::size_t>(image.width) * image.height;
  const auto channel = [&](std::size_t i) {
    return image.rgba8.empty() ? static_cast<float>(image.rgba16[i]) / 65535.0f
                               : static_cast<float>(image.rgba8[i]) / 255.0f;
  };
  for (std::size_t i = 0; i < count && !face.is_hdr; ++i) {
    face.is_hdr = channel(4 * i + 3) < 1.0f;
  }
  face.texels.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const float divisor = channel(4 * i + 3);
    for (std::size_t c = 0; c < 3; ++c) {
      const float code = channel(4 * i + c);
      // Without a divisor nothing can have been there.
      face.texels[i][static_cast<int>(c)] = !face.is_hdr     ? static_cast<float>(srgb_decode(code))
                                            : divisor > 0.0f ? std::pow(code, 2.2f) / divisor
                                                             : 0.0f;
    }
  }
  return face;
}

Mat3d rotation_of(const Fields& light) {
  if (!light.has("rotation")) return Mat3d(1.0);
  const std::vector<double> q = light.numbers("rotation", 4, 4, {-1e6, 1e6});
  const glm::dquat rotation(q[3], q[0], q[1], q[2]);
  if (!(glm::length(rotation) > 1e-6)) {
    throw_input_error(light.where("rotation"), "a quaternion of length 0", "a rotation");
  }
  return glm::mat3_cast(glm::normalize(rotation));
}

}  // namespace

void apply_image_based_light(Document& document, Accessors& accessors, int scene_index,
                             Scene& scene) {
  constexpr const char* kName = "EXT_lights_image_based";
  const Json& json = document.json();
  const Json* use = find_extension(document, "scenes", scene_index, kName);
  if (use == nullptr) return;
  if (scene.environment) {
    document.notes().warn(
        document.where(fmt::format("/scenes/{}/extensions/{}", scene_index, kName)),
        "not used: the environment of ABBE_scene takes its place");
    return;
  }
  const auto index = (*use)["light"].get<std::size_t>();
  const std::string pointer = fmt::format("/extensions/{}/lights/{}", kName, index);
  const Json& source = json["extensions"][kName]["lights"][index];
  const Fields light(document, source, pointer);
  const Json& faces = source["specularImages"][0];
  if (faces.size() != 6) {
    throw_input_error(document.where(pointer + "/specularImages/0"), describe(faces),
                      "six images: +X, -X, +Y, -Y, +Z, -Z");
  }
  CubeMap cube;
  bool is_hdr = false;
  for (std::size_t i = 0; i < 6; ++i) {
    const std::string place = fmt::format("{}/specularImages/0/{}", pointer, i);
    const auto image =
        image_bytes(document, accessors, faces[i].get<int>(), "the environment " + pointer);
    if (!image) return;
    Face face =
        read_face(decode_texture(image->bytes, document.where(place)), document.where(place));
    constexpr int kMaxSize = 4096;  // An equirectangular image of kMaxEnvironmentTexels.
    static_assert(std::int64_t{8} * kMaxSize * kMaxSize <= kMaxEnvironmentTexels);
    if (face.size > kMaxSize || (i > 0 && face.size != cube.size)) {
      throw_input_error(document.where(place), fmt::format("{0}x{0} pixels", face.size),
                        i > 0 ? fmt::format("{0}x{0}, as the first face has", cube.size)
                              : fmt::format("at most {0}x{0}", kMaxSize));
    }
    cube.size = face.size;
    cube.faces[i] = std::move(face.texels);
    is_hdr = is_hdr || face.is_hdr;
  }
  auto environment = std::make_shared<Environment>();
  environment->name = kName;
  if (light.has("name")) environment->name += " \"" + light.required_text("name") + "\"";
  environment->image = equirectangular(cube, rotation_of(light));
  environment->scale = light.number("intensity", 1.0, {0.0, 1e12});
  scene.environment = std::move(environment);
  document.notes().info(
      document.where(pointer),
      fmt::format("the environment is the first level of its specularImages, six faces of {0}x{0} "
                  "{1} pixels as cd/m2; further levels and irradianceCoefficients, which follow "
                  "from it, are not used",
                  cube.size, is_hdr ? "RGBD" : "sRGB"));
}

}  // namespace abbe::gltf
