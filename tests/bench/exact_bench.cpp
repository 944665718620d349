/// What exact light through flat glass costs, as ratios of CPU times in one run: newton and the
/// floor below gems. Prints a table and writes it as JSON.
///
///   abbe_exact_bench [--repeats=N] [--out=FILE]
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>

#include "abbe/base/isa.h"
#include "abbe/session/prepare.h"
#include "bench/render_jobs.h"
#include "support/gems.h"
#include "support/scene_builder.h"

namespace abbe::bench {
namespace {

Subject newton(bool has_fog) {
  Notes notes;
  PreparedScene prepared = prepare_scene({.file = ABBE_SOURCE_DIR "/scenes/newton/newton.gltf"},
                                         test::catalogue(), notes);
  if (!has_fog) prepared.scene.fog.reset();
  return {"newton", prepared.scene, prepared.chosen_camera()};
}

/// The floor around and below a gem, and a lamp above; the camera sees the floor alone.
Subject floor_below(const ConvexShape& gem) {
  Subject subject;
  subject.name = fmt::format("gem of {} facets", gem.planes.size());
  Scene& scene = subject.scene;
  test::add_square(scene, test::add(scene, test::matte(Vec3f(1.0f))), 20.0,
                   test::rotation({1, 0, 0}, -90.0));
  test::add_shape(scene, {.name = "gem", .geometry = gem},
                  test::add(scene, test::glass("glass/schott/N-SF66")),
                  test::translation({0, 1.6, 0}));
  scene.lights.push_back(test::point_light({1.2, 5.0, 0.8}, 300.0));
  subject.camera = test::orthographic_camera({0, 0.02, 0}, {0, 0, 0}, 3.0, 3.0);
  return subject;
}

RenderSettings without_caustics(RenderSettings settings) {
  settings.caustics = false;
  return settings;
}

int run(int argc, char** argv) {
  int repeats = 3;
  std::string out = "out/bench-exact.json";
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument.starts_with("--repeats=")) repeats = std::stoi(argument.substr(10));
    if (argument.starts_with("--out=")) out = argument.substr(6);
  }
  apply_isa_from_environment();
  Bench bench(repeats, out);
  bench.json()["isa"] = isa_level();
  const Subject clear = newton(false);
  const Subject foggy = newton(true);
  const RenderSettings picture = settings_of(Mode::Spectral, {320, 180}, 4);
  bench.compare("newton_off", "newton without fog: exact over off",
                {job("exact", clear, picture), job("off", clear, without_caustics(picture))});
  RenderSettings few = picture;
  few.wavelengths.count = 4;
  bench.compare("newton_wavelengths", "newton without fog: 16 wavelengths over 4",
                {job("16", clear, picture), job("4", clear, few)});
  bench.compare("newton_fog", "newton: fog over no fog",
                {job("fog", foggy, picture), job("clear", clear, picture)});
  const std::array<ConvexShape, 3> gems = {test::single_cut(), test::simple_brilliant(),
                                           test::brilliant()};
  const RenderSettings floor = settings_of(Mode::Spectral, {48, 48}, 4);
  std::vector<Subject> subjects;
  for (const ConvexShape& gem : gems) subjects.push_back(floor_below(gem));
  std::vector<double> ratios;
  for (const Subject& subject : subjects) {
    ratios.push_back(bench.compare(
        subject.name, subject.name + ", its floor: exact over off",
        {job("exact", subject, floor), job("off", subject, without_caustics(floor))}));
  }
  for (std::size_t i = 1; i < ratios.size(); ++i) {
    const double facets =
        static_cast<double>(gems[i].planes.size()) / static_cast<double>(gems[i - 1].planes.size());
    const double exponent = std::log(ratios[i] / ratios[i - 1]) / std::log(facets);
    fmt::print("from {} to {} facets the cost grows with the power {:.2f}\n",
               gems[i - 1].planes.size(), gems[i].planes.size(), exponent);
    bench.json()[fmt::format("growth_{}", gems[i].planes.size())] = exponent;
  }
  bench.write();
  return 0;
}

}  // namespace
}  // namespace abbe::bench

int main(int argc, char** argv) {
  return abbe::bench::run(argc, argv);
}
