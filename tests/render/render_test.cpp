// Whole renders: white, reproducibility, crops, spectral channels.

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "abbe/base/error.h"
#include "abbe/base/parallel.h"
#include "abbe/color/color.h"
#include "abbe/image/exr/exr.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

Scene glowing_sphere(const char* lamp = nullptr) {
  Scene scene;
  Material material = test::emitter(Vec3f(1.0f));
  if (lamp != nullptr) {
    material.emission = SpectralEmission{{lamp, test::catalogue().illuminant(lamp)}, 1.0};
  }
  test::add_sphere(scene, test::add(scene, material), Vec3d(0.0), 50.0);
  scene.cameras.push_back(test::perspective_camera({0, 0, 0}, {0, 0, -1}, 40.0));
  return scene;
}

Scene lit_white_floor() {
  Scene scene;
  test::add_square(scene, test::add(scene, test::matte(Vec3f(1.0f))), 20.0,
                   test::rotation({1, 0, 0}, -90.0));
  scene.cameras.push_back(test::orthographic_camera({0, 30, 0}, {0, 0, 0}, 1.0, 1.0));
  scene.lights.push_back(test::directional_light({0, -1, 0}, 3.14159265358979));
  return scene;
}

void expect_white(const Image& image, float tolerance) {
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    EXPECT_NEAR(image.pixels[i], 1.0f, tolerance) << "value " << i;
  }
}

TEST(WhiteTest, emission_of_1_1_1_develops_to_1_1_1) {
  RenderSettings settings = test::small_settings();
  settings.samples_per_pixel = 16;
  expect_white(test::render(glowing_sphere(), settings).image, 1e-4f);
}

TEST(WhiteTest, white_floor_lit_by_d65_develops_to_1_1_1) {
  RenderSettings settings = test::small_settings();
  settings.samples_per_pixel = 16;
  // The promise for 16 samples of 16 wavelengths.
  expect_white(test::render(lit_white_floor(), settings).image, 1e-4f);
}

TEST(WhiteTest, four_wavelengths_keep_white_within_2e_3) {
  RenderSettings settings = test::small_settings();
  settings.samples_per_pixel = 16;
  settings.wavelengths.count = 4;
  expect_white(test::render(lit_white_floor(), settings).image, 2e-3f);
}

TEST(WhiteTest, rgb_modes_keep_white_to_rounding) {
  RenderSettings settings = test::small_settings();
  for (const Mode mode : {Mode::Rgb, Mode::Rgb3}) {
    settings.mode = mode;
    expect_white(test::render(lit_white_floor(), settings).image, 2e-6f);
  }
}

TEST(WhiteTest, fluorescent_lamp_has_no_colour_error_beyond_0_2) {
  RenderSettings settings = test::small_settings();
  settings.samples_per_pixel = 16;
  const test::Rendered result = test::render(glowing_sphere("illuminant/FL11"), settings);
  const Observer observer = test::catalogue().observer();
  const Spectrum lamp = test::catalogue().illuminant("illuminant/FL11");
  const Vec3d white = xyz_of(lamp, observer) / xyz_of(lamp, observer).y;
  const Development development =
      development_for(observer, test::catalogue().illuminant("illuminant/D65"));
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      const Vec3d rgb_rec709(test::pixel(result.image, x, y, "R"),
                             test::pixel(result.image, x, y, "G"),
                             test::pixel(result.image, x, y, "B"));
      const Vec3d lab = lab_of_xyz(development.rec709_to_xyz * rgb_rec709, white);
      EXPECT_LT(std::hypot(lab.y, lab.z), 0.2);
    }
  }
}

Scene glass_over_floor() {
  Scene scene = lit_white_floor();
  scene.materials.front().base_color_rec709 = Vec4f(0.8f, 0.5f, 0.3f, 1.0f);
  test::add_sphere(scene, test::add(scene, test::glass("glass/schott/SF10")), {0, 1, 0}, 0.8);
  scene.lights.push_back(test::point_light({2, 3, 1}, 20.0));
  return scene;
}

