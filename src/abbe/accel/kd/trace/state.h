/// What a query carries through the tree, the same for every instruction set level.
#pragma once

#include <cstddef>
#include <cstdint>

#include "abbe/accel/kd/layout.h"
#include "abbe/accel/kd/trace/beam.h"
#include "abbe/accel/leaf/packet.h"
#include "abbe/accel/leaf/shear.h"
#include "abbe/accel/leaf/ties.h"
#include "abbe/accel/query.h"

namespace abbe {

inline constexpr KdChild kDoneChild = 0xffffffffu;

/// Cells still to be visited, the nearest on top. Eight entries are written at a time.
struct alignas(64) TraversalStack {
  KdChild child[kStackEntries + 8];
  float t_near[kStackEntries + 8];
  float t_far[kStackEntries + 8];
  int top = 0;

  /// The root above an entry that no ray skips and that says that all is done.
  void start(KdChild root, const Beam& beam) {
    child[0] = kDoneChild;
    t_near[0] = -kInfinity;
    t_far[0] = kInfinity;
    child[1] = root;
    t_near[1] = beam.t_near;
    t_far[1] = beam.t_far;
    top = beam.t_near <= beam.t_far ? 2 : 1;
  }

  /// Takes the cells off that begin behind t, down to the first that does not. Cells lie in order
  /// but for the width of beams, so hardly one is left below.
  void drop_behind(float t) {
    while (t_near[top - 1] > t) --top;
  }
};

/// What is to be done next for a ray or packet in flight.
namespace WorkList {
enum : std::size_t { kInner = 0, kLeaf = 1, kDone = 2 };
}

/// Everything in flight by what is to be done next. Branches that a processor would have to guess
/// ray by ray become loops over lists.
template <std::size_t kSlots>
struct WorkLists {
  std::uint8_t slot[3][kSlots + 1] = {};  ///< The last is written to, but never counts.
  std::size_t count[3] = {0, 0, 0};

  /// Written to all three lists, of which one grows: which one is no address that the next must
  /// wait for.
  void add(KdChild current, std::size_t s) {
    using namespace WorkList;
    const std::size_t is_no_node = current >> 31;
    const std::size_t is_done = current == kDoneChild ? 1 : 0;
    for (const std::size_t list : {kInner, kLeaf, kDone}) {
      slot[list][count[list]] = static_cast<std::uint8_t>(s);
    }
    count[kInner] += 1 - is_no_node;
    count[kLeaf] += is_no_node - is_done;
    count[kDone] += is_done;
  }
};

/// One ray in flight.
struct alignas(64) RayState {
  Beam beam;
  ShearedRay sheared;
  Hit hit;  ///< hit.t is the end of the open segment; it shrinks with every hit.
  const Ray* ray = nullptr;
  std::size_t index = 0;
  KdChild current = kDoneChild;       ///< The cell the ray is in.
  float t_near = 0.0f, t_far = 0.0f;  ///< Where it is in there.
  TraversalStack stack;

  /// All but the beam and the stack. `found` is what was met already; its t ends the segment.
  void start(const Ray& r, const Hit& found, std::size_t i) {
    ray = &r;
    index = i;
    sheared = ShearedRay(r);
    hit = found;
  }
};

/// The search of a ray in flight, as leaf/search.h has it.
struct RaySearch {
  const KdView& view;
  QueryMask mask;
  RayState& ray;

  void found(float t, std::uint32_t primitive, float u, float v, int) {
    if (t > 0.0f && is_nearer(t, primitive, ray.hit) && view.is_visible(primitive, mask)) {
      ray.hit = {t, primitive, u, v};
    }
  }
  /// Tests a solid: compiled once, for all instruction set levels.
  void test(std::uint32_t solid);
};

inline constexpr int kPairLanes = 2 * kPacketLanes;
inline constexpr std::uint32_t kAllLanes = (1u << kPacketLanes) - 1u;  ///< Of one packet.

/// Sixteen rays in flight together, or the thirty-two of two packets.
template <int kWidth>
struct alignas(64) PacketState : PacketRays<kWidth> {
  Beam beam;
  ShearGroup groups[3];
  int group_count = 0;
  std::uint32_t active = 0;
  std::uint32_t met = 0;    ///< Of any hit: lanes that are done.
  float farthest = 0.0f;    ///< Largest hits.t.
  std::uint32_t apart = 0;  ///< Lanes that are better traced apart from the rest.
  bool has_line = false;
  // If so, all rays are within (half_x + spread_x·|z|, …) of one line, z from its origin along
  // axes.z.
  ShearAxes axes;
  float line_x = 0.0f, line_y = 0.0f, line_z = 0.0f;
  float line_shear_x = 0.0f, line_shear_y = 0.0f;
  float half_x = 0.0f, half_y = 0.0f, half_z = 0.0f;
  float spread_x = 0.0f, spread_y = 0.0f;
  float longest_z = 0.0f;  ///< Largest |direction| along axes.z.
  bool is_z_positive = true;
  bool common_origin = false;
  bool is_whole = true;               ///< All active lanes of a packet, not a part of them.
  std::size_t index = 0;              ///< Of the packet, or the first of two.
  int budget = 0;                     ///< Work left before the rays go on alone.
  KdChild current = kDoneChild;       ///< The cell the packet is in.
  float t_near = 0.0f, t_far = 0.0f;  ///< Where it is in there.
  TraversalStack stack;

  /// Whether all was visited before the budget ran out.
  bool is_complete() const { return budget >= 0; }
  void stop() { current = kDoneChild; }
  /// Whether `apart` divides the active lanes.
  bool is_parted() const { return apart != 0 && apart != active; }
};

/// Puts the block behind the current one on the stack of a ray or packet, if there is one and it
/// begins before t_end: no branch to guess.
template <class State>
void push_next_block(State& state, std::uint32_t next_lines, float t_end) {
  TraversalStack& stack = state.stack;
  stack.child[stack.top] = state.current + next_lines;
  stack.t_near[stack.top] = state.t_near;
  stack.t_far[stack.top] = state.t_far;
  stack.top += next_lines != 0 && state.t_near <= t_end ? 1 : 0;
}

/// Takes the nearest cell. What is behind all hits was dropped when they were met.
template <class State>
void pop(State& state) {
  const int top = --state.stack.top;
  state.current = state.stack.child[top];
  state.t_near = state.stack.t_near[top];
  state.t_far = state.stack.t_far[top];
}

}  // namespace abbe
