#include "abbe/accel/instances/placed_meshes.h"

#include <algorithm>
#include <cmath>

#include "abbe/accel/instances/bounds.h"
#include "abbe/accel/instances/numbers.h"
#include "abbe/accel/leaf/ties.h"
#include "abbe/base/parallel.h"

namespace abbe {
namespace {

// Queries on their way at once: so many are a good call to the tree of a mesh, and their stacks
// stay in the caches.
constexpr std::size_t kInFlight = 128;

// Up to where something that comes before `best` may lie: at the same distance a lower number does.
float end_of_interest(const Hit& best, float t_max) {
  return best.is_hit() ? std::nextafter(best.t, kInfinity) : t_max;
}

Box3f point(const Vec3f& v) {
  return {v, v};
}

}  // namespace

PlacedMeshes::PlacedMeshes(const ShapeSpans& shapes, const Build& build) {
  ShapeSpans rest = shapes;
  rest.mesh_triangles = {};
  rest.meshes = {};
  rest.places = {};
  rest_ = build(rest);
  visibility_ = Visibility(rest);
  meshes_.resize(shapes.meshes.size());
  std::vector<std::vector<Box3f>> parts(shapes.meshes.size());
  parallel_for(0, shapes.meshes.size(), 1, [&](std::size_t i) {
    // Places say which of them are seen from both sides.
    const std::vector<std::uint8_t> front_only(shapes.meshes[i].count, 1);
    meshes_[i] = build({.positions = shapes.positions,
                        .triangles = shapes.triangles_of(shapes.meshes[i]),
                        .front_only = front_only});
    parts[i] = boxes_of_parts(shapes.positions, shapes.triangles_of(shapes.meshes[i]));
  });
  const PlacedNumbers numbers(shapes.meshes, shapes.places, shapes.primitive_count());
  places_.resize(shapes.places.size());
  std::vector<Box3f> boxes(shapes.places.size());
  parallel_for(0, shapes.places.size(), 256, [&](std::size_t i) {
    const MeshPlace& from = shapes.places[i];
    const Mat3d to_mesh = glm::inverse(from.linear);
    places_[i] = {to_mesh,
                  -(to_mesh * from.offset_m),
                  from.mesh,
                  numbers.first_primitive(static_cast<std::uint32_t>(i)),
                  from.mask,
                  from.front_only,
                  glm::determinant(from.linear) < 0.0};
    boxes[i] = bounds_at(parts[from.mesh], from.linear, from.offset_m);
  });
  tree_ = PlaceTree(boxes);
  const Vec3f far = glm::max(glm::abs(tree_.bounds().low), glm::abs(tree_.bounds().high));
  reach_m_ = std::max({far.x, far.y, far.z});
}

PlaceBeam PlacedMeshes::beam_of_ray(const Ray& ray) const {
  return beam_of(point(ray.origin), point(ray.direction), reach_m_);
}

PlaceBeam PlacedMeshes::beam_of_packet(const RayPacket& packet) const {
  Box3f origins, directions;
  for (int lane = 0; lane < kPacketLanes; ++lane) {
    if ((packet.active >> lane & 1u) == 0) continue;
    const Ray ray = ray_of(packet, lane);
    origins.extend(ray.origin);
    directions.extend(ray.direction);
  }
  return beam_of(origins, directions, reach_m_);
}

Ray PlacedMeshes::in_mesh(const Ray& ray, const Place& place, float t_max) const {
  Ray to = moved(place.to_mesh_linear, place.to_mesh_offset, ray);
  to.t_max = t_max;
  return to;
}

// What the mesh of a place is asked. Of a mirror image it is the front that is seen from behind.
QueryMask PlacedMeshes::query_of(const Place& place, QueryMask mask) {
  constexpr QueryMask kBoth = kCullBack | kCullFront;
  QueryMask culled = place.front_only ? static_cast<QueryMask>(mask & kBoth) : QueryMask{0};
  if (place.is_mirrored && culled != 0) culled = static_cast<QueryMask>(culled ^ kBoth);
  return static_cast<QueryMask>(kAllBits | culled);
}

// Searches advance place by place, so that many rays are asked of a mesh at once. A kind of query
// says with start() whether one of it has to be searched for, and how; collects with add() what is
// asked of a mesh; asks it; and takes the answers with keep(), true where nothing is left to find.
template <class Kind>
void PlacedMeshes::search(std::size_t count, QueryMask mask, Kind& kind) const {
  const std::size_t in_flight = std::min(count, kInFlight);
  std::vector<PlaceEntry> stacks(in_flight * tree_.stack_entries());
  std::vector<PlaceEntry*> free;
  for (std::size_t i = in_flight; i-- > 0;) {
    free.push_back(stacks.data() + i * tree_.stack_entries());
  }
  std::vector<PlaceSearch> searches;
  std::vector<std::uint32_t> next(in_flight);
  std::vector<Job> jobs;
  std::size_t started = 0;
  const auto drop = [&](std::size_t i) {
    kind.end(searches[i]);
    free.push_back(searches[i].bottom);
    searches[i] = searches.back();
    next[i] = next[searches.size() - 1];
    searches.pop_back();
  };
  for (;;) {
    while (!free.empty() && started < count) {
      PlaceSearch search;
      search.query = started++;
      if (!kind.start(search)) continue;
      search.bottom = search.top = free.back();
      free.pop_back();
      *search.top++ = {0.0f, 0};
      searches.push_back(search);
    }
    if (searches.empty()) return;
    next_places(tree_, searches, next);
    jobs.clear();
    for (std::size_t i = 0; i < searches.size();) {
      if (next[i] == kNoPlace) {
        drop(i);
        continue;
      }
      if ((places_[next[i]].mask & mask) != 0)
        jobs.push_back({static_cast<std::uint32_t>(i), next[i]});
      ++i;
    }
    if (meshes_.size() > 1) {
      std::sort(jobs.begin(), jobs.end(), [&](const Job& a, const Job& b) {
        const std::uint32_t mesh_a = places_[a.place].mesh, mesh_b = places_[b.place].mesh;
        return mesh_a != mesh_b ? mesh_a < mesh_b : a.search < b.search;
      });
    }
    for (std::size_t begin = 0, end = 0; begin < jobs.size(); begin = end) {
      const std::uint32_t mesh = places_[jobs[begin].place].mesh;
      const QueryMask query = query_of(places_[jobs[begin].place], mask);
      kind.clear();
      for (end = begin; end < jobs.size(); ++end) {
        const Place& place = places_[jobs[end].place];
        if (place.mesh != mesh || query_of(place, mask) != query) break;
        kind.add(searches[jobs[end].search], place);
      }
      kind.ask(*meshes_[mesh], query);
      for (std::size_t i = begin; i < end; ++i) {
        PlaceSearch& search = searches[jobs[i].search];
        if (kind.keep(search, places_[jobs[i].place], i - begin)) search.top = search.bottom;
      }
    }
  }
}

struct PlacedMeshes::ClosestRays {
  const PlacedMeshes& all;
  std::span<const Ray> rays;
  std::span<Hit> hits;
  std::vector<Ray> local = {};
  std::vector<Hit> found = {};

