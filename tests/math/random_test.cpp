/// Chance by name: every sequence is stratified, no two are tied together.
#include "abbe/math/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "abbe/math/sampling.h"

namespace abbe {
namespace {

constexpr std::uint32_t kSeed = 1;

std::uint64_t glass_path() {
  return path_after(path_after(kCameraPath, 2), 1);
}

/// One number of a sample: what a purpose draws along one axis.
struct Number {
  std::string name;
  std::function<float(const SampleChance&)> draw;
};

/// All numbers of a sample: of every purpose on two paths, of a second item, and its wavelengths'.
std::vector<Number> all_numbers() {
  std::vector<Number> numbers{
      {"wavelengths", [](const SampleChance& sample) { return wavelength_shift(sample.index); }}};
  for (int p = 0; p < kPurposes; ++p) {
    const auto purpose = static_cast<Purpose>(p);
    for (const std::uint64_t path : {kCameraPath, glass_path()}) {
      for (const std::uint32_t item : {0u, 1u}) {
        const std::string name = std::to_string(p) +
                                 (path == kCameraPath ? " camera " : " glass ") +
                                 std::to_string(item);
        numbers.push_back({name, [=](const SampleChance& sample) {
                             return random_1d(sample, path, purpose, item);
                           }});
        for (int axis = 0; axis < 2; ++axis) {
          numbers.push_back(
              {name + " axis " + std::to_string(axis), [=](const SampleChance& sample) {
                 return random_2d(sample, path, purpose, item)[axis];
               }});
        }
      }
    }
  }
  return numbers;
}

std::vector<SampleChance> some_pixels() {
  return {{pixel_chance({0, 0}, 0)}, {pixel_chance({17, 3}, 0)}, {pixel_chance({17, 3}, kSeed)}};
}

int cell(float u, int cells) {
  EXPECT_GE(u, 0.0f);
  EXPECT_LT(u, 1.0f);
  return static_cast<int>(u * static_cast<float>(cells));
}

TEST(Random, every_aligned_block_of_two_to_the_k_samples_has_one_number_in_each_part) {
  for (const Number& number : all_numbers()) {
    for (SampleChance sample : some_pixels()) {
      for (int samples = 1; samples <= 256; samples *= 2) {
        for (int block = 0; block < 3; ++block) {
          std::set<int> parts;
          for (int i = 0; i < samples; ++i) {
            sample.index = static_cast<std::uint32_t>(block * samples + i);
            parts.insert(cell(number.draw(sample), samples));
          }
          ASSERT_EQ(parts.size(), static_cast<std::size_t>(samples)) << number.name;
        }
      }
    }
  }
}

TEST(Random, every_aligned_block_has_one_point_in_each_box_of_any_dyadic_shape) {
  for (int p = 0; p < kPurposes; ++p) {
    for (const std::uint64_t path : {kCameraPath, glass_path()}) {
      for (SampleChance sample : some_pixels()) {
        for (int k = 0; k <= 8; ++k) {
          for (int kx = 0; kx <= k; ++kx) {
            std::set<std::pair<int, int>> boxes;
            for (int i = 0; i < 1 << k; ++i) {
              sample.index = static_cast<std::uint32_t>((1 << k) + i);
              const Vec2f u = random_2d(sample, path, static_cast<Purpose>(p));
              boxes.emplace(cell(u.x, 1 << kx), cell(u.y, 1 << (k - kx)));
            }
            ASSERT_EQ(boxes.size(), std::size_t{1} << k) << p;
          }
        }
      }
    }
  }
}

TEST(Random, film_and_wavelengths_are_stratified_together) {
  SampleChance sample{pixel_chance({5, 8}, kSeed)};
  for (int axis = 0; axis < 2; ++axis) {
    for (int k = 1; k <= 8; ++k) {
      for (int kx = 0; kx < k; ++kx) {
        // Sobol's dimensions 0 and 2, or 1 and 2, have at most two points in a box of two shares.
        std::vector<int> counts(std::size_t{1} << (k - 1));
        for (int i = 0; i < 1 << k; ++i) {
          sample.index = static_cast<std::uint32_t>(i);
          const float x = random_2d(sample, kCameraPath, Purpose::Film)[axis];
          const int box = cell(x, 1 << kx) << (k - 1 - kx);
          ++counts[static_cast<std::size_t>(
              box + cell(wavelength_shift(sample.index), 1 << (k - 1 - kx)))];
        }
        for (const int count : counts) ASSERT_EQ(count, 2) << axis << ", " << k << ", " << kx;
      }
    }
  }
}

TEST(Random, every_prefix_counts_an_interval_to_within_its_binary_digits) {
  // A prefix is made of one aligned block for each binary digit of its length, and a block of 2^k
  // misses no interval from 0 by a whole point. Independent numbers miss by √n.
  for (const Number& number : all_numbers()) {
    SampleChance sample{pixel_chance({3, 4}, 0)};
    std::vector<float> drawn;
    for (std::uint32_t n = 1; n <= 100; ++n) {
      sample.index = n - 1;
      drawn.push_back(number.draw(sample));
      for (int t = 1; t < 16; ++t) {
        const float end = static_cast<float>(t) / 16.0f;
        const auto below =
            std::count_if(drawn.begin(), drawn.end(), [end](float u) { return u < end; });
        ASSERT_LE(std::abs(static_cast<float>(below) - end * static_cast<float>(n)),
                  static_cast<float>(std::popcount(n)))
            << number.name;
      }
    }
  }
}

// Pearson's statistic of pairs of numbers in 4 × 4 cells, over many pixels.
double chi_square(const Number& a, const Number& b, std::uint32_t index_a, std::uint32_t index_b,
                  const Vec2i& apart = {0, 0}) {
  constexpr int kWidth = 64;
  std::vector<double> counts(16);
  for (int y = 0; y < kWidth; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const float u = a.draw({pixel_chance({x, y}, kSeed), index_a});
      const float v = b.draw({pixel_chance(Vec2i(x, y) + apart, kSeed), index_b});
      ++counts[static_cast<std::size_t>(4 * cell(u, 4) + cell(v, 4))];
    }
  }
  constexpr double kExpected = kWidth * kWidth / 16.0;
  double sum = 0.0;
  for (const double count : counts) sum += (count - kExpected) * (count - kExpected) / kExpected;
  return sum;
}

// With 15 degrees of freedom, independent numbers exceed 60 once in 4 million.
constexpr double kMaxChiSquare = 60.0;

TEST(Random, numbers_of_different_purposes_paths_and_items_are_independent) {
  std::vector<Number> numbers = all_numbers();
  numbers.erase(numbers.begin());  // Wavelengths are the same in all pixels, as they should be.
  // Three numbers to a use: what is drawn as one number is not drawn as two as well.
  for (std::size_t a = 0; a < numbers.size(); ++a) {
    for (const std::size_t further : {3u, 4u, 7u, 30u}) {
      const Number& b = numbers[(a + further) % numbers.size()];
      EXPECT_LT(chi_square(numbers[a], b, 5, 5), kMaxChiSquare)
          << numbers[a].name << ", " << b.name;
    }
  }
}

TEST(Random, axes_of_a_point_are_independent) {
  for (int p = 0; p < kPurposes; ++p) {
    for (const std::uint64_t path : {kCameraPath, glass_path()}) {
      const auto axis = [&](int i) {
        return Number{"", [=](const SampleChance& sample) {
                        return random_2d(sample, path, static_cast<Purpose>(p))[i];
                      }};
      };
      EXPECT_LT(chi_square(axis(0), axis(1), 5, 5), kMaxChiSquare) << p;
    }
  }
}

TEST(Random, pixels_are_independent_of_their_neighbours) {
  std::vector<Number> numbers = all_numbers();
  numbers.erase(numbers.begin());
  for (const Number& number : numbers) {
    for (const Vec2i& apart : {Vec2i(1, 0), Vec2i(0, 1), Vec2i(1, 1), Vec2i(-1, 2)}) {
      EXPECT_LT(chi_square(number, number, 3, 3, apart), kMaxChiSquare) << number.name;
    }
  }
}

TEST(Random, means_converge_much_faster_than_those_of_independent_numbers) {
  // ∫∫ x·y = 1/4, with a variance of 7/144; 64 independent points miss by 0.0276 in the mean
  // square.
  double square = 0.0;
  constexpr int kPixels = 400;
  for (int pixel = 0; pixel < kPixels; ++pixel) {
    double sum = 0.0;
    for (std::uint32_t i = 0; i < 64; ++i) {
      const Vec2f u =
          random_2d({pixel_chance({pixel, 0}, kSeed), i}, glass_path(), Purpose::Microfacet);
      sum += double{u.x} * u.y;
    }
    square += (sum / 64.0 - 0.25) * (sum / 64.0 - 0.25);
  }
  EXPECT_LT(std::sqrt(square / kPixels), 0.0276 / 8.0);
}

TEST(Random, film_has_the_same_places_along_an_axis_in_all_pixels) {
  for (int samples = 4; samples <= 64; samples *= 2) {
    for (int axis = 0; axis < 2; ++axis) {
      std::set<std::set<float>> axes;
      for (int x = 0; x < 50; ++x) {
        std::set<float> places;
        for (int i = 0; i < samples; ++i) {
          places.insert(random_2d({pixel_chance({x, 9}, kSeed), static_cast<std::uint32_t>(i)},
                                  kCameraPath, Purpose::Film)[axis]);
        }
        axes.insert(places);
      }
      EXPECT_EQ(axes.size(), 1u) << samples;
      if (samples == 16) {
        int i = 0;
        for (const float place : *axes.begin())
          EXPECT_EQ(place, (static_cast<float>(i++) + 0.5f) / 16.0f);
      }
    }
  }
}

TEST(Random, numbers_are_the_same_on_every_machine) {
  const SampleChance sample{pixel_chance({12, 34}, 5), 6};
  EXPECT_EQ(sample.pixel, pixel_chance({12, 34}, 5));
  EXPECT_NE(sample.pixel, pixel_chance({34, 12}, 5));
  EXPECT_NE(sample.pixel, pixel_chance({12, 34}, 6));
  EXPECT_NE(path_after(kCameraPath, 1), path_after(kCameraPath, 2));
  EXPECT_NE(glass_path(), path_after(path_after(kCameraPath, 1), 2));
  EXPECT_EQ(wavelength_shift(0), 0.65625f);
  EXPECT_EQ(wavelength_shift(1), 0.15625f);
}

TEST(Dither, noise_is_the_sum_of_two_uniform_numbers) {
  double sum = 0.0;
  double square = 0.0;
  constexpr int kWidth = 128;
  for (int y = 0; y < kWidth; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto noise = static_cast<double>(dither_noise({x, y}, 1));
      ASSERT_LT(std::abs(noise), 1.0);
      sum += noise;
      square += noise * noise;
    }
  }
  EXPECT_NEAR(sum / (kWidth * kWidth), 0.0, 0.01);            // 3 standard deviations.
  EXPECT_NEAR(square / (kWidth * kWidth), 1.0 / 6.0, 0.005);  // 3 standard deviations.
}

}  // namespace
}  // namespace abbe
