/// A rough square alone in space, and the light that it sends on.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <ostream>
#include <vector>

#include "abbe/optics/fresnel.h"
#include "support/ggx.h"
#include "support/scene_builder.h"

namespace abbe {

enum class Kind { WhiteMetal, Gold, Glass, GlassFromInside, Sheet };

inline constexpr std::array<double, 3> kLines_nm{450.0, 550.0, 650.0};
inline constexpr int kMiddle = 1;

/// A surface seen under an angle, and what a single microfacet of it does.
struct RoughCase {
  Kind kind;
  double roughness;
  double angle_deg;

  bool is_metal() const { return kind == Kind::WhiteMetal || kind == Kind::Gold; }
  test::Ggx ggx() const { return {roughness * roughness}; }
  Vec3d view() const {
    const double angle = glm::radians(angle_deg);
    return {0.6 * std::sin(angle), 0.8 * std::sin(angle), std::cos(angle)};
  }
  Material material() const {
    Material material =
        kind == Kind::Gold ? test::mirror("metal/Au-Johnson") : test::glass("glass/schott/N-SF66");
    if (kind == Kind::WhiteMetal) {
      material = test::matte(Vec3f(1.0f));
      material.metallic = 1.0f;
    }
    if (kind == Kind::Sheet) material.has_volume = false;
    material.roughness = static_cast<float>(roughness);
    return material;
  }
  // Of N-SF66, and of gold.
  double eta_ti(int lane) const {
    static const std::array<double, 3> kIndex = [] {
      const Material glass = test::glass("glass/schott/N-SF66");
      std::array<double, 3> n{};
      for (std::size_t i = 0; i < 3; ++i) n[i] = refractive_index(glass.index, kLines_nm[i]);
      return n;
    }();
    const double n = kIndex[static_cast<std::size_t>(lane)];
    return kind == Kind::GlassFromInside ? 1.0 / n : n;
  }
  double reflectance(int lane, double cosine) const {
    static const Conductor kGold = *test::mirror("metal/Au-Johnson").conductor;
    if (kind == Kind::WhiteMetal) return 1.0;
    if (kind != Kind::Gold) return fresnel_dielectric(cosine, eta_ti(lane)).reflectance();
    const double nm = kLines_nm[static_cast<std::size_t>(lane)];
    return fresnel_conductor(cosine, kGold.n.value(nm), kGold.k.value(nm), 1.0);
  }
};

inline std::ostream& operator<<(std::ostream& out, const RoughCase& c) {
  const char* const kinds[] = {"white metal", "gold", "glass", "glass from inside", "sheet"};
  return out << kinds[static_cast<int>(c.kind)] << " of roughness " << c.roughness << " at "
             << c.angle_deg << " degrees";
}

/// Light that has left the surface: in the frame of its judge, where the view is above.
struct Escaped {
  bool is_refracted = false;
  int lane = 0;
  Vec3d direction{0.0};
  double share = 0.0;
};

/// A rough square in the empty.
class RoughSurface {
 public:
  explicit RoughSurface(const RoughCase& c, bool multiple_scattering = false)
      : from_inside_(c.kind == Kind::GlassFromInside) {
    Scene scene;
    test::add_square(scene, test::add(scene, c.material()), 100.0, Mat4d(1.0));
    RenderSettings settings;
    settings.wavelengths.exact_nm.assign(kLines_nm.begin(), kLines_nm.end());
    world_.emplace(test::make_world(scene, settings));
    integrator_.cutoff = 0.0f;
    integrator_.multiple_scattering = multiple_scattering;
  }

  /// Follows `count` rays that arrive along −view(i), the samples of one pixel or each of its own.
  void follow(std::uint32_t count, bool one_pixel, const std::function<Vec3d(std::uint32_t)>& view,
              const std::function<void(std::uint32_t, const Escaped&)>& visit) {
    for (std::uint32_t i = 0; i < count; ++i) {
      const Vec3d v = view(i);
      CameraSample sample;
      sample.direction = Vec3f(glm::normalize(side(-v)));
      sample.origin = -sample.direction;
      sample.chance = one_pixel ? SampleChance{pixel_chance({3, 5}, 7), i}
                                : SampleChance{pixel_chance({i % 1024, i / 1024}, 7), 0};
      radiance_.assign(static_cast<std::size_t>(world_->lanes.lane_stride()), 0.0f);
      records_.clear();
      trace_samples(*world_, integrator_, {&sample, 1},
                    {.radiance = radiance_, .records = &records_}, stats_, scratch_);
      for (const FanRecord& record : records_) {
        if (record.is_hit) continue;
        for (const LaneRecord& lane : record.lanes) {
          visit(i, {record.made_by == FanOrigin::Refracted, lane.lane,
                    side(glm::normalize(Vec3d(lane.direction))),
                    static_cast<double>(lane.throughput)});
        }
      }
    }
  }

 private:
  Vec3d side(const Vec3d& v) const { return from_inside_ ? Vec3d(v.x, v.y, -v.z) : v; }

  bool from_inside_;
  std::optional<LitWorld> world_;
  IntegratorSettings integrator_;
  IntegratorStats stats_;
  IntegratorScratch scratch_;
  std::vector<float> radiance_;
  std::vector<FanRecord> records_;
};

}  // namespace abbe