  bool start(PlaceSearch& search) const {
    const Ray& ray = rays[search.query];
    search.end = end_of_interest(hits[search.query], ray.t_max);
    search.beam = all.beam_of_ray(ray);
    return search.end > 0.0f;
  }
  void end(const PlaceSearch&) const {}
  void clear() { local.clear(); }
  void add(const PlaceSearch& search, const Place& place) {
    local.push_back(all.in_mesh(rays[search.query], place, search.end));
  }
  void ask(const Accelerator& mesh, QueryMask query) {
    found.resize(local.size());
    mesh.closest_hits(std::span<const Ray>(local), query, std::span<Hit>(found));
  }
  bool keep(PlaceSearch& search, const Place& place, std::size_t number) const {
    Hit hit = found[number];
    if (!hit.is_hit()) return false;
    hit.primitive += place.first_primitive;
    Hit& best = hits[search.query];
    if (!is_nearer(hit.t, hit.primitive, best)) return false;
    best = hit;
    search.end = end_of_interest(best, 0.0f);
    return false;
  }
};

struct PlacedMeshes::AnyRays {
  const PlacedMeshes& all;
  std::span<const Ray> rays;
  std::span<std::uint8_t> occluded;
  std::vector<Ray> local = {};
  std::vector<std::uint8_t> found = {};

