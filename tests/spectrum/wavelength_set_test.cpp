#include "abbe/spectrum/wavelength_set.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "abbe/base/constants.h"
#include "abbe/base/error.h"
#include "abbe/load/spectra/catalogue.h"
#include "abbe/math/random.h"
#include "abbe/math/sampling.h"
#include "abbe/spectrum/wavelength_density.h"

namespace abbe {
namespace {

struct Lamps {
  Observer observer;
  Spectrum d65, a, e, fl2, fl11;
};

const Lamps& data() {
  static const Lamps result = [] {
    const Catalogue catalogue = Catalogue::standard();
    return Lamps{catalogue.observer(),
                 catalogue.illuminant("D65"),
                 catalogue.illuminant("illuminant/A"),
                 catalogue.illuminant("illuminant/E"),
                 catalogue.illuminant("FL2"),
                 catalogue.illuminant("FL11")};
  }();
  return result;
}

WavelengthQuadrature quadrature(int count, const std::vector<Spectrum>& lamps) {
  WavelengthOptions options;
  options.count = count;
  return WavelengthQuadrature(options, data().observer, lamps);
}

// The set of a sample by the plain sequence of shifts, scrambled by the low 8 bits of `scramble`.
int set_of(const WavelengthQuadrature& sets, std::uint32_t sample, std::uint32_t scramble) {
  return sets.set_of(unit_float(reverse_bits(sample) ^ (scramble << 24)));
}

// Tristimulus values of the light on a flat reflector, as a film adds them up over samples.
class Eye {
 public:
  Eye(const WavelengthQuadrature& sets, const Spectrum& light)
      : sets_(sets),
        weights_(sets.observer_weights(data().observer)),
        light_(sets.tabulate_emission(light)) {}

  Vec3d sample(int set) const {
    Vec3d xyz(0.0);
    const int stride = sets_.lane_stride();
    for (int channel = 0; channel < 3; ++channel) {
      for (int lane = 0; lane < stride; ++lane) {
        xyz[channel] +=
            double{weights_[(set * 3 + channel) * stride + lane]} * light_[set * stride + lane];
      }
    }
    return xyz;
  }
  Vec3d mean(int samples, std::uint32_t scramble) const {
    Vec3d sum(0.0);
    for (int i = 0; i < samples; ++i) {
      sum += sample(set_of(sets_, static_cast<std::uint32_t>(i), scramble));
    }
    return sum / static_cast<double>(samples);
  }

