#include "abbe/world/light/environment.h"

#include <algorithm>
#include <cmath>

#include "abbe/base/constants.h"
#include "abbe/color/color.h"
#include "abbe/color/uplift/uplift.h"

namespace abbe {
namespace {

constexpr float kFloatPi = static_cast<float>(kPi);

// Bands are linear between their wavelengths and 0 beyond the first and the last.
float between_bands(const std::vector<float>& band_nm, const float* values, float nm) {
  if (nm < band_nm.front() || nm > band_nm.back()) return 0.0f;
  const auto above = std::upper_bound(band_nm.begin(), band_nm.end(), nm);
  if (above == band_nm.end()) return values[band_nm.size() - 1];
  const auto i = static_cast<std::size_t>(above - band_nm.begin());
  const float share = (nm - band_nm[i - 1]) / (band_nm[i] - band_nm[i - 1]);
  return (1.0f - share) * values[i - 1] + share * values[i];
}

// The colour of each band's share of a spectrum.
std::vector<Vec3d> colors_of_bands(const EnvironmentImage& image, const LaneModel& lanes) {
  std::vector<double> nm(image.band_nm.begin(), image.band_nm.end());
  std::vector<Vec3d> colors;
  for (std::size_t band = 0; band < nm.size(); ++band) {
    std::vector<double> values(nm.size(), 0.0);
    values[band] = 1.0;
    const Spectrum share =
        nm.size() == 1 ? Spectrum() : Spectrum::tabulated(nm, values, OutsideTable::Zero);
    colors.push_back(rec709_of_emission(share, lanes.film_observer(), lanes.development()));
  }
  return colors;
}

}  // namespace

WorldEnvironment::WorldEnvironment(std::shared_ptr<const Environment> source,
                                   const LaneModel& lanes, Rows& rows)
    : source_(std::move(source)),
      width_(source_->image.width),
      height_(source_->image.height),
      turn_(static_cast<float>(source_->rotation_deg / 360.0)),
      is_rgb_(lanes.is_rgb(Cause::Lamps)) {
  const EnvironmentImage& image = source_->image;
  const bool has_bands = !image.band_nm.empty();
  // What a lamp of that spectrum is in each lane; lanes of spectral lines have none of it.
  Spectrum white = has_bands           ? Spectrum::constant(1.0)
                   : source_->spectrum ? source_->spectrum->spectrum
                                       : lanes.d65();
  if (has_bands && is_rgb_) white = lanes.d65();
  std::vector<float> row =
      has_bands && !is_rgb_ ? lanes.emission(white) : lanes.emission(white, 1.0);
  for (float& value : row) value *= static_cast<float>(source_->scale);
  white_ = rows.add(row);
  abscissa_ = rows.add(lanes.uplift_abscissa());
  if (lanes.uplift() == Uplift::MallettYuksel) {
    for (int c = 0; c < 3; ++c) basis_[c] = rows.add(lanes.uplift_basis(c));
  }
  if (!has_bands || is_rgb_) tabulate_colors(lanes);
  tabulate_cells();
}

void WorldEnvironment::tabulate_colors(const LaneModel& lanes) {
  const EnvironmentImage& image = source_->image;
  const std::size_t count = static_cast<std::size_t>(width_) * height_;
  const std::size_t bands = image.band_nm.size();
  std::vector<Vec3d> of_bands;
  if (bands > 0) of_bands = colors_of_bands(image, lanes);
  texels_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    Vec3f rgb(0.0f);
    if (bands == 0) {
      rgb = image.rgb_rec709[i];
    } else {
      Vec3d sum(0.0);
      for (std::size_t band = 0; band < bands; ++band) {
        sum += static_cast<double>(image.bands[i * bands + band]) * of_bands[band];
      }
      rgb = Vec3f(sum);
    }
    if (is_rgb_) {
      texels_[i] = Vec4f(glm::max(rgb, 0.0f), 1.0f);
      continue;
    }
    // The scale rule for unbounded colours: see uplift_emission.
    const float scale = 2.0f * std::max({rgb.x, rgb.y, rgb.z, 0.0f});
    const Vec3f color = scale > 0.0f ? rgb / scale : Vec3f(0.0f);
    const Vec3f coefficients = lanes.uplift() == Uplift::JakobHanika
                                   ? uplift_rec709_from_table(color)
                                   : glm::clamp(color, 0.0f, 1.0f);
    texels_[i] = Vec4f(coefficients, scale);
  }
}