TEST(RenderTest, image_for_any_number_of_threads_is_the_same_bit_for_bit) {
  RenderSettings settings = test::small_settings();
  settings.size = {70, 70};
  settings.samples_per_pixel = 2;
  const Scene scene = glass_over_floor();
  std::vector<float> reference;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    const std::vector<float> pixels = test::render(scene, settings).image.pixels;
    if (reference.empty()) reference = pixels;
    EXPECT_EQ(pixels, reference) << threads;
  }
}

TEST(RenderTest, crop_has_the_pixels_of_the_whole_image) {
  RenderSettings settings = test::small_settings();
  settings.size = {70, 50};
  settings.samples_per_pixel = 3;
  settings.filter = "mitchell";
  const Scene scene = glass_over_floor();
  const Image whole = test::render(scene, settings).image;
  settings.crop = PixelRect{13, 7, 55, 41};
  const Image part = test::render(scene, settings).image;
  ASSERT_EQ(part.width, 42);
  ASSERT_EQ(part.height, 34);
  for (int y = 0; y < part.height; ++y) {
    for (int x = 0; x < part.width; ++x) {
      for (std::size_t c = 0; c < 3; ++c) {
        ASSERT_EQ(part.at(x, y, c), whole.at(x + 13, y + 7, c));
      }
    }
  }
}

TEST(RenderTest, cancelled_render_says_that_it_is_incomplete) {
  RenderSettings settings = test::small_settings();
  settings.size = {200, 200};
  const Scene scene = glass_over_floor();
  const LitWorld world = test::make_world(scene, settings);
  Film film(film_options(settings));
  const CancelFlag cancel{true};
  EXPECT_FALSE(render(world, scene.cameras.front(), settings, film, {}, &cancel).complete);
  EXPECT_EQ(film.sample_count({0, 0}), 0u);
}

TEST(RenderTest, film_that_is_kept_is_added_to) {
  RenderSettings settings = test::small_settings();
  settings.samples_per_pixel = 4;
  settings.bands = parse_bands("400:700:100");
  const Scene scene = glass_over_floor();
  const LitWorld world = test::make_world(scene, settings);
  Film film(film_options(settings));
  const auto rgb_of = [&] {
    const Image image = film.develop({.xyz_to_rec709 = world.lanes.film_to_rec709()});
    return std::array{image.at(5, 5, 0), image.at(5, 5, 1), image.at(5, 5, 2)};
  };
  EXPECT_TRUE(render(world, scene.cameras.front(), settings, film).complete);
  const auto once = rgb_of();
  EXPECT_GT(once[1], 0.0f);
  EXPECT_EQ(film.sample_count({5, 5}), 4u);
  render(world, scene.cameras.front(), settings, film);
  EXPECT_EQ(film.sample_count({5, 5}), 8u);
  EXPECT_EQ(rgb_of(), once);  // Sums in double precision: twice the same is no other mean.
}

TEST(RenderTest, what_was_made_for_other_settings_is_a_usage_error_that_says_what_differs) {
  const Scene scene = glass_over_floor();
  const RenderSettings made = test::small_settings();
  const LitWorld world = test::make_world(scene, made);
  const auto rejects = [&](const char* part, const auto& change_settings, bool is_film = false) {
    RenderSettings settings = made;
    change_settings(settings);
    Film film(film_options(is_film ? made : settings));
    try {
      (void)render(world, scene.cameras.front(), settings, film);
      ADD_FAILURE() << "no error for " << part;
    } catch (const Error& error) {
      EXPECT_EQ(error.detail().kind, ErrorKind::Usage);
      EXPECT_EQ(error.detail().where, part) << error.what();
    }
  };
  rejects("world.mode", [](RenderSettings& s) { s.mode = Mode::Rgb; });
  rejects("world.wavelengths", [](RenderSettings& s) { s.wavelengths.count = 64; });
  rejects("world.wavelengths", [](RenderSettings& s) { s.wavelengths.exact_nm = {500.0}; });
  rejects("world.uplift", [](RenderSettings& s) { s.uplift = Uplift::MallettYuksel; });
  rejects("world.frozen", [](RenderSettings& s) { s.frozen = CauseSet::all(); });
  rejects("world.caustics", [](RenderSettings& s) { s.caustics = false; });
  rejects("samples_per_pixel", [](RenderSettings& s) { s.samples_per_pixel = -1; });
  const bool is_film = true;
  rejects(
      "film.crop",
      [](RenderSettings& s) {
        s.size = {9, 8};
      },
      is_film);
  rejects(
      "film.crop",
      [](RenderSettings& s) {
        s.crop = PixelRect{1, 1, 3, 3};
      },
      is_film);
  rejects(
      "film.channels", [](RenderSettings& s) { s.bands = BandOptions{}; }, is_film);
  rejects(
      "film.channels", [](RenderSettings& s) { s.aovs = {"Z"}; }, is_film);
  rejects(
      "film.weight_magnitude", [](RenderSettings& s) { s.filter = "mitchell"; }, is_film);
  Camera camera = scene.cameras.front();
  camera.to_world[3].x = std::nan("");
  Film film(film_options(made));
  EXPECT_THROW((void)render(world, camera, made, film), Error);
}