 private:
  const WavelengthQuadrature& sets_;
  std::vector<float> weights_, light_;
};

double worst_ratio(const Vec3d& xyz, const Vec3d& exact) {
  double worst = 0.0;
  for (int i = 0; i < 3; ++i) worst = std::max(worst, std::abs(xyz[i] / exact[i] - 1.0));
  return worst;
}

// Chroma C*ab of a nearly neutral colour relative to its white.
double chroma(const Vec3d& xyz, const Vec3d& white) {
  const double x = std::cbrt(xyz.x / white.x), y = std::cbrt(xyz.y / white.y),
               z = std::cbrt(xyz.z / white.z);
  return std::hypot(500.0 * (x - y), 200.0 * (y - z));
}

TEST(WavelengthQuadrature, lanes_are_padded_to_four_up_to_eight_and_then_to_sixteen) {
  const std::vector<std::pair<int, int>> expected{{1, 4},  {3, 4},   {4, 4},   {5, 8},   {8, 8},
                                                  {9, 16}, {16, 16}, {17, 32}, {33, 48}, {64, 64}};
  for (const auto& [count, stride] : expected) {
    const WavelengthQuadrature sets = quadrature(count, {data().d65});
    EXPECT_EQ(sets.lane_count(), count);
    EXPECT_EQ(sets.lane_stride(), stride);
    EXPECT_EQ(sets.set_count(), WavelengthQuadrature::kShiftCount);
    EXPECT_EQ(std::count(sets.kinds().begin(), sets.kinds().end(), LaneKind::Padding),
              stride - count);
    for (int lane = count; lane < stride; ++lane) {
      EXPECT_EQ(sets.weights_nm(7)[lane], 0.0f);
      EXPECT_EQ(sets.wavelengths_nm(7)[lane], sets.wavelengths_nm(7)[count - 1]);
    }
  }
}

TEST(WavelengthQuadrature, every_set_has_one_wavelength_in_each_stratum) {
  const WavelengthQuadrature sets = quadrature(16, {data().d65});
  const Spectrum mix = lamp_mix(std::vector<Spectrum>{data().d65}, data().observer);
  const WavelengthDensity density(mix, data().observer, 360.0, 830.0);
  for (int set = 0; set < sets.set_count(); ++set) {
    for (int lane = 0; lane < 16; ++lane) {
      EXPECT_GT(sets.wavelengths_nm(set)[lane], density.quantile(lane / 16.0) - 1e-3);
      EXPECT_LT(sets.wavelengths_nm(set)[lane], density.quantile((lane + 1) / 16.0) + 1e-3);
    }
  }
}

TEST(WavelengthQuadrature, weights_are_an_unbiased_quadrature_over_all_sets) {
  for (const Spectrum& lamp : {data().d65, data().fl11}) {
    const WavelengthQuadrature sets = quadrature(16, {lamp});
    // An arbitrary narrow band that the density knows nothing of.
    const Spectrum band =
        Spectrum::tabulated({520.0, 527.0, 533.0}, {0.0, 1.0, 0.0}, OutsideTable::Zero);
    const std::vector<float> values = sets.tabulate(band);
    double sum = 0.0;
    for (int set = 0; set < sets.set_count(); ++set) {
      for (int lane = 0; lane < sets.lane_stride(); ++lane) {
        sum += double{sets.weights_nm(set)[lane]} * values[set * sets.lane_stride() + lane];
      }
    }
    // 4096 points lie about 0.1 nm apart, against kinks of a band 13 nm wide.
    EXPECT_NEAR(sum / sets.set_count(), integral(band), 2e-3 * integral(band));
  }
}

TEST(WavelengthQuadrature, first_powers_of_two_of_samples_divide_the_stratum_evenly) {
  const WavelengthQuadrature sets = quadrature(16, {data().d65});
  for (std::uint32_t scramble : {0u, 1u, 77u, 0xdeadbeefu}) {
    for (int bits = 0; bits <= 8; ++bits) {
      const int samples = 1 << bits;
      std::set<int> parts;
      for (int i = 0; i < samples; ++i) {
        const int set = set_of(sets, static_cast<std::uint32_t>(i), scramble);
        ASSERT_GE(set, 0);
        ASSERT_LT(set, 256);
        parts.insert(set / (256 / samples));
      }
      EXPECT_EQ(parts.size(), static_cast<std::size_t>(samples));
    }
  }
}

TEST(WavelengthQuadrature, samples_of_a_pixel_take_the_sets_of_their_shifts) {
  const WavelengthQuadrature sets = quadrature(16, {data().d65});
  for (std::uint32_t i = 0; i < 16; ++i) {
    // 16 shifts lie in the middles of their parts: the midpoint rule.
    EXPECT_EQ(sets.set_of(wavelength_shift(i)) % 16, 8);
  }
  EXPECT_EQ(sets.set_of(0.0f), 0);
  EXPECT_EQ(sets.set_of(std::nextafter(1.0f, 0.0f)), 255);
}

TEST(WavelengthQuadrature, white_under_d65_converges_as_promised_for_every_scramble) {
  const Vec3d exact = xyz_of(data().d65, data().observer);
  for (const auto& [count, tolerance] : {std::pair{16, 1e-4}, std::pair{4, 2e-3}}) {
    const WavelengthQuadrature sets = quadrature(count, {data().d65});
    const Eye eye(sets, data().d65);
    for (std::uint32_t scramble = 0; scramble < 2000; ++scramble) {
      ASSERT_LT(worst_ratio(eye.mean(16, scramble), exact), tolerance) << scramble;
    }
  }
}

TEST(WavelengthQuadrature, white_converges_by_the_plain_weights_alone) {
  // Without the correction of observer_weights: 16 samples of 16 wavelengths.
  const Vec3d exact = xyz_of(data().d65, data().observer);
  const WavelengthQuadrature sets = quadrature(16, {data().d65});
  const std::vector<float> light = sets.tabulate_emission(data().d65);
  const std::vector<float> bars[] = {sets.tabulate(data().observer.x_bar),
                                     sets.tabulate(data().observer.y_bar),
                                     sets.tabulate(data().observer.z_bar)};
  for (std::uint32_t scramble = 0; scramble < 500; ++scramble) {
    Vec3d sum(0.0);
    for (std::uint32_t i = 0; i < 16; ++i) {
      const int set = set_of(sets, i, scramble);
      for (int channel = 0; channel < 3; ++channel) {
        for (int lane = 0; lane < 16; ++lane) {
          const int at = set * 16 + lane;
          sum[channel] += kLuminousEfficacy_lm_per_W * double{sets.weights_nm(set)[lane]} *
                          bars[channel][at] * light[at];
        }
      }
    }
    ASSERT_LT(worst_ratio(sum / 16.0, exact), 1e-4) << scramble;
  }
}

TEST(WavelengthQuadrature, single_sample_of_sixteen_shows_each_lamp_in_its_own_colour) {
  for (const Spectrum& lamp : {data().d65, data().a, data().e, data().fl2, data().fl11}) {
    const Vec3d exact = xyz_of(lamp, data().observer);
    const WavelengthQuadrature sets = quadrature(16, {lamp});
    const Eye eye(sets, lamp);
    for (int set = 0; set < sets.set_count(); ++set) {
      // What single precision and the regularisation leave.
      ASSERT_LT(worst_ratio(eye.sample(set), exact), 2e-6) << set;
    }
  }
}

TEST(WavelengthQuadrature, fluorescent_white_has_no_colour_at_sixteen_by_sixteen) {
  const Vec3d exact = xyz_of(data().fl11, data().observer);
  const WavelengthQuadrature sets = quadrature(16, {data().fl11});
  const Eye eye(sets, data().fl11);
  for (std::uint32_t scramble = 0; scramble < 2000; ++scramble) {
    ASSERT_LT(chroma(eye.mean(16, scramble), exact), 0.2) << scramble;
  }
}

TEST(WavelengthQuadrature, lamps_of_a_mixture_converge_each_by_itself) {
  const WavelengthQuadrature sets = quadrature(16, {data().d65, data().a, data().fl11});
  for (const Spectrum& lamp : {data().d65, data().a, data().fl11}) {
    const Vec3d exact = xyz_of(lamp, data().observer);
    const Eye eye(sets, lamp);
    for (std::uint32_t scramble = 0; scramble < 256; ++scramble) {
      ASSERT_LT(chroma(eye.mean(16, scramble), exact), 0.5) << scramble;  // measured: 0.2
    }
  }
}

TEST(WavelengthQuadrature, observer_weights_are_positive_and_padding_is_zero) {
  const WavelengthQuadrature sets = quadrature(10, {data().fl11});
  const std::vector<float> weights = sets.observer_weights(data().observer);
  ASSERT_EQ(weights.size(), 256u * 3u * 16u);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    EXPECT_GE(weights[i], 0.0f);
    if (i % 16 >= 10) {
      EXPECT_EQ(weights[i], 0.0f);
    }
  }
}

TEST(WavelengthQuadrature, sodium_lamp_alone_needs_two_lanes_and_one_set) {
  const Spectrum sodium = Spectrum::lines({{588.995, 2.0}, {589.592, 1.0}});
  const WavelengthQuadrature sets = quadrature(16, {sodium});
  EXPECT_EQ(sets.lane_count(), 2);
  EXPECT_EQ(sets.lane_stride(), 4);
  EXPECT_EQ(sets.set_count(), 1);
  EXPECT_EQ(sets.kinds()[0], LaneKind::Line);
  EXPECT_FLOAT_EQ(sets.wavelengths_nm(0)[1], 589.592f);
  EXPECT_EQ(sets.set_of(0.7f), 0);
  const Vec3d exact = xyz_of(sodium, data().observer);
  EXPECT_LT(worst_ratio(Eye(sets, sodium).sample(0), exact), 1e-6);  // single precision
}

TEST(WavelengthQuadrature, lamp_of_lines_beside_daylight_is_exact_in_every_sample) {
  const Spectrum mercury =
      Spectrum::lines({{404.66, 3.0}, {435.83, 5.0}, {546.07, 6.0}, {576.96, 1.0}, {579.07, 1.0}});
  const WavelengthQuadrature sets = quadrature(16, {data().d65, mercury});
  EXPECT_EQ(sets.lane_count(), 21);
  EXPECT_EQ(sets.lane_stride(), 32);
  for (const Spectrum& lamp : {mercury, data().d65}) {
    const Vec3d exact = xyz_of(lamp, data().observer);
    const Eye eye(sets, lamp);
    for (int set = 0; set < 256; ++set) {
      ASSERT_LT(worst_ratio(eye.sample(set), exact), 2e-6);  // single precision
    }
  }
}

TEST(WavelengthQuadrature, too_many_lines_keep_the_strongest_and_all_the_power) {
  std::vector<SpectralLine> lines;
  for (int i = 0; i < 200; ++i) lines.push_back({401.0 + i, i == 100 ? 50.0 : 0.1 + 1e-4 * i});
  const Spectrum lamp = Spectrum::lines(lines);
  const WavelengthQuadrature sets = quadrature(64, {data().d65, lamp});
  EXPECT_EQ(sets.lane_count(), kMaxLanes);
  const std::vector<float> emission = sets.tabulate_emission(lamp);
  double power = 0.0;
  bool keeps_strongest = false;
  for (int lane = 0; lane < sets.lane_count(); ++lane) {
    if (sets.kinds()[lane] != LaneKind::Line) continue;
    power += emission[lane];
    keeps_strongest = keeps_strongest || std::abs(sets.wavelengths_nm(0)[lane] - 501.0f) < 0.01f;
  }
  EXPECT_TRUE(keeps_strongest);
  EXPECT_NEAR(power, integral(lamp), 1e-3);  // single precision of 200 numbers
}

TEST(WavelengthQuadrature, exact_lanes_are_the_wavelengths_asked_for_at_one_nanometre_each) {
  WavelengthOptions options;
  options.exact_nm = {656.27, 486.13, 587.56};
  const std::vector<Spectrum> lamps{data().d65};
  const WavelengthQuadrature sets(options, data().observer, lamps);
  EXPECT_EQ(sets.lane_count(), 3);
  EXPECT_EQ(sets.lane_stride(), 4);
  EXPECT_EQ(sets.set_count(), 1);
  EXPECT_EQ(sets.kinds()[2], LaneKind::Exact);
  EXPECT_EQ(sets.kinds()[3], LaneKind::Padding);
  EXPECT_FLOAT_EQ(sets.wavelengths_nm(0)[0], 656.27f);
  EXPECT_EQ(sets.weights_nm(0)[0], 1.0f);
  const std::vector<float> weights = sets.observer_weights(data().observer);
  EXPECT_FLOAT_EQ(weights[4 + 1], static_cast<float>(kLuminousEfficacy_lm_per_W *
                                                     data().observer.y_bar.value(486.13)));
  // A lamp's line counts on the lane of its wavelength, and nowhere else.
  const std::vector<float> emission =
      sets.tabulate_emission(Spectrum::lines({{587.562, 7.0}, {500.0, 3.0}}));
  EXPECT_EQ(emission[0], 0.0f);
  EXPECT_EQ(emission[2], 7.0f);
}

TEST(WavelengthQuadrature, restricted_range_integrates_just_that_range) {
  WavelengthOptions options;
  options.range_min_nm = 500.0;
  options.range_max_nm = 600.5;
  const std::vector<Spectrum> lamps{data().d65};
  const WavelengthQuadrature sets(options, data().observer, lamps);
  const Spectrum window = Spectrum::tabulated({500.0, 600.5}, {1, 1}, OutsideTable::Zero);
  const Vec3d exact = xyz_of(product(data().d65, window), data().observer);
  const Eye eye(sets, data().d65);
  for (int set = 0; set < 256; ++set) {
    for (int lane = 0; lane < 16; ++lane) {
      ASSERT_GE(sets.wavelengths_nm(set)[lane], 500.0f);
      ASSERT_LE(sets.wavelengths_nm(set)[lane], 600.5f);
    }
  }
  Vec3d mean(0.0);
  for (int set = 0; set < 256; ++set) mean += eye.sample(set) / 256.0;
  EXPECT_LT(worst_ratio(mean, exact), 1e-4);  // a range cut at its ends converges more slowly
}

TEST(WavelengthQuadrature, scene_without_lamps_is_sampled_for_equal_energy) {
  const WavelengthQuadrature sets = quadrature(16, {});
  EXPECT_EQ(sets.lane_count(), 16);
  const Vec3d exact = xyz_of(Spectrum::constant(1.0), data().observer);
  EXPECT_LT(worst_ratio(Eye(sets, Spectrum::constant(1.0)).mean(16, 5), exact), 1e-4);
}

// Bands of 2 nm, one of them 3 nm, three in one spectrum.
Spectrum three_bands() {
  return Spectrum::tabulated(
      {448.9, 449.1, 450.9, 451.1, 543.9, 544.1, 546.9, 547.1, 610.2, 610.4, 612.2, 612.4},
      {0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0}, OutsideTable::Clamp);
}

std::vector<float> shifts_of(int samples) {
  std::vector<float> shifts;
  for (int i = 0; i < samples; ++i) shifts.push_back(wavelength_shift(static_cast<unsigned>(i)));
  return shifts;
}

TEST(WavelengthQuadrature, narrow_bands_have_their_colour_in_the_mean_of_a_pixel) {
  const std::vector<Spectrum> filters{three_bands()};
  for (const Spectrum& lamp : {data().d65, data().a, data().fl11}) {
    const Vec3d exact = xyz_of(product(lamp, filters[0]), data().observer);
    // Cells that the samples divide evenly: what light and observer vary over one of them, and the
    // ripple of the corrections. Others overlap by parts of a cell.
    for (const auto& [samples, tolerance] :
         {std::pair{4, 0.05}, std::pair{16, 0.01}, std::pair{64, 0.01}, std::pair{10, 0.1}}) {
      const std::vector<float> shifts = shifts_of(samples);
      const WavelengthQuadrature sets({}, data().observer, std::vector<Spectrum>{lamp},
                                      {narrow_bands(filters), shifts});
      const std::vector<float> weights = sets.observer_weights(data().observer);
      const std::vector<float> light = sets.tabulate_emission(lamp);
      const std::vector<float> filter = sets.tabulate_reflectance(filters[0]);
      Vec3d mean(0.0);
      for (const float shift : shifts) {
        const int set = sets.set_of(shift);
        for (int channel = 0; channel < 3; ++channel) {
          for (int lane = 0; lane < 16; ++lane) {
            mean[channel] += double{weights[(set * 3 + channel) * 16 + lane]} *
                             light[set * 16 + lane] * filter[set * 16 + lane] / samples;
          }
        }
      }
      EXPECT_LT(worst_ratio(mean, exact), tolerance) << samples;
    }
  }
}

TEST(WavelengthQuadrature, narrow_bands_leave_every_sample_of_white_its_colour) {
  const std::vector<NarrowBand> bands = narrow_bands(std::vector<Spectrum>{three_bands()});
  for (const Spectrum& lamp : {data().d65, data().a, data().fl11}) {
    const WavelengthQuadrature sets({}, data().observer, std::vector<Spectrum>{lamp},
                                    {bands, shifts_of(16)});
    const Eye eye(sets, lamp);
    const Vec3d exact = xyz_of(lamp, data().observer);
    for (const float shift : shifts_of(16)) {
      // What single precision and the regularisation leave.
      EXPECT_LT(worst_ratio(eye.sample(sets.set_of(shift)), exact), 2e-6);
    }
  }
}

TEST(WavelengthQuadrature, each_of_a_few_narrow_bands_has_a_wavelength_of_every_set) {
  const std::vector<NarrowBand> bands = narrow_bands(std::vector<Spectrum>{three_bands()});
  ASSERT_EQ(bands.size(), 3u);
  const WavelengthQuadrature sets({}, data().observer, std::vector<Spectrum>{data().d65},
                                  {bands, shifts_of(16)});
  for (int set = 0; set < sets.set_count(); ++set) {
    const std::span<const float> nm = sets.wavelengths_nm(set);
    for (const NarrowBand& band : bands) {
      const auto within = std::count_if(nm.begin(), nm.end(), [&](float at_nm) {
        return at_nm >= band.low_nm && at_nm <= band.high_nm;
      });
      EXPECT_EQ(within, 1) << set;
    }
  }
}

TEST(WavelengthQuadrature, without_narrow_bands_samples_and_reflectances_change_nothing) {
  const WavelengthQuadrature plain = quadrature(16, {data().fl11});
  const Spectrum step =
      Spectrum::tabulated({360, 550, 550.1, 830}, {0, 0, 1, 1}, OutsideTable::Clamp);
  const WavelengthQuadrature resolved({}, data().observer, std::vector<Spectrum>{data().fl11},
                                      {narrow_bands(std::vector<Spectrum>{step}), shifts_of(16)});
  for (int set = 0; set < plain.set_count(); ++set) {
    EXPECT_TRUE(std::ranges::equal(plain.wavelengths_nm(set), resolved.wavelengths_nm(set)));
    EXPECT_TRUE(std::ranges::equal(plain.weights_nm(set), resolved.weights_nm(set)));
  }
  EXPECT_EQ(plain.observer_weights(data().observer), resolved.observer_weights(data().observer));
  EXPECT_EQ(resolved.tabulate_reflectance(step), plain.tabulate(step));
}

TEST(WavelengthQuadrature, options_out_of_bounds_are_usage_errors) {
  const std::vector<Spectrum> lamps{data().d65};
  const auto expect_usage_error = [&](const WavelengthOptions& options) {
    try {
      const WavelengthQuadrature sets(options, data().observer, lamps);
      ADD_FAILURE() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.detail().kind, ErrorKind::Usage);
    }
  };
  expect_usage_error({.count = 0});
  expect_usage_error({.count = 65});
  expect_usage_error({.range_min_nm = 350.0});
  expect_usage_error({.range_min_nm = 600.0, .range_max_nm = 500.0});
  expect_usage_error({.exact_nm = {300.0}});
  expect_usage_error({.exact_nm = {500.0, 500.0}});
  expect_usage_error({.exact_nm = std::vector<double>(129, 500.0)});
}

}  // namespace
}  // namespace abbe
