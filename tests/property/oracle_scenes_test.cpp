// Analytic scenes and their answers, which abbe did not compute: glass that vanishes in a furnace,
// metals, slabs and a prism.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "abbe/image/exr/exr.h"
#include "abbe/load/gltf.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

using nlohmann::json;

const std::filesystem::path kFolder =
    std::filesystem::path(ABBE_SOURCE_DIR) / "tests/reference/analytic";

json read_oracles() {
  return json::parse(std::ifstream(kFolder / "oracles.json"));
}

const json& oracle(const std::string& scene) {
  static const json kOracles = read_oracles();
  for (const json& entry : kOracles["oracles"]) {
    if (entry["scene"] == scene) return entry;
  }
  throw std::runtime_error("no oracle for " + scene);
}

std::vector<double> wavelengths_of(const json& expected) {
  std::vector<double> nm;
  for (const auto& [key, value] : expected.items()) nm.push_back(std::stod(key));
  std::sort(nm.begin(), nm.end());
  return nm;
}

std::string key_of(const json& expected, double nm) {
  for (const auto& [key, value] : expected.items()) {
    if (std::stod(key) == nm) return key;
  }
  throw std::runtime_error("no such wavelength");
}

struct Rendered {
  Image image;
  std::vector<double> wavelengths_nm;

  float value(int x, int y, double nm) const {
    return test::pixel(image, x, y, spectral_channel_name(nm));
  }
};

Scene load(const std::string& name) {
  Notes notes;
  return load_gltf(kFolder / (name + ".gltf"), test::catalogue(), {}, notes);
}

Rendered render_lines(const Scene& scene, const std::vector<double>& wavelengths_nm,
                      const Vec2i& size) {
  RenderSettings settings = test::small_settings();
  settings.size = size;
  settings.max_depth = 24;
  settings.wavelengths.exact_nm = wavelengths_nm;
  return {test::render(scene, settings).image, wavelengths_nm};
}

/// Divides the triangles of a mesh about the origin, its corners moved onto the unit sphere.
void divide_on_unit_sphere(Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [place, is_new] =
        middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.positions.size()));
    if (is_new) mesh.positions.push_back(glm::normalize(mesh.positions[a] + mesh.positions[b]));
    return place->second;
  };
  decltype(mesh.triangles) divided;
  for (const auto& [a, b, c] : mesh.triangles) {
    const std::uint32_t ab = middle(a, b);
    const std::uint32_t bc = middle(b, c);
    const std::uint32_t ca = middle(c, a);
    divided.insert(divided.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  mesh.triangles = std::move(divided);
  mesh.normals = mesh.positions;
}

class FurnaceOracle : public testing::TestWithParam<const char*> {};

TEST_P(FurnaceOracle, ball_of_glass_has_the_radiance_of_its_enclosure) {
  Scene scene = load(GetParam());
  // 32 768 triangles: the furnace must not see their edges either.
  for (int i = 0; i < 6; ++i) divide_on_unit_sphere(scene.meshes.at(1));
  const Rendered rendered = render_lines(scene, {450, 550, 650}, {33, 33});
  for (int y = 0; y < 33; ++y) {
    for (int x = 0; x < 33; ++x) {
      // The camera is 3 m wide and the ball 1 m in radius; its rim is left out, as stated.
      const double radius = std::hypot(x - 16, y - 16) * 3.0 / 33.0;
      for (const double nm : rendered.wavelengths_nm) {
        const double ratio = static_cast<double>(rendered.value(x, y, nm)) /
                             static_cast<double>(rendered.value(0, 0, nm));
        EXPECT_LT(ratio, 1.0 + 1e-4);
        if (radius < 0.98) {
          EXPECT_NEAR(ratio, 1.0, 1e-3) << x << ", " << y;
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(scenes, FurnaceOracle, testing::Values("o1_furnace_glass_ball"));

class MetalOracle : public testing::TestWithParam<const char*> {};

TEST_P(MetalOracle, metal_plate_reflects_as_fresnel_with_n_and_k) {
  const json& expected = oracle(GetParam())["expected_ratio"];
  const Rendered rendered = render_lines(load(GetParam()), wavelengths_of(expected), {9, 9});
  for (const double nm : rendered.wavelengths_nm) {
    const double ratio = static_cast<double>(rendered.value(4, 4, nm)) /
                         static_cast<double>(rendered.value(0, 0, nm));
    // The stated tolerance; n and k are linear in nm.
    EXPECT_NEAR(ratio, expected[key_of(expected, nm)].get<double>(), 0.002) << nm;
  }
}

INSTANTIATE_TEST_SUITE_P(scenes, MetalOracle,
                         testing::Values("o2_metal_Au_Johnson_0deg", "o2_metal_Au_Johnson_60deg",
                                         "o2_metal_Ag_Johnson_0deg", "o2_metal_Ag_Johnson_60deg",
                                         "o2_metal_Cu_Johnson_0deg", "o2_metal_Cu_Johnson_60deg",
                                         "o2_metal_Al_Rakic_0deg", "o2_metal_Al_Rakic_60deg"));

class SlabOracle : public testing::TestWithParam<const char*> {};

TEST_P(SlabOracle, slab_transmits_the_sum_over_its_inner_reflections) {
  const json& expected = oracle(GetParam())["expected_ratio_unpolarised_tracer"];
  const Rendered rendered = render_lines(load(GetParam()), wavelengths_of(expected), {31, 3});
  for (const double nm : rendered.wavelengths_nm) {
    const double ratio = static_cast<double>(rendered.value(15, 1, nm)) /
                         static_cast<double>(rendered.value(0, 1, nm));
    // The stated tolerance, against light unpolarised at each boundary.
    EXPECT_NEAR(ratio, expected[key_of(expected, nm)].get<double>(), 1e-3) << nm;
  }
}

INSTANTIATE_TEST_SUITE_P(scenes, SlabOracle,
                         testing::Values("o3_slabT_N-BK7_0", "o3_slabT_N-BK7_45",
                                         "o3_slabT_N-SF66_0", "o3_slabT_N-SF66_45"));

class PrismOracle : public testing::TestWithParam<const char*> {};

TEST_P(PrismOracle, prism_shows_each_wavelength_the_stripe_of_its_deviation) {
  const json& entry = oracle(GetParam());
  const json& expected = entry["mini_trace_radiance"];
  const Rendered rendered = render_lines(load(GetParam()), wavelengths_of(expected), {3, 3});
  const Spectrum d65 = test::catalogue().illuminant("illuminant/D65");
  const double scale = 1.0 / xyz_of(d65, test::catalogue().observer()).y;
  for (const double nm : rendered.wavelengths_nm) {
    // Stripes glow in steps of 1/81 of D65 at 1 cd/m²; half a step tells them apart.
    const double value = static_cast<double>(rendered.value(1, 1, nm)) / (scale * d65.value(nm));
    EXPECT_NEAR(value, expected[key_of(expected, nm)].get<double>(), 0.002) << nm;
  }
}

INSTANTIATE_TEST_SUITE_P(scenes, PrismOracle, testing::Values("o4_prism_N-BK7_49.3233"));

}  // namespace
}  // namespace abbe
