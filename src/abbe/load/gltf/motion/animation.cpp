#include "abbe/load/gltf/motion/animation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "abbe/base/error.h"
#include "abbe/base/text.h"
#include "abbe/load/gltf/motion/curve.h"

namespace abbe::gltf {
namespace {

std::string name_of(const tinygltf::Animation& animation, std::size_t number) {
  return animation.name.empty() ? fmt::format("animation {}", number) : animation.name;
}

// Animations by their numbers, first to last.
std::vector<std::size_t> chosen_animations(const Document& document, const std::string& choice) {
  const auto& animations = document.model().animations;
  std::vector<std::size_t> all;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < animations.size(); ++i) {
    all.push_back(i);
    names.push_back(name_of(animations[i], i));
    if (names.back() == choice) return {i};
  }
  if (choice.empty()) return all;
  if (const auto number = whole_u32_of(choice); number && *number < animations.size()) {
    return {*number};
  }
  throw_usage_error("animation", in_quotes(choice), "an animation of " + document.file_name(),
                    names);
}

/// Reads curves; times that many samplers share are read once.
class Curves {
 public:
  Curves(Document& document, Accessors& accessors) : document_(document), accessors_(accessors) {}

  const std::vector<float>& times(int accessor, const std::string& user) {
    accessors_.spend(accessors_.count(accessor), user);  // They are looked at for each curve.
    auto known = times_.find(accessor);
    if (known == times_.end()) {
      known =
          times_.emplace(accessor, accessors_.scalars(accessor, user, Components::FloatOnly)).first;
    }
    return known->second;
  }

  /// The curve of a sampler for a property of so many numbers; nothing after a fault.
  std::optional<Curve> read(const tinygltf::AnimationSampler& sampler, const std::string& pointer,
                            const std::string& path, std::size_t width) {
    Curve curve;
    curve.width = width;
    curve.is_rotation = path == "rotation";
    const std::string& interpolation = sampler.interpolation;
    if (interpolation == "STEP") {
      curve.interpolation = Interpolation::Step;
    } else if (interpolation == "CUBICSPLINE") {
      curve.interpolation = Interpolation::CubicSpline;
    } else if (interpolation != "LINEAR") {
      document_.fault(pointer + "/interpolation", in_quotes(interpolation),
                      "LINEAR, STEP or CUBICSPLINE", "LINEAR is used");
    }
    curve.times_s = times(sampler.input, pointer + "/input");
    curve.values = values(sampler.output, pointer + "/output", path);
    if (!are_times(curve.times_s, pointer)) return std::nullopt;
    if (!std::all_of(curve.values.begin(), curve.values.end(),
                     [](float value) { return std::isfinite(value); })) {
      document_.fault(pointer + "/output", "a value that is not finite", "finite values",
                      "it moves nothing");
      return std::nullopt;
    }
    const bool is_spline = curve.interpolation == Interpolation::CubicSpline;
    const std::size_t expected = (is_spline ? 3 : 1) * width * curve.times_s.size();
    if (curve.values.size() != expected) {
      document_.fault(pointer + "/output", fmt::format("{} numbers", curve.values.size()),
                      fmt::format("{} for {} keys{}", expected, curve.times_s.size(),
                                  is_spline ? " with their tangents" : ""),
                      "it moves nothing");
      return std::nullopt;
    }
    return curve;
  }

 private:
  bool are_times(const std::vector<float>& times_s, const std::string& pointer) {
    const bool rise = std::is_sorted(times_s.begin(), times_s.end()) && !times_s.empty() &&
                      std::all_of(times_s.begin(), times_s.end(),
                                  [](float time_s) { return std::isfinite(time_s); });
    if (!rise) {
      document_.fault(pointer + "/input",
                      times_s.empty() ? "no key" : "times that fall or are not finite",
                      "times that rise", "it moves nothing");
    }
    return rise;
  }

  std::vector<float> values(int accessor, const std::string& user, const std::string& path) {
    accessors_.spend(accessors_.count(accessor), user);
    if (path == "weights") return accessors_.scalars(accessor, user, Components::FloatOrNormalized);
    std::vector<float> numbers;
    if (path == "rotation") {
      for (const Vec4f& q : accessors_.vec4(accessor, user, Components::FloatOrNormalized)) {
        numbers.insert(numbers.end(), {q.x, q.y, q.z, q.w});
      }
      return numbers;
    }
    for (const Vec3f& v : accessors_.vec3(accessor, user, Components::FloatOrNormalized)) {
      numbers.insert(numbers.end(), {v.x, v.y, v.z});
    }
    return numbers;
  }

