/// Typed arrays out of the buffers of a glTF file, with every size, offset and stride checked.
#pragma once

#include <tiny_gltf.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "abbe/load/gltf/document/document.h"
#include "abbe/math/vec.h"

namespace abbe::gltf {

/// Which component types an attribute may have besides float.
enum class Components {
  FloatOnly,
  FloatOrUnorm,       ///< Also normalized unsigned 8 and 16 bit: texture coordinates and colours.
  FloatOrNormalized,  ///< Also normalized signed ones: animated rotations and weights.
  AnyQuantized,       ///< Also what KHR_mesh_quantization allows: signed and not normalized ones.
};

/// Some of an accessor's elements, by rising index; nothing means all.
using Selection = std::optional<std::vector<std::uint32_t>>;

/// Reads accessors. Buffers are fetched when they are first needed.
class Accessors {
 public:
  explicit Accessors(Document& document);

  /// Elements as floats; integers are normalized where the accessor says so. `selected` are the
  /// elements wanted, rising; all by default.
  /// Errors: input Error at the accessor when the type is another, or data lie outside.
  std::vector<Vec2f> vec2(int accessor, const std::string& user, Components allowed,
                          const Selection& selected = {});
  std::vector<Vec3f> vec3(int accessor, const std::string& user, Components allowed,
                          const Selection& selected = {});
  std::vector<Vec4f> vec4(int accessor, const std::string& user, Components allowed,
                          const Selection& selected = {});
  /// VEC3 or VEC4; a missing fourth component is `alpha`.
  std::vector<Vec4f> color(int accessor, const std::string& user, Components allowed,
                           const Selection& selected = {}, float alpha = 1.0f);
  std::vector<float> scalars(int accessor, const std::string& user, Components allowed);
  /// Indices of joints, as floats, which are exact.
  std::vector<Vec4f> joints(int accessor, const std::string& user, const Selection& selected);
  std::vector<Mat4d> matrices(int accessor, const std::string& user);
  std::vector<std::uint32_t> indices(int accessor, const std::string& user);
  /// The largest value of its unsigned component type.
  std::uint32_t largest_index(int accessor) const;

  std::size_t count(int accessor) const {
    const auto found = supplied_.find(accessor);
    return found == supplied_.end() ? model_.accessors[at(accessor)].count : found->second.count;
  }

  /// Lets dense elements of an accessor's type stand for its own, until forget_supplied().
  void supply(int accessor, std::size_t count, std::vector<std::uint8_t> elements);
  void forget_supplied() { supplied_.clear(); }

  /// Counts bytes decompressed against what files of this size may unfold into.
  /// Errors: input Error when a small file claims to hold enormous arrays.
  void count_decompressed(std::size_t bytes, const std::string& user);

  /// The bytes of a buffer view, decompressed where need be; they live as long as this.
  Bytes view(int buffer_view, const std::string& user);

  /// Counts elements taken into the scene against what a file of this size may unfold into.
  /// Errors: input Error when a small file claims to be an enormous scene.
  void spend(std::size_t elements, const std::string& user);

 private:
  // A checked run of elements; without data it reads as zeros.
  struct Run {
    const std::uint8_t* data = nullptr;
    std::size_t count = 0;
    std::size_t stride = 0;
    int component_type = 0;
    int components = 0;
    bool normalized = false;
  };

  struct Supplied {
    std::size_t count = 0;
    std::vector<std::uint8_t> elements;
  };

  Bytes buffer(int index);
  Bytes part(int buffer, std::uint64_t offset, std::uint64_t length, const std::string& pointer,
             const std::string& user);
  Run run_of(int accessor);
  void check(int accessor, const std::string& user, std::initializer_list<int> types,
             Components allowed) const;
  template <int N>
  std::vector<glm::vec<N, float>> read(int accessor, const Selection& selected, float fill);
  template <int N>
  void apply_sparse(int accessor, const Selection& selected, float fill,
                    std::vector<glm::vec<N, float>>& elements);
  std::vector<std::uint32_t> read_integers(const Run& run) const;
  std::vector<std::uint32_t> sparse_indices(int accessor);
  Run sparse_run(int accessor, int view_index, std::size_t byte_offset, int component_type,
                 int components, const char* part);
  void require_type(int accessor, const std::string& user, std::initializer_list<int> types) const;

  Document& document_;
  const tinygltf::Model& model_;
  std::vector<std::optional<Bytes>> buffers_;
  std::map<int, std::vector<std::uint8_t>> decompressed_;
  std::uint64_t decompressed_bytes_ = 0;
  std::map<int, Supplied> supplied_;
  std::uint64_t spent_ = 0;
};

}  // namespace abbe::gltf
