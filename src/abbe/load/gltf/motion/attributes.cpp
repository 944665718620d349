#include "abbe/load/gltf/motion/attributes.h"

#include <fmt/format.h>

#include "abbe/base/error.h"
#include "abbe/load/gltf/document/check.h"

namespace abbe::gltf {
namespace {

void check_count(Document& document, Accessors& accessors, const tinygltf::Primitive& source,
                 int accessor, const std::string& user) {
  const std::size_t vertices = accessors.count(source.attributes.at("POSITION"));
  if (accessors.count(accessor) == vertices) return;
  throw_input_error(document.where(user), fmt::format("{} elements", accessors.count(accessor)),
                    fmt::format("as many as POSITION has, {}", vertices));
}

}  // namespace

std::vector<MorphTarget> read_morph_targets(Document& document, Accessors& accessors,
                                            const tinygltf::Primitive& source,
                                            const std::vector<double>& weights,
                                            const Selection& selected, const std::string& pointer) {
  const Components exact = uses_extension(document, "KHR_mesh_quantization")
                               ? Components::AnyQuantized
                               : Components::FloatOnly;
  std::vector<MorphTarget> targets;
  for (std::size_t t = 0; t < std::min(source.targets.size(), weights.size()); ++t) {
    if (weights[t] == 0.0) continue;
    MorphTarget target;
    target.weight = weights[t];
    for (const auto& [name, accessor] : source.targets[t]) {
      const std::string user = fmt::format("{}/targets/{}/{}", pointer, t, name);
      const bool is_known = name == "POSITION" || name == "NORMAL" || name == "TANGENT" ||
                            name == "TEXCOORD_0" || name == "TEXCOORD_1" || name == "COLOR_0";
      if (!is_known) continue;
      check_count(document, accessors, source, accessor, user);
      accessors.spend(selected ? selected->size() : accessors.count(accessor), user);
      if (name == "POSITION") {
        target.positions = accessors.vec3(accessor, user, exact, selected);
      } else if (name == "NORMAL") {
        target.normals = accessors.vec3(accessor, user, exact, selected);
      } else if (name == "TANGENT") {
        target.tangents = accessors.vec3(accessor, user, exact, selected);
      } else if (name == "COLOR_0") {
        target.colors =
            accessors.color(accessor, user, Components::FloatOrNormalized, selected, 0.0f);
      } else {
        target.uv[name == "TEXCOORD_0" ? 0 : 1] =
            accessors.vec2(accessor, user, Components::FloatOrNormalized, selected);
      }
    }
    targets.push_back(std::move(target));
  }
  return targets;
}

bool has_joints(const tinygltf::Primitive& source) {
  return source.attributes.contains("JOINTS_0") && source.attributes.contains("WEIGHTS_0");
}

std::vector<JointSet> read_joints(Document& document, Accessors& accessors,
                                  const tinygltf::Primitive& source, std::size_t joint_count,
                                  const Selection& selected, const std::string& pointer) {
  std::vector<JointSet> sets;
  for (int n = 0;; ++n) {
    const auto joints = source.attributes.find(fmt::format("JOINTS_{}", n));
    const auto weights = source.attributes.find(fmt::format("WEIGHTS_{}", n));
    if (joints == source.attributes.end() || weights == source.attributes.end()) break;
    const std::string user = fmt::format("{}/attributes/JOINTS_{}", pointer, n);
    const std::string of_weights = fmt::format("{}/attributes/WEIGHTS_{}", pointer, n);
    check_count(document, accessors, source, joints->second, user);
    check_count(document, accessors, source, weights->second, of_weights);
    accessors.spend(2 * (selected ? selected->size() : accessors.count(joints->second)), user);
    sets.push_back(
        {accessors.joints(joints->second, user, selected),
         accessors.vec4(weights->second, of_weights, Components::FloatOrUnorm, selected)});
  }
  const JointFaults faults = repair_weights(sets);
  const std::string of_weights = pointer + "/attributes/WEIGHTS_0";
  if (faults.sums > 0) {
    document.fault(of_weights,
                   fmt::format("{} vertices whose weights do not add up to 1", faults.sums),
                   "sums of 1", "they are made to");
  }
  if (faults.weights > 0) {
    document.fault(
        of_weights,
        fmt::format("{} vertices with a weight that is negative or not finite", faults.weights),
        "weights from 0 to 1", "it counts as 0");
  }
  for (std::size_t n = 0; n < sets.size(); ++n) {
    for (std::size_t i = 0; i < sets[n].joints.size(); ++i) {
      for (int k = 0; k < 4; ++k) {
        const auto joint = static_cast<std::size_t>(sets[n].joints[i][k]);
        if (joint < joint_count) continue;
        // Writers leave anything where the weight is 0.
        if (sets[n].weights[i][k] == 0.0f) continue;
        throw_input_error(document.where(fmt::format("{}/attributes/JOINTS_{}", pointer, n)),
                          fmt::format("joint {} at place {}", joint, i),
                          fmt::format("below the number of the skin's joints, {}", joint_count));
      }
    }
  }
  return sets;
}

}  // namespace abbe::gltf