  Document& document_;
  Accessors& accessors_;
  std::map<int, std::vector<float>> times_;
};

// How many numbers a property of a node has; nothing, after a fault, where it has none.
std::optional<std::size_t> width_of(Document& document, int node, const std::string& path,
                                    const std::string& pointer) {
  const tinygltf::Model& model = document.model();
  const tinygltf::Node& target = model.nodes[at(node)];
  if (path == "weights") {
    const std::size_t targets =
        target.mesh < 0 || model.meshes[at(target.mesh)].primitives.empty()
            ? 0
            : model.meshes[at(target.mesh)].primitives.front().targets.size();
    if (targets > 0) return targets;
    document.fault(pointer + "/path", fmt::format("weights of node {}", node),
                   "a node whose mesh has morph targets", "it moves nothing");
    return std::nullopt;
  }
  if (path != "translation" && path != "rotation" && path != "scale") {
    document.fault(pointer + "/path", in_quotes(path), "translation, rotation, scale or weights",
                   "it moves nothing");
    return std::nullopt;
  }
  if (!target.matrix.empty()) {
    document.fault(pointer + "/node", fmt::format("node {}, which has a matrix", node),
                   "a node that says its translation, rotation and scale", "it moves nothing");
    return std::nullopt;
  }
  return path == "rotation" ? 4 : 3;
}

void apply(const std::string& path, std::vector<double> value, NodePose& pose) {
  if (path == "weights") {
    pose.weights = std::move(value);
  } else if (path == "rotation") {
    pose.rotation = Vec4d(value[0], value[1], value[2], value[3]);
  } else {
    (path == "scale" ? pose.scale : pose.translation) = Vec3d(value[0], value[1], value[2]);
  }
}

// A file that names the extension has been warned of already.
void warn_of_pointers(Document& document) {
  constexpr const char* kExtension = "KHR_animation_pointer";
  const auto& used = document.model().extensionsUsed;
  if (std::find(used.begin(), used.end(), kExtension) != used.end()) return;
  const auto& animations = document.model().animations;
  for (std::size_t a = 0; a < animations.size(); ++a) {
    const auto& channels = animations[a].channels;
    for (std::size_t c = 0; c < channels.size(); ++c) {
      if (channels[c].target_path != "pointer") continue;
      document.notes().warn(
          document.where(fmt::format("/animations/{}/channels/{}/target/path", a, c)),
          fmt::format("extension {} is not supported; ignored", kExtension));
      return;
    }
  }
}

}  // namespace

void check_animations(Document& document) {
  warn_of_pointers(document);
  const auto& animations = document.model().animations;
  for (std::size_t a = 0; a < animations.size(); ++a) {
    const std::size_t samplers = animations[a].samplers.size();
    const auto& channels = animations[a].channels;
    for (std::size_t c = 0; c < channels.size(); ++c) {
      if (at(channels[c].sampler) < samplers) continue;
      throw_input_error(document.where(fmt::format("/animations/{}/channels/{}/sampler", a, c)),
                        std::to_string(channels[c].sampler),
                        fmt::format("a sampler of the animation, which has {}", samplers));
    }
  }
}

std::vector<Animation> list_animations(Document& document, Accessors& accessors) {
  Curves curves(document, accessors);
  std::vector<Animation> result;
  const auto& animations = document.model().animations;
  for (std::size_t a = 0; a < animations.size(); ++a) {
    Animation animation{name_of(animations[a], a), 0.0};
    const auto& samplers = animations[a].samplers;
    for (std::size_t s = 0; s < samplers.size(); ++s) {
      const int input = samplers[s].input;
      const std::vector<double>& max = document.model().accessors[at(input)].maxValues;
      double end_s = 0.0;
      if (!max.empty()) {
        end_s = max.front();
      } else {
        const auto& times_s =
            curves.times(input, fmt::format("/animations/{}/samplers/{}/input", a, s));
        if (!times_s.empty()) end_s = static_cast<double>(times_s.back());
      }
      animation.length_s = std::max(animation.length_s, end_s);
    }
    result.push_back(std::move(animation));
  }
  return result;
}

Pose pose_at(Document& document, Accessors& accessors, double time_s,
             const std::string& animation) {
  const auto& animations = document.model().animations;
  const std::vector<std::size_t> chosen = chosen_animations(document, animation);
  if (chosen.empty()) {
    document.notes().warn(document.file_name(), "no animation: it is the same at every time");
  }
  Curves curves(document, accessors);
  Pose pose;
  std::set<std::pair<int, std::string>> moved;
  for (const std::size_t a : chosen) {
    bool is_second = false;
    std::set<std::pair<int, std::string>> moved_here;
    const auto& channels = animations[a].channels;
    for (std::size_t c = 0; c < channels.size(); ++c) {
      const int target = channels[c].target_node;
      if (target < 0) continue;  // Of an extension that is not supported, or of nothing.
      const std::string& path = channels[c].target_path;
      if (moved.contains({target, path})) {
        is_second = true;
        continue;
      }
      const std::string pointer = fmt::format("/animations/{}/channels/{}/target", a, c);
      const auto width = width_of(document, target, path, pointer);
      if (!width) continue;
      const std::size_t sampler = at(channels[c].sampler);
      const auto curve =
          curves.read(animations[a].samplers[sampler],
                      fmt::format("/animations/{}/samplers/{}", a, sampler), path, *width);
      if (!curve) continue;
      apply(path, value_at(*curve, time_s), pose[target]);
      moved_here.insert({target, path});
    }
    moved.merge(moved_here);
    if (is_second) {
      document.notes().info(document.where(fmt::format("/animations/{}", a)),
                            fmt::format("\"{}\" moves what an animation before it moves, which "
                                        "is taken; one can be chosen by its name",
                                        name_of(animations[a], a)));
    }
  }
  return pose;
}

}  // namespace abbe::gltf
