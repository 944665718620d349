#include "abbe/integrate/light/transmittance.h"

#include <algorithm>
#include <cmath>

#include "abbe/caustics/flat/chain.h"
#include "abbe/integrate/surface/contact.h"
#include "abbe/integrate/surface/material_sample.h"
#include "abbe/optics/boundary.h"
#include "abbe/optics/rough/layer_albedo.h"

namespace abbe {
namespace {

/// A straight shadow ray in flight: one lane of a spread job, or all lanes of a united one.
struct ShadowPath {
  Ray ray;
  Departure departure;
  MediumStack media;
  LaneMask lanes;
  std::uint32_t visibility = 0;  ///< Offset in ShadowBuffers::data.
  int set = 0;
  bool is_unbent = false;
  std::optional<ShadowEnd> ends_on = {};
  std::size_t flat_crossings = 0;  ///< Facets of glass that chains lead over.
};

template <typename Body>
void for_each_lane(const LaneMask& lanes, int lane_count, const Body& body) {
  for (int lane = 0; lane < lane_count; ++lane) {
    if (lanes.test(lane)) body(lane);
  }
}

// KHR_materials_specular as the eye's rays have it (answer-inl.h). Domain: no total reflection.
double with_specular(double eta, double reflected, double color, double factor) {
  const double f0 = std::pow((eta - 1.0) / (eta + 1.0), 2);
  const double colored = std::min(f0 * color, 1.0);
  const double grazing = f0 < 1.0 ? (reflected - f0) / (1.0 - f0) : 1.0;
  return factor * std::clamp(colored + (1.0 - colored) * grazing, 0.0, 1.0);
}

// What a coat and a sheen leave of light that a boundary lets through, as for the eye's rays
// (layers-inl.h): at the angle outside, which a straight ray has on both sides.
float left_by_layers(const SurfaceMaterial& material, const LayerSample& layers, float cosine,
                     double reflected) {
  float left = 1.0f;
  if (material.layers->coat) {
    const float coat = LayerAlbedo::table().coat(cosine, layers.coat_roughness);
    const float often = 1.0f - static_cast<float>(reflected) * coat;
    left = 1.0f - layers.coat + layers.coat * (1.0f - coat) / std::max(often, 1e-6f);
  }
  if (material.layers->sheen) {
    const float sheen = LayerAlbedo::table().sheen(cosine, layers.sheen_roughness);
    left *= std::max(0.0f, 1.0f - layers.sheen_most * std::min(1.0f, sheen));
  }
  return left;
}

// Whether the eye's rays go on straight behind a surface that is there: polished sheets.
bool goes_straight(const World& world, const SurfaceMaterial& material,
                   const MaterialSample& sample, const SurfacePoint& point,
                   const MediumChange& change) {
  if (change.is_boundary() || sample.roughness >= kSmoothRoughness) return false;
  if (!material.layers || !material.layers->anisotropy) return true;
  // As rough along one direction as makes no sheet polished.
  const float along = layer_sample(world, material, point, 0.0f).anisotropy;
  const float least = kSmoothRoughness * kSmoothRoughness;
  return point.tangent == Vec3f(0.0f) || !(along * along * (1.0f - least) > 0.01f * least);
}

// They end 1e-5 of their length before it (emitted-inl.h); a little beyond it is no longer on it.
constexpr float kOnEmitter = 1.3e-5f;

class ShadowTransmittance {
 public:
  ShadowTransmittance(const World& world, ShadowBuffers& buffers, const ShadowQueries& queries,
                      AtGlass rule, IntegratorStats& stats)
      : world_(world),
        buffers_(buffers),
        queries_(queries),
        rule_(rule),
        passing_(world.visibility_bits & passing_bits(rule)),
        stats_(stats),
        list_(world) {
    // Most rays meet nothing transparent: a packet finds that out for sixteen lanes at once.
    meets_.resize(queries.packets.size());
    if (!meets_.empty() && passing_ != 0) {
      world.accelerator->any_hits(std::span<const RayPacket>(queries.packets),
                                  static_cast<QueryMask>(passing_ | kCullFront),
                                  std::span<std::uint32_t>(meets_));
    }
  }

