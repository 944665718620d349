// Thin films on surfaces of a scene, per wavelength, against Airy's sum.
#include <gtest/gtest.h>

#include <cmath>

#include "abbe/base/constants.h"
#include "abbe/image/exr/exr.h"
#include "support/airy.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

constexpr double kWavelengths_nm[] = {436.0, 486.1327, 546.0, 587.5618, 656.2725};

RenderSettings line_settings() {
  RenderSettings settings = test::small_settings();
  settings.wavelengths.exact_nm.assign(std::begin(kWavelengths_nm), std::end(kWavelengths_nm));
  return settings;
}

ThinFilm film_of(double n, float thickness_nm) {
  ThinFilm film;
  film.index = ConstantIndex{n};
  film.thickness_max_nm = thickness_nm;
  return film;
}

// A plane of the material at y = 0, seen at an angle from the normal; what it mirrors is a wall of
// light (1 cd/m²) across the way of the mirrored ray, far away. Nothing else shines.
Scene plane_under_a_wall(const Material& material, double angle_deg) {
  Scene scene;
  const double angle = angle_deg * kPi / 180.0;
  test::add_square(scene, test::add(scene, material), 0.5, test::rotation({1, 0, 0}, -90.0));
  const Vec3d eye(-std::sin(angle), std::cos(angle), 0.0);
  scene.cameras.push_back(test::orthographic_camera(2.0 * eye, {0, 0, 0}, 1e-4, 1e-4));
  // Its plane is tilted by the angle, so that the mirrored ray meets it head on.
  const double wall_m = 20.0;
  const Mat4d place = test::translation(wall_m * Vec3d(std::sin(angle), std::cos(angle), 0.0)) *
                      test::rotation({0, 0, 1}, -angle_deg) * test::rotation({1, 0, 0}, 90.0);
  Material light = test::emitter(Vec3f(1.0f));
  light.double_sided = true;
  test::add_square(scene, test::add(scene, light), 2.0, place);
  return scene;
}

// What the plane sends back of what the wall alone shows, per wavelength.
std::vector<double> reflectances(const Scene& scene, const RenderSettings& settings) {
  Scene mirror = scene;
  mirror.materials[0] = Material{};
  mirror.materials[0].roughness = 0.0f;
  mirror.materials[0].metallic = 0.0f;
  mirror.materials[0].index_is_infinite = true;
  mirror.materials[0].base_color_rec709 = Vec4f(0.0f, 0.0f, 0.0f, 1.0f);
  const Image with = test::render(scene, settings).image;
  const Image all = test::render(mirror, settings).image;
  std::vector<double> result;
  for (const double nm : settings.wavelengths.exact_nm) {
    const std::string channel = spectral_channel_name(nm);
    result.push_back(static_cast<double>(test::pixel(with, 4, 4, channel)) /
                     static_cast<double>(test::pixel(all, 4, 4, channel)));
  }
  return result;
}

Material black_glass(double n) {
  Material material;
  material.metallic = 0.0f;
  material.roughness = 0.0f;
  material.base_color_rec709 = Vec4f(0.0f, 0.0f, 0.0f, 1.0f);
  material.index = ConstantIndex{n};
  return material;
}

Material soap(double n, float thickness_nm) {
  Material material = black_glass(1.0);
  material.base_color_rec709 = Vec4f(1.0f);
  material.transmission = 1.0f;
  material.film = film_of(n, thickness_nm);
  return material;
}

TEST(FilmTest, soap_film_has_the_colours_of_airys_sum) {
  for (const double angle_deg : {30.0, 60.0}) {
    for (const float thickness_nm : {20.0f, 250.0f, 550.0f, 1200.0f}) {
      const Scene scene = plane_under_a_wall(soap(1.33, thickness_nm), angle_deg);
      const std::vector<double> found = reflectances(scene, line_settings());
      for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_NEAR(found[i],
                    static_cast<double>(test::airy_reflectance(std::cos(angle_deg * kPi / 180.0),
                                                               1.0L, 1.33L, 1.0L, thickness_nm,
                                                               kWavelengths_nm[i])),
                    1e-5)  // What is asked of soap films.
            << thickness_nm << " nm at " << angle_deg << " deg, " << kWavelengths_nm[i] << " nm";
      }
    }
  }
}

