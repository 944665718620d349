// Prisms at minimum deviation, traced: the deviation must be the closed form's.

#include <gtest/gtest.h>

#include <cmath>

#include "abbe/base/constants.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

struct PrismCase {
  const char* glass;
  double incidence_deg;
  double deviation_deg[3];  ///< F, d, C
};

// A prism of 60° in which the d line runs at minimum deviation.
// Source: closed form 2·asin(n·sin 30°) − 60° for d, and refraction at both faces for F and C.
constexpr PrismCase kCases[] = {
    {"glass/schott/N-BK7", 49.3233, {39.13905, 38.64670, 38.42932}},
    {"glass/schott/F2", 54.0979, {49.38809, 48.19578, 47.70902}},
    {"glass/schott/N-SF11", 63.1713, {69.25084, 66.34263, 65.24956}},
};

class MinimumDeviation : public testing::TestWithParam<PrismCase> {};

std::vector<FanRecord> trace_through(const PrismCase& prism) {
  Scene scene;
  test::add_prism(scene, test::add(scene, test::glass(prism.glass)), 60.0, 1.0, Mat4d(1.0));
  // Something to hit, so that the rays that leave are recorded with their directions.
  test::add_sphere(scene, test::add(scene, test::emitter(Vec3f(1.0f))), Vec3d(0.0), 100.0);
  RenderSettings settings;
  settings.wavelengths.exact_nm = {kLineF_nm, kLine_d_nm, kLineC_nm};
  const LitWorld world = test::make_world(scene, settings);
  // The face towards +Z has the normal (sin 30°, 0, cos 30°), 60° from the X axis.
  const double normal_deg = 60.0;
  const double arrival = glm::radians(normal_deg + prism.incidence_deg);
  const Vec3d direction(-std::cos(arrival), 0.0, -std::sin(arrival));
  // Aim at a point of that face, 0.3 m from the apex edge.
  const Vec3d on_face(-0.3 * std::cos(glm::radians(30.0)), 0.0, 0.3 * std::sin(glm::radians(30.0)));
  CameraSample sample;
  sample.origin = Vec3f(on_face - 2.0 * direction);
  sample.direction = Vec3f(direction);
  std::vector<float> radiance(static_cast<std::size_t>(world.lanes.lane_stride()));
  std::vector<FanRecord> records;
  IntegratorStats stats;
  IntegratorScratch scratch;
  trace_samples(world, {.max_depth = 2}, std::span(&sample, 1),
                {.radiance = radiance, .records = &records}, stats, scratch);
  return records;
}

TEST_P(MinimumDeviation, prism_at_catalogue_incidence_deviates_as_closed_form) {
  const std::vector<FanRecord> records = trace_through(GetParam());
  // Entry, then the spread fan at the second face, then what left the prism, at the sphere.
  const FanRecord* left = nullptr;
  for (const FanRecord& record : records) {
    if (record.depth == 2 && record.made_by == FanOrigin::Refracted) left = &record;
  }
  ASSERT_NE(left, nullptr);
  ASSERT_EQ(left->lanes.size(), 3u);
  ASSERT_TRUE(left->was_spread);
  const Vec3d before(records.front().lanes.front().direction);
  for (std::size_t lane = 0; lane < 3; ++lane) {
    const Vec3d after(left->lanes[lane].direction);
    // The arc tangent keeps its precision where the arc cosine loses it.
    const double deviation_deg =
        glm::degrees(std::atan2(glm::length(glm::cross(before, after)), glm::dot(before, after)));
    // Rays in single precision err by up to 5e-5°; the incidence is given to 5e-5°.
    EXPECT_NEAR(deviation_deg, GetParam().deviation_deg[lane], 2e-4);
  }
}

INSTANTIATE_TEST_SUITE_P(glasses, MinimumDeviation, testing::ValuesIn(kCases),
                         [](const auto& test) {
                           std::string name = test.param.glass;
                           name = name.substr(name.rfind('/') + 1);
                           std::erase(name, '-');
                           return name;
                         });

TEST(PrismTest, fan_at_first_face_reflects_united_and_refracts_spread) {
  const std::vector<FanRecord> records = trace_through(kCases[2]);
  int united_reflections = 0;
  for (const FanRecord& record : records) {
    if (record.depth == 1 && record.made_by == FanOrigin::Reflected) {
      EXPECT_FALSE(record.was_spread);
      ++united_reflections;
    }
    if (record.depth == 1 && record.made_by == FanOrigin::Refracted) {
      EXPECT_TRUE(record.was_spread);
    }
  }
  EXPECT_EQ(united_reflections, 1);
}

}  // namespace
}  // namespace abbe
