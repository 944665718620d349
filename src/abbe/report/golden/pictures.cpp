#include "abbe/report/golden/pictures.h"

#include <filesystem>
#include <system_error>

#include "abbe/base/file.h"
#include "abbe/display/display.h"
#include "abbe/image/channels.h"
#include "abbe/image/metrics/heat_map.h"
#include "abbe/image/metrics/metrics.h"
#include "abbe/image/raster/raster.h"
#include "abbe/report/pack.h"

namespace abbe {
namespace {

std::string png_uri(const Image& rgb_encoded) {
  // The writer of pictures knows files alone.
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() /
      ("abbe-" +
       std::to_string(
           hash_bytes(rgb_encoded.pixels.data(), rgb_encoded.pixels.size() * sizeof(float))) +
       ".png");
  write_raster(file, rgb_encoded);
  const std::string uri = data_uri(file, "image/png");
  std::error_code error;
  std::filesystem::remove(file, error);
  return uri;
}

}  // namespace

Image with_channels(const Image& image, const std::vector<std::string>& channels,
                    const std::string& where) {
  if (image.channels == channels) return image;
  Image result = same_window(image, channels);
  result.pixels = picked_values(image, channel_places(image, channels, where));
  return result;
}

std::vector<std::pair<std::string, std::string>> failure_pictures(
    const Image& reference, const Image& image, const CompareThresholds& thresholds) {
  std::vector<std::pair<std::string, std::string>> pictures;
  if (reference.width != image.width || reference.height != image.height) return pictures;
  if (rgb_channels(reference)) {
    pictures.emplace_back("reference", png_uri(to_display(reference, {})));
    pictures.emplace_back("result", png_uri(to_display(image, {})));
  }
  const double scale = thresholds.hard_fail > 0.0 ? thresholds.hard_fail : 1e-6;
  pictures.emplace_back("difference", png_uri(heat_map(max_error_map(image, reference),
                                                       reference.width, reference.height, scale)));
  return pictures;
}

}  // namespace abbe