  void add(const ShadowJob& job, int set) {
    const std::uint32_t visibility =
        job.data + static_cast<std::uint32_t>(world_.lanes.lane_stride());
    if (!job.spread) {
      if (queries_.ray_occluded[job.first_query] != 0) return;
      if (job.media.empty() && passing_ == 0) return;
      in_flight_.push_back({queries_.rays[job.first_query], job.departure, job.media, job.lanes,
                            visibility, set, job.is_unbent, job.ends_on});
      return;
    }
    for_each_lane(job.lanes, world_.lanes.lane_count(), [&](int lane) {
      const std::size_t packet_index = job.first_query + static_cast<std::size_t>(lane / 16);
      const int i = lane % 16;
      if ((queries_.packet_occluded[packet_index] >> i) & 1u) return;
      const bool meets = ((meets_[packet_index] >> i) & 1u) != 0;
      const bool ends_before = job.ends_on && passing_ != 0;  // What lies there is asked below.
      if (job.media.empty() && !meets && !ends_before && !job.departure.is_crowded()) return;
      const RayPacket& packet = queries_.packets[packet_index];
      ShadowPath path;
      path.ray = ray_of(packet, i);
      path.departure = job.departure;
      path.media = job.media;
      path.lanes.set(lane);
      path.visibility = visibility;
      path.set = set;
      path.is_unbent = job.is_unbent;
      path.ends_on = job.ends_on;
      in_flight_.push_back(path);
    });
  }

  void run() {
    // Where something is nearby the start, what is opaque there tells what comes before it.
    const auto crowded = std::partition(in_flight_.begin(), in_flight_.end(), [](const auto& path) {
      return !path.departure.is_crowded();
    });
    run({in_flight_.begin(), crowded}, passing_);
    run({crowded, in_flight_.end()}, passing_ | kOpaqueBit);
    stats_.shadow_rays += in_flight_.size();
  }

 private:
  void run(std::span<ShadowPath> paths, VisibilityMask mask) {
    if (paths.empty()) return;
    lines_.clear();
    for (const ShadowPath& path : paths) {
      // From where the ray has left its surface.
      Ray line = path.ray;
      line.origin -= path.departure.reach_m * line.direction;
      line.t_max += path.departure.reach_m;
      // Shadow rays end short of what shines, and so of glass that touches it.
      if (path.ends_on) {
        const float cosine =
            std::max(std::abs(glm::dot(line.direction, path.ends_on->normal)), 1e-3f);
        line.t_max += kOnEmitter * path.ray.t_max + 2.0f * path.ends_on->rounding_m / cosine;
      }
      lines_.push_back(line);
    }
    found_.clear();
    world_.accelerator->all_hits(std::span<const Ray>(lines_),
                                 static_cast<QueryMask>(mask | kCullFront), 0, found_);
    for (std::size_t i = 0; i < paths.size(); ++i) {
      list_.sort(lines_[i], found_[i]);
      follow(paths[i], lines_[i]);
    }
  }

  float* visibility(const ShadowPath& path) { return buffers_.data.data() + path.visibility; }

  void absorb(const ShadowPath& path, std::optional<std::uint32_t> medium, double distance_m) {
    if (!medium || !world_.materials[*medium].absorption_per_m) return;
    const float* absorption = world_.row(*world_.materials[*medium].absorption_per_m, path.set);
    const auto along_m = static_cast<float>(distance_m);
    for_each_lane(path.lanes, world_.lanes.lane_count(), [&](int lane) {
      visibility(path)[lane] *= std::exp(-absorption[lane] * along_m);
    });
  }

  // Goes through what the line meets behind the start, up to the light or to darkness.
  void follow(ShadowPath& path, const Ray& line) {
    double t = static_cast<double>(path.departure.reach_m);
    std::size_t next = 0;
    if (path.departure.is_crowded()) {
      next = list_.find(t, [&](std::uint32_t surface, std::uint32_t) {
        return surface == path.departure.surface;
      });
      if (next < list_.all().size()) {
        t = list_.all()[next++].t;
      } else {
        for (next = 0; next < list_.all().size() && !(list_.all()[next].last_t > t);) ++next;
      }
    }
    const auto end = static_cast<double>(path.ray.t_max + path.departure.reach_m);
    for (; next < list_.all().size(); ++next) {
      const Interface& met = list_.all()[next];
      if (met.t > end && path.ends_on && met.surface == path.ends_on->surface) continue;
      const std::uint32_t number = world_.geometry.surfaces[met.surface].material;
      const SurfaceMaterial& material = world_.materials[number];
      const std::span<const MetFace> faces = list_.faces(met);
      const MediumChange change = cross(path.media, material.transmission, faces);
      absorb(path, change.arrives_in, met.t - t);
      if (change.crossing != Crossing::Hidden) {
        path.flat_crossings += world_.geometry.surfaces[met.surface].ends_light;
        pass(path, line, met, change);
      }
      path.media = change.behind;
      t = met.t;
      bool lit = false;
      for_each_lane(path.lanes, world_.lanes.lane_count(),
                    [&](int lane) { lit |= visibility(path)[lane] > 0.0f; });
      if (!lit) return;
    }
    absorb(path, path.media.owner(), std::max(end - t, 0.0));
    const bool is_on_chains = path.flat_crossings > 0 && path.flat_crossings <= kMaxRefractions;
    if (rule_ != AtGlass::Counts || !is_on_chains) return;
    for_each_lane(path.lanes, world_.lanes.lane_count(),
                  [&](int lane) { visibility(path)[lane] = 0.0f; });
  }