// Parts between texel centres, in which the radiance is bilinear; half as high at the poles. Small
// images have more parts, so that what faces away from a surface is told from what does not.
void WorldEnvironment::tabulate_cells() {
  const EnvironmentImage& image = source_->image;
  const std::size_t bands = image.band_nm.size();
  const std::size_t count = static_cast<std::size_t>(width_) * height_;
  std::vector<float> light(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (bands == 0) {
      const Vec3f c = glm::max(image.rgb_rec709[i], 0.0f);
      light[i] = 0.2f * c.x + 0.7f * c.y + 0.1f * c.z;
    } else {
      for (std::size_t band = 0; band < bands; ++band) light[i] += image.bands[i * bands + band];
    }
  }
  const int finer = width_ < 64 ? 2 * ((64 + 2 * width_ - 1) / (2 * width_)) : 1;
  const int columns = width_ * finer;
  std::vector<float> row_limits = {0.0f};
  for (int k = 1; k < 2 * height_ * finer; ++k) {
    const bool is_limit = finer > 1 ? k % 2 == 0 : k % 2 == 1;
    if (is_limit) {
      row_limits.push_back(static_cast<float>(k) / static_cast<float>(2 * height_ * finer));
    }
  }
  row_limits.push_back(1.0f);
  const std::size_t rows = row_limits.size() - 1;
  // The radiance at the corners of the parts; columns are counted from the first texel's centre.
  const auto at = [&](int column, float v) {
    const float x = static_cast<float>(column) / static_cast<float>(finer);
    const float y =
        std::clamp(v * static_cast<float>(height_) - 0.5f, 0.0f, static_cast<float>(height_ - 1));
    const int x0 = static_cast<int>(x);
    const int y0 = static_cast<int>(y);
    const float fx = x - static_cast<float>(x0);
    const float fy = y - static_cast<float>(y0);
    const auto texel = [&](int i, int j) {
      return light[static_cast<std::size_t>(std::min(j, height_ - 1)) * width_ + i % width_];
    };
    return (1.0f - fy) * ((1.0f - fx) * texel(x0, y0) + fx * texel(x0 + 1, y0)) +
           fy * ((1.0f - fx) * texel(x0, y0 + 1) + fx * texel(x0 + 1, y0 + 1));
  };
  std::vector<float> parts;
  parts.reserve(static_cast<std::size_t>(columns) * rows);
  for (std::size_t row = 0; row < rows; ++row) {
    const float top = row_limits[row], bottom = row_limits[row + 1];
    for (int column = 0; column < columns; ++column) {
      parts.push_back(0.25f * (at(column, top) + at(column + 1, top) + at(column, bottom) +
                               at(column + 1, bottom)));
    }
  }
  cells_ = LightCells(std::move(parts), columns, std::move(row_limits),
                      0.5f / static_cast<float>(width_) - 0.5f - turn_);
}

WorldEnvironment::Taps WorldEnvironment::taps(const Vec3f& direction) const {
  const float turns = std::atan2(direction.z, direction.x) / (2.0f * kFloatPi) + 0.5f + turn_;
  const float u = turns - std::floor(turns);
  const float v = std::acos(std::clamp(direction.y, -1.0f, 1.0f)) / kFloatPi;
  const float x = u * static_cast<float>(width_) - 0.5f;
  const float y =
      std::clamp(v * static_cast<float>(height_) - 0.5f, 0.0f, static_cast<float>(height_ - 1));
  const float x0 = std::floor(x);
  const float fx = x - x0;
  const int row = static_cast<int>(y);
  const float fy = y - static_cast<float>(row);
  const int left = (static_cast<int>(x0) + width_) % width_;
  const int right = (left + 1) % width_;
  const int below = std::min(row + 1, height_ - 1);
  const auto texel = [&](int i, int j) { return static_cast<std::size_t>(j) * width_ + i; };
  return {{texel(left, row), texel(right, row), texel(left, below), texel(right, below)},
          {(1.0f - fx) * (1.0f - fy), fx * (1.0f - fy), (1.0f - fx) * fy, fx * fy}};
}

void WorldEnvironment::radiance(const LaneModel& lanes, const Rows& rows, int set,
                                const Vec3f& direction, float* out) const {
  const Taps at = taps(direction);
  const int stride = lanes.lane_stride();
  const float* white = rows.at(white_, set);
  std::fill(out, out + stride, 0.0f);
  const EnvironmentImage& image = source_->image;
  for (int tap = 0; tap < 4; ++tap) {
    const float weight = at.weight[tap];
    if (!(weight > 0.0f)) continue;
    if (texels_.empty()) {
      const float* values = image.bands.data() + at.texel[tap] * image.band_nm.size();
      for (int lane = 0; lane < lanes.lane_count(); ++lane) {
        out[lane] += weight * between_bands(image.band_nm, values, lanes.wavelength_nm(set, lane));
      }
      continue;
    }
    const Vec4f& c = texels_[at.texel[tap]];
    if (is_rgb_) {
      for (int lane = 0; lane < stride; ++lane) out[lane] += weight * c[lanes.channel_of(lane)];
    } else if (lanes.uplift() == Uplift::MallettYuksel) {
      for (int i = 0; i < 3; ++i) {
        const float* curve = rows.at(basis_[i], set);
        for (int lane = 0; lane < stride; ++lane) out[lane] += weight * c.w * c[i] * curve[lane];
      }
    } else {
      const float* s = rows.at(abscissa_, set);
      for (int lane = 0; lane < stride; ++lane) {
        const float x = (c.x * s[lane] + c.y) * s[lane] + c.z;
        out[lane] += weight * c.w * (0.5f + 0.5f * (x / std::sqrt(1.0f + x * x)));
      }
    }
  }
  for (int lane = 0; lane < stride; ++lane) out[lane] *= white[lane];
}

std::shared_ptr<const WorldEnvironment> tabulate_environment(const Scene& scene,
                                                             const LaneModel& lanes, Rows& rows) {
  if (!scene.environment || !(scene.environment->scale > 0.0)) return nullptr;
  return std::make_shared<const WorldEnvironment>(scene.environment, lanes, rows);
}

}  // namespace abbe
