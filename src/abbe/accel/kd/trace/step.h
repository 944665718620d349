/// One step down the tree in plain C++: the children of a wide node, and their order along a ray.
#pragma once

#include <cstdint>

#include "abbe/accel/kd/layout.h"
#include "abbe/accel/kd/trace/beam.h"
#include "abbe/accel/kd/trace/state.h"

namespace abbe {

/// For each set of planes whose upper side comes first (bit p for plane p) the eight children, the
/// farthest first.
struct ChildOrder {
  alignas(64) std::uint8_t order[128][8]{};

  constexpr ChildOrder() {
    for (unsigned flips = 0; flips < 128; ++flips) {
      for (unsigned i = 0; i < 8; ++i) {
        const unsigned s0 = (i >> 2) ^ (flips & 1u);
        const unsigned s1 = (i >> 1 & 1u) ^ (flips >> (1 + s0) & 1u);
        const unsigned s2 = (i & 1u) ^ (flips >> (3 + 2 * s0 + s1) & 1u);
        order[flips][7 - i] = static_cast<std::uint8_t>(4 * s0 + 2 * s1 + s2);
      }
    }
  }
};
inline constexpr ChildOrder kChildOrder;

/// Puts the children of a node that a beam meets between t_near and t_far, and not behind
/// `farthest`, onto the stack, the nearest on top. PushChildren() in step-inl.h is the same at once
/// for all children.
inline void push_children(const WideNode& node, const Beam& beam, float t_near, float t_far,
                          float farthest, TraversalStack& stack) {
  float enter[2][7], leave[2][7];
  unsigned flips = 0;
  for (int p = 0; p < 7; ++p) {
    const unsigned axis = (node.axes >> (4 * p)) & 3u;
    const float low_r = beam.reciprocal[axis];
    const float high_r = beam.reciprocal[4 + axis];
    const float below = (node.planes[p] - beam.origin[axis]) * low_r;
    const float above = (node.planes[p] - beam.origin[4 + axis]) * high_r;
    enter[0][p] = low_r > 0.0f ? -kInfinity : below;
    leave[0][p] = low_r > 0.0f ? below : kInfinity;
    enter[1][p] = high_r > 0.0f ? above : -kInfinity;
    leave[1][p] = high_r > 0.0f ? kInfinity : above;
    flips |= (node.planes[p] < beam.origin[axis] ? 1u : 0u) << p;
  }
  int top = stack.top;
  for (int i = 0; i < 8; ++i) {
    const unsigned c = kChildOrder.order[flips][i];
    const KdChild child = node.children[c];
    if (child == kEmptyChild) continue;
    const unsigned s0 = c >> 2, s1 = c >> 1 & 1u, s2 = c & 1u;
    const unsigned p1 = 1 + s0, p2 = 3 + (c >> 1);
    float in = enter[s0][0] > enter[s1][p1] ? enter[s0][0] : enter[s1][p1];
    if (enter[s2][p2] > in) in = enter[s2][p2];
    if (t_near > in) in = t_near;
    float out = leave[s0][0] < leave[s1][p1] ? leave[s0][0] : leave[s1][p1];
    if (leave[s2][p2] < out) out = leave[s2][p2];
    if (t_far < out) out = t_far;
    if (in <= out && in <= farthest) {
      stack.child[top] = child;
      stack.t_near[top] = in;
      stack.t_far[top] = out;
      ++top;
    }
  }
  stack.top = top;
}

}  // namespace abbe
