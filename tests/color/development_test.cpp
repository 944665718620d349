#include "abbe/color/development.h"

#include <gtest/gtest.h>

#include "abbe/base/error.h"
#include "abbe/load/spectra/catalogue.h"

namespace abbe {
namespace {

void expect_near(const Vec3d& value, const Vec3d& expected, double tolerance) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(value[i], expected[i], tolerance) << "component " << i;
}

const Catalogue& catalogue() {
  static const Catalogue result = Catalogue::standard();
  return result;
}
const Observer& cie1931() {
  static const Observer result = catalogue().observer();
  return result;
}
const Observer& cie1964() {
  static const Observer result = catalogue().observer("observer/cie1964-10deg");
  return result;
}
const Spectrum& d65() {
  static const Spectrum result = catalogue().illuminant("illuminant/D65");
  return result;
}

Spectrum of_1_cd(const std::string& id) {
  const Spectrum lamp = catalogue().illuminant(id);
  return lamp.scaled(1.0 / xyz_of(lamp, cie1931()).y);
}

White white_of(const std::string& id) {
  return {id, {{catalogue().illuminant(id), 1.0}}, std::nullopt};
}

Vec3d developed(const Spectrum& light, const DevelopmentOptions& options) {
  const Observer& observer = options.observer ? *options.observer : cie1931();
  return responses_to_rec709(options, cie1931(), d65()) * responses_of(light, observer);
}

/// A camera made of the matching functions, mixed by a matrix.
Observer luther_camera() {
  const auto mix = [](double x, double y, double z) {
    std::vector<double> nm, values;
    for (int at = 360; at <= 830; ++at) {
      nm.push_back(at);
      values.push_back(x * cie1931().x_bar.value(at) + y * cie1931().y_bar.value(at) +
                       z * cie1931().z_bar.value(at));
    }
    return Spectrum::tabulated(nm, values, OutsideTable::Zero);
  };
  return {"camera", mix(0.9, 0.3, -0.1), mix(-0.2, 1.1, 0.1), mix(0.05, 0.0, 0.6)};
}

/// A camera with three bands of Gaussian shape: no linear mix of the matching functions.
Observer gaussian_camera() {
  const auto band = [](double center_nm, double sigma_nm) {
    std::vector<double> nm, values;
    for (int at = 360; at <= 830; ++at) {
      nm.push_back(at);
      values.push_back(std::exp(-0.5 * std::pow((at - center_nm) / sigma_nm, 2.0)));
    }
    return Spectrum::tabulated(nm, values, OutsideTable::Zero);
  };
  return {"camera", band(600.0, 35.0), band(540.0, 40.0), band(460.0, 30.0)};
}

TEST(Development, default_is_d65_for_white_by_the_1931_observer) {
  expect_near(developed(of_1_cd("illuminant/D65"), {}), Vec3d(1.0), 1e-12);  // rounding
  const Development plain = development_for(cie1931(), d65());
  const Vec3d A = xyz_of(of_1_cd("illuminant/A"), cie1931());
  expect_near(developed(of_1_cd("illuminant/A"), {}), plain.xyz_to_rec709 * A, 1e-12);
}

TEST(Development, white_of_any_lamp_observer_and_adaptation_is_neutral) {
  for (const char* id : {"illuminant/D65", "illuminant/A", "illuminant/D50", "illuminant/FL11"}) {
    for (const Adaptation adaptation : {Adaptation::Cat16, Adaptation::Bradford}) {
      for (const Observer& observer : {cie1931(), cie1964(), luther_camera(), gaussian_camera()}) {
        DevelopmentOptions options{observer, white_of(id), adaptation};
        if (observer.id == "camera") {
          options.observer->responses_to_xyz =
              fit_sensor(observer, cie1931(), d65()).responses_to_xyz;
        }
        expect_near(developed(of_1_cd(id), options), Vec3d(1.0), 1e-9);  // rounding
      }
    }
  }
}

TEST(Development, chromaticity_as_white_is_neutral_whatever_has_it) {
  const Vec3d A = xyz_of(of_1_cd("illuminant/A"), cie1931());
  const Vec2d xy(A.x / (A.x + A.y + A.z), A.y / (A.x + A.y + A.z));
  const DevelopmentOptions options{{}, White{"xy", {}, xy}, Adaptation::Cat16};
  expect_near(developed(of_1_cd("illuminant/A"), options), Vec3d(1.0), 1e-12);  // rounding
}

TEST(Development, without_adaptation_is_the_matrix_of_rec709) {
  const DevelopmentOptions options{{}, {}, Adaptation::None};
  // D65 integrated and through the matrix, FACTS of colorimetry, five decimals.
  expect_near(developed(of_1_cd("illuminant/D65"), options), {1.00017, 0.99998, 0.99974}, 2e-5);
}

TEST(Development, two_adaptations_agree_on_white_and_differ_elsewhere) {
  const Vec3d red =
      responses_of(product(Spectrum::tabulated({590.0, 610.0}, {0.0, 1.0}, OutsideTable::Clamp),
                           of_1_cd("illuminant/A")),
                   cie1931());
  const Vec3d cat16 =
      responses_to_rec709({{}, white_of("illuminant/A"), Adaptation::Cat16}, cie1931(), d65()) *
      red;
  const Vec3d bradford =
      responses_to_rec709({{}, white_of("illuminant/A"), Adaptation::Bradford}, cie1931(), d65()) *
      red;
  EXPECT_GT(glm::length(cat16 - bradford), 0.01);
  EXPECT_LT(glm::length(cat16 - bradford), 0.2);
}

TEST(Development, rgb_modes_adapt_as_spectra_do) {
  // A lamp as an RGB mode carries it, and the same adapted afterwards: what the spectrum gives.
  for (const char* id : {"illuminant/A", "illuminant/D50"}) {
    const DevelopmentOptions options{{}, white_of(id), Adaptation::Cat16};
    const Vec3d as_lanes = developed(of_1_cd(id), {});
    expect_near(rec709_to_rec709(options, cie1931(), d65()) * as_lanes, Vec3d(1.0), 1e-9);
    const Vec3d d65_seen = rec709_to_rec709(options, cie1931(), d65()) * Vec3d(1.0);
    expect_near(d65_seen, developed(of_1_cd("illuminant/D65"), options), 1e-9);  // rounding
  }
}

TEST(SensorFit, of_mixed_matching_functions_is_exact) {
  const SensorFit fit = fit_sensor(luther_camera(), cie1931(), d65());
  EXPECT_LT(fit.max_delta_e2000, 1e-6);  // rounding of a 3×3 system
  Observer camera = luther_camera();
  camera.responses_to_xyz = fit.responses_to_xyz;
  for (const char* id : {"illuminant/A", "illuminant/FL2", "illuminant/E"}) {
    expect_near(xyz_of(of_1_cd(id), camera), xyz_of(of_1_cd(id), cie1931()), 1e-8);  // rounding
  }
}

TEST(SensorFit, of_a_camera_keeps_white_and_is_close_elsewhere) {
  const SensorFit fit = fit_sensor(gaussian_camera(), cie1931(), d65());
  Observer camera = gaussian_camera();
  camera.responses_to_xyz = fit.responses_to_xyz;
  expect_near(xyz_of(of_1_cd("illuminant/D65"), camera),
              xyz_of(of_1_cd("illuminant/D65"), cie1931()), 1e-9);  // rounding
  EXPECT_GT(fit.mean_delta_e2000, 0.1);
  EXPECT_LT(fit.mean_delta_e2000, 4.0);  // cameras with such bands are known to err by 1 to 3
}

TEST(SensorFit, of_curves_of_one_shape_is_an_input_error) {
  Observer camera = gaussian_camera();
  camera.z_bar = camera.y_bar;
  EXPECT_THROW(fit_sensor(camera, cie1931(), d65()), Error);
  camera.z_bar = camera.x_bar.scaled(2.0);
  EXPECT_THROW(fit_sensor(camera, cie1931(), d65()), Error);
  camera.z_bar = Spectrum();
  EXPECT_THROW(fit_sensor(camera, cie1931(), d65()), Error);
}

TEST(Adaptation, has_names) {
  for (const char* name : {"cat16", "bradford", "none"}) {
    EXPECT_EQ(adaptation_name(adaptation_from_name(name)), name);
  }
  EXPECT_THROW(adaptation_from_name("CIECAM"), Error);
}

}  // namespace
}  // namespace abbe
