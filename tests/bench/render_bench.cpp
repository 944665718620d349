/// Whole renders as ratios: spectral over RGB, threads over one thread, packets over the older ways
/// to carry wavelengths, and POV-Ray. Every pair is rendered in turn, several times (POV-Ray's
/// once), and the ratio is of the least CPU times. Prints a table and writes it as JSON.
///
///   abbe_render_bench [--repeats=N] [--out=FILE] [--povray]
#include <fmt/format.h>
#include <sys/resource.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "abbe/base/isa.h"
#include "abbe/session/prepare.h"
#include "bench/render_jobs.h"
#include "support/gems.h"
#include "support/scene_builder.h"

namespace abbe::bench {
namespace {

Subject hero() {
  Notes notes;
  const PreparedScene prepared =
      prepare_scene({.file = ABBE_SOURCE_DIR "/scenes/prism/prism.gltf"}, test::catalogue(), notes);
  return {"prism", prepared.scene, prepared.chosen_camera()};
}

/// A brilliant of dense flint over a white floor, in a dark room with ten lamps to reflect.
Subject diamond() {
  Subject subject;
  subject.name = "diamond";
  Scene& scene = subject.scene;
  Instance gem;
  Shape shape;
  shape.material = test::add(scene, test::glass("glass/schott/N-SF66"));
  shape.geometry = test::brilliant();
  gem.what = shape;
  scene.instances.push_back(gem);
  test::add_square(scene, test::add(scene, test::matte(Vec3f(0.5f))), 20.0,
                   test::translation({0, -1, 0}) * test::rotation({1, 0, 0}, -90.0));
  const std::uint32_t lamp = test::add(scene, test::emitter(Vec3f(8.0f)));
  for (int k = 0; k < 10; ++k) {
    const Mat4d turn =
        test::rotation({0, 1, 0}, 36.0 * k) * test::rotation({1, 0, 0}, 25.0 + 6 * k);
    test::add_square(scene, lamp, 0.6, turn * test::translation({0, 0, -8}));
  }
  scene.lights.push_back(test::point_light({3, 7, 4}, 300.0));
  subject.camera = test::perspective_camera({0, 4.2, 2.6}, {0, -0.1, 0}, 24.0);
  return subject;
}

void compare_modes(Bench& bench, const Subject& subject, const std::string& key,
                   const std::string& what, const Vec2i& size,
                   const std::optional<PixelRect>& crop) {
  RenderSettings spectral = settings_of(Mode::Spectral, size, 4);
  spectral.crop = crop;
  for (const bool caustics : {true, false}) {
    spectral.caustics = caustics;
    RenderSettings rgb = spectral;
    rgb.mode = Mode::Rgb;
    bench.compare(key + (caustics ? "" : "_straight"),
                  what + (caustics ? "" : ", straight shadow rays"),
                  {job("spectral", subject, spectral), job("rgb", subject, rgb)});
  }
}

void compare_carriers(Bench& bench, const Subject& subject, const std::string& key,
                      const Vec2i& size, const std::optional<PixelRect>& crop) {
  RenderSettings packets = settings_of(Mode::Spectral, size, 2);
  packets.crop = crop;
  RenderSettings clusters = packets, single = packets;
  clusters.cluster_lanes = 4;
  single.cluster_lanes = 1;
  bench.compare(key + "_single_rays", subject.name + ": a ray per wavelength over packets",
                {job("single", subject, single), job("packets", subject, packets)});
  bench.compare(key + "_clusters", subject.name + ": clusters of four over packets",
                {job("clusters", subject, clusters), job("packets", subject, packets)});
}

void report_fans(Bench& bench, const Subject& subject, const std::string& key, const Vec2i& size) {
  const RenderSettings settings = settings_of(Mode::Spectral, size, 4);
  const LitWorld world = test::make_world(subject.scene, settings);
  const Timed timed = timed_render(world, subject.camera, settings);
  const IntegratorStats& s = timed.stats;
  fmt::print("{}: {:.3f} million spread fans/s, queue at most {} fans of {}, {:.2f} MB\n",
             subject.name, 1e-6 * static_cast<double>(s.spread_fans) / timed.cpu_seconds,
             s.peak_queued_fans, timed.queue_capacity,
             1e-6 * static_cast<double>(s.peak_queue_bytes));
  auto& json = bench.json()[key];
  json = {{"spread_fans_per_second", static_cast<double>(s.spread_fans) / timed.cpu_seconds},
          {"peak_queued_fans", s.peak_queued_fans},
          {"queue_capacity", timed.queue_capacity},
          {"peak_queue_bytes", s.peak_queue_bytes}};
  fmt::print("  lanes per spread fan by depth:");
  for (std::size_t depth = 0; depth < IntegratorStats::kDepths; ++depth) {
    if (s.spread_fans_at[depth] == 0) continue;
    const double lanes = static_cast<double>(s.spread_lanes_at[depth]) /
                         static_cast<double>(s.spread_fans_at[depth]);
    fmt::print(" {}:{:.1f}", depth, lanes);
    json["lanes_by_depth"][std::to_string(depth)] = lanes;
  }
  fmt::print("\n");
}

/// Wall time: what a second thread is for.
void compare_threads(Bench& bench, const Subject& subject, int repeats) {
  std::vector<Job> jobs;
  for (const int threads : {1, 2}) {
    RenderSettings settings = settings_of(Mode::Spectral, {960, 540}, 1);
    settings.threads = threads;
    auto world = std::make_shared<LitWorld>(test::make_world(subject.scene, settings));
    jobs.push_back(
        {fmt::format("{} thread{}", threads, threads > 1 ? "s" : ""), [world, &subject, settings] {
           return timed_render(*world, subject.camera, settings).wall_seconds;
         }});
  }
  const std::vector<double> seconds = least_seconds(jobs, repeats);
  bench.report("threads", "prism: two threads over one, wall time", seconds[0] / seconds[1], jobs,
               seconds);
}

Job povray_job(int bands) {
  return {fmt::format("POV-Ray, {} bands", bands), [bands] {
            const double before = cpu_seconds(RUSAGE_CHILDREN);
            const std::string command = fmt::format(
                "povray +I{}/tests/bench/prism.pov +W1280 +H720 -A +WT1 -D -F Declare=Bands={} "
                "> /dev/null 2>&1",
                ABBE_SOURCE_DIR, bands);
            if (std::system(command.c_str()) != 0) {
              fmt::print("POV-Ray failed: {}\n", command);
              return 1e30;
            }
            return cpu_seconds(RUSAGE_CHILDREN) - before;
          }};
}

/// POV-Ray has straight shadow rays and ends rays below 1/255: over abbe as it renders by default,
/// and as POV-Ray does.
void compare_povray(Bench& bench, const Subject& subject) {
  std::vector<double> growth(3, 1.0);  // Of each job, from few wavelengths to many.
  for (const int wavelengths : {8, 32}) {
    RenderSettings settings = settings_of(Mode::Spectral, {1280, 720}, 1);
    settings.wavelengths.count = wavelengths;
    RenderSettings alike = settings;
    alike.caustics = false;
    alike.cutoff = 1.0 / 255.0;
    alike.drop = true;
    const std::vector<Job> jobs = {povray_job(wavelengths),
                                   job(fmt::format("abbe, {}", wavelengths), subject, settings),
                                   job("as POV-Ray", subject, alike)};
    const std::vector<double> seconds = least_seconds(jobs, 1);
    const auto report = [&](const std::string& key, const std::string& how, std::size_t ours) {
      bench.report(
          fmt::format("povray_{}{}", wavelengths, key),
          fmt::format("prism 1280x720, {} wavelengths{}: POV-Ray over abbe", wavelengths, how),
          seconds[0] / seconds[ours], {jobs[0], jobs[ours]}, {seconds[0], seconds[ours]});
    };
    report("", "", 1);
    report("_alike", ", alike", 2);
    for (std::size_t j = 0; j < growth.size(); ++j) growth[j] = seconds[j] / growth[j];
  }
  fmt::print("from 8 to 32: POV-Ray {:.2f} times as long, abbe {:.2f}, alike {:.2f}\n", growth[0],
             growth[1], growth[2]);
  bench.json()["povray_growth"] = {
      {"povray", growth[0]}, {"abbe", growth[1]}, {"alike", growth[2]}};
}

int run(int argc, char** argv) {
  int repeats = 3;
  std::string out = "out/bench-render.json";
  bool has_povray = false;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument.starts_with("--repeats=")) repeats = std::stoi(argument.substr(10));
    if (argument.starts_with("--out=")) out = argument.substr(6);
    if (argument == "--povray") has_povray = true;
  }
  apply_isa_from_environment();
  Bench bench(repeats, out);
  bench.json()["isa"] = isa_level();
  const Subject prism = hero();
  const Subject gem = diamond();
  const PixelRect inside{380, 150, 580, 300};
  compare_modes(bench, prism, "prism", "prism: spectral over rgb", {480, 270}, std::nullopt);
  compare_modes(bench, prism, "prism_fills", "prism that fills the frame: spectral over rgb",
                {960, 540}, inside);
  compare_modes(bench, gem, "diamond", "diamond: spectral over rgb", {160, 120}, std::nullopt);
  {
    RenderSettings few = settings_of(Mode::Spectral, {480, 270}, 2);
    RenderSettings many = few;
    few.wavelengths.count = 8;
    many.wavelengths.count = 32;
    bench.compare("wavelengths", "prism: 32 wavelengths over 8",
                  {job("32", prism, many), job("8", prism, few)});
    many.caustics = few.caustics = false;
    bench.compare("wavelengths_straight", "prism: 32 wavelengths over 8, straight shadow rays",
                  {job("32", prism, many), job("8", prism, few)});
  }
  compare_threads(bench, prism, repeats);
  compare_carriers(bench, prism, "prism", {480, 270}, std::nullopt);
  compare_carriers(bench, gem, "diamond", {160, 120}, std::nullopt);
  report_fans(bench, prism, "prism_fans", {480, 270});
  report_fans(bench, gem, "diamond_fans", {160, 120});
  if (has_povray) compare_povray(bench, prism);
  bench.write();
  return 0;
}

}  // namespace
}  // namespace abbe::bench

int main(int argc, char** argv) {
  return abbe::bench::run(argc, argv);
}
