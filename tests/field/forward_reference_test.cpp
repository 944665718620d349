// The forward reference against closed forms, before anything is measured against it.

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numeric>

#include "abbe/base/constants.h"
#include "support/forward/photons.h"
#include "support/forward/setups.h"

namespace abbe::test {
namespace {

// At normal incidence: one face, and what a row of places that each pass or return light passes,
// added one by one with all reflections between them.
double face_share(double n1, double n2) {
  const double r = (n1 - n2) / (n1 + n2);
  return r * r;
}

struct Stack {
  double passed = 1.0, returned_behind = 0.0;

  void add(double reflected, double kept = 1.0) {
    returned_behind *= kept * kept;
    passed *= kept;
    const double round_trips = 1.0 / (1.0 - returned_behind * reflected);
    passed *= (1.0 - reflected) * round_trips;
    returned_behind =
        reflected + (1.0 - reflected) * (1.0 - reflected) * returned_behind * round_trips;
  }
};

const double kBk7 = n_bk7().at(kLine_d_nm);
const double kFace = face_share(1.0, kBk7);

PhotonOptions exactly(std::uint64_t photons = 64) {
  PhotonOptions options;
  options.wavelength_nm = kLine_d_nm;
  options.photons = photons;
  options.split_share = 1e-12;  // Below it chance moves less than is asked here.
  return options;
}

// A beam along +X of 2 cm that falls onto a receiver of 4 cm at x = 1 m.
OpticalSetup beam() {
  OpticalSetup setup;
  setup.add("wall", {Rectangle{{1, 0, 0}, {0, 0, 1}, {0, 1, 0}}.face()}, Wall{});
  setup.receiver = {{1, 0, 0}, {0, 0, 0.02}, {0, 0.02, 0}};
  setup.cells = {1, 1};
  setup.aim = {{-1, 0, 0}, {0, 0, 0.01}, {0, 0.01, 0}};
  return setup;
}

double share_on_receiver(const OpticalSetup& setup, const PhotonOptions& options = exactly()) {
  const ForwardResult result = follow_photons(setup, options);
  EXPECT_EQ(result.lost, 0.0);
  return std::accumulate(result.irradiance.begin(), result.irradiance.end(), 0.0) *
         setup.receiver.area() / static_cast<double>(result.irradiance.size()) / result.sent;
}

FlatFaces plate(double x0, double x1, double half = 0.5) {
  return box({0.5 * (x0 + x1), 0, 0}, {0.5 * (x1 - x0), half, half});
}

constexpr double kRounding = 1e-9;  // Of sums over round trips, and what falls to chance.

TEST(ForwardReference, interface_has_fresnels_values) {
  // Born & Wolf, 7th ed., 1.5.2: n = 1.5 at 0 and 45°, diamond; a metal at 0°.
  EXPECT_NEAR(interface_reflectance(1.0, 1.0, 1.5), 0.04, 1e-12);
  EXPECT_NEAR(interface_reflectance(std::sqrt(0.5), 1.0, 1.5), 0.5 * (0.092013 + 0.008466), 1e-6);
  EXPECT_NEAR(interface_reflectance(1.0, 1.0, 2.4175), 0.172040, 1e-6);
  EXPECT_NEAR(interface_reflectance(1.0, 1.0, {0.96, 6.69}),
              (0.04 * 0.04 + 6.69 * 6.69) / (1.96 * 1.96 + 6.69 * 6.69), 1e-12);
  const double critical = std::asin(1.0 / 1.5);
  EXPECT_LT(interface_reflectance(std::cos(critical - 1e-3), 1.5, 1.0), 0.8);
  EXPECT_EQ(interface_reflectance(std::cos(critical + 1e-6), 1.5, 1.0), 1.0);
}

TEST(ForwardReference, interface_is_the_same_from_both_sides) {
  for (const double sine : {0.0, 0.3, 0.6, 0.9}) {
    const double inner_sine = sine / 1.7;
    EXPECT_NEAR(interface_reflectance(std::sqrt(1.0 - sine * sine), 1.0, 1.7),
                interface_reflectance(std::sqrt(1.0 - inner_sine * inner_sine), 1.7, 1.0), 1e-14);
  }
}

TEST(ForwardReference, one_pane_passes_the_sum_over_its_inner_reflections) {
  OpticalSetup setup = beam();
  setup.add("pane", plate(0.0, 0.01), Dielectric{n_bk7()});
  EXPECT_NEAR(share_on_receiver(setup), (1.0 - kFace) / (1.0 + kFace), kRounding);
}

TEST(ForwardReference, row_of_panes_passes_the_sum_over_all_reflections) {
  OpticalSetup setup = beam();
  Stack stack;
  for (int i = 0; i < 3; ++i) {
    setup.add("pane", plate(0.1 * i, 0.1 * i + 0.01), Dielectric{n_bk7()});
    stack.add(kFace);
    stack.add(kFace);
    PhotonOptions options = exactly(16);
    options.split_share = 1e-7;
    // Some thousand drawn choices of 1e-7 a photon, at most.
    EXPECT_NEAR(share_on_receiver(setup, options), stack.passed, 1e-6) << i + 1;
  }
}

TEST(ForwardReference, orders_of_reflection_in_a_tilted_pane_land_side_by_side) {
  // At 45° the pane of 1 cm moves each order on by 2 d tan θ' cos 45°.
  const double n = kBk7;
  const double sine = std::sqrt(0.5);
  const double inner_tangent = sine / std::sqrt(n * n - sine * sine);
  const double step = 2.0 * 0.01 * inner_tangent * sine;
  const double reflected = interface_reflectance(sine, 1.0, n);
  OpticalSetup setup = beam();
  const Mat4d tilt = glm::rotate(Mat4d(1.0), glm::radians(45.0), Vec3d(0, 0, 1));
  setup.add("pane", moved(tilt, plate(0.0, 0.01)), Dielectric{n_bk7()});
  setup.aim = {{-1, 0, 0}, {0, 0, 1e-4}, {0, 1e-4, 0}};
  // Parallel light leaves on the line that a plate of its thickness shifts it to.
  const double inner_angle = std::atan(inner_tangent);
  const double shift = 0.01 * std::sin(glm::radians(45.0) - inner_angle) / std::cos(inner_angle);
  for (int order = 0; order < 3; ++order) {
    setup.receiver = {{1, shift - order * step, 0}, {0, 0, 1e-3}, {0, 1e-3, 0}};
    EXPECT_NEAR(share_on_receiver(setup),
                (1.0 - reflected) * (1.0 - reflected) * std::pow(reflected, 2 * order), kRounding)
        << order;
  }
}

TEST(ForwardReference, dyed_pane_absorbs_by_beer_and_lambert) {
  OpticalSetup setup = beam();
  setup.add("pane", plate(0.0, 0.02), Dielectric{n_bk7(), 30.0});
  const double kept = std::exp(-30.0 * 0.02);
  const double expected =
      (1.0 - kFace) * (1.0 - kFace) * kept / (1.0 - kFace * kFace * kept * kept);
  // The thickness is that of floats.
  EXPECT_NEAR(share_on_receiver(setup), expected, 1e-7);
}

TEST(ForwardReference, prism_in_minimum_deviation_bends_the_lines_as_snell_says) {
  // N-SF11, 60°, met at 63.1713°; its edge is up and the light along +X goes down.
  const auto towards = [](double angle_deg) {
    return Vec2d(std::cos(glm::radians(angle_deg)), std::sin(glm::radians(angle_deg)));
  };
  const double down_the_face_deg = 180.0 + 90.0 - 63.1713;
  const Vec2d edge = -0.05 * towards(down_the_face_deg);
  const std::vector<Vec2d> outline = {edge, edge + 0.1 * towards(down_the_face_deg),
                                      edge + 0.1 * towards(down_the_face_deg + 60.0)};
  const std::pair<double, double> lines[] = {
      {kLineF_nm, 69.25084}, {kLine_d_nm, 66.34263}, {kLineC_nm, 65.24956}};
  for (const auto& [nm, deviation_deg] : lines) {
    OpticalSetup setup;
    setup.add("prism", swept(outline, -0.05, 0.05), Dielectric{n_sf11()});
    setup.aim = {{-0.2, 0, 0}, {0, 0, 1e-7}, {0, 1e-7, 0}};
    // So far away that it does not matter where light leaves the prism: 5 cm are 3e-6°. Half the
    // wall's width is 2e-5°; deviations are rounded to half of that.
    const double far = 1e6;
    const Vec3d out(towards(-deviation_deg), 0.0);
    const Vec3d across(-out.y, out.x, 0.0);
    const double half = far * glm::radians(2e-5);
    setup.add("wall", {Rectangle{far * out, {0, 0, half}, half * across}.face()}, Wall{});
    PhotonOptions options = exactly(16);
    options.wavelength_nm = nm;
    const ForwardResult result = follow_photons(setup, options);
    const double n = n_sf11().at(nm);
    const double first = glm::radians(63.1713);
    const double inside = kPi / 3.0 - std::asin(std::sin(first) / n);
    const double passed = (1.0 - interface_reflectance(std::cos(first), 1.0, n)) *
                          (1.0 - interface_reflectance(std::cos(inside), n, 1.0));
    // After six reflections inside, 0.15 each, light leaves along the same way again: 1e-5.
    EXPECT_NEAR(result.on_body[1] / result.sent, passed, 2e-5) << nm;
    // Unpolarised at each face.
    if (nm == kLine_d_nm) {
      EXPECT_NEAR(passed, 0.721, 5e-4);
    }
  }
}

TEST(ForwardReference, right_angled_prism_reflects_totally) {
  OpticalSetup setup = beam();
  // In through the leg at x = 0, off the hypotenuse at 45°, out through the leg at y = −0.05.
  setup.add("prism", swept({{0, -0.05}, {0.1, -0.05}, {0, 0.05}}, -0.05, 0.05),
            Dielectric{n_bk7()});
  setup.add("below", {Rectangle{{0, -0.5, 0}, {0, 0, 1}, {1, 0, 0}}.face()}, Wall{});
  const ForwardResult result = follow_photons(setup, exactly());
  // What the leg reflects goes back by the same way: as in a pane, and nothing passes the oblique
  // face.
  EXPECT_NEAR(result.on_body[2] / result.sent, (1.0 - kFace) / (1.0 + kFace), kRounding);
  EXPECT_EQ(result.on_body[0], 0.0);
}

TEST(ForwardReference, corner_cube_returns_light_along_its_own_way) {
  OpticalSetup setup = optical_setup("corner_cube_sun");
  setup.lamp.direction = {-1, 0, 0};
  // A wall over the lower half only; light goes in above it and comes back turned by 180°.
  setup.bodies.back().faces = {Rectangle{{0.45, -0.5, 0}, {0, 0, 1}, {0, 0.5, 0}}.face()};
  setup.aim = {{0.2, 0.005, 0.003}, {0, 0, 1e-4}, {0, 1e-4, 0}};
  setup.receiver = {{0.45, -0.005, -0.003}, {0, 0, 2e-4}, {0, 2e-4, 0}};
  setup.cells = {1, 1};
  // What the front reflects inside makes its round twice more before it comes here again.
  EXPECT_NEAR(share_on_receiver(setup), (1.0 - kFace) * (1.0 - kFace) / (1.0 - kFace * kFace),
              1e-9);
}

TEST(ForwardReference, panes_in_contact_are_one_pane) {
  OpticalSetup setup = beam();
  setup.add("first", plate(0.0, 0.01), Dielectric{n_bk7()});
  setup.add("second", plate(0.01, 0.02), Dielectric{n_bk7()});
  EXPECT_NEAR(share_on_receiver(setup), (1.0 - kFace) / (1.0 + kFace), kRounding);
}

TEST(ForwardReference, cemented_glasses_have_one_interface_from_one_into_the_other) {
  const double flint = n_sf11().at(kLine_d_nm);
  for (const double gap : {0.0, 2e-8, 1e-6}) {
    OpticalSetup setup = beam();
    setup.add("crown", plate(0.0, 0.01), Dielectric{n_bk7()});
    setup.add("flint", plate(0.01 + gap, 0.02), Dielectric{n_sf11()});
    Stack stack;
    stack.add(kFace);
    if (gap < 1e-7) {  // Within four units in the last place of 0.5 m.
      stack.add(face_share(kBk7, flint));
    } else {
      stack.add(kFace);
      stack.add(face_share(1.0, flint));
    }
    stack.add(face_share(1.0, flint));
    PhotonOptions options = exactly(16);
    options.split_share = 1e-8;
    EXPECT_NEAR(share_on_receiver(setup, options), stack.passed, 1e-6) << gap;
  }
}

TEST(ForwardReference, plate_in_water_has_interfaces_of_water) {
  for (const bool water_first : {true, false}) {
    OpticalSetup setup = beam();
    if (water_first) setup.add("water", plate(0.0, 0.1), Dielectric{{kWater}});
    setup.add("plate", plate(0.04, 0.05, 0.4), Dielectric{n_bk7()});
    if (!water_first) setup.add("water", plate(0.0, 0.1), Dielectric{{kWater}});
    Stack stack;
    stack.add(face_share(1.0, kWater));
    stack.add(face_share(kWater, kBk7));
    stack.add(face_share(kWater, kBk7));
    stack.add(face_share(1.0, kWater));
    EXPECT_NEAR(share_on_receiver(setup), stack.passed, 1e-8) << water_first;
  }
}

TEST(ForwardReference, higher_priority_owns_the_space_where_bodies_overlap) {
  for (const int priority : {-1, 1}) {
    OpticalSetup setup = beam();
    setup.add("water", plate(0.0, 0.1), Dielectric{{kWater}});
    setup.add("glass", plate(0.05, 0.12), Dielectric{n_bk7(), 0.0, priority});
    Stack stack;
    stack.add(face_share(1.0, kWater));
    stack.add(face_share(kWater, kBk7));
    stack.add(face_share(1.0, kBk7));
    EXPECT_NEAR(share_on_receiver(setup), stack.passed, 1e-8) << priority;
  }
}

TEST(ForwardReference, pane_on_a_wall_has_a_thin_gap_before_it) {
  for (const double gap : {0.0, 0.01}) {
    OpticalSetup setup = beam();
    setup.add("pane", plate(0.5, 1.0 - gap), Dielectric{n_bk7()});
    EXPECT_NEAR(share_on_receiver(setup), (1.0 - kFace) / (1.0 + kFace), kRounding) << gap;
  }
}

TEST(ForwardReference, dyed_pane_on_a_mirror_is_one_before_a_mirror) {
  double before = 0.0;
  for (const double gap : {0.01, 0.0}) {
    OpticalSetup setup = beam();
    const Mirror metal{std::complex<double>(0.96, 6.69)};
    setup.add("mirror", {Rectangle{{0.5, 0, 0}, {0, 0, 0.4}, {0, 0.4, 0}}.face()}, metal);
    setup.add("pane", plate(0.45, 0.5 - gap, 0.3), Dielectric{n_bk7(), 20.0});
    PhotonOptions options = exactly(16);
    options.split_share = 1e-8;
    const ForwardResult result = follow_photons(setup, options);
    const double kept = std::exp(-20.0 * (0.05 - gap));
    Stack stack;
    stack.add(kFace);
    stack.add(kFace, kept);
    const double metal_share = interface_reflectance(1.0, 1.0, *metal.index);
    const double on_mirror = stack.passed / (1.0 - stack.returned_behind * metal_share);
    EXPECT_NEAR(result.on_body[1] / result.sent, on_mirror * (1.0 - metal_share), 1e-6) << gap;
    EXPECT_NE(result.on_body[1], before);
    before = result.on_body[1];
  }
}

TEST(ForwardReference, lamps_light_a_bare_wall_by_their_laws) {
  OpticalSetup setup = beam();
  setup.lamp = {LampKind::Spot, {-1, 0.3, 0}, {1, 0, 0}, 0.05, 0.2};
  setup.receiver = {{1, 0.4, 0.05}, {0, 0, 1e-3}, {0, 1e-3, 0}};
  setup.aim = {{1, 0.4, 0.05}, {0, 0, 1e-3}, {0, 1e-3, 0}};
  const Vec3d way = setup.receiver.center - setup.lamp.position;
  const double r = glm::length(way);
  const double ramp = (way.x / r - std::cos(0.2)) / (std::cos(0.05) - std::cos(0.2));
  const double intensity = std::min(1.0, ramp * ramp);
  // Over 2 mm of 2 m the cone and the squares change by 1e-3; the middle is theirs to 1e-6.
  EXPECT_NEAR(follow_photons(setup, exactly(160000)).irradiance[0], intensity * way.x / (r * r * r),
              2e-5 * intensity);
  setup.lamp.kind = LampKind::Directional;
  setup.lamp.direction = glm::normalize(Vec3d(1, 0.5, 0.2));
  EXPECT_NEAR(follow_photons(setup, exactly(160000)).irradiance[0], setup.lamp.direction.x, 1e-3);
}

class EverySetup : public testing::TestWithParam<std::string> {};

TEST_P(EverySetup, keeps_account_of_all_light) {
  PhotonOptions options;
  options.photons = 2000;
  options.split_share = 1e-3;
  const ForwardResult result = follow_photons(optical_setup(GetParam()), options);
  const double kept = std::accumulate(result.on_body.begin(), result.on_body.end(), 0.0);
  EXPECT_NEAR(kept + result.absorbed + result.escaped + result.lost, result.sent,
              1e-12 * result.sent);
  EXPECT_LE(result.lost, 1e-9 * result.sent);
}

TEST_P(EverySetup, is_lit_by_what_it_aims_at_and_by_nothing_else) {
  OpticalSetup setup = optical_setup(GetParam());
  PhotonOptions options;
  options.photons = 10000;
  const ForwardResult aimed = follow_photons(setup, options);
  setup.aim.x *= 2.0;
  setup.aim.y *= 2.0;
  options.photons = 40000;
  options.seed = 2;
  const ForwardResult wide = follow_photons(setup, options);
  const auto mean = [](const std::vector<double>& cells) {
    return std::accumulate(cells.begin(), cells.end(), 0.0) / static_cast<double>(cells.size());
  };
  for (std::size_t c = 0; c < aimed.irradiance.size(); ++c) {
    // Five standard errors of the difference; and 0.1 % for reflections of far away.
    const double error = std::hypot(aimed.standard_error[c], wide.standard_error[c]);
    EXPECT_NEAR(aimed.irradiance[c], wide.irradiance[c],
                5.0 * error + 1e-3 * mean(aimed.irradiance))
        << c;
  }
}

INSTANTIATE_TEST_SUITE_P(forward, EverySetup, testing::ValuesIn(optical_setup_names()),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace abbe::test
