#include "abbe/load/gltf/document/images.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "abbe/base/error.h"
#include "abbe/load/gltf/document/check.h"

namespace abbe::gltf {
namespace {

// The media type of a data: URI, or nothing.
std::string data_label(const std::string& uri) {
  if (!is_data(uri)) return "";
  return uri.substr(5, uri.find_first_of(";,") - 5);
}

bool is_webp(Bytes bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return text.starts_with("RIFF") &&
         text.substr(std::min<std::size_t>(8, text.size())).starts_with("WEBP");
}

void warn_of_label(Document& document, Bytes bytes, const std::string& label,
                   const std::string& pointer) {
  const bool is_png = bytes.size() > 1 && bytes[0] == 0x89 && bytes[1] == 'P';
  const bool is_jpeg = bytes.size() > 1 && bytes[0] == 0xff && bytes[1] == 0xd8;
  if ((is_png && label == "image/jpeg") || (is_jpeg && label == "image/png")) {
    document.notes().warn(
        document.where(pointer),
        std::string("labelled ") + label + ", but is a " + (is_png ? "PNG" : "JPEG") + " image");
  }
}

}  // namespace

std::filesystem::path image_file(const Document& document, int index) {
  const std::string pointer = fmt::format("/images/{}/uri", index);
  const Json* uri = find(&document.json()["images"][at(index)], "uri");
  if (uri == nullptr) return {};
  const auto& text = uri->get_ref<const std::string&>();
  if (is_data(text) || !document.has_uri(text, pointer)) return {};
  return document.resolve_uri(text, pointer);
}

std::optional<ImageBytes> image_bytes(Document& document, Accessors& accessors, int index,
                                      const std::string& user) {
  const std::string pointer = fmt::format("/images/{}", index);
  const Json& source = document.json()["images"][at(index)];
  const Json* uri = find(&source, "uri");
  const Json* view = find(&source, "bufferView");
  if (uri == nullptr && view == nullptr) {
    throw_input_error(document.where(pointer), "neither uri nor bufferView", "one of them");
  }
  if (uri != nullptr && !document.has_uri(uri->get_ref<const std::string&>(), pointer)) {
    document.fault(pointer + "/uri", "no file " + describe(*uri), "an existing file",
                   user + " is ignored");
    return std::nullopt;
  }
  ImageBytes result{{}, image_file(document, index), {}};
  if (!result.file.empty()) {
    // Once decoded its bytes are not needed again.
    const auto read = document.read_once(result.file, pointer + "/uri");
    result.bytes = *read;
    result.owner = read;
  } else if (uri != nullptr) {
    result.bytes = document.read_uri(uri->get_ref<const std::string&>(), pointer + "/uri");
  } else {
    result.bytes = accessors.view(view->get<int>(), pointer);
  }
  const Bytes bytes = result.bytes;
  const Json* mime = find(&source, "mimeType");
  warn_of_label(document, bytes,
                mime != nullptr  ? mime->get<std::string>()
                : uri != nullptr ? data_label(uri->get_ref<const std::string&>())
                                 : "",
                pointer);
  if (is_webp(bytes) && !uses_extension(document, "EXT_texture_webp")) {
    document.fault(pointer, "a WebP image", "PNG or JPEG, or EXT_texture_webp",
                   "it is read all the same");
  }
  return result;
}

}  // namespace abbe::gltf
