#include "abbe/load/environment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "abbe/base/error.h"
#include "abbe/base/text.h"
#include "abbe/color/color.h"
#include "abbe/color/rgb_space.h"
#include "abbe/image/channels.h"
#include "abbe/image/exr/exr.h"
#include "abbe/image/raster/raster.h"

namespace abbe {
namespace {

constexpr const char* kExpected = "an equirectangular image, scene-linear RGB or spectral";

std::size_t texels_of(const Image& image) {
  return static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
}

void check_size(int width, int height, std::size_t channels, const std::string& where) {
  const std::int64_t texels = std::int64_t{width} * height;
  if (texels > kMaxEnvironmentTexels) {
    throw_input_error(where, fmt::format("{}x{} = {} texels", width, height, texels),
                      fmt::format("at most {}, as 16384x8192 has", kMaxEnvironmentTexels));
  }
  const std::int64_t values = texels * static_cast<std::int64_t>(channels);
  if (values > kMaxEnvironmentValues) {
    throw_input_error(
        where,
        fmt::format("{}x{} texels of {} channels, {} values", width, height, channels, values),
        fmt::format("at most {}", kMaxEnvironmentValues));
  }
}

// Of a texel's luminance: what matrices and filters leave of a channel that is 0.
constexpr float kNoise = 1e-3f;

// What of the values is no radiance, in words.
class Losses {
 public:
  void add_not_finite() { ++not_finite_; }
  void add_negative() { ++negative_; }
  void add_outside() { ++outside_; }
  void tell(const std::string& where, Notes& notes) const {
    if (not_finite_ > 0) {
      notes.warn(where, fmt::format("{} texels of the environment are not finite: taken as black",
                                    not_finite_));
    }
    if (negative_ > 0) {
      notes.warn(where,
                 fmt::format("{} texels of the environment have negative light: taken as none",
                             negative_));
    }
    if (outside_ > 0) {
      notes.warn(where, fmt::format("{} texels of the environment have a negative red, green or "
                                    "blue of Rec. 709: taken as none of it",
                                    outside_));
    }
  }

