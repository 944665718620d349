/// A square of a layered material alone in space, and the light that it sends on.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "abbe/optics/fresnel.h"
#include "support/scene_builder.h"

namespace abbe {

inline Material white_metal(float roughness) {
  Material m = test::matte(Vec3f(1.0f));
  m.metallic = 1.0f;
  m.roughness = roughness;
  return m;
}

inline Material white_plastic(float roughness) {
  Material m;
  m.metallic = 0.0f;
  m.roughness = roughness;
  return m;
}

inline Vec3d direction_at(double angle_deg) {
  const double angle = glm::radians(angle_deg);
  return {0.6 * std::sin(angle), 0.8 * std::sin(angle), std::cos(angle)};
}

inline Clearcoat coat_of(float factor, float roughness = 0.0f) {
  Clearcoat coat;
  coat.factor = factor;
  coat.roughness = roughness;
  return coat;
}

inline Sheen sheen_of(const Vec3f& color_rec709, float roughness) {
  Sheen sheen;
  sheen.color_rec709 = color_rec709;
  sheen.roughness = roughness;
  return sheen;
}

inline Anisotropy brushed(float strength, float rotation_rad = 0.0f) {
  Anisotropy anisotropy;
  anisotropy.strength = strength;
  anisotropy.rotation_rad = rotation_rad;
  return anisotropy;
}

inline SpecularPart specular_of(float factor, float color) {
  SpecularPart specular;
  specular.factor = factor;
  specular.color_rec709 = Vec3f(color);
  return specular;
}

inline DiffuseTransmission through_of(float factor, float color) {
  DiffuseTransmission through;
  through.factor = factor;
  through.color_rec709 = Vec3f(color);
  return through;
}

// A square in the empty, seen from above.
class Square {
 public:
  explicit Square(const Material& material, Mode mode = Mode::Rgb) {
    scene_.instances.clear();
    test::add_square(scene_, test::add(scene_, material), 100.0, Mat4d(1.0));
    Mesh* mesh = scene_.meshes.empty() ? nullptr : &scene_.meshes.front();
    if (mesh != nullptr) {
      mesh->tangents.assign(mesh->positions.size(), Vec4f(1.0f, 0.0f, 0.0f, 1.0f));
    }
    settings_.mode = mode;
    integrator_.cutoff = 0.0f;
  }

  // What leaves along `view` of lamps, in green.
  double lit_by(const Vec3d& view, std::vector<Light> lamps) {
    scene_.lights = std::move(lamps);
    const LitWorld world = test::make_world(scene_, settings_);
    return traced(world, view, 0, nullptr);
  }

  // The same of lamps of 1 cd/m² from all around: the albedo of all lobes that have a width.
  double broad_albedo(const Vec3d& view, bool from_below = false) {
    std::vector<Light> lamps;
    constexpr int kHeights = 128, kTurns = 128;
    for (int i = 0; i < kHeights * kTurns; ++i) {
      const double sine = std::sqrt((i / kTurns + 0.5) / kHeights);
      const double turn =
          2.0 * kPi * (i % kTurns + std::fmod((i / kTurns) * 0.618034, 1.0)) / kTurns;
      const double cosine = std::sqrt(1.0 - sine * sine);
      const Vec3d light(sine * std::cos(turn), sine * std::sin(turn),
                        from_below ? -cosine : cosine);
      lamps.push_back(test::directional_light(-light, kPi / (kHeights * kTurns) / cosine));
    }
    return lit_by(view, std::move(lamps));
  }

  // The same and what rays bring, under a sky of 1 cd/m² that is all around, below as well.
  double in_even_light(const Vec3d& view, std::uint32_t rays) {
    auto sky = std::make_shared<Environment>();
    sky->image.width = 16;
    sky->image.height = 8;
    sky->image.rgb_rec709.assign(16 * 8, Vec3f(1.0f));
    scene_.lights.clear();
    scene_.environment = sky;
    const LitWorld world = test::make_world(scene_, settings_);
    double sum = 0.0;
    for (std::uint32_t i = 0; i < rays; ++i) sum += traced(world, view, i, nullptr);
    return sum / rays;
  }

  // What rays carry on, in the mean: of ideal lobes, and of sampled ones.
  struct Carried {
    double ideal = 0.0, sampled = 0.0;
  };
  Carried carried(const Vec3d& view, std::uint32_t rays) {
    scene_.lights = {test::point_light({0, 0, -1e6}, 1e-9)};
    const LitWorld world = test::make_world(scene_, settings_);
    Carried sum;
    for (std::uint32_t i = 0; i < rays; ++i) {
      std::vector<FanRecord> records;
      traced(world, view, i, &records);
      for (const FanRecord& record : records) {
        if (record.is_hit) continue;
        for (const LaneRecord& lane : record.lanes) {
          if (lane.lane != 1) continue;
          const Vec3d away = glm::normalize(Vec3d(lane.direction));
          const bool mirrored = glm::length(away - Vec3d(-view.x, -view.y, view.z)) < 1e-5;
          const bool ideal = mirrored || record.made_by == FanOrigin::Refracted;
          (ideal ? sum.ideal : sum.sampled) += static_cast<double>(lane.throughput) / rays;
        }
      }
    }
    return sum;
  }

 private:
  double traced(const LitWorld& world, const Vec3d& view, std::uint32_t number,
                std::vector<FanRecord>* records) {
    CameraSample sample;
    sample.direction = Vec3f(-view);
    sample.origin = -sample.direction;
    sample.chance = SampleChance{pixel_chance({3, 5}, 7), number};
    std::vector<float> radiance(static_cast<std::size_t>(world.lanes.lane_stride()));
    trace_samples(world, integrator_, {&sample, 1}, {.radiance = radiance, .records = records},
                  stats_, scratch_);
    return static_cast<double>(radiance[1]);
  }

  Scene scene_;
  RenderSettings settings_;
  IntegratorSettings integrator_;
  IntegratorStats stats_;
  IntegratorScratch scratch_;
};

inline double k_r(double cosine) {
  return fresnel_dielectric(cosine, 1.5).reflectance();
}

}  // namespace abbe