  // Loses what the surface does not let through. What is before its front counts as outside.
  void pass(const ShadowPath& path, const Ray& line, const Interface& met,
            const MediumChange& change) {
    const SurfaceMaterial& material = world_.materials[list_.faces(met).front().material];
    const SurfacePoint point = surface_point(world_, line.origin, line.direction, met.hit);
    const MaterialSample sample = material_sample(world_, material, point, 0.0f);
    const auto row = [&](RowId id) { return world_.row(id, path.set); };
    const auto index_of = [&](std::optional<std::uint32_t> medium) {
      return medium ? row(world_.materials[*medium].index) : nullptr;
    };
    const bool enters = change.crossing != Crossing::Leave;
    const float* base_row = row(material.base_color);
    const float* n_outside = index_of(enters ? change.arrives_in : change.goes_into());
    const float* n_inside = !change.is_boundary() ? row(material.index)
                            : enters              ? index_of(change.goes_into())
                                                  : index_of(change.arrives_in);
    const float* film_n = material.film ? row(material.film->index) : nullptr;
    const float* inverse_wavelength = row(world_.inverse_wavelength);
    const float cosine = std::min(1.0f, std::abs(glm::dot(line.direction, point.shading_normal)));
    float share = (1.0f - sample.metallic) * sample.transmission;
    if (path.is_unbent && !goes_straight(world_, material, sample, point, change)) share = 0.0f;
    const bool has_lookup = share > 0.0f && sample.base_color.uses_lookup;
    const Vec3f lookup = has_lookup ? looked_up(world_, sample.base_color) : Vec3f(0.0f);
    const bool has_layers = share > 0.0f && material.layers.has_value();
    const LayerSample layers =
        has_layers ? layer_sample(world_, material, point, 0.0f) : LayerSample{};
    const bool has_specular = has_layers && material.layers->specular;
    const Vec3f specular_lookup = has_specular && layers.specular_color.uses_lookup
                                      ? looked_up(world_, layers.specular_color)
                                      : Vec3f(0.0f);
    for_each_lane(path.lanes, world_.lanes.lane_count(), [&](int lane) {
      float through = 0.0f;
      if (share > 0.0f && !material.index_is_infinite) {
        Boundary boundary;
        if (n_outside != nullptr) boundary.n_incident = n_outside[lane];
        if (n_inside != nullptr) boundary.n = n_inside[lane];
        if (film_n != nullptr) {
          boundary.film = {film_n[lane], sample.film_thickness_nm, sample.film_factor};
          boundary.wavelength_nm = 1.0 / inverse_wavelength[lane];
        }
        double reflected = boundary_reflectance(boundary, cosine);
        double taken = reflected;
        if (has_specular) {
          const ColorUse& use = material.layers->specular->color;
          const float color = use.scale * lane_value(world_, layers.specular_color, specular_lookup,
                                                     row(use.row), path.set, lane);
          const double eta = boundary.n / boundary.n_incident;
          const auto factor = static_cast<double>(layers.specular);
          const auto most = static_cast<double>(std::max(color, layers.specular_most));
          taken = with_specular(eta, reflected, most, factor);
          reflected = with_specular(eta, reflected, static_cast<double>(color), factor);
        }
        through = share * static_cast<float>(1.0 - taken) *
                  lane_value(world_, sample.base_color, lookup, base_row, path.set, lane);
        if (has_layers) through *= left_by_layers(material, layers, cosine, reflected);
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
  std::vector<Ray> lines_;
  HitLists found_;
  InterfaceList list_;
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
