#include "abbe/load/spectra/observer_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "abbe/base/error.h"
#include "image/temporary_folder.h"

namespace abbe {
namespace {

using ::testing::HasSubstr;

class ObserverFile : public ::testing::Test {
 protected:
  static const Observer& photometer() {
    static const Observer result = Catalogue::standard().observer();
    return result;
  }
  static const Spectrum& d65() {
    static const Spectrum result = Catalogue::standard().illuminant("illuminant/D65");
    return result;
  }
  Observer read(const std::string& text) const {
    std::ofstream(folder_ / "camera.csv") << text;
    return read_observer_csv(folder_ / "camera.csv", photometer(), d65());
  }
  std::string error_of(const std::string& text) const {
    try {
      (void)read(text);
    } catch (const Error& error) {
      EXPECT_EQ(error.detail().kind, ErrorKind::Input);
      return error.what();
    }
    return "no error";
  }
  // The 1931 table at 5 nm under a header, with a separator.
  static std::string table(const std::string& header, const std::string& separator) {
    std::string text = header.empty() ? "" : header + "\n";
    for (int nm = 360; nm <= 830; nm += 5) {
      text += std::to_string(nm);
      for (const Spectrum* curve :
           {&photometer().x_bar, &photometer().y_bar, &photometer().z_bar}) {
        text += separator + std::to_string(curve->value(nm));
      }
      text += "\n";
    }
    return text;
  }

  TemporaryFolder folder_;
};

TEST_F(ObserverFile, named_x_y_z_holds_matching_functions) {
  for (const char* header : {"nm,x,y,z", "wavelength,X,Y,Z", "nm,x_bar,y_bar,z_bar"}) {
    const Observer observer = read(table(header, ","));
    EXPECT_EQ(observer.responses_to_xyz, Mat3d(1.0));
    EXPECT_NEAR(observer.y_bar.value(555.0), 1.0, 1e-6);  // six printed decimals
    EXPECT_EQ(observer.x_bar.value(900.0), 0.0);
  }
}

TEST_F(ObserverFile, of_other_names_or_none_is_a_camera_with_a_fitted_matrix) {
  for (const char* header : {"nm,red,green,blue", ""}) {
    const Observer camera = read(table(header, ","));
    // The functions themselves: the fit finds the identity, by 5 nm and six decimals of the table.
    for (int c = 0; c < 3; ++c) {
      for (int r = 0; r < 3; ++r) {
        EXPECT_NEAR(camera.responses_to_xyz[c][r], c == r ? 1.0 : 0.0, 2e-3);
      }
    }
    EXPECT_THAT(camera.id, HasSubstr("camera"));
  }
}

TEST_F(ObserverFile, may_be_separated_by_commas_semicolons_tabs_or_blanks) {
  const Observer expected = read(table("nm,x,y,z", ","));
  for (const char* separator : {";", "\t", "  ", ", "}) {
    const Observer observer = read("# measured\n\n" + table("", separator));
    EXPECT_EQ(observer.y_bar.value(551.0), expected.y_bar.value(551.0)) << separator;
  }
  EXPECT_EQ(read("\xef\xbb\xbfnm,x,y,z\r\n400,1,1,1\r\n700,1,2,1\r\n").y_bar.value(700.0), 2.0);
}

TEST_F(ObserverFile, id_is_of_the_content_and_not_of_the_path) {
  const Observer first = read(table("nm,x,y,z", ","));
  EXPECT_EQ(read(table("nm,x,y,z", ",")).id, first.id);
  EXPECT_NE(read(table("nm,x,y,z", ";")).id, first.id);
  EXPECT_THAT(first.id, testing::Not(HasSubstr("camera.csv")));
}

TEST_F(ObserverFile, error_names_the_line) {
  EXPECT_THAT(error_of("nm,r,g,b\n400,1,2\n"), HasSubstr("camera.csv:2: found 3 columns"));
  EXPECT_THAT(error_of("nm,r,g,b\n400,1,2,x\n"), HasSubstr("camera.csv:2: found \"x\""));
  EXPECT_THAT(error_of("nm,r,g,b\n400,1,2,nan\n"), HasSubstr("a finite number"));
  EXPECT_THAT(error_of("400,1,2,3\n500,1,2,3\n450,1,2,3\n"), HasSubstr("camera.csv:3"));
  EXPECT_THAT(error_of("0.4,1,2,3\n0.5,1,2,3\n"), HasSubstr("in nm"));
  EXPECT_THAT(error_of(""), HasSubstr("0 rows"));
  EXPECT_THAT(error_of("400,1,2,3\n"), HasSubstr("1 rows"));
  EXPECT_THAT(error_of("400,1,1,1\n500,1,1,1\n700,1,1,1\n"), HasSubstr("not independent"));
  EXPECT_THAT(error_of("nm,x,y,z\n400,1,1,0\n700,1,1,0\n"), HasSubstr("D65 is not positive"));
}

TEST_F(ObserverFile, names_are_those_of_the_catalogue_or_a_usage_error_lists_them) {
  const Catalogue catalogue = Catalogue::standard();
  EXPECT_EQ(observer_named("cie1931", catalogue, photometer(), d65()).id, "observer/cie1931-2deg");
  EXPECT_EQ(observer_named("cie1964", catalogue, photometer(), d65()).id, "observer/cie1964-10deg");
  try {
    (void)observer_named("cie2006", catalogue, photometer(), d65());
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().kind, ErrorKind::Usage);
    EXPECT_THAT(error.what(), HasSubstr("cie1931, cie1964"));
  }
  EXPECT_THROW(observer_named("none.csv", catalogue, photometer(), d65()), Error);
}

}  // namespace
}  // namespace abbe
