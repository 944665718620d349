#include "abbe/integrate/light/transmittance.h"

#include <algorithm>
#include <cmath>

#include "abbe/caustics/flat/chain.h"
#include "abbe/integrate/surface/material_sample.h"
#include "abbe/optics/boundary.h"

namespace abbe {
namespace {

// A shadow ray that crosses more surfaces than this is taken as blocked.
constexpr int kMaxCrossings = 64;

/// A straight shadow ray in flight: one lane of a spread job, or all lanes of a united one.
struct ShadowPath {
  Ray ray;
  MediumStack media;
  LaneMask lanes;
  std::uint32_t visibility = 0;  ///< Offset in ShadowBuffers::data.
  int set = 0;
  std::size_t flat_crossings = 0;  ///< Facets of glass that chains lead over.
};

template <typename Body>
void for_each_lane(const LaneMask& lanes, int lane_count, const Body& body) {
  for (int lane = 0; lane < lane_count; ++lane) {
    if (lanes.test(lane)) body(lane);
  }
}

class ShadowTransmittance {
 public:
  ShadowTransmittance(const World& world, ShadowBuffers& buffers, const ShadowQueries& queries,
                      AtGlass rule, IntegratorStats& stats)
      : world_(world),
        buffers_(buffers),
        queries_(queries),
        rule_(rule),
        passing_(world.visibility_bits & passing_bits(rule)),
        stats_(stats) {
    // Most rays meet nothing transparent: a packet finds that out for sixteen lanes at once.
    meets_.resize(queries.packets.size());
    if (!meets_.empty() && passing_ != 0) {
      world.accelerator->any_hits(std::span<const RayPacket>(queries.packets), passing_,
                                  std::span<std::uint32_t>(meets_));
    }
  }

  void add(const ShadowJob& job, int set) {
    const std::uint32_t visibility =
        job.data + static_cast<std::uint32_t>(world_.lanes.lane_stride());
    if (!job.spread) {
      if (queries_.ray_occluded[job.first_query] != 0) return;
      if (job.media.empty() && passing_ == 0) return;
      in_flight_.push_back({queries_.rays[job.first_query], job.media, job.lanes, visibility, set});
      return;
    }
    for_each_lane(job.lanes, world_.lanes.lane_count(), [&](int lane) {
      const std::size_t packet_index = job.first_query + static_cast<std::size_t>(lane / 16);
      const int i = lane % 16;
      if ((queries_.packet_occluded[packet_index] >> i) & 1u) return;
      if (job.media.empty() && ((meets_[packet_index] >> i) & 1u) == 0) return;
      const RayPacket& packet = queries_.packets[packet_index];
      ShadowPath path;
      path.ray = ray_of(packet, i);
      path.media = job.media;
      path.lanes.set(lane);
      path.visibility = visibility;
      path.set = set;
      in_flight_.push_back(path);
    });
  }

  void run() {
    for (int crossing = 0; !in_flight_.empty(); ++crossing) {
      if (crossing == kMaxCrossings) {
        for (const ShadowPath& path : in_flight_) block(path);
        return;
      }
      rays_.clear();
      for (const ShadowPath& path : in_flight_) rays_.push_back(path.ray);
      hits_.resize(rays_.size());
      world_.accelerator->closest_hits(std::span<const Ray>(rays_), passing_,
                                       std::span<Hit>(hits_));
      stats_.shadow_rays += rays_.size();
      std::size_t kept = 0;
      for (std::size_t i = 0; i < in_flight_.size(); ++i) {
        if (advance(in_flight_[i], hits_[i])) in_flight_[kept++] = in_flight_[i];
      }
      in_flight_.resize(kept);
    }
  }

 private:
  float* visibility(const ShadowPath& path) { return buffers_.data.data() + path.visibility; }

  void block(const ShadowPath& path) {
    for_each_lane(path.lanes, world_.lanes.lane_count(),
                  [&](int lane) { visibility(path)[lane] = 0.0f; });
  }

  void absorb(const ShadowPath& path, std::uint32_t material, float distance_m) {
    const SurfaceMaterial& medium = world_.materials[material];
    if (!medium.absorption_per_m) return;
    const float* absorption = world_.row(*medium.absorption_per_m, path.set);
    for_each_lane(path.lanes, world_.lanes.lane_count(), [&](int lane) {
      visibility(path)[lane] *= std::exp(-absorption[lane] * distance_m);
    });
  }