TEST(RenderTest, scene_of_a_program_is_checked_where_its_world_is_made) {
  Scene scene = glass_over_floor();
  scene.meshes.front().triangles.front()[1] = 1'000'000;
  EXPECT_THROW((void)test::make_world(scene, test::small_settings()), Error);
}

double relative_rms(const std::vector<double>& sums, double count, const Image& reference) {
  double error = 0.0, size = 0.0;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const double value = static_cast<double>(reference.pixels[i]);
    error += std::pow(sums[i] / count - value, 2.0);
    size += value * value;
  }
  return std::sqrt(error / size);
}

TEST(RenderTest, mean_of_many_seeds_is_about_as_good_as_one_render_of_all_their_samples) {
  const Scene scene = glass_over_floor();
  RenderSettings settings = test::small_settings();
  settings.size = {24, 24};
  settings.filter = "gaussian";
  const LitWorld world = test::make_world(scene, settings);
  const auto image_of = [&](int samples, std::uint32_t seed) {
    settings.samples_per_pixel = samples;
    settings.seed = seed;
    return test::render(world, scene.cameras.front(), settings).image;
  };
  const Image reference = image_of(1024, 1000);
  const auto error_of = [&](int samples, std::uint32_t first, std::uint32_t seeds) {
    std::vector<double> sums(reference.pixels.size());
    for (std::uint32_t seed = first; seed < first + seeds; ++seed) {
      const Image image = image_of(samples, seed);
      for (std::size_t i = 0; i < sums.size(); ++i) {
        sums[i] += static_cast<double>(image.pixels[i]);
      }
    }
    return relative_rms(sums, seeds, reference);
  };
  const double one = error_of(64, 0, 1);
  for (const int samples : {1, 3, 4, 16}) {
    // Seeds lie at the edges of the strata they share, a single render in the middles.
    EXPECT_LT(error_of(samples, 0, 64u / static_cast<unsigned>(samples)), 1.5 * one) << samples;
    EXPECT_LT(error_of(samples, 64, 64u / static_cast<unsigned>(samples)), 1.5 * one) << samples;
  }
}

TEST(RenderTest, no_two_seeds_are_one_image_however_large_they_are) {
  const Scene scene = glass_over_floor();
  RenderSettings settings = test::small_settings();
  settings.samples_per_pixel = 16;  // Seeds times 16 pass 32 bits.
  std::set<std::vector<float>> images;
  for (const std::uint32_t seed : {0u, 1u, 1u << 28, (1u << 28) + 1u, 1u << 31, 0xffffffffu}) {
    settings.seed = seed;
    images.insert(test::render(scene, settings).image.pixels);
  }
  EXPECT_EQ(images.size(), 6u);
}

TEST(RenderTest, bands_hold_the_mean_spectral_radiance_of_the_lamp) {
  RenderSettings settings = test::small_settings();
  settings.samples_per_pixel = 16;
  settings.bands = parse_bands("360:830:5");
  const Image image = test::render(glowing_sphere("illuminant/E"), settings).image;
  // An equal-energy lamp of 1 cd/m² has 1/(683.002·∫ȳ) W·m⁻²·sr⁻¹·nm⁻¹ at every wavelength.
  const float level = static_cast<float>(1.0 / (683.002 * 106.856917));
  const auto first = image.channel_index("S0.362,500000nm");
  ASSERT_TRUE(first.has_value());
  for (std::size_t band = 0; band < 94; ++band) {
    EXPECT_NEAR(image.at(3, 3, *first + band) / level, 1.0f, 1e-4f) << band;
  }
}

