// Fans: their growth is bounded, and their sums do not depend on how they are batched.

#include <gtest/gtest.h>

#include <cmath>

#include "support/scene_builder.h"

namespace abbe {
namespace {

Scene crowd_of_glass_spheres() {
  Scene scene;
  test::add_sphere(scene, test::add(scene, test::emitter(Vec3f(1.0f, 0.9f, 0.8f))), Vec3d(0.0),
                   50.0);
  const std::uint32_t flint = test::add(scene, test::glass("glass/schott/SF10"));
  for (int z = 0; z < 4; ++z) {
    for (int y = 0; y < 5; ++y) {
      for (int x = 0; x < 5; ++x) {
        test::add_sphere(scene, flint, {x - 2.0, y - 2.0, -z + 0.3 * (x % 2)}, 0.45);
      }
    }
  }
  scene.cameras.push_back(test::perspective_camera({0.2, 0.1, 8}, {0, 0, 0}, 35.0));
  return scene;
}

struct Traced {
  std::vector<float> radiance;
  IntegratorStats stats;
};

Traced trace_all(const LitWorld& world, const Camera& camera, const RenderSettings& settings,
                 const IntegratorSettings& integrator, int pixels) {
  std::vector<CameraSample> samples;
  for (int i = 0; i < pixels; ++i) {
    samples.push_back(
        camera_sample(world, camera, settings, {i % settings.size.x, i / settings.size.x}, 0));
  }
  Traced traced;
  traced.radiance.resize(samples.size() * static_cast<std::size_t>(world.lanes.lane_stride()));
  IntegratorScratch scratch;
  trace_samples(world, integrator, samples, {traced.radiance}, traced.stats, scratch);
  return traced;
}

class FanTest : public testing::Test {
 protected:
  FanTest() {
    settings_.size = {16, 16};
    world_.emplace(test::make_world(scene_, settings_));
  }
  Scene scene_ = crowd_of_glass_spheres();
  RenderSettings settings_ = test::small_settings();
  std::optional<LitWorld> world_;
};

TEST_F(FanTest, queue_of_a_hundred_spheres_at_depth_16_stays_within_its_capacity) {
  const IntegratorSettings integrator;
  const Traced traced = trace_all(*world_, scene_.cameras.front(), settings_, integrator, 256);
  EXPECT_LE(traced.stats.peak_queued_fans,
            queue_capacity(integrator, 256, world_->lanes.lane_count()));
  // What a thread holds: far below the gigabyte that many glass surfaces may cost.
  EXPECT_LT(traced.stats.peak_queue_bytes, 64u << 20);
}

TEST_F(FanTest, radiance_of_a_sample_does_not_depend_on_its_neighbours) {
  const Traced all = trace_all(*world_, scene_.cameras.front(), settings_, {}, 128);
  const Traced one = trace_all(*world_, scene_.cameras.front(), settings_, {}, 77);
  const std::vector<float> same(
      all.radiance.begin(),
      all.radiance.begin() + static_cast<std::ptrdiff_t>(one.radiance.size()));
  EXPECT_EQ(one.radiance, same);
}

TEST_F(FanTest, fans_of_a_generation_stay_below_the_inverse_cutoff_and_in_the_queue) {
  IntegratorSettings integrator;
  integrator.cutoff = 1e-2f;
  const Traced traced = trace_all(*world_, scene_.cameras.front(), settings_, integrator, 1);
  // One sample: at most 1/c branching fans, each with two children, and the lanes that have been
  // parted from them.
  EXPECT_LE(traced.stats.peak_queued_fans,
            2u * 100u + 100u * static_cast<unsigned>(world_->lanes.lane_count()));
}

TEST_F(FanTest, cutoff_keeps_the_mean_where_drop_loses_energy_and_says_so) {
  const auto mean = [&](const Traced& traced) {
    double sum = 0.0;
    for (const float value : traced.radiance) sum += static_cast<double>(value);
    return sum;
  };
  const double exact = mean(trace_all(*world_, scene_.cameras.front(), settings_,
                                      {.max_depth = 10, .cutoff = 1e-5f}, 256));
  const Traced kept = trace_all(*world_, scene_.cameras.front(), settings_,
                                {.max_depth = 10, .cutoff = 2e-2f}, 256);
  const Traced dropped = trace_all(*world_, scene_.cameras.front(), settings_,
                                   {.max_depth = 10, .cutoff = 2e-2f, .drop = true}, 256);
  // 256 samples, of each of which a few per cent is decided by chance.
  EXPECT_NEAR(mean(kept) / exact, 1.0, 5e-3);
  EXPECT_EQ(kept.stats.weight_lost_to_cutoff, 0.0);
  EXPECT_GT(dropped.stats.weight_lost_to_cutoff, 0.0);
  EXPECT_LT(mean(dropped), exact);
}

TEST_F(FanTest, weight_is_conserved_between_what_is_seen_and_what_depth_cuts_off) {
  // All glass, nothing absorbs: what does not reach the enclosure is lost to depth.
  const Traced traced =
      trace_all(*world_, scene_.cameras.front(), settings_, {.max_depth = 4, .cutoff = 0.0f}, 256);
  const float* weights = world_->luminance_weights.data();
  const int stride = world_->lanes.lane_stride();
  Scene empty = scene_;
  empty.instances.resize(1);
  const LitWorld open = test::make_world(empty, settings_);
  const Traced all = trace_all(open, scene_.cameras.front(), settings_, {}, 256);
  double seen = 0.0;
  for (int i = 0; i < 256; ++i) {
    const int set =
        camera_sample(*world_, scene_.cameras.front(), settings_, {i % 16, i / 16}, 0).set;
    for (int lane = 0; lane < world_->lanes.lane_count(); ++lane) {
      const std::size_t at = static_cast<std::size_t>(i) * stride + lane;
      if (all.radiance[at] > 0.0f) {
        seen += static_cast<double>(weights[set * stride + lane] * traced.radiance[at] /
                                    all.radiance[at]);
      }
    }
  }
  // Sums of a few thousand floats.
  EXPECT_NEAR((seen + traced.stats.weight_lost_to_depth) / traced.stats.weight_started, 1.0, 1e-4);
}

}  // namespace
}  // namespace abbe
