/// What a study renders again.
#include "abbe/session/study.h"

#include <gtest/gtest.h>

#include "image/temporary_folder.h"
#include "support/scene_builder.h"

namespace abbe {
namespace {

// A grey floor under a lamp, seen by two cameras of one name.
PreparedScene prepared() {
  PreparedScene prepared;
  Scene& scene = prepared.scene;
  test::add_square(scene, test::add(scene, test::matte(Vec3f(0.5f))), 20.0,
                   test::rotation({1, 0, 0}, -90.0));
  scene.lights.push_back(test::point_light({2, 3, 1}, 20.0));
  scene.lights.front().spectrum = NamedSpectrum{"lamp", Spectrum::constant(1.0)};
  for (const double height_m : {3.0, 6.0}) {
    scene.cameras.push_back(test::orthographic_camera({0, height_m, 0}, {0, 0, 0}, 1.0, 1.0));
    scene.cameras.back().name = "same";
  }
  return prepared;
}

class StudyTest : public testing::Test {
 protected:
  // Whether a render of the same file is one that stands.
  bool is_reused(const PreparedScene& scene, const DevelopmentOptions& development = {}) const {
    Study study(scene, standards_, development, {.folder = folder_.path()});
    const auto shot = study.render("a.exr", "a", test::small_settings());
    EXPECT_TRUE(shot);
    return shot && shot->is_reused;
  }

 private:
  TemporaryFolder folder_;
  Standards standards_ = read_standards(test::catalogue());
};

TEST_F(StudyTest, the_same_render_is_reused) {
  EXPECT_FALSE(is_reused(prepared()));
  EXPECT_TRUE(is_reused(prepared()));
}

TEST_F(StudyTest, another_camera_of_the_same_name_is_rendered_again) {
  PreparedScene scene = prepared();
  EXPECT_FALSE(is_reused(scene));
  scene.camera = 1;
  EXPECT_FALSE(is_reused(scene));
}

TEST_F(StudyTest, spectrum_that_has_changed_under_its_name_is_rendered_again) {
  PreparedScene scene = prepared();
  EXPECT_FALSE(is_reused(scene));
  scene.scene.lights.front().spectrum->spectrum =
      Spectrum::tabulated({400.0, 700.0}, {1.0, 2.0}, OutsideTable::Zero);
  EXPECT_FALSE(is_reused(scene));
  EXPECT_TRUE(is_reused(scene));
  // Between two points of the 1 nm grid.
  scene.scene.lights.front().spectrum->spectrum = Spectrum::tabulated(
      {400.0, 550.4, 550.5, 550.6, 700.0}, {1.0, 1.5, 9.0, 1.5, 2.0}, OutsideTable::Zero);
  EXPECT_FALSE(is_reused(scene));
}

TEST_F(StudyTest, glass_and_white_that_have_changed_are_rendered_again) {
  PreparedScene scene = prepared();
  Material& glass = scene.scene.materials.front();
  glass.index_id = "glass/mine";
  glass.index = ConstantIndex{1.5};
  DevelopmentOptions development;
  development.white = White{"mine", {{Spectrum::constant(1.0), 1.0}}, {}};
  EXPECT_FALSE(is_reused(scene, development));
  EXPECT_TRUE(is_reused(scene, development));
  glass.index = ConstantIndex{1.6};
  EXPECT_FALSE(is_reused(scene, development));
  development.white->lamps.front().first = Spectrum::blackbody(3000.0);
  EXPECT_FALSE(is_reused(scene, development));
}

}  // namespace
}  // namespace abbe