  // Goes to the next surface and through it; false when the light, or darkness, is reached.
  bool advance(ShadowPath& path, const Hit& hit) {
    const float distance_m = hit.is_hit() ? hit.t : path.ray.t_max;
    if (!hit.is_hit()) {
      if (!path.media.empty()) absorb(path, path.media.top(), distance_m);
      const bool is_on_chains = path.flat_crossings > 0 && path.flat_crossings <= kMaxRefractions;
      if (rule_ == AtGlass::Counts && is_on_chains) block(path);
      return false;
    }
    const SurfacePoint point = surface_point(world_, path.ray.origin, path.ray.direction, hit);
    const std::uint32_t number = world_.geometry.surfaces[point.surface].material;
    const SurfaceMaterial& material = world_.materials[number];
    const bool front = glm::dot(path.ray.direction, point.normal) < 0.0f;
    const MediumChange change = cross(path.media, number, material.transmission, front);
    if (change.arrives_in) absorb(path, *change.arrives_in, distance_m);
    if (change.crossing != Crossing::Hidden) {
      path.flat_crossings += world_.geometry.surfaces[point.surface].ends_light;
      pass(path, material, point, front ? path.media : change.behind);
    }
    path.media = change.behind;

    const Vec3f origin = off_surface(point, path.ray.direction);
    path.ray.t_max -= glm::dot(origin - path.ray.origin, path.ray.direction);
    path.ray.origin = origin;
    bool lit = false;
    for_each_lane(path.lanes, world_.lanes.lane_count(),
                  [&](int lane) { lit |= visibility(path)[lane] > 0.0f; });
    return lit && path.ray.t_max > 0.0f;
  }

  // Loses what the surface does not let through; `outside` are the media before its front.
  void pass(const ShadowPath& path, const SurfaceMaterial& material, const SurfacePoint& point,
            const MediumStack& outside) {
    const MaterialSample sample = material_sample(world_, material, point, 0.0f);
    const auto row = [&](RowId id) { return world_.row(id, path.set); };
    const float* base_row = row(material.base_color);
    const float* n_inside = row(material.index);
    const float* n_outside = outside.empty() ? nullptr : row(world_.materials[outside.top()].index);
    const float* film_n = material.film ? row(material.film->index) : nullptr;
    const float* inverse_wavelength = row(world_.inverse_wavelength);
    const float cosine =
        std::min(1.0f, std::abs(glm::dot(path.ray.direction, point.shading_normal)));
    const float share = (1.0f - sample.metallic) * sample.transmission;
    const bool has_lookup = share > 0.0f && sample.base_color.uses_lookup;
    const Vec3f lookup = has_lookup ? looked_up(world_, sample.base_color) : Vec3f(0.0f);
    for_each_lane(path.lanes, world_.lanes.lane_count(), [&](int lane) {
      float through = 0.0f;
      if (share > 0.0f && !material.index_is_infinite) {
        Boundary boundary;
        if (n_outside != nullptr) boundary.n_incident = n_outside[lane];
        boundary.n = n_inside[lane];
        if (film_n != nullptr) {
          boundary.film = {film_n[lane], sample.film_thickness_nm, sample.film_factor};
          boundary.wavelength_nm = 1.0 / inverse_wavelength[lane];
        }
        through = share * static_cast<float>(1.0 - boundary_reflectance(boundary, cosine)) *
                  lane_value(world_, sample.base_color, lookup, base_row, path.set, lane);
      }
      visibility(path)[lane] *= (1.0f - sample.alpha) + sample.alpha * through;
    });
  }

  const World& world_;
  ShadowBuffers& buffers_;
  const ShadowQueries& queries_;
  const AtGlass rule_;
  const VisibilityMask passing_;  ///< Of the surfaces that are there, those that let light by.
  IntegratorStats& stats_;
  std::vector<std::uint32_t> meets_;  ///< Per packet, the lanes that meet something transparent.
  std::vector<ShadowPath> in_flight_;
  std::vector<Ray> rays_;
  std::vector<Hit> hits_;
};

}  // namespace

void attenuate_by_transparent(const World& world, std::span<const CameraSample> samples,
                              ShadowBuffers& buffers, IntegratorStats& stats) {
  for (std::size_t number = 0; number < kAtGlassRules; ++number) {
    const auto rule = static_cast<AtGlass>(number);
    const ShadowQueries& queries = buffers.queries[number];
    if (queries.rays.empty() && queries.packets.empty()) continue;
    ShadowTransmittance transmittance(world, buffers, queries, rule, stats);
    for (const ShadowJob& job : buffers.jobs) {
      if (job.at_glass == rule) transmittance.add(job, samples[job.sample].set);
    }
    transmittance.run();
  }
}

}  // namespace abbe
