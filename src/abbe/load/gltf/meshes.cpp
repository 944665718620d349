#include "abbe/load/gltf/meshes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "abbe/base/error.h"
#include "abbe/load/gltf/document/check.h"
#include "abbe/load/gltf/document/compressed.h"
#include "abbe/load/gltf/motion/attributes.h"

namespace abbe::gltf {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

// Adds the triangles of a list, strip or fan. Source: glTF 2.0, 3.7.2.1.
void assemble(std::span<const std::uint32_t> indices, int mode, Triangles& triangles) {
  const std::size_t n = indices.size();
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    triangles.reserve(triangles.size() + n / 3);
    for (std::size_t i = 0; i + 2 < n; i += 3) {
      triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
    }
    return;
  }
  for (std::size_t i = 0; i + 2 < n; ++i) {
    if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
      triangles.push_back({indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]});
    } else {
      triangles.push_back({indices[i + 1], indices[i + 2], indices[0]});
    }
  }
}

// Where many primitives share large arrays, each takes only the vertices it uses, and its indices
// are renumbered to them.
Selection select(std::vector<std::uint32_t>& indices, std::size_t vertex_count) {
  if (indices.size() >= vertex_count / 2) return std::nullopt;
  std::vector<std::uint32_t> used = indices;
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  for (std::uint32_t& index : indices) {
    index = static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), index) -
                                       used.begin());
  }
  return used;
}

const char* mode_name(int mode) {
  switch (mode) {
    case TINYGLTF_MODE_POINTS:
      return "points";
    case TINYGLTF_MODE_LINE:
    case TINYGLTF_MODE_LINE_LOOP:
    case TINYGLTF_MODE_LINE_STRIP:
      return "lines";
    default:
      return "triangles";
  }
}

std::size_t corner_count(const Accessors& accessors, const tinygltf::Primitive& source) {
  if (source.indices >= 0) return accessors.count(source.indices);
  const auto position = source.attributes.find("POSITION");
  return position == source.attributes.end() ? 0 : accessors.count(position->second);
}

// Of points and lines. Source: glTF 2.0, 3.7.2.1.
std::size_t element_count(int mode, std::size_t corners) {
  switch (mode) {
    case TINYGLTF_MODE_LINE:
      return corners / 2;
    case TINYGLTF_MODE_LINE_STRIP:
      return corners < 2 ? 0 : corners - 1;
    default:
      return corners;
  }
}

void check_range(Document& document, const tinygltf::Accessor& accessor, int index,
                 const std::vector<Vec3f>& positions) {
  if (accessor.minValues.size() != 3 || accessor.maxValues.size() != 3) return;
  for (int c = 0; c < 3; ++c) {
    const auto axis = static_cast<std::size_t>(c);
    const double low = accessor.minValues[axis];
    const double high = accessor.maxValues[axis];
    // Writers print a few digits only.
    const double slack = 1e-3 * std::max({std::abs(low), std::abs(high), high - low, 1e-6});
    double seen_low = std::numeric_limits<double>::infinity();
    double seen_high = -seen_low;
    for (const Vec3f& p : positions) {
      if (!std::isfinite(p[c])) return;  // Said elsewhere.
      seen_low = std::min(seen_low, static_cast<double>(p[c]));
      seen_high = std::max(seen_high, static_cast<double>(p[c]));
    }
    if (std::abs(seen_low - low) > slack || std::abs(seen_high - high) > slack) {
      document.notes().warn(document.where(fmt::format("/accessors/{}", index)),
                            fmt::format("min and max say {} to {} on axis {}, the data {} to {}",
                                        low, high, "xyz"[c], seen_low, seen_high));
      return;
    }
  }
}

/// The corners of a primitive's triangles, and which of its vertices they use where it says.
struct Corners {
  std::vector<std::uint32_t> indices;
  Selection selected;
  /// Where a strip, fan or triangle begins anew: places in `indices`, rising.
  std::vector<std::size_t> restarts = {};
};

// The largest value of its type, which glTF forbids as an index, ends what was begun: graphics
// libraries of viewers do so, whatever the number of vertices.
void take_restarts(Document& document, std::uint32_t restart, const std::string& pointer,
                   Corners& corners) {
  std::size_t kept = 0;
  for (const std::uint32_t index : corners.indices) {
    if (index == restart) {
      corners.restarts.push_back(kept);
    } else {
      corners.indices[kept++] = index;
    }
  }
  corners.indices.resize(kept);
  if (corners.restarts.empty()) return;
  document.fault(
      pointer + "/indices",
      fmt::format("{} times {}, the largest of its type", corners.restarts.size(), restart),
      "indices below", "a strip, fan or triangle begins anew there");
}

