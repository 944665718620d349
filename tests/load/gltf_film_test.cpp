#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "load/gltf_builder.h"

namespace abbe {
namespace {

using testing::HasSubstr;

class GltfFilm : public GltfTest {
 protected:
  Json& iridescence() { return material()["extensions"]["KHR_materials_iridescence"]; }
  std::optional<ThinFilm> film() { return load().materials.at(0).film; }
  static double n_d(const ThinFilm& film) { return refractive_index(film.index, 587.5618); }
};

TEST_F(GltfFilm, iridescence_has_the_defaults_of_the_extension) {
  iridescence() = {{"iridescenceFactor", 1.0}};
  const ThinFilm read = film().value();
  EXPECT_EQ(read.factor, 1.0f);
  EXPECT_EQ(n_d(read), 1.3);
  EXPECT_EQ(read.thickness_min_nm, 100.0f);
  EXPECT_EQ(read.thickness_max_nm, 400.0f);
  EXPECT_FALSE(read.thickness_texture || read.factor_texture);
}

TEST_F(GltfFilm, iridescence_without_a_factor_is_none) {
  iridescence() = {{"iridescenceIor", 1.8}};
  EXPECT_FALSE(film().has_value());
}

TEST_F(GltfFilm, iridescence_reads_what_is_stated) {
  iridescence() = {{"iridescenceFactor", 0.5},
                   {"iridescenceIor", 1.8},
                   {"iridescenceThicknessMinimum", 50.0},
                   {"iridescenceThicknessMaximum", 900.0}};
  const ThinFilm read = film().value();
  EXPECT_EQ(read.factor, 0.5f);
  EXPECT_EQ(n_d(read), 1.8);
  EXPECT_EQ(read.thickness_min_nm, 50.0f);
  EXPECT_EQ(read.thickness_max_nm, 900.0f);
}

TEST_F(GltfFilm, index_below_one_or_negative_thickness_is_an_error_with_its_place) {
  iridescence() = {{"iridescenceFactor", 1.0}, {"iridescenceIor", 0.5}};
  EXPECT_THAT(error(), HasSubstr("KHR_materials_iridescence/iridescenceIor"));
  iridescence() = {{"iridescenceFactor", 1.0}, {"iridescenceThicknessMaximum", -1.0}};
  EXPECT_THAT(error(), HasSubstr("iridescenceThicknessMaximum"));
}

TEST_F(GltfFilm, abbe_film_takes_an_id_a_number_or_a_table) {
  abbe_material()["film"] = {{"ior", "liquid/water-daimon-20c"}, {"thickness_nm", 320.0}};
  ThinFilm read = film().value();
  EXPECT_EQ(read.index_id, "liquid/water-daimon-20c");
  EXPECT_NEAR(n_d(read), 1.3334, 1e-4);  // the digits given
  EXPECT_EQ(read.thickness_max_nm, 320.0f);
  EXPECT_EQ(read.factor, 1.0f);
  abbe_material()["film"]["ior"] = 1.38;
  EXPECT_EQ(n_d(film().value()), 1.38);
  abbe_material()["film"]["ior"] = {{400, 1.4}, {700, 1.3}};
  EXPECT_NEAR(refractive_index(film().value().index, 550.0), 1.35, 1e-12);  // rounding
}

TEST_F(GltfFilm, abbe_film_overrides_only_what_it_states) {
  iridescence() = {{"iridescenceFactor", 0.5}, {"iridescenceThicknessMaximum", 900.0}};
  abbe_material()["film"] = {{"ior", 1.33}};
  const ThinFilm read = film().value();
  EXPECT_EQ(n_d(read), 1.33);
  EXPECT_EQ(read.factor, 0.5f);
  EXPECT_EQ(read.thickness_max_nm, 900.0f);
}

TEST_F(GltfFilm, abbe_film_with_mistakes_says_what_it_wants) {
  abbe_material()["film"] = {{"ior", 1.33}};
  EXPECT_THAT(error(), HasSubstr("film/thickness_nm"));
  abbe_material()["film"] = {{"thickness_nm", 300.0}};
  EXPECT_THAT(error(), HasSubstr("film/ior"));
  abbe_material()["film"] = {{"ior", "metal/Au-Johnson"}, {"thickness_nm", 300.0}};
  EXPECT_THAT(error(), HasSubstr("does not absorb"));
  abbe_material()["film"] = {{"ior", 1.33}, {"thickness_nm", -5.0}};
  EXPECT_THAT(error(), HasSubstr("film/thickness_nm"));
}

}  // namespace
}  // namespace abbe
