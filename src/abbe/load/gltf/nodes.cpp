#include "abbe/load/gltf/nodes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/base/error.h"

namespace abbe::gltf {
namespace {

std::size_t at(int index) {
  return static_cast<std::size_t>(index);
}

Mat4d from_matrix(const std::vector<double>& m, const std::string& where, Notes& notes) {
  Mat4d result;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) {
      result[column][row] = m[static_cast<std::size_t>(column * 4 + row)];
    }
  }
  const Vec4d last_row(m[3], m[7], m[11], m[15]);
  if (last_row != Vec4d(0.0, 0.0, 0.0, 1.0)) {
    notes.warn(where, fmt::format("last row {:g} {:g} {:g} {:g}; glTF has affine transforms only, "
                                  "0 0 0 1 is used",
                                  m[3], m[7], m[11], m[15]));
    for (int column = 0; column < 3; ++column) result[column][3] = 0.0;
    result[3][3] = 1.0;
  }
  for (int c = 0; c < 3; ++c) {
    const Vec3d a(result[c]);
    const Vec3d b(result[(c + 1) % 3]);
    constexpr double kRounding = 1e-3;  // Writers print a few digits only.
    if (std::abs(glm::dot(a, b)) > kRounding * glm::length(a) * glm::length(b)) {
      notes.warn(where, "a shear, which glTF does not allow; rendered as it stands");
      break;
    }
  }
  return result;
}

Mat4d from_trs(const tinygltf::Node& node, const std::string& where, Notes& notes) {
  Mat4d result(1.0);
  if (node.rotation.size() == 4) {
    double x = node.rotation[0], y = node.rotation[1], z = node.rotation[2], w = node.rotation[3];
    const double length = std::sqrt(x * x + y * y + z * z + w * w);
    if (!(length > 1e-100) || !std::isfinite(length)) {
      notes.warn(where, "a rotation of length 0; no rotation is used");
    } else {
      x /= length, y /= length, z /= length, w /= length;
      result[0] = Vec4d(1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y), 0);
      result[1] = Vec4d(2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x), 0);
      result[2] = Vec4d(2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y), 0);
    }
  }
  if (node.scale.size() == 3) {
    for (int c = 0; c < 3; ++c) result[c] *= node.scale[at(c)];
  }
  if (node.translation.size() == 3) {
    result[3] = Vec4d(node.translation[0], node.translation[1], node.translation[2], 1.0);
  }
  return result;
}

bool is_finite(const Mat4d& m) {
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) {
      if (!std::isfinite(m[column][row])) return false;
    }
  }
  return true;
}

}  // namespace

void check_graph(const Document& document, const tinygltf::Model& model) {
  constexpr int kNone = -1;
  std::vector<int> parents(model.nodes.size(), kNone);
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    const auto& children = model.nodes[i].children;
    for (std::size_t c = 0; c < children.size(); ++c) {
      int& parent = parents[at(children[c])];
      if (parent != kNone) {
        throw_input_error(document.where(fmt::format("/nodes/{}/children/{}", i, c)),
                          fmt::format("node {}, already a child of node {}", children[c], parent),
                          "one parent for each node");
      }
      parent = static_cast<int>(i);
    }
  }
  // With one parent each, what cannot be reached from a root goes round in a cycle.
  std::vector<int> stack;
  std::vector<bool> reached(model.nodes.size(), false);
  for (std::size_t i = 0; i < parents.size(); ++i) {
    if (parents[i] == kNone) stack.push_back(static_cast<int>(i));
  }
  while (!stack.empty()) {
    const int node = stack.back();
    stack.pop_back();
    reached[at(node)] = true;
    const auto& children = model.nodes[at(node)].children;
    stack.insert(stack.end(), children.begin(), children.end());
  }
  const auto lost = std::find(reached.begin(), reached.end(), false);
  if (lost != reached.end()) {
    throw_input_error(document.where(fmt::format("/nodes/{}", lost - reached.begin())),
                      "a node that is its own ancestor", "a tree");
  }
}