TEST(RenderTest, lines_give_the_radiance_at_exactly_those_wavelengths) {
  RenderSettings settings = test::small_settings();
  settings.wavelengths.exact_nm = {450.0, 550.0, 650.0};
  const Image image = test::render(glowing_sphere("illuminant/A"), settings).image;
  const Observer observer = test::catalogue().observer();
  const Spectrum lamp = test::catalogue().illuminant("illuminant/A");
  const double scale = 1.0 / xyz_of(lamp, observer).y;
  const char* names[] = {"S0.450,000000nm", "S0.550,000000nm", "S0.650,000000nm"};
  for (int i = 0; i < 3; ++i) {
    const double expected = scale * lamp.value(settings.wavelengths.exact_nm[i]);
    EXPECT_NEAR(test::pixel(image, 2, 2, names[i]) / expected, 1.0, 1e-6) << names[i];
  }
}

TEST(RenderTest, range_renders_a_part_without_rescaling_the_light) {
  RenderSettings settings = test::small_settings();
  // All 256 shifts: a spectrum that is cut where it is bright needs them for its end.
  settings.samples_per_pixel = 256;
  settings.size = {4, 4};
  double sum = 0.0;
  for (const auto& [low, high] : {std::pair{360.0, 555.0}, {555.0, 830.0}}) {
    settings.wavelengths.range_min_nm = low;
    settings.wavelengths.range_max_nm = high;
    sum +=
        static_cast<double>(test::pixel(test::render(glowing_sphere(), settings).image, 3, 3, "G"));
  }
  // Two halves make the whole.
  EXPECT_NEAR(sum, 1.0, 1e-3);
}

TEST(RenderTest, extra_channels_tell_depth_position_and_ids) {
  RenderSettings settings = test::small_settings();
  settings.aovs = {"Z", "P", "N", "albedo", "UV", "objectId", "materialId"};
  const Image image = test::render(glass_over_floor(), settings).image;
  EXPECT_NEAR(test::pixel(image, 0, 0, "Z"), 30.0f, 1e-4f);
  EXPECT_NEAR(test::pixel(image, 0, 0, "P.Y"), 0.0f, 1e-5f);
  EXPECT_NEAR(test::pixel(image, 0, 0, "N.Y"), 1.0f, 1e-6f);
  EXPECT_NEAR(test::pixel(image, 0, 0, "albedo.R"), 0.8f, 1e-6f);
  EXPECT_EQ(test::pixel(image, 0, 0, "objectId"), 1.0f);
  EXPECT_EQ(test::pixel(image, 4, 4, "objectId"), 2.0f);
  EXPECT_EQ(test::pixel(image, 4, 4, "materialId"), 2.0f);
}

TEST(RenderTest, cost_of_a_pixel_is_the_work_of_its_rays_traced_alone) {
  Scene scene;
  test::add_box_mesh(scene, test::add(scene, test::emitter(Vec3f(1.0f))), {1, 2, 3}, Mat4d(1.0));
  scene.cameras.push_back(test::perspective_camera({0, 0, 12}, {0, 0, 0}, 40.0));
  RenderSettings settings = test::small_settings();
  settings.aovs = {"cost"};
  const LitWorld world = test::make_world(scene, settings);
  const Image image = test::render(world, scene.cameras.front(), settings).image;
  for (const int x : {0, 4}) {
    const CameraSample sample = camera_sample(world, scene.cameras.front(), settings, {x, 4}, 0);
    QueryCost cost;
    world.accelerator->closest_hit_with_cost({sample.origin, kInfinity, sample.direction}, kAllBits,
                                             cost);
    // One sample a pixel; its emitter sends no further ray and no lamp asks for a shadow.
    EXPECT_EQ(test::pixel(image, x, 4, "cost.nodes"), static_cast<float>(cost.nodes));
    EXPECT_EQ(test::pixel(image, x, 4, "cost.triangles"), static_cast<float>(cost.primitives));
  }
  EXPECT_GT(test::pixel(image, 4, 4, "cost.triangles"), 0.0f);
}

