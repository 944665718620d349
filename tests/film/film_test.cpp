#include "abbe/film/film.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "abbe/base/error.h"
#include "abbe/base/parallel.h"
#include "abbe/film/filter.h"

namespace abbe {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Film, constant_is_developed_exactly_for_any_count_and_filter) {
  for (const std::string& name : filter_names()) {
    const Filter filter = Filter::named(name);
    FilmOptions options;
    options.full_size = {1, 1};
    options.bands = parse_bands("400:700:100");
    options.aovs = {aov_channel("albedo.R")};
    options.weight_magnitude = filter.weight_magnitude();
    const Vec3f constant{0.1f, 0.7f, 1.3f};
    const std::array<float, 3> bands{1e-5f, 0.3f, 7.7f};
    std::mt19937 random(7);
    std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
    for (const int samples : {1, 2, 3, 7, 16, 1000}) {
      Film film(options);
      for (int s = 0; s < samples; ++s) {
        const FilterSample sample = filter.sample({uniform(random), uniform(random)});
        film.add({0, 0}, sample.weight, constant, bands, std::array{0.6f});
      }
      EXPECT_THAT(film.develop({}).pixels, ElementsAre(0.1f, 0.7f, 1.3f, 1e-5f, 0.3f, 7.7f, 0.6f))
          << name << ", " << samples << " samples";
    }
  }
}

TEST(Film, signed_weights_give_the_filtered_value) {
  // A vertical edge through the pixel's centre plus 0.4: the answer is the kernel's mass left of
  // it.
  const Filter filter = Filter::named("mitchell");
  double expected = 0.0;
  constexpr int kSteps = 100000;
  for (int i = 0; i < kSteps; ++i) {
    const double width = 2.4 / kSteps;
    expected += filter.value(-2.0 + (i + 0.5) * width) * width;
  }
  FilmOptions options;
  options.full_size = {1, 1};
  options.weight_magnitude = filter.weight_magnitude();
  Film film(options);
  constexpr int kSide = 300;
  for (int i = 0; i < kSide * kSide; ++i) {
    const Vec2f u{(static_cast<float>(i % kSide) + 0.5f) / kSide,
                  (static_cast<float>(i / kSide) + 0.5f) / kSide};
    const FilterSample s = filter.sample(u);
    film.add({0, 0}, s.weight, Vec3f(s.offset_px.x < 0.4f ? 1.0f : 0.0f));
  }
  // One column of 1/300 of the samples lies astride the edge.
  EXPECT_NEAR(film.develop({}).pixels[0], expected, 0.5 / kSide * filter.weight_magnitude());
}

TEST(Film, pixel_with_only_negative_samples_shows_their_mean) {
  FilmOptions options;
  options.full_size = {1, 1};
  options.weight_magnitude = 1.2f;
  Film film(options);
  film.add({0, 0}, -1.2f, Vec3f(0.5f));
  EXPECT_EQ(film.develop({}).pixels[0], 0.5f);
  EXPECT_EQ(film.sample_count({0, 0}), 1u);
}

TEST(Film, crop_equals_the_same_pixels_of_the_full_film) {
  FilmOptions options;
  options.full_size = {8, 6};
  Film full(options);
  options.crop = PixelRect{2, 1, 7, 5};
  Film crop(options);
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 8; ++x) {
      for (int s = 0; s < 3; ++s) {
        const Vec3f xyz(std::sin(static_cast<float>(x + 8 * y + 48 * s)));
        full.add({x, y}, 1.0f, xyz);
        if (crop.crop().contains({x, y})) crop.add({x, y}, 1.0f, xyz);
      }
    }
  }
  const Image all = full.develop({});
  const Image part = crop.develop({});
  EXPECT_EQ(part.width, 5);
  EXPECT_EQ(part.height, 4);
  EXPECT_EQ(part.data_origin, Vec2i(2, 1));
  EXPECT_EQ(part.full_size, Vec2i(8, 6));
  for (int y = 0; y < part.height; ++y) {
    for (int x = 0; x < part.width; ++x) EXPECT_EQ(part.at(x, y, 0), all.at(x + 2, y + 1, 0));
  }
}

TEST(Film, channels_and_attributes_follow_the_spectral_layout) {
  FilmOptions options;
  options.full_size = {1, 1};
  options.bands = parse_bands("360:370:5");
  options.aovs = {aov_channel("Z"), aov_channel("albedo.R")};
  Film film(options);
  const Image image = film.develop({.attributes = {{"abbe:mode", std::string("spectral")}}});
  EXPECT_THAT(image.channels,
              ElementsAre("R", "G", "B", "S0.362,500000nm", "S0.367,500000nm", "Z", "albedo.R"));
  EXPECT_EQ(std::get<std::string>(image.attributes.at("spectralLayoutVersion")), "1.0");
  EXPECT_EQ(std::get<std::string>(image.attributes.at("emissiveUnits")), "W.m^-2.sr^-1");
  EXPECT_EQ(std::get<float>(image.attributes.at("EV")), 0.0f);
  EXPECT_EQ(std::get<std::string>(image.attributes.at("abbe:mode")), "spectral");
}

TEST(Film, lines_are_channels_of_their_own_wavelengths) {
  FilmOptions options;
  options.full_size = {1, 1};
  options.lines_nm = {486.13, 587.56};
  Film film(options);
  film.add({0, 0}, 1.0f, Vec3f(1.0f), std::array{2.0f, 3.0f});
  const Image image = film.develop({});
  EXPECT_THAT(image.channels, ElementsAre("R", "G", "B", "S0.486,130000nm", "S0.587,560000nm"));
  EXPECT_EQ(image.pixels[3], 2.0f);
  EXPECT_EQ(image.pixels[4], 3.0f);
}