 private:
  std::size_t not_finite_ = 0, negative_ = 0, outside_ = 0;
};

EnvironmentImage spectral_image(const Image& image, const std::string& where, Notes& notes) {
  if (image.attributes.contains("abbe:lines")) {
    throw_input_error(where, "channels of spectral lines", "channels of bands, radiance per nm");
  }
  std::vector<std::pair<double, std::size_t>> bands;
  for (std::size_t c = 0; c < image.channel_count(); ++c) {
    if (const auto nm = spectral_channel_wavelength_nm(image.channels[c])) {
      bands.emplace_back(*nm, c);
    }
  }
  std::sort(bands.begin(), bands.end());
  EnvironmentImage result{image.width, image.height, {}, {}, {}};
  std::vector<std::size_t> places;
  for (const auto& [nm, channel] : bands) {
    const auto as_float = static_cast<float>(nm);
    if (!result.band_nm.empty() && !(as_float > result.band_nm.back())) {
      throw_input_error(where, fmt::format("two bands at {} nm", nm), "each band once");
    }
    result.band_nm.push_back(as_float);
    places.push_back(channel);
  }
  if (places.size() < 2) {
    throw_input_error(where, "a single spectral channel", "two bands at least");
  }
  check_size(image.width, image.height, places.size(), where);
  result.bands = picked_values(image, places);
  Losses losses;
  for (std::size_t t = 0; t < texels_of(image); ++t) {
    bool is_finite = true, is_negative = false;
    for (std::size_t b = 0; b < places.size(); ++b) {
      float& value = result.bands[t * places.size() + b];
      is_finite = is_finite && std::isfinite(value);
      is_negative = is_negative || value < 0.0f;
      if (!(value >= 0.0f && std::isfinite(value))) value = 0.0f;
    }
    if (!is_finite) {
      losses.add_not_finite();
    } else if (is_negative) {
      losses.add_negative();
    }
  }
  losses.tell(where, notes);
  return result;
}

EnvironmentImage color_image(const Image& image, const Mat3d& to_rec709, const std::string& where,
                             Notes& notes) {
  std::vector<std::size_t> places;
  if (const auto rgb = rgb_channels(image)) {
    places.assign(rgb->begin(), rgb->end());
  } else if (const auto grey = image.channel_index("Y")) {
    places.assign(3, *grey);
  } else if (image.channel_count() < 3 && image.channel_count() > 0) {
    places.assign(3, 0);
  } else {
    throw_input_error(where, "neither R, G, B, a grey Y nor spectral channels S0", kExpected,
                      image.channels);
  }
  check_size(image.width, image.height, 3, where);
  EnvironmentImage result{image.width, image.height, {}, {}, {}};
  result.rgb_rec709.resize(texels_of(image));
  const Vec3d weights(rec709_to_xyz()[0][1], rec709_to_xyz()[1][1], rec709_to_xyz()[2][1]);
  const bool converts = to_rec709 != Mat3d(1.0);
  Losses losses;
  for (std::size_t t = 0; t < result.rgb_rec709.size(); ++t) {
    const float* texel = image.pixels.data() + t * image.channel_count();
    Vec3f color(texel[places[0]], texel[places[1]], texel[places[2]]);
    if (converts) color = Vec3f(to_rec709 * Vec3d(color));
    const double luminance = glm::dot(weights, Vec3d(color));
    if (!std::isfinite(luminance)) {
      losses.add_not_finite();
      color = Vec3f(0.0f);
    } else if (luminance < 0.0) {
      losses.add_negative();
      color = Vec3f(0.0f);
    } else if (std::min({color.r, color.g, color.b}) < -kNoise * static_cast<float>(luminance)) {
      losses.add_outside();
    }
    result.rgb_rec709[t] = color;
  }
  losses.tell(where, notes);
  return result;
}

Mat3d to_rec709(const ExrHeader& header, const std::string& where) {
  if (!header.chromaticities) return Mat3d(1.0);
  const auto& xy = *header.chromaticities;
  const auto at = [&xy](std::size_t i) { return Vec2d(xy[2 * i], xy[2 * i + 1]); };
  const auto matrix = rgb_to_rec709({at(0), at(1), at(2)}, at(3));
  if (!matrix) throw_input_error(where, "chromaticities that span no colours", "RGB primaries");
  return *matrix;
}

// Files speak of themselves; a scene's error is at its place.
template <typename Read>
auto read_at(const std::string& where, const Read& read) {
  try {
    return read();
  } catch (const Error& error) {
    ErrorDetail detail = error.detail();
    if (detail.where != where) detail.where = where;
    throw Error(std::move(detail));
  }
}

}  // namespace

EnvironmentImage read_environment_image(const std::filesystem::path& file, const std::string& where,
                                        Notes& notes) {
  const bool is_exr = lower_case(file.extension().string()) == ".exr";
  EnvironmentImage result;
  if (is_exr) {
    const ExrHeader header = read_at(where, [&file] { return read_exr_header(file); });
    std::size_t channels = 0;
    for (const ExrHeader::Channel& channel : header.channels) {
      channels += spectral_channel_wavelength_nm(channel.name).has_value() ? 1 : 0;
    }
    const bool is_spectral = channels > 0;
    check_size(header.width, header.height, is_spectral ? channels : 3, where);
    const Image image = read_at(where, [&file] { return read_exr(file); });
    result = is_spectral ? spectral_image(image, where, notes)
                         : color_image(image, to_rec709(header, where), where, notes);
  } else {
    Image image = read_at(where, [&file] { return read_raster(file); });
    if (read_at(where, [&file] { return raster_has_codes(file); })) {
      notes.warn(where, "whole numbers instead of light: taken as sRGB codes, of at most 1 cd/m2");
      for (float& value : image.pixels) value = static_cast<float>(srgb_decode(value));
    }
    result = color_image(image, Mat3d(1.0), where, notes);
  }
  if (result.width != 2 * result.height) {
    notes.warn(where, fmt::format("{}x{} texels: an equirectangular image is twice as wide as "
                                  "high; it is stretched to all directions",
                                  result.width, result.height));
  }
  return result;
}

}  // namespace abbe