Triangles assemble(const Corners& corners, int mode) {
  Triangles triangles;
  const std::span<const std::uint32_t> indices(corners.indices);
  std::size_t begin = 0;
  for (const std::size_t end : corners.restarts) {
    assemble(indices.subspan(begin, end - begin), mode, triangles);
    begin = end;
  }
  assemble(indices.subspan(begin), mode, triangles);
  return triangles;
}

// `decoded` are those of a compressed primitive, if it is one.
Corners read_corners(Document& document, Accessors& accessors, const tinygltf::Primitive& source,
                     std::optional<std::vector<std::uint32_t>> decoded, std::size_t vertex_count,
                     const std::string& pointer) {
  if (vertex_count > std::numeric_limits<std::uint32_t>::max()) {
    throw_input_error(document.where(pointer), fmt::format("{} vertices", vertex_count),
                      "at most 2^32 - 1");
  }
  Corners corners;
  std::vector<std::uint32_t>& indices = corners.indices;
  if (decoded) {
    accessors.spend(decoded->size(), pointer);
    indices = std::move(*decoded);
    corners.selected = select(indices, vertex_count);
  } else if (source.indices >= 0) {
    accessors.spend(accessors.count(source.indices), pointer);
    indices = accessors.indices(source.indices, pointer + "/indices");
    take_restarts(document, accessors.largest_index(source.indices), pointer, corners);
    for (std::size_t i = 0; i < indices.size(); ++i) {
      if (indices[i] >= vertex_count) {
        throw_input_error(document.where(pointer + "/indices"),
                          fmt::format("index {} at place {}", indices[i], i),
                          fmt::format("below the number of vertices, {}", vertex_count));
      }
    }
    corners.selected = select(indices, vertex_count);
  }
  accessors.spend(corners.selected ? corners.selected->size() : vertex_count, pointer);
  if (!decoded && source.indices < 0) {
    indices.resize(vertex_count);
    std::iota(indices.begin(), indices.end(), 0u);
  }
  return corners;
}

void read_attributes(Document& document, Accessors& accessors, const tinygltf::Primitive& source,
                     const Selection& selected, const std::string& pointer, Mesh& mesh) {
  const bool is_quantized = uses_extension(document, "KHR_mesh_quantization");
  const Components exact = is_quantized ? Components::AnyQuantized : Components::FloatOnly;
  const Components unorm = is_quantized ? Components::AnyQuantized : Components::FloatOrUnorm;

  const std::size_t vertex_count = accessors.count(source.attributes.at("POSITION"));
  for (const auto& [name, accessor] : source.attributes) {
    const std::string user = pointer + "/attributes/" + name;
    const bool is_known = name == "POSITION" || name == "NORMAL" || name == "TANGENT" ||
                          name == "TEXCOORD_0" || name == "TEXCOORD_1" || name == "COLOR_0";
    if (!is_known) continue;
    if (accessors.count(accessor) == 0) {
      document.fault(fmt::format("/accessors/{}/count", accessor), "0", "at least 1",
                     user + " is ignored");
      continue;
    }
    if (accessors.count(accessor) != vertex_count) {
      throw_input_error(document.where(user), fmt::format("{} elements", accessors.count(accessor)),
                        fmt::format("as many as POSITION has, {}", vertex_count));
    }
    if (name == "POSITION") {
      mesh.positions = accessors.vec3(accessor, user, exact, selected);
      if (selected) continue;
      check_range(document, document.model().accessors[at(accessor)], accessor, mesh.positions);
    } else if (name == "NORMAL") {
      mesh.normals = accessors.vec3(accessor, user, exact, selected);
    } else if (name == "TANGENT") {
      mesh.tangents = accessors.vec4(accessor, user, exact, selected);
    } else if (name == "COLOR_0") {
      mesh.colors_rec709 = accessors.color(accessor, user, unorm, selected);
    } else {
      mesh.uv[name == "TEXCOORD_0" ? 0 : 1] = accessors.vec2(accessor, user, unorm, selected);
    }
  }
}

void move_vertices(Document& document, Accessors& accessors, const tinygltf::Primitive& source,
                   const Deformation& deformation, const Selection& selected,
                   const std::string& pointer, Mesh& mesh) {
  mesh.morph_targets = static_cast<std::uint32_t>(source.targets.size());
  const auto targets =
      read_morph_targets(document, accessors, source, deformation.weights, selected, pointer);
  std::vector<JointSet> joints;
  static const std::vector<Mat4d> kNone;
  const std::vector<Mat4d>& matrices =
      deformation.skin == nullptr ? kNone : deformation.skin->joint_matrices;
  if (deformation.skin != nullptr && has_joints(source)) {
    mesh.joints = static_cast<std::uint32_t>(matrices.size());
    joints = read_joints(document, accessors, source, matrices.size(), selected, pointer);
  }
  deform(mesh, targets, joints, matrices);
}