TEST(FilmTest, oxide_on_a_metal_has_the_colours_of_airys_sum) {
  Material metal = test::mirror("metal/Ti-Johnson");
  metal.film = film_of(2.4, 60.0f);
  const Scene scene = plane_under_a_wall(metal, 45.0);
  const std::vector<double> found = reflectances(scene, line_settings());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const long double nm = kWavelengths_nm[i];
    const std::complex<long double> substrate(metal.conductor->n.value(kWavelengths_nm[i]),
                                              metal.conductor->k.value(kWavelengths_nm[i]));
    EXPECT_NEAR(found[i],
                static_cast<double>(
                    test::airy_reflectance(std::cos(kPi / 4.0), 1.0L, 2.4L, substrate, 60.0L, nm)),
                1e-5);  // the vector code's promise
  }
}

TEST(FilmTest, film_of_zero_thickness_or_no_share_equals_no_film_to_the_last_bit) {
  for (Material material : {black_glass(1.5168), test::mirror("metal/Au-Johnson")}) {
    const Image bare = test::render(plane_under_a_wall(material, 60.0), line_settings()).image;
    material.film = film_of(1.33, 0.0f);
    EXPECT_EQ(test::render(plane_under_a_wall(material, 60.0), line_settings()).image.pixels,
              bare.pixels);
    material.film = film_of(1.33, 300.0f);
    EXPECT_NE(test::render(plane_under_a_wall(material, 60.0), line_settings()).image.pixels,
              bare.pixels);
    material.film->factor = 0.0f;
    EXPECT_EQ(test::render(plane_under_a_wall(material, 60.0), line_settings()).image.pixels,
              bare.pixels);
  }
}

TEST(FilmTest, factor_mixes_the_reflectances) {
  Material material = black_glass(1.5168);
  const auto at_factor = [&](float factor) {
    material.film = film_of(1.38, 100.0f);
    material.film->factor = factor;
    return reflectances(plane_under_a_wall(material, 30.0), line_settings());
  };
  const auto none = at_factor(0.0f), some = at_factor(0.25f), all = at_factor(1.0f);
  for (std::size_t i = 0; i < none.size(); ++i) {
    EXPECT_NEAR(some[i], 0.75 * none[i] + 0.25 * all[i], 1e-6);  // single precision
  }
}

TEST(FilmTest, texture_sets_the_thickness_and_the_share) {
  Material material = black_glass(1.5168);
  material.film = film_of(1.38, 500.0f);
  material.film->thickness_min_nm = 100.0f;
  material.film->thickness_texture = TextureUse{};
  material.film->factor_texture = TextureUse{};
  Scene scene = plane_under_a_wall(material, 30.0);
  TextureImage image;
  image.width = image.height = 1;
  image.rgba8 = {128, 51, 0, 255};  // R: share 128/255; G: a fifth of the way from 100 to 500 nm.
  scene.images.push_back(image);
  scene.textures.push_back(Texture{});
  Scene plain = scene;
  plain.materials[0].film = film_of(1.38, 180.0f);
  plain.materials[0].film->factor = 128.0f / 255.0f;
  const auto textured = reflectances(scene, line_settings());
  const auto uniform = reflectances(plain, line_settings());
  for (std::size_t i = 0; i < textured.size(); ++i) {
    EXPECT_NEAR(textured[i], uniform[i], 1e-6);  // rounding of the texture's mix
  }
}

TEST(FilmTest, straight_light_through_a_film_loses_what_the_film_reflects) {
  // A matte floor under a lamp; a soap film across the way.
  const auto lit = [](std::optional<Material> film) {
    Scene scene;
    test::add_square(scene, test::add(scene, test::matte(Vec3f(1.0f))), 20.0,
                     test::rotation({1, 0, 0}, -90.0));
    if (film) {
      test::add_square(scene, test::add(scene, *film), 1.0,
                       test::translation({2, 1.5, 0}) * test::rotation({1, 0, 0}, -90.0));
    }
    scene.lights.push_back(test::point_light({4, 3, 0}, 100.0));
    scene.cameras.push_back(test::orthographic_camera({0, 30, 0}, {0, 0, 0}, 1e-4, 1e-4));
    return test::render(scene, line_settings()).image;
  };
  const Image clear = lit(std::nullopt);
  const Image through = lit(soap(1.33, 300.0f));
  for (const double nm : kWavelengths_nm) {
    const double share = static_cast<double>(test::pixel(through, 4, 4, spectral_channel_name(nm)) /
                                             test::pixel(clear, 4, 4, spectral_channel_name(nm)));
    EXPECT_NEAR(
        share,
        1.0 - static_cast<double>(test::airy_reflectance(0.6L, 1.0L, 1.33L, 1.0L, 300.0L, nm)),
        1e-5);  // single precision; the cosine of the way down is 3/5
  }
}

}  // namespace
}  // namespace abbe
