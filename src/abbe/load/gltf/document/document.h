/// The outer layers of a glTF file: container, JSON text, what it says, and the other files it
/// names. Everything hostile is stopped here or in check.h, before tinygltf sees the document.
#pragma once

#include <tiny_gltf.h>

#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/base/error.h"
#include "abbe/base/notes.h"

namespace abbe::gltf {

using Json = nlohmann::json;
using Bytes = std::span<const std::uint8_t>;

/// An index, as tinygltf has it, as a place in an array.
constexpr std::size_t at(int index) {
  return static_cast<std::size_t>(index);
}

/// Largest file read, the scene's own or one that it names.
inline constexpr std::uint64_t kMaxFileBytes = std::uint64_t{4} << 30;

/// A glTF file taken apart: what it says, its binary chunk, and the bytes of all files read.
class Document {
 public:
  /// Reads a .gltf or .glb; the content decides which it is.
  /// With `strict` every fault() is an error.
  /// Errors: input Error when missing, not a regular file, too large, no glTF, nested too deep.
  Document(const std::filesystem::path& file, Notes& notes, bool strict = false);

  /// All of its JSON, until read_model() takes the core out.
  const Json& json() const { return json_; }
  Json& json() { return json_; }
  /// glTF's core as tinygltf reads it, but for buffers, images, materials and cameras.
  const tinygltf::Model& model() const { return model_; }
  /// Has tinygltf read the arrays of the core, which checks have passed: model() has them then, and
  /// of their elements (and of primitives) json() only the extensions.
  /// Errors: input Error for what tinygltf refuses.
  void read_model();

  /// The BIN chunk of a .glb, if it has one.
  std::optional<Bytes> binary_chunk() const { return binary_chunk_; }

  /// Place for messages: the file and a JSON pointer.
  std::string where(const std::string& pointer) const {
    return pointer.empty() ? file_name_ : file_name_ + ": " + pointer;
  }
  const std::string& file_name() const { return file_name_; }

  /// A file that the document names, inside its folder. `uri` may be percent-encoded.
  /// Errors: input Error when it leaves the folder, has a scheme, is broken or missing.
  std::filesystem::path resolve_uri(const std::string& uri, const std::string& pointer) const;
  /// The same for a plain relative path, taken literally.
  std::filesystem::path resolve_path(const std::string& path, const std::string& pointer) const;

  /// The part of resolve_uri that needs no file: for URIs that are named but not used.
  void check_uri(const std::string& uri, const std::string& pointer) const;

  /// Whether a URI is data: or names a file that is there. Errors: as resolve_uri, but for missing.
  bool has_uri(const std::string& uri, const std::string& pointer) const;

  /// The bytes behind a URI, data: or a file; they live as long as the document.
  Bytes read_uri(const std::string& uri, const std::string& pointer);
  /// The bytes of a file returned by resolve_uri or resolve_path.
  Bytes read_resolved(const std::filesystem::path& file, const std::string& pointer);

  /// The same, not kept: they are read anew when they are asked for again, and count only once.
  std::shared_ptr<const std::vector<std::uint8_t>> read_once(const std::filesystem::path& file,
                                                             const std::string& pointer);

  /// Bytes of all files read so far.
  std::uint64_t bytes_read() const { return bytes_read_; }
  /// Hash over them, 16 hex digits.
  std::string content_hash() const;

  Notes& notes() { return notes_; }

  /// Something that breaks a rule and that viewers put up with: a warning that ends with what is
  /// made of it ("it is not rendered"). Errors: an input Error of a strict document.
  void fault(const std::string& pointer, const std::string& found, const std::string& expected,
             const std::string& consequence);
  /// The first fault as an Error, if there was one: of a file of which nothing is left.
  const std::optional<Error>& first_fault() const { return first_fault_; }

 private:
  void count(Bytes bytes);
  Bytes keep(std::vector<std::uint8_t> bytes);
  Bytes split_glb(Bytes file);
  std::filesystem::path checked_relative(const std::string& path, const std::string& pointer) const;
  std::string decoded_uri(const std::string& uri, const std::string& pointer) const;
  bool is_inside(const std::filesystem::path& candidate) const;

  std::string file_name_;
  std::filesystem::path folder_;
  std::deque<std::vector<std::uint8_t>> kept_;
  std::map<std::filesystem::path, Bytes> files_;
  std::set<std::filesystem::path> read_once_;
  std::optional<Bytes> binary_chunk_;
  Json json_;
  tinygltf::Model model_;
  std::uint64_t bytes_read_ = 0;
  std::uint64_t hash_ = 0xcbf29ce484222325ull;
  Notes& notes_;
  bool is_strict_;
  std::optional<Error> first_fault_;
};

/// Whether a URI holds its data itself. Schemes have no case.
bool is_data(const std::string& uri);

/// Decodes %XX. Errors: input Error at `where` for a broken escape or an encoded NUL.
std::string percent_decoded(const std::string& text, const std::string& where);

/// Decodes the part after `base64,`. Errors: input Error at `where`.
std::vector<std::uint8_t> base64_decoded(std::string_view text, const std::string& where);

/// How many brackets of a JSON text are open at once at most; strings are skipped.
std::size_t nesting_depth(std::string_view json);

}  // namespace abbe::gltf