  bool start(PlaceSearch& search) const {
    const Ray& ray = rays[search.query];
    search.end = ray.t_max;
    search.beam = all.beam_of_ray(ray);
    return occluded[search.query] == 0 && ray.t_max > 0.0f;
  }
  void end(const PlaceSearch&) const {}
  void clear() { local.clear(); }
  void add(const PlaceSearch& search, const Place& place) {
    local.push_back(all.in_mesh(rays[search.query], place, search.end));
  }
  void ask(const Accelerator& mesh, QueryMask query) {
    found.resize(local.size());
    mesh.any_hits(std::span<const Ray>(local), query, std::span<std::uint8_t>(found));
  }
  bool keep(const PlaceSearch& search, const Place&, std::size_t number) const {
    occluded[search.query] |= found[number];
    return found[number] != 0;
  }
};

// What each ray has met, in any order, with whether it stops the ray.
struct PlacedMeshes::AllRays {
  struct Met {
    std::size_t ray;
    Hit hit;
    bool stops;
  };

  const PlacedMeshes& all;
  std::span<const Ray> rays;
  VisibilityMask stops;
  const std::vector<float>& ends;  ///< Where the rest stops each ray.
  std::vector<Met> met = {};
  std::vector<Ray> local = {};
  HitLists found = {};

  bool start(PlaceSearch& search) const {
    search.end = ends[search.query];
    search.beam = all.beam_of_ray(rays[search.query]);
    return search.end > 0.0f;
  }
  void end(const PlaceSearch&) const {}
  void clear() { local.clear(); }
  void add(const PlaceSearch& search, const Place& place) {
    local.push_back(all.in_mesh(rays[search.query], place, search.end));
  }
  void ask(const Accelerator& mesh, QueryMask query) {
    mesh.all_hits(std::span<const Ray>(local), query, 0, found);
  }
  bool keep(PlaceSearch& search, const Place& place, std::size_t number) {
    const bool does_stop = (place.mask & stops) != 0;
    for (Hit hit : found[number]) {
      hit.primitive += place.first_primitive;
      met.push_back({search.query, hit, does_stop});
      if (!does_stop) continue;
      search.end = std::min(search.end, end_of_interest(hit, 0.0f));
      break;
    }
    return false;
  }
};

struct PlacedMeshes::ClosestPackets {
  const PlacedMeshes& all;
  std::span<const RayPacket> packets;
  std::span<HitPacket> hits;
  std::vector<RayPacket> local = {};
  std::vector<HitPacket> found = {};

