/// Textures, samplers and images of a glTF file.
#pragma once

#include <tiny_gltf.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "abbe/base/paged.h"
#include "abbe/image/raster/raster.h"
#include "abbe/load/gltf/document/accessors.h"
#include "abbe/load/gltf/document/document.h"
#include "abbe/load/gltf/document/fields.h"
#include "abbe/scene/scene.h"

namespace abbe::gltf {

/// Makes the scene's textures and images, each when a material first uses it.
class Textures {
 public:
  /// All of these outlive this. `memory`: about how many bytes of memory textures may take.
  Textures(Document& document, Accessors& accessors, std::uint64_t memory, Scene& scene)
      : document_(document),
        model_(document.model()),
        accessors_(accessors),
        memory_(memory),
        scene_(scene) {}

  /// The use that a member, a texture info object, describes, KHR_texture_transform included.
  /// Nothing where it is absent, or, with a note, when the texture has no image or wants a third
  /// set of texture coordinates. Errors: input Error with a JSON pointer; a broken image is one.
  std::optional<TextureUse> use(const Fields& fields, const char* name);

  /// Checks that every URI of an image stays inside the folder, used or not.
  void check_uris() const;

 private:
  std::optional<std::uint32_t> texture(int index, const std::string& pointer);
  /// The image of a texture, by glTF's source or that of an extension.
  std::optional<std::uint32_t> image_of(int texture, const std::string& user);
  /// Nothing, with a fault, where the image is not there.
  std::optional<std::uint32_t> image(int index, const std::string& user);
  /// Takes the pixels, into memory as long as there is some for them.
  TextureImage keep(DecodedTexture decoded);
  TextureWrap wrap(int value, const std::string& pointer);

  Document& document_;
  const tinygltf::Model& model_;
  Accessors& accessors_;
  std::uint64_t memory_;
  Scene& scene_;
  std::uint64_t bytes_ = 0;
  std::shared_ptr<PageStore> store_;
  std::map<int, std::optional<std::uint32_t>> textures_;
  std::map<int, std::optional<std::uint32_t>> images_;
  std::map<const std::uint8_t*, std::uint32_t> decoded_;  // By where the bytes of a file lie.
  std::map<std::filesystem::path, std::uint32_t> decoded_files_;
  std::uint64_t pixels_ = 0;
};

}  // namespace abbe::gltf
