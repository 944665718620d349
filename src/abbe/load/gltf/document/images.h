/// The files of images that a document names.
#pragma once

#include <optional>
#include <string>

#include "abbe/load/gltf/document/accessors.h"
#include "abbe/load/gltf/document/document.h"

namespace abbe::gltf {

/// The bytes of an image's file, with warnings of wrong labels. Nothing, with a fault, where it is
/// not there: what `user` says is then left out.
/// Errors: input Error with a JSON pointer.
std::optional<Bytes> image_bytes(Document& document, Accessors& accessors, int index,
                                 const std::string& user);

}  // namespace abbe::gltf
