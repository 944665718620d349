#include "abbe/integrate/light/transmittance.h"

#include <algorithm>
#include <cmath>

#include "abbe/integrate/surface/material_sample.h"
#include "abbe/optics/boundary.h"

namespace abbe {
namespace {

// A shadow ray that crosses more surfaces than this is taken as blocked.
constexpr int kMostCrossings = 64;

/// A straight ray under way: one lane of a spread job, or all lanes of a united one.
struct Passage {
  Ray ray;
  MediumStack media;
  LaneMask lanes;
  std::uint32_t visibility = 0;  ///< Offset in Buffers::shadow_data.
  int set = 0;
};

template <typename Body>
void for_each_lane(const LaneMask& lanes, int lane_count, const Body& body) {
  for (int lane = 0; lane < lane_count; ++lane) {
    if (lanes.test(lane)) body(lane);
  }
}

class Passer {
 public:
  Passer(const World& world, IntegratorScratch::Buffers& buffers, const ShadowQueries& queries,
         VisibilityMask passing, IntegratorStats& stats)
      : world_(world),
        buffers_(buffers),
        queries_(queries),
        passing_(world.visibility_bits & passing),
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
      underway_.push_back({queries_.rays[job.first_query], job.media, job.lanes, visibility, set});
      return;
    }
    for_each_lane(job.lanes, world_.lanes.lane_count(), [&](int lane) {
      const std::size_t packet_index = job.first_query + static_cast<std::size_t>(lane / 16);
      const int i = lane % 16;
      if ((queries_.packet_occluded[packet_index] >> i) & 1u) return;
      if (job.media.empty() && ((meets_[packet_index] >> i) & 1u) == 0) return;
      const RayPacket& packet = queries_.packets[packet_index];
      Passage passage;
      passage.ray = ray_of(packet, i);
      passage.media = job.media;
      passage.lanes.set(lane);
      passage.visibility = visibility;
      passage.set = set;
      underway_.push_back(passage);
    });
  }

  void run() {
    for (int crossing = 0; !underway_.empty(); ++crossing) {
      if (crossing == kMostCrossings) {
        for (const Passage& passage : underway_) block(passage);
        return;
      }
      rays_.clear();
      for (const Passage& passage : underway_) rays_.push_back(passage.ray);
      hits_.resize(rays_.size());
      world_.accelerator->closest_hits(std::span<const Ray>(rays_), passing_,
                                       std::span<Hit>(hits_));
      stats_.shadow_rays += rays_.size();
      std::size_t kept = 0;
      for (std::size_t i = 0; i < underway_.size(); ++i) {
        if (advance(underway_[i], hits_[i])) underway_[kept++] = underway_[i];
      }
      underway_.resize(kept);
    }
  }

 private:
  float* visibility(const Passage& passage) {
    return buffers_.shadow_data.data() + passage.visibility;
  }

  void block(const Passage& passage) {
    for_each_lane(passage.lanes, world_.lanes.lane_count(),
                  [&](int lane) { visibility(passage)[lane] = 0.0f; });
  }

  void absorb(const Passage& passage, std::uint32_t material, float distance_m) {
    const SurfaceMaterial& medium = world_.materials[material];
    if (!medium.absorption_per_m) return;
    const float* absorption = world_.row(*medium.absorption_per_m, passage.set);
    for_each_lane(passage.lanes, world_.lanes.lane_count(), [&](int lane) {
      visibility(passage)[lane] *= std::exp(-absorption[lane] * distance_m);
    });
  }

  // Goes to the next surface and through it; false when the light, or darkness, is reached.
  bool advance(Passage& passage, const Hit& hit) {
    const float distance_m = hit.is_hit() ? hit.t : passage.ray.t_max;
    if (!hit.is_hit()) {
      if (!passage.media.empty()) absorb(passage, passage.media.top(), distance_m);
      return false;
    }
    const SurfacePoint point =
        surface_point(world_, passage.ray.origin, passage.ray.direction, hit);
    const std::uint32_t number = world_.geometry.surfaces[point.surface].material;
    const SurfaceMaterial& material = world_.materials[number];
    const bool front = glm::dot(passage.ray.direction, point.normal) < 0.0f;
    const MediumChange change = cross(passage.media, number, material.transmission, front);
    if (change.arrives_in) absorb(passage, *change.arrives_in, distance_m);
    if (change.crossing != Crossing::Hidden) {
      pass(passage, material, point, front ? passage.media : change.behind);
    }
    passage.media = change.behind;

    const Vec3f origin = off_surface(point, passage.ray.direction);
    passage.ray.t_max -= glm::dot(origin - passage.ray.origin, passage.ray.direction);
    passage.ray.origin = origin;
    bool lit = false;
    for_each_lane(passage.lanes, world_.lanes.lane_count(),
                  [&](int lane) { lit |= visibility(passage)[lane] > 0.0f; });
    return lit && passage.ray.t_max > 0.0f;
  }

  // Loses what the surface does not let through; `outside` are the media before its front.
  void pass(const Passage& passage, const SurfaceMaterial& material, const SurfacePoint& point,
            const MediumStack& outside) {
    const MaterialSample sample = material_sample(world_, material, point, 0.0f);
    const auto row = [&](RowId id) { return world_.row(id, passage.set); };
    const float* base_row = row(material.base_color);
    const float* n_inside = row(material.index);
    const float* n_outside = outside.empty() ? nullptr : row(world_.materials[outside.top()].index);
    const float* film_n = material.film ? row(material.film->index) : nullptr;
    const float* inverse_wavelength = row(world_.inverse_wavelength);
    const float cosine =
        std::min(1.0f, std::abs(glm::dot(passage.ray.direction, point.shading_normal)));
    const float share = (1.0f - sample.metallic) * sample.transmission;
    const bool has_lookup = share > 0.0f && sample.base_color.uses_lookup;
    const Vec3f lookup = has_lookup ? looked_up(world_, sample.base_color) : Vec3f(0.0f);
    for_each_lane(passage.lanes, world_.lanes.lane_count(), [&](int lane) {
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
                  lane_value(world_, sample.base_color, lookup, base_row, passage.set, lane);
      }
      visibility(passage)[lane] *= (1.0f - sample.alpha) + sample.alpha * through;
    });
  }

  const World& world_;
  IntegratorScratch::Buffers& buffers_;
  const ShadowQueries& queries_;
  const VisibilityMask passing_;  ///< Of the surfaces that are there, those that let light by.
  IntegratorStats& stats_;
  std::vector<std::uint32_t> meets_;  ///< Per packet, the lanes that meet something transparent.
  std::vector<Passage> underway_;
  std::vector<Ray> rays_;
  std::vector<Hit> hits_;
};

}  // namespace

void attenuate_by_transparent(const World& world, std::span<const CameraSample> samples,
                              IntegratorScratch::Buffers& buffers, IntegratorStats& stats) {
  for (const bool ends_at_glass : {false, true}) {
    const ShadowQueries& queries = buffers.shadow_queries[ends_at_glass];
    if (queries.rays.empty() && queries.packets.empty()) continue;
    Passer passer(world, buffers, queries, passing_bits(ends_at_glass), stats);
    for (const ShadowJob& job : buffers.shadow_jobs) {
      if (job.ends_at_glass == ends_at_glass) passer.add(job, samples[job.sample].set);
    }
    passer.run();
  }
}

}  // namespace abbe
