#include "abbe/film/spectral_image.h"

#include <algorithm>

#include "abbe/base/constants.h"
#include "abbe/base/error.h"
#include "abbe/base/parallel.h"
#include "abbe/image/channels.h"
#include "abbe/image/exr/exr.h"

namespace abbe {
namespace {

struct Band {
  double center_nm = 0.0;
  std::size_t channel = 0;
};

std::vector<Band> bands_of(const Image& image) {
  std::vector<Band> bands;
  for (std::size_t c = 0; c < image.channel_count(); ++c) {
    if (const auto nm = spectral_channel_wavelength_nm(image.channels[c])) {
      bands.push_back({*nm, c});
    }
  }
  std::sort(bands.begin(), bands.end(),
            [](const Band& a, const Band& b) { return a.center_nm < b.center_nm; });
  return bands;
}

// What radiance of 1 in a band does to the observer.
std::vector<Vec3d> responses_of_bands(const Image& image, const std::vector<Band>& bands,
                                      const Observer& observer) {
  std::vector<Vec3d> responses;
  if (image.attributes.contains("abbe:lines")) {
    for (const Band& band : bands) {
      responses.push_back(kLuminousEfficacy_lm_per_W * Vec3d(observer.x_bar.value(band.center_nm),
                                                             observer.y_bar.value(band.center_nm),
                                                             observer.z_bar.value(band.center_nm)));
    }
    return responses;
  }
  if (bands.size() < 2) {
    throw_input_error("", "a single spectral channel, " + image.channels[bands.front().channel],
                      "two bands at least: their distance is their width");
  }
  for (std::size_t i = 0; i < bands.size(); ++i) {
    const double here = bands[i].center_nm;
    const double below = i > 0 ? here - bands[i - 1].center_nm : bands[1].center_nm - here;
    const double above =
        i + 1 < bands.size() ? bands[i + 1].center_nm - here : here - bands[i - 1].center_nm;
    responses.push_back(responses_of(Spectrum::tabulated({here - 0.5 * below, here + 0.5 * above},
                                                         {1.0, 1.0}, OutsideTable::Zero),
                                     observer));
  }
  return responses;
}

}  // namespace

bool has_spectrum(const Image& image) {
  return std::any_of(image.channels.begin(), image.channels.end(), [](const std::string& channel) {
    return spectral_channel_wavelength_nm(channel).has_value();
  });
}

Image developed(const Image& spectral, const DevelopmentOptions& options,
                const Observer& photometer, const Spectrum& d65) {
  const std::vector<Band> bands = bands_of(spectral);
  if (bands.empty()) {
    throw_input_error("", "an image without spectral channels", "channels S0.<nm>nm",
                      spectral.channels);
  }
  const Observer& observer = options.observer ? *options.observer : photometer;
  const Mat3d to_rec709 = responses_to_rec709(options, photometer, d65);
  std::vector<Vec3d> rgb_rec709_of_band = responses_of_bands(spectral, bands, observer);
  for (Vec3d& response : rgb_rec709_of_band) response = to_rec709 * response;

  Image image = same_window(spectral, {"R", "G", "B"});
  const std::size_t pixels =
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  image.pixels.resize(3 * pixels);
  parallel_for(0, pixels, 1024, [&](std::size_t p) {
    const float* values = spectral.pixels.data() + p * spectral.channel_count();
    Vec3d sum(0.0);
    for (std::size_t i = 0; i < bands.size(); ++i) {
      sum += static_cast<double>(values[bands[i].channel]) * rgb_rec709_of_band[i];
    }
    for (int c = 0; c < 3; ++c) {
      image.pixels[3 * p + static_cast<std::size_t>(c)] = static_cast<float>(sum[c]);
    }
  });
  return image;
}

}  // namespace abbe
