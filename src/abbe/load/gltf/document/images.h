/// The files of images that a document names.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "abbe/load/gltf/document/accessors.h"
#include "abbe/load/gltf/document/document.h"

namespace abbe::gltf {

/// An image as it is in its file.
struct ImageBytes {
  Bytes bytes;
  std::filesystem::path file;         ///< Of its own; empty where it is in a buffer or a data: URI.
  std::shared_ptr<const void> owner;  ///< Of bytes of a file of its own: they end with it.
};

/// The file that is an image's own. Empty where there is none, or it is not there.
std::filesystem::path image_file(const Document& document, int index);

/// The bytes of an image's file, with warnings of wrong labels. Nothing, with a fault, where it is
/// not there: what `user` says is then left out.
/// Errors: input Error with a JSON pointer.
std::optional<ImageBytes> image_bytes(Document& document, Accessors& accessors, int index,
                                      const std::string& user);

}  // namespace abbe::gltf
