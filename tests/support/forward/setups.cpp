#include "support/forward/setups.h"

#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <stdexcept>

#include "support/gems.h"

namespace abbe::test {
namespace {

const Dielectric kGlass{n_bk7()};
const Dielectric kFlint{n_sf11()};
const Dielectric kWet{{kWater}};

Rectangle facing_back(const Vec3d& center, double half) {
  return {center, {0, 0, half}, {0, half, 0}};
}

/// Where a ray of the lamp to a place passes the plane of an x, and what lights it there.
Vec3d on_the_way(const SetupLamp& lamp, const Vec3d& to, double x) {
  const Vec3d along = lamp.kind == LampKind::Directional ? lamp.direction : to - lamp.position;
  return to + along * ((x - to.x) / along.x);
}

void set_lamp(OpticalSetup& setup, LampKind kind, const Vec3d& position, const Vec3d& direction) {
  setup.lamp.kind = kind;
  setup.lamp.position = position;
  setup.lamp.direction = glm::normalize(direction);
}

/// States figures in what the lamp gives at right angles after some way.
void set_unit(OpticalSetup& setup, double way_m) {
  setup.unit = setup.lamp.kind == LampKind::Directional ? 1.0 : 1.0 / (way_m * way_m);
}

/// Puts the receiver where straight light through a place meets the wall at x = 0.5 m.
void look_behind(OpticalSetup& setup, const Vec3d& through, double half) {
  setup.receiver = facing_back(on_the_way(setup.lamp, through, 0.5), half);
  set_unit(setup, glm::distance(setup.receiver.center, setup.lamp.position));
}

/// A wall of sides 2 `half`, with its front towards −X.
FlatFaces wall(const Vec3d& center, const Vec2d& half) {
  return {Rectangle{center, {0, 0, half.y}, {0, half.x, 0}}.face()};
}

OpticalSetup bare(LampKind kind) {
  return before_wall(kind);
}

template <int kCount>
OpticalSetup row_of_panes(LampKind kind) {
  return panes(kind, kCount, 0.042);
}

OpticalSetup panes_in_contact(LampKind kind) {
  return panes(kind, 2, 0.0);
}
OpticalSetup three_in_contact(LampKind kind) {
  return panes(kind, 3, 0.0);
}
OpticalSetup panes_1_um_apart(LampKind kind) {
  return panes(kind, 2, 1e-6);
}

OpticalSetup cemented(LampKind kind) {
  OpticalSetup setup = before_wall(kind);
  setup.add("crown", box({-0.204, 0, 0}, {0.004, 1.0, 1.0}), kGlass);
  setup.add("flint", box({-0.196, 0, 0}, {0.004, 1.0, 1.0}), kFlint);
  return setup;
}

OpticalSetup dyed_pane(LampKind kind) {
  OpticalSetup setup = before_wall(kind);
  setup.add("dyed", box({-0.2, 0, 0}, {0.008, 1.0, 1.0}), Dielectric{n_bk7(), 40.0});
  return setup;
}

OpticalSetup plate_in_water(LampKind kind) {
  OpticalSetup setup = before_wall(kind);
  setup.add("water", box({0, 0, 0}, {0.05, 0.3, 0.3}), kWet);
  setup.add("plate", box({0.005, 0, 0}, {0.004, 0.2, 0.2}), kGlass);
  return setup;
}

OpticalSetup nested_boxes(LampKind kind) {
  OpticalSetup setup = before_wall(kind);
  setup.add("water", box({0, 0, 0}, {0.06, 0.3, 0.3}), kWet);
  setup.add("flint", box({0, 0, 0}, {0.04, 0.28, 0.28}), kFlint);
  setup.add("crown", box({0, 0, 0}, {0.02, 0.26, 0.26}), kGlass);
  return setup;
}

OpticalSetup hollow_box(LampKind kind) {
  OpticalSetup setup = before_wall(kind);
  setup.add(
      "hollow",
      joined(box({0, 0, 0}, {0.05, 0.3, 0.3}), turned_over(box({0, 0, 0}, {0.042, 0.292, 0.292}))),
      kGlass);
  return setup;
}

OpticalSetup aquarium(LampKind kind) {
  OpticalSetup setup = before_wall(kind);
  const FlatFaces inside = box({0, 0, 0}, {0.042, 0.292, 0.292});
  setup.add("glass", joined(box({0, 0, 0}, {0.05, 0.3, 0.3}), turned_over(inside)), kGlass);
  setup.add("water", inside, kWet);
  return setup;
}

FlatFaces hexagonal_rod(double radius, double low, double high) {
  std::vector<Vec2d> outline;
  for (int k = 0; k < 6; ++k) {
    const double azimuth = glm::radians(60.0 * k + 7.0);
    outline.emplace_back(radius * std::cos(azimuth), radius * std::sin(azimuth));
  }
  // From along Z to along Y.
  return moved(glm::rotate(Mat4d(1.0), glm::radians(-90.0), Vec3d(1, 0, 0)),
               swept(outline, low, high));
}

OpticalSetup vessel_of_water(LampKind kind) {
  OpticalSetup setup = before_wall(kind);
  setup.add("vessel", cup({0, 0, 0}, {0.06, 0.06, 0.06}, {0.052, 0.052}, -0.05), kGlass);
  setup.add("water", box({0, -0.01, 0}, {0.052, 0.04, 0.052}), kWet);
  setup.aim = facing_back(on_the_way(setup.lamp, {0, 0, 0}, -0.1), 0.12);
  setup.samples = 1024;
  setup.photons = 400000;
  return setup;
}

OpticalSetup vessel_with_rod(LampKind kind) {
  OpticalSetup setup = vessel_of_water(kind);
  setup.add("rod", hexagonal_rod(0.012, -0.045, 0.02), kGlass);
  setup.samples = 4096;  // The rod throws narrow bright lines.
  return setup;
}

/// A rod that reaches out of the water and owns the space where it is in it.
OpticalSetup vessel_with_stirrer(LampKind kind) {
  OpticalSetup setup = vessel_of_water(kind);
  Dielectric glass = kGlass;
  glass.priority = 1;
  setup.add("stirrer", hexagonal_rod(0.012, -0.045, 0.1), glass);
  return setup;
}

OpticalSetup mirror_then_pane(LampKind kind) {
  OpticalSetup setup = before_wall(kind);
  const double half = 0.2 * M_SQRT1_2;
  setup.add("mirror", {Rectangle{{-0.2, 0, 0}, {half, -half, 0}, {0, 0, 0.2}}.face()}, Mirror{});
  setup.add("pane", box({0.2, 0, 0}, {0.004, 0.15, 0.5}), kGlass);
  setup.add("blind", wall({0.0, 0.9, 0}, {0.7, 1.0}), Wall{});
  set_lamp(setup, kind, {-0.25, 1.2, 0.02}, {-0.02, -1, 0.03});
  setup.receiver.center = {0.5, 0.0, 0.03};
  set_unit(setup, 1.9);
  setup.aim = {{-0.2, 0.2, 0.0}, {0.1, 0, 0}, {0, 0, 0.1}};
  setup.photons = 300000;
  return setup;
}

OpticalSetup periscope(LampKind kind) {
  OpticalSetup setup = before_wall(kind);
  const double half = 0.15 * M_SQRT1_2;
  const Vec3d across(0, 0, 0.15);
  setup.add("lower", {Rectangle{{0, 0, 0}, {half, half, 0}, across}.face()}, Mirror{});
  setup.add("upper", {Rectangle{{0, 0.3, 0}, {half, half, 0}, across}.face()},
            Mirror{std::complex<double>(0.96, 6.69)});
  setup.add("blind", wall({-0.15, 0.85, 0}, {0.7, 1.0}), Wall{});
  set_lamp(setup, kind, {-1.0, 0.03, 0.03}, {1.0, 0.05, 0.03});
  setup.receiver = facing_back({0.5, 0.32, 0.02}, 0.03);
  set_unit(setup, 1.8);
  setup.aim = facing_back(on_the_way(setup.lamp, {0, 0, 0}, -0.2), 0.1);
  setup.photons = 300000;
  return setup;
}

/// Of 60°, its edge up, along Z.
FlatFaces dispersing_prism() {
  const double half = 0.06;
  return swept({{-half, -0.05}, {half, -0.05}, {0.0, half * std::sqrt(3.0) - 0.05}}, -0.1, 0.1);
}

OpticalSetup prism(LampKind kind) {
  OpticalSetup setup = before_wall(kind);
  setup.add("prism", dispersing_prism(), kGlass);
  setup.add("blind", wall({-0.1, -0.55, 0}, {0.5, 1.0}), Wall{});
  setup.lamp.position.y = -0.15;
  setup.receiver = facing_back({0.5, -0.28, 0.02}, 0.06);
  setup.aim = {{-0.1, 0.01, 0}, {0, 0, 0.12}, {0, 0.08, 0}};
  setup.samples = 1024;
  return setup;
}

OpticalSetup prism_in_water(LampKind kind) {
  OpticalSetup setup = before_wall(kind);
  setup.add("water", box({0, 0, 0}, {0.12, 0.15, 0.15}), kWet);
  setup.add("prism", dispersing_prism(), kFlint);
  setup.add("blind", wall({-0.13, -0.55, 0}, {0.5, 1.0}), Wall{});
  setup.lamp.position.y = -0.15;
  setup.receiver = facing_back({0.5, -0.2, 0.02}, 0.06);
  setup.aim = {{-0.13, 0.055, 0}, {0, 0, 0.17}, {0, 0.12, 0}};
  setup.samples = 1024;
  return setup;
}

OpticalSetup corner_cube(LampKind kind) {
  OpticalSetup setup;
  setup.receiver = facing_back({0.45, 0.055, 0.0135}, 0.01);
  set_lamp(setup, kind, {1.0, 0.15, 0.03}, {-1.0, -0.15, -0.03});
  set_unit(setup, 1.45);
  // A corner of a cube, cut off by its front at x = 0.
  const double edge = 0.05;
  std::array<Vec3d, 3> front;
  for (std::size_t k = 0; k < 3; ++k) {
    const double azimuth = 2.0 * M_PI * static_cast<double>(k) / 3.0 + 0.1;
    front[k] = edge * std::sqrt(2.0 / 3.0) * Vec3d(0, std::cos(azimuth), std::sin(azimuth));
  }
  const Vec3d corner(-edge / std::sqrt(3.0), 0, 0);
  setup.add("corner cube",
            {{front[0], front[1], front[2]},
             {front[1], front[0], corner},
             {front[2], front[1], corner},
             {front[0], front[2], corner}},
            kGlass);
  // Its upper edge lets light pass to the cube; what comes back falls below it.
  setup.add("wall", wall({0.45, 0.0675 - 0.3, 0}, {0.3, 0.6}), Wall{});
  setup.aim = facing_back({0.01, 0.0015, 0.0003}, 0.045);
  setup.samples = 1024;
  setup.photons = 600000;
  return setup;
}

/// A brilliant, its table to the lamp, a little turned away.
void add_gem(OpticalSetup& setup) {
  Mat4d place = glm::rotate(Mat4d(1.0), glm::radians(12.0), Vec3d(0, 1, 0));
  place = glm::rotate(place, glm::radians(97.0), Vec3d(0, 0, 1));
  place = glm::scale(place, Vec3d(0.1));
  setup.add("brilliant", moved(place, convex(brilliant().planes)), Dielectric{{kDiamond}});
}

/// Its shadow.
OpticalSetup diamond(LampKind kind) {
  OpticalSetup setup = before_wall(kind);
  add_gem(setup);
  look_behind(setup, {0, 0, 0}, 0.2);
  setup.aim = facing_back(on_the_way(setup.lamp, {0, 0, 0}, -0.15), 0.25);
  setup.samples = 1024;
  return setup;
}

/// What it throws onto a floor that sees no lamp.
OpticalSetup diamond_over_floor(LampKind kind) {
  OpticalSetup setup;
  set_lamp(setup, kind, {-1.0, -0.5, 0.02}, {1.0, 0.4, 0.05});
  set_unit(setup, 1.5);
  add_gem(setup);
  setup.receiver = {{-0.1, -0.35, 0}, {0.3, 0, 0}, {0, 0, -0.3}};
  setup.add("floor", {Rectangle{{0, -0.35, 0}, {0.6, 0, 0}, {0, 0, -0.6}}.face()}, Wall{});
  setup.aim = facing_back(on_the_way(setup.lamp, {0, 0, 0}, -0.12), 0.13);
  setup.samples = 1024;
  setup.photons = 800000;
  return setup;
}

OpticalSetup cube_on_floor(LampKind kind) {
  OpticalSetup setup;
  setup.receiver = {{0.045, 0, 0.003}, {0.01, 0, 0}, {0, 0, -0.01}};
  set_lamp(setup, kind, {-0.5, 0.6, -0.03}, {1.0, -1.1, 0.08});
  set_unit(setup, glm::distance(setup.receiver.center, setup.lamp.position));
  setup.add("floor", {Rectangle{{0, 0, 0}, {1, 0, 0}, {0, 0, -1}}.face()}, Wall{});
  setup.add("cube", box({0, 0.03, 0}, {0.03, 0.03, 0.03}), kGlass);
  setup.eye_m = 0.005;
  setup.aim = {{-0.02, 0.07, 0}, {0.06, 0, 0}, {0, 0, 0.05}};
  setup.samples = 1024;
  setup.photons = 800000;
  return setup;
}

struct Named {
  const char* name;
  OpticalSetup (*make)(LampKind);
};

const Named kSetups[] = {
    {"bare", bare},
    {"panes_1", row_of_panes<1>},
    {"panes_2", row_of_panes<2>},
    {"panes_3", row_of_panes<3>},
    {"panes_4", row_of_panes<4>},
    {"panes_5", row_of_panes<5>},
    {"panes_6", row_of_panes<6>},
    {"panes_in_contact_2", panes_in_contact},
    {"panes_in_contact_3", three_in_contact},
    {"panes_1_um_apart", panes_1_um_apart},
    {"cemented", cemented},
    {"dyed_pane", dyed_pane},
    {"plate_in_water", plate_in_water},
    {"nested_boxes", nested_boxes},
    {"hollow_box", hollow_box},
    {"aquarium", aquarium},
    {"vessel_of_water", vessel_of_water},
    {"vessel_with_rod", vessel_with_rod},
    {"vessel_with_stirrer", vessel_with_stirrer},
    {"mirror_then_pane", mirror_then_pane},
    {"periscope", periscope},
    {"prism", prism},
    {"prism_in_water", prism_in_water},
    {"corner_cube", corner_cube},
    {"diamond", diamond},
    {"diamond_over_floor", diamond_over_floor},
    {"cube_on_floor", cube_on_floor},
};

const std::pair<LampKind, const char*> kLamps[] = {{LampKind::Directional, "_sun"},
                                                   {LampKind::Point, "_point"}};

}  // namespace

OpticalSetup before_wall(LampKind kind) {
  OpticalSetup setup;
  setup.add("wall", wall({0.5, 0, 0}, {1, 1}), Wall{});
  set_lamp(setup, kind, {-1.0, 0.03, 0.02}, {1.0, 0.12, 0.05});
  look_behind(setup, {0, 0, 0}, 0.04);
  // Wider than the receiver, for light that comes by reflections.
  setup.aim = facing_back(on_the_way(setup.lamp, {0, 0, 0}, -0.3),
                          kind == LampKind::Directional ? 0.1 : 0.05);
  return setup;
}

OpticalSetup panes(LampKind kind, int count, double gap_m) {
  OpticalSetup setup = before_wall(kind);
  // So wide that what their rims throw falls beside the receiver.
  for (int i = 0; i < count; ++i)
    setup.add("pane " + std::to_string(i + 1),
              box({-0.2 + i * (0.008 + gap_m), 0, 0}, {0.004, 1.0, 1.0}), kGlass);
  return setup;
}

std::vector<std::string> optical_setup_names() {
  std::vector<std::string> names;
  for (const Named& named : kSetups)
    for (const auto& [kind, suffix] : kLamps) names.push_back(std::string(named.name) + suffix);
  return names;
}

OpticalSetup optical_setup(const std::string& name) {
  for (const Named& named : kSetups) {
    for (const auto& [kind, suffix] : kLamps) {
      if (named.name + std::string(suffix) != name) continue;
      OpticalSetup setup = named.make(kind);
      setup.name = name;
      return setup;
    }
  }
  throw std::invalid_argument("no optical setup " + name);
}

}  // namespace abbe::test
