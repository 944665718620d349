// The three spectra that stand for the channels of linear Rec.709.

#include "abbe/color/channel_basis.h"

#include <gtest/gtest.h>

#include "abbe/load/spectra/catalogue.h"

namespace abbe {
namespace {

struct Data {
  Observer observer;
  Spectrum d65;
  Development development;
  ChannelBasis basis;
};

const Data& data() {
  static const Data result = [] {
    const Catalogue catalogue = Catalogue::standard();
    Data made{catalogue.observer(), catalogue.illuminant("D65"), {}, {}};
    made.development = development_for(made.observer, made.d65);
    made.basis = channel_basis(made.observer, made.d65, made.development).value();
    return made;
  }();
  return result;
}

TEST(ChannelBasis, each_spectrum_has_the_colour_of_its_primary) {
  for (int channel = 0; channel < 3; ++channel) {
    // By the general integrals, which share no code with the fit's sums.
    const Vec3d rgb_rec709 = rec709_of_reflectance(data().basis[static_cast<std::size_t>(channel)],
                                                   data().observer, data().d65, data().development);
    for (int i = 0; i < 3; ++i) {
      // The fit stops at 1e-12; the rest is rounding of 471 terms.
      EXPECT_NEAR(rgb_rec709[i], i == channel ? 1.0 : 0.0, 1e-9) << channel << i;
    }
  }
}

TEST(ChannelBasis, spectra_are_positive_and_add_up_to_one) {
  for (double nm = 360.0; nm <= 830.0; nm += 1.0) {
    double sum = 0.0;
    for (const Spectrum& spectrum : data().basis) {
      EXPECT_GE(spectrum.value(nm), 0.0) << nm;
      sum += spectrum.value(nm);
    }
    EXPECT_NEAR(sum, 1.0, 1e-12) << nm;  // Rounding.
  }
}

TEST(ChannelBasis, ten_degree_observer_has_one_too) {
  const Catalogue catalogue = Catalogue::standard();
  const Observer wide = catalogue.entry("observer/cie1964-10deg", "").observer.value();
  const Development development = development_for(wide, data().d65);
  const auto basis = channel_basis(wide, data().d65, development);
  ASSERT_TRUE(basis.has_value());
  const Vec3d green = rec709_of_reflectance((*basis)[1], wide, data().d65, development);
  EXPECT_NEAR(green.y, 1.0, 1e-9);  // As above.
}

TEST(ChannelBasis, observer_of_one_sensitivity_has_none) {
  Observer blind = data().observer;
  blind.x_bar = blind.y_bar;
  blind.z_bar = blind.y_bar;
  EXPECT_FALSE(channel_basis(blind, data().d65, data().development).has_value());
}

}  // namespace
}  // namespace abbe