// A primitive that has triangles and POSITION; `decoded` are its corners where it was compressed.
std::optional<Mesh> read_triangles(Document& document, Accessors& accessors, int mesh_index,
                                   std::size_t primitive, const Deformation& deformation,
                                   std::optional<std::vector<std::uint32_t>> decoded) {
  const tinygltf::Mesh& source_mesh = document.model().meshes[at(mesh_index)];
  const tinygltf::Primitive& source = source_mesh.primitives[primitive];
  const std::string pointer = fmt::format("/meshes/{}/primitives/{}", mesh_index, primitive);
  const std::string place = document.where(pointer);
  Notes& notes = document.notes();
  // A strip, too, is compressed as a list.
  const int mode = decoded ? TINYGLTF_MODE_TRIANGLES : source.mode;

  const int positions = source.attributes.at("POSITION");
  for (const int used : {positions, decoded ? -1 : source.indices}) {
    if (used < 0 || accessors.count(used) > 0) continue;
    document.fault(fmt::format("/accessors/{}/count", used), "0", "at least 1",
                   pointer + " is not rendered");
    return std::nullopt;
  }
  const Corners corners = read_corners(document, accessors, source, std::move(decoded),
                                       accessors.count(positions), pointer);

  Mesh mesh;
  mesh.name = source_mesh.name.empty() ? fmt::format("mesh {}", mesh_index) : source_mesh.name;
  if (source_mesh.primitives.size() > 1) mesh.name += fmt::format(" [{}]", primitive);
  mesh.material = source.material < 0 ? 0 : static_cast<std::uint32_t>(source.material);

  read_attributes(document, accessors, source, corners.selected, pointer, mesh);

  const std::size_t count = corners.indices.size();
  if (mode == TINYGLTF_MODE_TRIANGLES && corners.restarts.empty() && count % 3 != 0) {
    notes.warn(place, fmt::format("{} corners are no multiple of 3; the last {} are ignored", count,
                                  count % 3));
  }
  mesh.triangles = assemble(corners, mode);
  move_vertices(document, accessors, source, deformation, corners.selected, pointer, mesh);
  clean(mesh, place, notes);
  if (mesh.triangles.empty()) {
    notes.warn(place, "no triangle is left; not rendered");
    return std::nullopt;
  }
  return mesh;
}

}  // namespace

std::optional<Mesh> read_primitive(Document& document, Accessors& accessors, int mesh,
                                   std::size_t primitive, const Deformation& deformation) {
  const tinygltf::Primitive& source = document.model().meshes[at(mesh)].primitives[primitive];
  const std::string place =
      document.where(fmt::format("/meshes/{}/primitives/{}", mesh, primitive));
  const int mode = source.mode;
  if (std::string(mode_name(mode)) != "triangles") {
    document.notes().warn(
        place, fmt::format("{} {} are not rendered",
                           element_count(mode, corner_count(accessors, source)), mode_name(mode)));
    return std::nullopt;
  }
  if (!source.attributes.contains("POSITION")) {
    document.notes().warn(place, "no POSITION; not rendered");
    return std::nullopt;
  }
  auto decoded = decode_primitive(document, accessors, mesh, primitive);
  auto result =
      read_triangles(document, accessors, mesh, primitive, deformation, std::move(decoded));
  accessors.forget_supplied();  // It was this primitive's alone.
  return result;
}

bool append_alike(const Mesh& mesh, Mesh& whole) {
  const auto both = [](const auto& a, const auto& b) { return a.empty() == b.empty(); };
  if (mesh.material != whole.material || mesh.joints != whole.joints ||
      !both(mesh.normals, whole.normals) || !both(mesh.tangents, whole.tangents) ||
      !both(mesh.uv[0], whole.uv[0]) || !both(mesh.uv[1], whole.uv[1]) ||
      !both(mesh.colors_rec709, whole.colors_rec709)) {
    return false;
  }
  const auto first = static_cast<std::uint32_t>(whole.positions.size());
  const auto add = [](const auto& from, auto& to) {
    to.insert(to.end(), from.begin(), from.end());
  };
  add(mesh.positions, whole.positions);
  add(mesh.normals, whole.normals);
  add(mesh.tangents, whole.tangents);
  for (int set = 0; set < 2; ++set) add(mesh.uv[set], whole.uv[set]);
  add(mesh.colors_rec709, whole.colors_rec709);
  for (std::array<std::uint32_t, 3> triangle : mesh.triangles) {
    for (std::uint32_t& corner : triangle) corner += first;
    whole.triangles.push_back(triangle);
  }
  return true;
}

}  // namespace abbe::gltf