TEST(Film, first_rule_keeps_the_first_sample_whatever_its_sign) {
  FilmOptions options;
  options.full_size = {1, 1};
  options.aovs = {aov_channel("objectId"), aov_channel("cost.nodes")};
  options.weight_magnitude = 1.2f;
  for (const float sign : {1.0f, -1.0f}) {
    Film film(options);
    film.add({0, 0}, sign * 1.2f, Vec3f(0.0f), {}, std::array{7.0f, 10.0f});
    film.add({0, 0}, 1.2f, Vec3f(0.0f), {}, std::array{9.0f, 10.0f});
    film.add({0, 0}, -1.2f, Vec3f(0.0f), {}, std::array{11.0f, 10.0f});
    EXPECT_EQ(film.develop({}).pixels[3], 7.0f);
    EXPECT_EQ(film.develop({}).pixels[4], 10.0f);
  }
}

TEST(Film, development_applies_the_matrix) {
  FilmOptions options;
  options.full_size = {1, 1};
  Film film(options);
  film.add({0, 0}, 1.0f, {1.0f, 2.0f, 3.0f});
  // Columns first, as GLM has it: R = X + Z.
  const Mat3d matrix{1, 0, 0, 0, 2, 0, 1, 0, -1};
  EXPECT_THAT(film.develop({.xyz_to_rec709 = matrix}).pixels, ElementsAre(4.0f, 4.0f, -3.0f));
}

TEST(Film, sample_that_is_not_finite_is_dropped_and_counted) {
  FilmOptions options;
  options.full_size = {1, 1};
  Film film(options);
  film.add({0, 0}, 1.0f, Vec3f(0.5f));
  film.add({0, 0}, 1.0f, {std::numeric_limits<float>::quiet_NaN(), 0.0f, 0.0f});
  film.add({0, 0}, 1.0f, {0.0f, std::numeric_limits<float>::infinity(), 0.0f});
  EXPECT_EQ(film.develop({}).pixels[0], 0.5f);
  EXPECT_EQ(film.dropped_sample_count(), 2u);
}

TEST(Film, pixel_without_samples_is_black) {
  FilmOptions options;
  options.full_size = {2, 1};
  options.weight_magnitude = 1.2f;
  Film film(options);
  film.add({0, 0}, 1.2f, Vec3f(1.0f));
  EXPECT_EQ(film.develop({}).at(1, 0, 0), 0.0f);
}

TEST(Film, pixels_from_many_threads_equal_those_of_one) {
  FilmOptions options;
  options.full_size = {64, 64};
  options.bands = parse_bands("400:700:50");
  const auto fill = [](Film& film, bool parallel) {
    const auto row = [&film](std::size_t y) {
      for (int x = 0; x < 64; ++x) {
        for (int s = 0; s < 16; ++s) {
          const float v = std::sin(static_cast<float>(x * s) + static_cast<float>(y));
          film.add({x, static_cast<int>(y)}, 1.0f, Vec3f(v), std::array{v, v, v, v, v, v});
        }
      }
    };
    if (parallel) {
      parallel_for(0, 64, 1, row);
    } else {
      for (std::size_t y = 0; y < 64; ++y) row(y);
    }
  };
  Film one(options);
  Film many(options);
  fill(one, false);
  fill(many, true);
  EXPECT_EQ(one.develop({}).pixels, many.develop({}).pixels);
}

TEST(Film, impossible_size_or_crop_is_a_usage_error) {
  const auto rejects = [](const Vec2i& size, std::optional<PixelRect> crop, const char* field) {
    try {
      Film film({.full_size = size, .crop = crop});
      ADD_FAILURE() << "no error for " << size.x << "x" << size.y;
    } catch (const Error& error) {
      EXPECT_EQ(error.detail().kind, ErrorKind::Usage);
      EXPECT_THAT(error.what(), HasSubstr(field));
    }
  };
  rejects({0, 5}, {}, "size");
  rejects({5, -1}, {}, "size");
  rejects({70000, 5}, {}, "size");
  rejects({65536, 65536}, {}, "size");
  rejects({10, 10}, PixelRect{0, 0, 11, 10}, "crop");
  rejects({10, 10}, PixelRect{-1, 0, 5, 5}, "crop");
  rejects({10, 10}, PixelRect{5, 0, 5, 5}, "crop");
}

TEST(Film, impossible_channels_are_a_usage_error_that_names_them) {
  const auto rejects = [](const FilmOptions& options, const char* field) {
    try {
      const Film film(options);
      ADD_FAILURE() << "no error for " << field;
    } catch (const Error& error) {
      EXPECT_EQ(error.detail().kind, ErrorKind::Usage);
      EXPECT_EQ(error.detail().where, field);
    }
  };
  rejects({.full_size = {4, 4}, .bands = BandOptions{400.0, 700.0, 0.0}}, "bands");
  rejects({.full_size = {4, 4}, .bands = BandOptions{}, .lines_nm = {500.0}}, "lines_nm");
  rejects({.full_size = {4, 4}, .aovs = {aov_channel("Z"), aov_channel("Z")}}, "aovs");
  rejects({.full_size = {4, 4}, .aovs = {aov_channel("G")}}, "aovs");
}

}  // namespace
}  // namespace abbe