std::vector<int> scene_roots(Document& document, const tinygltf::Model& model, int scene) {
  const std::vector<int>& listed = model.scenes[at(scene)].nodes;
  std::vector<int> parents(model.nodes.size(), -1);
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    for (const int child : model.nodes[i].children) parents[at(child)] = static_cast<int>(i);
  }
  std::vector<bool> is_listed(model.nodes.size(), false);
  std::vector<int> roots;
  for (std::size_t i = 0; i < listed.size(); ++i) {
    const int node = listed[i];
    const std::string pointer = fmt::format("/scenes/{}/nodes/{}", scene, i);
    if (is_listed[at(node)]) {
      document.fault(pointer, fmt::format("node {} again", node), "each root once",
                     "it is taken once");
      continue;
    }
    is_listed[at(node)] = true;
    roots.push_back(node);
  }
  // Below another root it is met in its place; otherwise its parents are in no scene.
  const auto is_below_a_root = [&](int node) {
    for (int p = parents[at(node)]; p != -1; p = parents[at(p)]) {
      if (is_listed[at(p)]) return true;
    }
    return false;
  };
  std::erase_if(roots, [&](int node) {
    if (parents[at(node)] == -1) return false;
    const bool is_below = is_below_a_root(node);
    document.fault(fmt::format("/scenes/{}/nodes", scene),
                   fmt::format("node {}, a child of node {}", node, parents[at(node)]),
                   "nodes without a parent",
                   is_below ? "it stands where its parent has it" : "it stands without its parent");
    return is_below;
  });
  return roots;
}

void visit_nodes(Document& document, const tinygltf::Model& model, const std::vector<int>& roots,
                 const std::function<void(const PlacedNode&)>& visit) {
  struct Pending {
    int index;
    Mat4d parent_to_world;
  };
  std::vector<Pending> stack;
  for (auto root = roots.rbegin(); root != roots.rend(); ++root) {
    stack.push_back({*root, Mat4d(1.0)});
  }
  while (!stack.empty()) {
    const Pending pending = stack.back();
    stack.pop_back();
    const tinygltf::Node& node = model.nodes[at(pending.index)];
    const std::string where = document.where(fmt::format("/nodes/{}", pending.index));
    const Mat4d local = node.matrix.size() == 16
                            ? from_matrix(node.matrix, where + "/matrix", document.notes())
                            : from_trs(node, where + "/rotation", document.notes());
    PlacedNode placed{pending.index,
                      node.name.empty() ? fmt::format("node {}", pending.index) : node.name,
                      pending.parent_to_world * local};
    if (!is_finite(placed.to_world)) {
      throw_input_error(where, "a transform beyond the range of numbers", "finite transforms");
    }
    visit(placed);
    for (auto child = node.children.rbegin(); child != node.children.rend(); ++child) {
      stack.push_back({*child, placed.to_world});
    }
  }
}

Mat4d rigid(const Mat4d& to_world) {
  const auto unit_or = [](const Vec3d& v, const Vec3d& otherwise) {
    // Scaled first: the squares of very short and very long vectors leave the range of numbers.
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    return largest > 0.0 ? glm::normalize(v / largest) : otherwise;
  };
  const Vec3d z = unit_or(Vec3d(to_world[2]), Vec3d(0.0, 0.0, 1.0));
  const Vec3d up = unit_or(Vec3d(to_world[1]), Vec3d(0.0, 1.0, 0.0));
  Vec3d x = glm::cross(up, z);
  if (glm::length(x) < 1e-12) {
    x = glm::cross(std::abs(z.y) < 0.9 ? Vec3d(0.0, 1.0, 0.0) : Vec3d(1.0, 0.0, 0.0), z);
  }
  x = glm::normalize(x);
  return {Vec4d(x, 0.0), Vec4d(glm::cross(z, x), 0.0), Vec4d(z, 0.0), to_world[3]};
}

}  // namespace abbe::gltf
