#include "abbe/film/film.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "abbe/base/error.h"
#include "abbe/base/parallel.h"
#include "abbe/image/exr/exr.h"

namespace abbe {
namespace {

constexpr int kLongestSide_px = 65536;
constexpr std::int64_t kMaxPixels = std::int64_t{1} << 28;

std::string text_of(const Vec2i& size) {
  return std::to_string(size.x) + "x" + std::to_string(size.y);
}

std::string text_of(const PixelRect& rect) {
  return std::to_string(rect.x0) + "," + std::to_string(rect.y0) + "," + std::to_string(rect.x1) +
         "," + std::to_string(rect.y1);
}

std::vector<std::string> channel_names(const FilmOptions& options) {
  std::vector<std::string> names{"R", "G", "B"};
  for (int band = 0; options.bands && band < options.bands->count(); ++band) {
    names.push_back(spectral_channel_name(options.bands->center_nm(band)));
  }
  for (const double nm : options.lines_nm) names.push_back(spectral_channel_name(nm));
  for (const AovChannel& aov : options.aovs) names.push_back(aov.name);
  return names;
}

void check_crop(const FilmOptions& options) {
  const Vec2i& size = options.full_size;
  if (size.x < 1 || size.y < 1 || size.x > kLongestSide_px || size.y > kLongestSide_px) {
    throw_usage_error("size", text_of(size), "1x1 to 65536x65536 pixels");
  }
  const PixelRect crop = options.crop.value_or(PixelRect{0, 0, size.x, size.y});
  if (crop.x0 < 0 || crop.y0 < 0 || crop.x1 > size.x || crop.y1 > size.y || crop.x0 >= crop.x1 ||
      crop.y0 >= crop.y1) {
    throw_usage_error("crop", text_of(crop),
                      "X0,Y0,X1,Y1 with X0 < X1 and Y0 < Y1 inside " + text_of(size));
  }
  if (std::int64_t{crop.width()} * crop.height() > kMaxPixels) {
    throw_usage_error("size", text_of(Vec2i{crop.width(), crop.height()}),
                      "at most 2^28 pixels; `crop` renders a part");
  }
}

// The options, checked before anything is made of them.
const FilmOptions& checked(const FilmOptions& options) {
  check_film(options);
  return options;
}

}  // namespace

AovChannel aov_channel(const std::string& name) {
  if (name == "samples") return {name, AovRule::Count};
  constexpr std::array<const char*, 8> kMeans{"albedo.",  "cost.",      "direct.",    "ambient.",
                                              "emitted.", "reflected.", "refracted.", "T."};
  const bool is_mean = std::any_of(kMeans.begin(), kMeans.end(), [&name](const char* prefix) {
    return name.starts_with(prefix);
  });
  return {name, is_mean ? AovRule::Mean : AovRule::First};
}

void check_film(const FilmOptions& options) {
  check_crop(options);
  if (options.bands) check_bands(*options.bands);
  if (options.bands && !options.lines_nm.empty()) {
    throw_usage_error("lines_nm", "`bands` beside it", "one of the two");
  }
  std::set<std::string> names;
  for (const std::string& name : channel_names(options)) {
    if (!names.insert(name).second) {
      throw_usage_error("aovs", "the channel " + name + " twice", "each channel once");
    }
  }
}

Film::Film(const FilmOptions& options)
    : options_(checked(options)),
      crop_(options.crop.value_or(PixelRect{0, 0, options.full_size.x, options.full_size.y})),
      spectral_count_(options.bands ? static_cast<std::size_t>(options.bands->count())
                                    : options.lines_nm.size()),
      extra_count_(spectral_count_ + options.aovs.size()) {
  const auto pixels =
      static_cast<std::size_t>(crop_.width()) * static_cast<std::size_t>(crop_.height());
  const auto allocate = [&](Sums& sums) {
    sums.xyz.resize(pixels * 3);
    sums.extra.resize(pixels * extra_count_);
    sums.count.resize(pixels);
  };
  allocate(positive_);
  if (options_.weight_magnitude > 1.0f) allocate(negative_);
}

std::size_t Film::pixel_index(const Vec2i& pixel) const {
  return static_cast<std::size_t>(pixel.y - crop_.y0) * static_cast<std::size_t>(crop_.width()) +
         static_cast<std::size_t>(pixel.x - crop_.x0);
}

void Film::add(const Vec2i& pixel, float weight, const Vec3f& xyz, std::span<const float> bands,
               std::span<const float> aovs) {
  // One NaN would spoil its pixel for good.
  if (!std::isfinite(xyz.x) || !std::isfinite(xyz.y) || !std::isfinite(xyz.z)) {
    dropped_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  const std::size_t index = pixel_index(pixel);
  const bool is_first =
      positive_.count[index] == 0 && (negative_.count.empty() || negative_.count[index] == 0);
  Sums& sums = weight < 0.0f && !negative_.count.empty() ? negative_ : positive_;
  for (int c = 0; c < 3; ++c)
    sums.xyz[index * 3 + static_cast<std::size_t>(c)] += static_cast<double>(xyz[c]);
  const float share = 1.0f / static_cast<float>(++sums.count[index]);

  float* extra = sums.extra.data() + index * extra_count_;
  for (std::size_t i = 0; i < bands.size(); ++i) extra[i] += (bands[i] - extra[i]) * share;
  extra += spectral_count_;
  // First values are kept with the positive samples, whatever the sign of the first sample.
  float* first = positive_.extra.data() + index * extra_count_ + spectral_count_;
  for (std::size_t i = 0; i < aovs.size(); ++i) {
    if (options_.aovs[i].rule == AovRule::Mean) {
      extra[i] += (aovs[i] - extra[i]) * share;
    } else if (is_first && options_.aovs[i].rule == AovRule::First) {
      first[i] = aovs[i];
    }
  }
}

void Film::develop_pixel(std::size_t pixel, const Mat3d& xyz_to_rec709, float* out) const {
  const auto count_in = [pixel](const Sums& sums) {
    return sums.count.empty() ? 0u : sums.count[pixel];
  };
  const std::uint32_t positive_count = count_in(positive_);
  const std::uint32_t negative_count = count_in(negative_);
  const auto mean_xyz = [pixel](const Sums& sums) {
    const double* sum = sums.xyz.data() + pixel * 3;
    return Vec3d(sum[0], sum[1], sum[2]) / static_cast<double>(sums.count[pixel]);
  };

  // S₊·mean₊ − S₋·mean₋ with S₊ − S₋ = 1, in the form that returns equal means unchanged.
  const double negative_share = 0.5 * (static_cast<double>(options_.weight_magnitude) - 1.0);
  const auto combined = [negative_share](const auto& mean_positive, const auto& mean_negative) {
    return mean_positive + negative_share * (mean_positive - mean_negative);
  };

  Vec3d xyz(0.0);
  if (positive_count > 0 && negative_count > 0) {
    xyz = combined(mean_xyz(positive_), mean_xyz(negative_));
  } else if (positive_count > 0) {
    xyz = mean_xyz(positive_);
  } else if (negative_count > 0) {
    xyz = mean_xyz(negative_);
  }
  const Vec3d rgb_rec709 = xyz_to_rec709 * xyz;
  for (int c = 0; c < 3; ++c) *out++ = static_cast<float>(rgb_rec709[c]);

  const float* positive = positive_.extra.data() + pixel * extra_count_;
  const float* negative =
      negative_.extra.empty() ? nullptr : negative_.extra.data() + pixel * extra_count_;
  for (std::size_t i = 0; i < extra_count_; ++i) {
    const AovRule rule =
        i >= spectral_count_ ? options_.aovs[i - spectral_count_].rule : AovRule::Mean;
    if (rule == AovRule::Count) {
      *out++ = static_cast<float>(positive_count + negative_count);
    } else if (rule == AovRule::First || negative_count == 0) {
      *out++ = positive[i];
    } else if (positive_count == 0) {
      *out++ = negative[i];
    } else {
      *out++ = static_cast<float>(
          combined(static_cast<double>(positive[i]), static_cast<double>(negative[i])));
    }
  }
}

Image Film::develop(const FilmDevelopment& development) const {
  Image image;
  image.width = crop_.width();
  image.height = crop_.height();
  image.data_origin = {crop_.x0, crop_.y0};
  image.full_size = options_.full_size;
  image.channels = channel_names(options_);

  image.attributes = development.attributes;
  if (spectral_count_ > 0) {
    image.attributes["spectralLayoutVersion"] = std::string("1.0");
    image.attributes["emissiveUnits"] = std::string("W.m^-2.sr^-1");
    image.attributes["EV"] = 0.0f;
  }

  const auto width = static_cast<std::size_t>(image.width);
  image.pixels.resize(width * static_cast<std::size_t>(image.height) * image.channel_count());
  parallel_for(0, static_cast<std::size_t>(image.height), 8, [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t pixel = y * width + x;
      develop_pixel(pixel, development.xyz_to_rec709,
                    image.pixels.data() + pixel * image.channel_count());
    }
  });
  return image;
}

std::size_t Film::sample_count(const Vec2i& pixel) const {
  const std::size_t index = pixel_index(pixel);
  return positive_.count[index] + (negative_.count.empty() ? 0u : negative_.count[index]);
}

std::size_t Film::bytes() const {
  std::size_t bytes = 0;
  for (const Sums* sums : {&positive_, &negative_}) {
    bytes += sums->xyz.size() * sizeof(double) + sums->extra.size() * sizeof(float) +
             sums->count.size() * sizeof(std::uint32_t);
  }
  return bytes;
}

}  // namespace abbe