  // The end of the lane that looks farthest.
  float end_of(std::size_t query) const {
    float end = 0.0f;
    for (int lane = 0; lane < kPacketLanes; ++lane) {
      if ((packets[query].active >> lane & 1u) != 0) end = std::max(end, end_of_lane(query, lane));
    }
    return end;
  }
  float end_of_lane(std::size_t query, int lane) const {
    return end_of_interest(hit_of(hits[query], lane), packets[query].t_max[lane]);
  }
  bool start(PlaceSearch& search) const {
    search.end = end_of(search.query);
    if (!(search.end > 0.0f)) return false;
    search.beam = all.beam_of_packet(packets[search.query]);
    return true;
  }
  void end(const PlaceSearch&) const {}
  void clear() { local.clear(); }
  void add(const PlaceSearch& search, const Place& place) {
    const RayPacket& from = packets[search.query];
    RayPacket& to = local.emplace_back();
    to.active = from.active;
    to.common_origin = from.common_origin;
    for (int lane = 0; lane < kPacketLanes; ++lane) {
      to.t_max[lane] = end_of_lane(search.query, lane);
    }
    move_packet(place.to_mesh_linear, place.to_mesh_offset, from, to);
  }
  void ask(const Accelerator& mesh, QueryMask query) {
    found.resize(local.size());
    mesh.closest_hits(std::span<const RayPacket>(local), query, std::span<HitPacket>(found));
  }
  bool keep(PlaceSearch& search, const Place& place, std::size_t number) const {
    HitPacket& best = hits[search.query];
    bool any = false;
    for (int lane = 0; lane < kPacketLanes; ++lane) {
      Hit hit = hit_of(found[number], lane);
      if (!hit.is_hit() || (packets[search.query].active >> lane & 1u) == 0) continue;
      hit.primitive += place.first_primitive;
      if (!is_nearer(hit.t, hit.primitive, hit_of(best, lane))) continue;
      best.t[lane] = hit.t;
      best.u[lane] = hit.u;
      best.v[lane] = hit.v;
      best.primitive[lane] = hit.primitive;
      any = true;
    }
    if (any) search.end = end_of(search.query);
    return false;
  }
};

struct PlacedMeshes::AnyPackets {
  const PlacedMeshes& all;
  std::span<const RayPacket> packets;
  std::span<std::uint32_t> occluded;
  std::vector<RayPacket> local = {};
  std::vector<std::uint32_t> found = {};

  bool start(PlaceSearch& search) const {
    RayPacket packet = packets[search.query];
    packet.active &= ~occluded[search.query];
    search.end = 0.0f;
    for (int lane = 0; lane < kPacketLanes; ++lane) {
      if ((packet.active >> lane & 1u) != 0) search.end = std::max(search.end, packet.t_max[lane]);
    }
    if (!(search.end > 0.0f)) return false;
    search.beam = all.beam_of_packet(packet);
    return true;
  }
  void end(const PlaceSearch&) const {}
  void clear() { local.clear(); }
  void add(const PlaceSearch& search, const Place& place) {
    const RayPacket& from = packets[search.query];
    RayPacket& to = local.emplace_back();
    to.active = from.active & ~occluded[search.query];
    to.common_origin = from.common_origin;
    std::copy(std::begin(from.t_max), std::end(from.t_max), to.t_max);
    move_packet(place.to_mesh_linear, place.to_mesh_offset, from, to);
  }
  void ask(const Accelerator& mesh, QueryMask query) {
    found.resize(local.size());
    mesh.any_hits(std::span<const RayPacket>(local), query, std::span<std::uint32_t>(found));
  }
  bool keep(const PlaceSearch& search, const Place&, std::size_t number) const {
    std::uint32_t& done = occluded[search.query];
    done |= found[number] & packets[search.query].active;
    return (packets[search.query].active & ~done) == 0;
  }
};

// One ray, with its cost.
struct PlacedMeshes::OneRay {
  const PlacedMeshes& all;
  const Ray& ray;
  bool is_any;
  Hit& best;
  QueryCost& cost;
  Ray local = {};
  Hit found = {};