// A glowing glass ball over a lit floor in ambient light, seen through a half transparent sheet.
Scene everything() {
  Scene scene = glass_over_floor();
  scene.ambient = Ambient{0.3, {"illuminant/A", test::catalogue().illuminant("illuminant/A")}};
  scene.materials.back().emissive_rec709 = Vec3f(0.1f, 0.0f, 0.2f);
  Material sheet = test::matte(Vec3f(0.4f, 0.5f, 0.6f));
  sheet.alpha_mode = AlphaMode::Blend;
  sheet.base_color_rec709.w = 0.5f;
  test::add_square(scene, test::add(scene, sheet), 0.5,
                   test::translation({0.5, 5.0, 0.0}) * test::rotation({1, 0, 0}, -90.0));
  return scene;
}

TEST(RenderTest, parts_of_the_light_add_up_to_the_colour) {
  RenderSettings settings = test::small_settings();
  settings.size = {24, 24};
  settings.samples_per_pixel = 4;
  settings.aovs = {"direct", "ambient", "emitted", "reflected", "refracted"};
  for (const Mode mode : {Mode::Spectral, Mode::Rgb}) {
    settings.mode = mode;
    const Image image = test::render(everything(), settings).image;
    std::vector<double> totals(5, 0.0);
    for (int y = 0; y < 24; ++y) {
      for (int x = 0; x < 24; ++x) {
        for (std::size_t c = 0; c < 3; ++c) {
          double sum = 0.0;
          for (std::size_t part = 0; part < 5; ++part) {
            sum += static_cast<double>(image.at(x, y, 3 + 3 * part + c));
            totals[part] += static_cast<double>(image.at(x, y, 3 + 3 * part + c));
          }
          // The same floats in another order.
          ASSERT_NEAR(sum, image.at(x, y, c), 2e-5 * std::max(1.0, sum)) << x << "," << y;
        }
      }
    }
    for (const double total : totals) EXPECT_GT(total, 0.1);
  }
}

TEST(RenderTest, parts_of_the_light_leave_the_image_as_it_is) {
  RenderSettings settings = test::small_settings();
  const Image plain = test::render(everything(), settings).image;
  settings.aovs = {"reflected"};
  const Image image = test::render(everything(), settings).image;
  for (int i = 0; i < 64; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_EQ(image.at(i % 8, i / 8, c), plain.at(i % 8, i / 8, c));
    }
  }
}

TEST(RenderTest, matte_floor_has_neither_reflected_nor_refracted_light) {
  RenderSettings settings = test::small_settings();
  settings.aovs = {"direct", "reflected", "refracted"};
  const Image image = test::render(lit_white_floor(), settings).image;
  EXPECT_NEAR(test::pixel(image, 3, 3, "direct.G"), 1.0f, 2e-3f);  // one sample of 16 wavelengths
  EXPECT_EQ(test::pixel(image, 3, 3, "reflected.G"), 0.0f);
  EXPECT_EQ(test::pixel(image, 3, 3, "refracted.G"), 0.0f);
}

TEST(RenderTest, spectral_albedo_is_the_reflectance_of_what_is_seen) {
  Scene scene = lit_white_floor();
  const Spectrum reflectance =
      Spectrum::tabulated({400.0, 550.0, 700.0}, {0.2, 0.8, 0.4}, OutsideTable::Clamp);
  scene.materials.front().reflectance = NamedSpectrum{"", reflectance};
  RenderSettings settings = test::small_settings();
  settings.samples_per_pixel = 16;
  settings.bands = parse_bands("420:680:20");
  settings.aovs = {"spectralAlbedo"};
  const Image image = test::render(scene, settings).image;
  for (int band = 0; band < settings.bands->count(); ++band) {
    const double nm = settings.bands->center_nm(band);
    if (std::abs(nm - 550.0) < 20.0) continue;  // The mean over the bend is below its peak.
    // Linear over the band: its mean is the value in the middle; floats.
    EXPECT_NEAR(test::pixel(image, 4, 4, reflective_channel_name(nm)), reflectance.value(nm), 1e-5);
  }
  settings.bands.reset();
  EXPECT_THROW(check_settings(settings), Error);
  settings.wavelengths.exact_nm = {475.0, 600.0};
  const Image lines = test::render(scene, settings).image;
  EXPECT_NEAR(test::pixel(lines, 4, 4, "T.475,000000nm"), 0.5f, 1e-6f);  // floats
}

}  // namespace
}  // namespace abbe
