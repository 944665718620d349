// Scenes whose spectra change fast, at default settings against many wavelengths and samples.
#include <gtest/gtest.h>

#include "support/image_difference.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

constexpr double kPi_lx = 3.14159265358979;

// Squares side by side, two rows of three, that a lamp of the catalogue lights.
Scene patches(const std::vector<Material>& materials, const std::string& lamp) {
  Scene scene;
  for (std::size_t i = 0; i < materials.size(); ++i) {
    const Vec3d place(static_cast<double>(i % 3) - 1.0, 0.5 - static_cast<double>(i / 3), 0.0);
    test::add_square(scene, test::add(scene, materials[i]), 0.5, test::translation(place));
  }
  scene.cameras.push_back(test::orthographic_camera({0, 0, 5}, {0, 0, 0}, 1.5, 1.0));
  Light light = test::directional_light({0, 0, -1}, kPi_lx);
  light.spectrum = NamedSpectrum{lamp, test::catalogue().illuminant(lamp)};
  scene.lights.push_back(light);
  return scene;
}

Material banded(const std::vector<double>& centers_nm, double width_nm = 2.0) {
  std::vector<double> nm, values;
  for (const double center_nm : centers_nm) {
    for (const double side : {-0.5, 0.5}) {
      const double edge_nm = center_nm + side * width_nm;
      nm.insert(nm.end(), {edge_nm - 0.05, edge_nm + 0.05});
    }
    values.insert(values.end(), {0.0, 1.0, 1.0, 0.0});
  }
  Material material = test::matte({1, 1, 1});
  material.reflectance =
      NamedSpectrum{"bands", Spectrum::tabulated(nm, values, OutsideTable::Clamp)};
  return material;
}

Material filmed(double thickness_nm) {
  Material material = test::mirror("Ag-Johnson");
  material.film.emplace().index = ConstantIndex{1.33};
  material.film->thickness_max_nm = static_cast<float>(thickness_nm);
  return material;
}

// Half a just noticeable difference on average, and thrice what is measured: 0.1 to 0.2, most of it
// at the borders of patches, where the samples of a pixel are few for each.
void expect_resolved(const Scene& scene) {
  RenderSettings settings;
  settings.size = {60, 40};
  const Image image = test::render(scene, settings).image;
  settings.wavelengths.count = 64;
  settings.samples_per_pixel = 256;
  settings.seed = 7;
  EXPECT_LT(test::mean_delta_e2000(image, test::render(scene, settings).image), 0.5);
}

TEST(NarrowBandsRender, reflectance_bands_of_two_nanometres_have_their_colour) {
  expect_resolved(patches({banded({455}), banded({505}), banded({550.3}), banded({611.7}),
                           banded({450, 540, 610}), test::matte({0.8f, 0.8f, 0.8f})},
                          "illuminant/D65"));
}

TEST(NarrowBandsRender, fluorescent_light_on_bands_and_smooth_colours_has_its_colour) {
  expect_resolved(patches(
      {test::matte({1, 1, 1}), test::matte({0.8f, 0.1f, 0.1f}), test::matte({0.1f, 0.6f, 0.1f}),
       test::matte({0.1f, 0.1f, 0.7f}), banded({545}), banded({436, 580})},
      "illuminant/FL11"));
}

TEST(NarrowBandsRender, thick_films_on_panes_have_their_colour) {
  Scene scene;
  int i = 0;
  for (const double thickness_nm : {2000.0, 4000.0, 10000.0}) {
    // A square that sees the lamp behind the camera at an angle.
    test::add_square(scene, test::add(scene, filmed(thickness_nm)), 0.45,
                     test::translation({i - 1.0, -0.5, 0.0}) * test::rotation({1, 0, 0}, 20.0));
    ++i;
  }
  test::add_square(scene, test::add(scene, test::emitter({1, 1, 1})), 60.0,
                   test::translation({0, 0, 9}) * test::rotation({1, 0, 0}, 180.0));
  scene.cameras.push_back(test::orthographic_camera({0, -0.5, 5}, {0, -0.5, 0}, 1.5, 0.4));
  expect_resolved(scene);
}

}  // namespace
}  // namespace abbe
