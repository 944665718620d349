#include "render/band_weights.h"

#include <algorithm>

namespace abbe {

BandWeights::BandWeights(const WavelengthQuadrature& quadrature, const BandOptions& bands,
                         int samples_per_pixel)
    : quadrature_(quadrature),
      bands_(bands),
      samples_(static_cast<float>(samples_per_pixel)),
      total_(static_cast<std::size_t>(bands.count)) {
  const int stride = quadrature.lane_stride();
  band_of_.assign(static_cast<std::size_t>(quadrature.set_count()) * stride, -1);
  for (int set = 0; set < quadrature.set_count(); ++set) {
    const std::span<const float> nm = quadrature.wavelengths_nm(set);
    for (int lane = 0; lane < quadrature.lane_count(); ++lane) {
      const std::optional<int> band = bands.index_of(static_cast<double>(nm[lane]));
      if (band) band_of_[static_cast<std::size_t>(set) * stride + lane] = *band;
    }
  }
}

void BandWeights::set_pixel(std::span<const int> sets) {
  std::fill(total_.begin(), total_.end(), 0.0f);
  const int stride = quadrature_.lane_stride();
  for (const int set : sets) {
    const std::span<const float> weights = quadrature_.weights_nm(set);
    const int* band_of = band_of_.data() + static_cast<std::size_t>(set) * stride;
    for (int lane = 0; lane < quadrature_.lane_count(); ++lane) {
      if (band_of[lane] >= 0 && quadrature_.kinds()[lane] == LaneKind::Continuous) {
        total_[band_of[lane]] += weights[lane];
      }
    }
  }
  empty_.clear();
  for (int band = 0; band < bands_.count; ++band) {
    if (!(total_[band] > 0.0f)) empty_.push_back(band);
  }
}

void BandWeights::apply(int set, std::span<const float> radiance, std::span<float> bands) const {
  std::fill(bands.begin(), bands.end(), 0.0f);
  const int stride = quadrature_.lane_stride();
  const std::span<const float> weights = quadrature_.weights_nm(set);
  const std::span<const float> nm = quadrature_.wavelengths_nm(set);
  const int* band_of = band_of_.data() + static_cast<std::size_t>(set) * stride;
  int last_continuous = -1;
  std::size_t next_empty = 0;
  // Continuous lanes come in order of wavelength: empty bands are filled while passing by.
  const auto fill_empty_below = [&](int lane) {
    while (next_empty < empty_.size()) {
      const double center_nm = bands_.center_nm(empty_[next_empty]);
      if (lane >= 0 && center_nm >= static_cast<double>(nm[lane])) return;
      float value = 0.0f;
      if (last_continuous >= 0 && lane >= 0) {
        const double span_nm =
            static_cast<double>(nm[lane]) - static_cast<double>(nm[last_continuous]);
        const float f = span_nm > 0.0
                            ? static_cast<float>(
                                  (center_nm - static_cast<double>(nm[last_continuous])) / span_nm)
                            : 0.0f;
        value = (1.0f - f) * radiance[last_continuous] + f * radiance[lane];
      } else if (lane >= 0) {
        value = radiance[lane];
      } else if (last_continuous >= 0) {
        value = radiance[last_continuous];
      }
      bands[empty_[next_empty++]] += value;
    }
  };
  for (int lane = 0; lane < quadrature_.lane_count(); ++lane) {
    const int band = band_of[lane];
    if (quadrature_.kinds()[lane] != LaneKind::Continuous) {
      if (band >= 0)
        bands[band] += radiance[lane] * weights[lane] / static_cast<float>(bands_.step_nm);
      continue;
    }
    fill_empty_below(lane);
    last_continuous = lane;
    if (band >= 0) bands[band] += radiance[lane] * weights[lane] * samples_ / total_[band];
  }
  fill_empty_below(-1);
}

}  // namespace abbe
