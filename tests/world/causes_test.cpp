// What can make a spectral image differ, found in a scene before anything is rendered.

#include "abbe/world/causes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "abbe/base/error.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const Spectrum& d65() {
  static const Spectrum spectrum = test::catalogue().illuminant("illuminant/D65");
  return spectrum;
}

Scene grey_scene() {
  Scene scene;
  test::add_sphere(scene, test::add(scene, test::matte(Vec3f(0.5f))), Vec3d(0.0), 1.0);
  scene.lights.push_back(test::directional_light({0, -1, 0}, 3.0));
  return scene;
}

TEST(Causes, grey_surfaces_and_clear_constant_glass_in_daylight_have_none) {
  Scene scene = grey_scene();
  test::add(scene, test::glass(1.5));
  scene.lights.push_back(test::point_light({0, 1, 0}, 10.0));
  scene.lights.back().spectrum = {"", d65().scaled(3.0)};
  EXPECT_THAT(acting_causes(scene, d65()), IsEmpty());
}

TEST(Causes, each_is_found_by_what_it_needs) {
  Scene glass = grey_scene();
  test::add(glass, test::glass("glass/schott/N-SF11"));
  EXPECT_THAT(acting_causes(glass, d65()), ElementsAre(Cause::IndexDispersion));

  Scene metal = grey_scene();
  test::add(metal, test::mirror("metal/Au-Johnson"));
  EXPECT_THAT(acting_causes(metal, d65()), ElementsAre(Cause::Fresnel));

  Scene tinted = grey_scene();
  Material green = test::glass(1.5);
  green.attenuation_color_rec709 = {0.5, 0.9, 0.5};
  green.attenuation_distance_m = 0.1;
  test::add(tinted, green);
  EXPECT_THAT(acting_causes(tinted, d65()), ElementsAre(Cause::Absorption));

  Scene lamp = grey_scene();
  lamp.lights.front().spectrum = {"illuminant/A", test::catalogue().illuminant("illuminant/A")};
  EXPECT_THAT(acting_causes(lamp, d65()), ElementsAre(Cause::Lamps));

  Scene color = grey_scene();
  test::add(color, test::matte({0.8f, 0.2f, 0.1f}));
  EXPECT_THAT(acting_causes(color, d65()), ElementsAre(Cause::Reflectances));
}

TEST(Causes, grey_attenuation_is_no_cause) {
  Scene scene = grey_scene();
  Material smoked = test::glass(1.5);
  smoked.attenuation_color_rec709 = Vec3d(0.5);
  smoked.attenuation_distance_m = 0.1;
  test::add(scene, smoked);
  EXPECT_THAT(acting_causes(scene, d65()), IsEmpty());
}

TEST(Causes, names_go_there_and_back) {
  EXPECT_EQ(causes_text(parse_causes({"lamps", "dispersion"})), "dispersion,lamps");
  EXPECT_EQ(parse_causes({"all"}), CauseSet::all());
  EXPECT_EQ(parse_causes(cause_names()), CauseSet::all());
  EXPECT_FALSE(parse_causes({"dispersion"}).has_channels());
  EXPECT_THROW(parse_causes({"colour"}), Error);
}

}  // namespace
}  // namespace abbe