  bool start(PlaceSearch& search) const {
    search.end = end_of_interest(best, ray.t_max);
    search.beam = all.beam_of_ray(ray);
    return search.end > 0.0f && !(is_any && best.is_hit());
  }
  void end(const PlaceSearch& search) const { cost.nodes += search.visited; }
  void clear() {}
  void add(const PlaceSearch& search, const Place& place) {
    local = all.in_mesh(ray, place, search.end);
  }
  void ask(const Accelerator& mesh, QueryMask query) {
    found = {};
    if (!is_any) {
      found = mesh.closest_hit_with_cost(local, query, cost);
    } else if (mesh.any_hit_with_cost(local, query, cost)) {
      found.primitive = 0;
    }
  }
  bool keep(PlaceSearch& search, const Place& place, std::size_t) const {
    if (!found.is_hit()) return false;
    Hit hit = found;
    hit.primitive += place.first_primitive;
    if (is_any || is_nearer(hit.t, hit.primitive, best)) best = hit;
    search.end = end_of_interest(best, 0.0f);
    return is_any;
  }
};

void PlacedMeshes::closest_hits(std::span<const Ray> rays, QueryMask mask,
                                std::span<Hit> hits) const {
  rest_->closest_hits(rays, mask, hits);
  ClosestRays kind{*this, rays, hits};
  search(rays.size(), mask, kind);
}

void PlacedMeshes::any_hits(std::span<const Ray> rays, QueryMask mask,
                            std::span<std::uint8_t> occluded) const {
  rest_->any_hits(rays, mask, occluded);
  AnyRays kind{*this, rays, occluded};
  search(rays.size(), mask, kind);
}

void PlacedMeshes::closest_hits(std::span<const RayPacket> packets, QueryMask mask,
                                std::span<HitPacket> hits) const {
  rest_->closest_hits(packets, mask, hits);
  ClosestPackets kind{*this, packets, hits};
  search(packets.size(), mask, kind);
}

void PlacedMeshes::any_hits(std::span<const RayPacket> packets, QueryMask mask,
                            std::span<std::uint32_t> occluded) const {
  rest_->any_hits(packets, mask, occluded);
  AnyPackets kind{*this, packets, occluded};
  search(packets.size(), mask, kind);
}

void PlacedMeshes::all_hits(std::span<const Ray> rays, QueryMask mask, VisibilityMask stops,
                            HitLists& hits) const {
  HitLists rest;
  rest_->all_hits(rays, mask, stops, rest);
  // A list ends with what stops the ray, if anything does.
  const auto stops_ray = [&](const Hit& hit) {
    return (visibility_.of(hit.primitive) & stops) != 0;
  };
  std::vector<float> ends(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const bool is_stopped = !rest[i].empty() && stops_ray(rest[i].back());
    ends[i] = is_stopped ? end_of_interest(rest[i].back(), 0.0f) : rays[i].t_max;
  }
  AllRays kind{*this, rays, stops, ends};
  search(rays.size(), mask, kind);
  const auto comes_before = [](const AllRays::Met& a, const AllRays::Met& b) {
    return a.ray != b.ray ? a.ray < b.ray : is_nearer(a.hit.t, a.hit.primitive, b.hit);
  };
  std::sort(kind.met.begin(), kind.met.end(), comes_before);
  hits.clear();
  auto placed = kind.met.begin();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const std::span<const Hit> list = rest[i];
    auto own = list.begin();
    bool is_stopped = false;
    while (!is_stopped && (own != list.end() || (placed != kind.met.end() && placed->ray == i))) {
      const bool is_placed = placed != kind.met.end() && placed->ray == i;
      if (own != list.end() &&
          (!is_placed || !is_nearer(placed->hit.t, placed->hit.primitive, *own))) {
        hits.add(*own);
        is_stopped = stops_ray(*own++);
      } else {
        hits.add(placed->hit);
        is_stopped = placed->stops;
        ++placed;
      }
    }
    while (placed != kind.met.end() && placed->ray == i) ++placed;
    hits.end_list();
  }
}

Hit PlacedMeshes::closest_hit_with_cost(const Ray& ray, QueryMask mask, QueryCost& cost) const {
  Hit best = rest_->closest_hit_with_cost(ray, mask, cost);
  OneRay kind{*this, ray, false, best, cost};
  search(1, mask, kind);
  return best;
}

bool PlacedMeshes::any_hit_with_cost(const Ray& ray, QueryMask mask, QueryCost& cost) const {
  Hit best;
  if (rest_->any_hit_with_cost(ray, mask, cost)) return true;
  OneRay kind{*this, ray, true, best, cost};
  search(1, mask, kind);
  return best.is_hit();
}

Box3f PlacedMeshes::bounds() const {
  Box3f all = rest_->bounds();
  all.extend(tree_.bounds());
  return all;
}

std::size_t PlacedMeshes::bytes() const {
  std::size_t sum =
      rest_->bytes() + tree_.bytes() + visibility_.bytes() + places_.size() * sizeof(Place);
  for (const auto& mesh : meshes_) sum += mesh->bytes();
  return sum;
}

}  // namespace abbe
