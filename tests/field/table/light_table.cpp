/// Prints the light of optical setups: by abbe, by abbe with straight shadow rays, and by the
/// forward reference.
///
///   abbe_light_table [--photons N] [--samples N] [--chain N] [--nm W] [--cells] [--list]
///                    [--write FOLDER] [PART-OF-A-NAME]...
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <numeric>
#include <string>
#include <vector>

#include "support/forward/photons.h"
#include "support/forward/rendered_setup.h"
#include "support/forward/setup_gltf.h"
#include "support/forward/setups.h"

namespace abbe::test {
namespace {

struct Options {
  PhotonOptions photons;
  std::optional<int> samples;
  std::optional<int> chain;
  bool prints_cells = false, only_lists = false;
  std::string folder;
  std::vector<std::string> parts;
};

Options options_of(const std::vector<std::string>& arguments) {
  Options options;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& argument = arguments[i];
    const auto value = [&] { return arguments.at(++i); };
    if (argument == "--photons")
      options.photons.photons = std::stoull(value());
    else if (argument == "--nm")
      options.photons.wavelength_nm = std::stod(value());
    else if (argument == "--samples")
      options.samples = std::stoi(value());
    else if (argument == "--chain")
      options.chain = std::stoi(value());
    else if (argument == "--write")
      options.folder = value();
    else if (argument == "--cells")
      options.prints_cells = true;
    else if (argument == "--list")
      options.only_lists = true;
    else
      options.parts.push_back(argument);
  }
  return options;
}

struct Column {
  std::vector<double> cells;
  double seconds = 0.0;

  double mean() const {
    return std::accumulate(cells.begin(), cells.end(), 0.0) / static_cast<double>(cells.size());
  }
  /// The greatest distance of a cell, over the mean of what is right.
  double worst(const Column& right) const {
    double most = 0.0;
    for (std::size_t i = 0; i < cells.size(); ++i)
      most = std::max(most, std::abs(cells[i] - right.cells[i]));
    return most / std::max(right.mean(), 1e-9);
  }
};

template <typename Make>
Column timed(const Make& make) {
  const auto start = std::chrono::steady_clock::now();
  Column column;
  column.cells = make();
  column.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return column;
}

Column rendered(const OpticalSetup& setup, const Options& options, bool caustics) {
  RenderSettings settings = setup_settings(setup, options.photons.wavelength_nm);
  settings.samples_per_pixel = options.samples.value_or(setup.samples);
  settings.caustics = caustics;
  if (options.chain) settings.inner_reflections = *options.chain;
  return timed([&] { return rendered_irradiance(setup, settings); });
}

void print_cells(const OpticalSetup& setup, const char* title, const std::vector<double>& cells) {
  fmt::print("  {}\n", title);
  for (std::size_t i = 0; i < cells.size(); ++i)
    fmt::print(" {:.5f}{}", cells[i],
               (i + 1) % static_cast<std::size_t>(setup.cells.x) ? "" : "\n");
}

void print_row(const OpticalSetup& setup, const Options& options) {
  ForwardResult forward;
  const Column right = timed([&] {
    forward = follow_photons(setup, options.photons);
    return forward.irradiance;
  });
  const Column exact = rendered(setup, options, true);
  const Column straight = rendered(setup, options, false);
  const double error =
      *std::max_element(forward.standard_error.begin(), forward.standard_error.end());
  fmt::print(
      "{:25} {:8.5f} ± {:5.2f} % | {:8.5f} {:+8.2f} % {:7.2f} % | {:8.5f} {:+8.2f} % | "
      "{:.1f} {:.1f} {:.1f} s\n",
      setup.name, right.mean(), 100.0 * error / std::max(right.mean(), 1e-9), exact.mean(),
      100.0 * (exact.mean() / right.mean() - 1.0), 100.0 * exact.worst(right), straight.mean(),
      100.0 * (straight.mean() / right.mean() - 1.0), right.seconds, exact.seconds,
      straight.seconds);
  if (forward.lost > 1e-6 * forward.sent)
    fmt::print("  the reference lost {:.1e} of the light\n", forward.lost / forward.sent);
  if (!options.prints_cells) return;
  print_cells(setup, "forward", right.cells);
  print_cells(setup, "abbe", exact.cells);
  print_cells(setup, "abbe, straight", straight.cells);
}

void run(const Options& options) {
  if (!options.only_lists && options.folder.empty())
    fmt::print("{:25} {:>8} {:>9} | {:>8} {:>10} {:>9} | {:>8} {:>10} | seconds of each\n", "E/E0",
               "forward", "cell", "abbe", "mean", "worst", "off", "mean");
  for (const std::string& name : optical_setup_names()) {
    const auto is_part = [&](const std::string& part) {
      return name.find(part) != std::string::npos;
    };
    if (!options.parts.empty() && std::none_of(options.parts.begin(), options.parts.end(), is_part))
      continue;
    const OpticalSetup setup = optical_setup(name);
    if (options.only_lists)
      fmt::print("{}\n", name);
    else if (!options.folder.empty())
      std::ofstream(options.folder + "/" + name + ".gltf") << gltf_text(setup);
    else
      print_row(setup, options);
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace abbe::test

int main(int argc, char** argv) {
  try {
    abbe::test::run(abbe::test::options_of({argv + 1, argv + argc}));
  } catch (const std::exception& error) {
    fmt::print(stderr, "abbe_light_table: {}\n", error.what());
    return 2;
  }
  return 0;
}
