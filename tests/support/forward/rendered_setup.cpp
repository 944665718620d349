#include "support/forward/rendered_setup.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "abbe/base/constants.h"
#include "abbe/image/exr/exr.h"
#include "abbe/load/gltf.h"
#include "support/forward/setup_gltf.h"
#include "support/scene_builder.h"

namespace abbe::test {
namespace {

// Along the side of a cell. The average of parallel light over a pixel is good where the pixel is
// smaller than what the light falls on.
constexpr int kPixels = 16;

Scene loaded(const OpticalSetup& setup) {
  std::string folder = (std::filesystem::temp_directory_path() / "abbe-setup-XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr) std::abort();
  const std::filesystem::path file = std::filesystem::path(folder) / "setup.gltf";
  std::ofstream(file) << gltf_text(setup);
  Notes notes;
  Scene scene = load_gltf(file, catalogue(), {}, notes);
  std::filesystem::remove_all(folder);
  return scene;
}

}  // namespace

RenderSettings setup_settings(const OpticalSetup& setup, double wavelength_nm) {
  RenderSettings settings = small_settings();
  settings.size = setup.cells;
  settings.wavelengths.exact_nm = {wavelength_nm};
  return settings;
}

std::vector<double> rendered_irradiance(const OpticalSetup& setup, const RenderSettings& settings) {
  RenderSettings finer = settings;
  finer.size = settings.size * kPixels;
  finer.samples_per_pixel = std::max(1, settings.samples_per_pixel / (kPixels * kPixels));
  const Image image = render(loaded(setup), finer).image;
  // A lamp of equal energy and 1 lx, by the observer's sum over 360 to 830 nm in steps of 1 nm; a
  // matte wall of albedo 0.8.
  const double irradiance_per_lux = 1.0 / (kLuminousEfficacy_lm_per_W * 106.856917);
  const double radiance = 0.8 / kPi * irradiance_per_lux * setup.unit;
  const std::string channel = spectral_channel_name(settings.wavelengths.exact_nm.front());
  std::vector<double> cells(static_cast<std::size_t>(settings.size.x * settings.size.y));
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const auto cell = static_cast<std::size_t>(y / kPixels * settings.size.x + x / kPixels);
      cells[cell] +=
          static_cast<double>(pixel(image, x, y, channel)) / (radiance * kPixels * kPixels);
    }
  }
  return cells;
}

}  // namespace abbe::test
