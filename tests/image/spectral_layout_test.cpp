// The layout of Fichet, Pacanowski & Wilkie (JCGT 10(3), 2021), read from the bytes of a file by
// the letter of the paper and of the EXR file format, without OpenEXR or anything of image/.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>
#include <regex>

#include "abbe/image/exr/exr.h"
#include "image/temporary_folder.h"

namespace abbe {
namespace {

/// A little-endian file of uncompressed scan lines.
class PlainExr {
 public:
  explicit PlainExr(std::vector<std::uint8_t> bytes) : bytes_(std::move(bytes)) {
    EXPECT_EQ(take<std::uint32_t>(), 20000630u);
    EXPECT_EQ(take<std::uint32_t>(), 2u);  // Single part, scan lines, short names, not deep.
    for (std::string name = text(); !name.empty(); name = text()) {
      const std::string type = text();
      const auto size = take<std::int32_t>();
      read_attribute(name, type, static_cast<std::size_t>(size));
    }
    read_lines();
  }

  std::map<std::string, std::string> strings;
  std::map<std::string, float> floats;
  std::map<std::string, std::vector<float>> channels;  ///< In the order of the file.
  std::map<std::string, int> pixel_types;
  int width = 0, height = 0;

 private:
  template <typename T>
  T take() {
    T value;
    std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  std::string text() {
    std::string result(reinterpret_cast<const char*>(bytes_.data()) + at_);
    at_ += result.size() + 1;
    return result;
  }
  void read_attribute(const std::string& name, const std::string& type, std::size_t size) {
    const std::size_t end = at_ + size;
    if (type == "chlist") {
      for (std::string channel = text(); !channel.empty(); channel = text()) {
        pixel_types[channel] = take<std::int32_t>();
        EXPECT_LT(names_.empty() ? "" : names_.back(), channel) << "channels come sorted as text";
        names_.push_back(channel);
        at_ += 12;  // pLinear and the sampling.
      }
    } else if (type == "string") {
      strings[name] = std::string(reinterpret_cast<const char*>(bytes_.data()) + at_, size);
    } else if (type == "float") {
      floats[name] = take<float>();
    } else if (name == "compression") {
      EXPECT_EQ(bytes_[at_], 0) << "this reader knows no compression";
    } else if (name == "dataWindow") {
      const auto x0 = take<std::int32_t>(), y0 = take<std::int32_t>();
      width = take<std::int32_t>() - x0 + 1;
      height = take<std::int32_t>() - y0 + 1;
    }
    at_ = end;
  }
  void read_lines() {
    at_ += static_cast<std::size_t>(height) * 8;  // The table of offsets.
    for (int y = 0; y < height; ++y) {
      EXPECT_EQ(take<std::int32_t>(), y);
      (void)take<std::int32_t>();  // Bytes of the line.
      for (const std::string& name : names_) {
        for (int x = 0; x < width; ++x) {
          ASSERT_EQ(pixel_types[name], 2) << "32-bit floats";
          channels[name].push_back(take<float>());
        }
      }
    }
  }

  std::vector<std::uint8_t> bytes_;
  std::size_t at_ = 0;
  std::vector<std::string> names_;
};

// The grammar of the paper, section 3: Stokes component or T, a value with a comma, prefix, unit.
std::optional<std::pair<std::string, double>> spectral_name(const std::string& channel) {
  static const std::regex pattern(R"(^(S[0-3]|T)\.(\d*,?\d*(?:[eE][+-]?\d+)?)(n|u|m)?m$)");
  std::smatch match;
  if (!std::regex_match(channel, match, pattern)) return std::nullopt;
  std::string value = match[2];
  double number = 0.0;
  const std::size_t comma = value.find(',');
  number = std::stod(value.substr(0, comma));
  if (comma != std::string::npos) {
    const std::string decimals = value.substr(comma + 1);
    number += std::stod(decimals) * std::pow(10.0, -static_cast<double>(decimals.size()));
  }
  const std::string prefix = match[3];
  const double nm = prefix == "n" ? 1.0 : prefix == "u" ? 1e3 : prefix == "m" ? 1e6 : 1e9;
  return std::pair{std::string(match[1]), number * nm};
}

TEST(SpectralLayout, bands_attributes_and_values_are_found_by_an_independent_reader) {
  const TemporaryFolder folder;
  Image image;
  image.width = 3;
  image.height = 2;
  image.channels = {"R", "G", "B"};
  for (int band = 0; band < 94; ++band) {
    image.channels.push_back(spectral_channel_name(362.5 + 5.0 * band));
  }
  image.channels.push_back(reflective_channel_name(362.5));
  for (std::size_t i = 0; i < 6 * image.channel_count(); ++i) {
    image.pixels.push_back(static_cast<float>(i) * 0.25f);
  }
  image.attributes = {{"spectralLayoutVersion", std::string("1.0")},
                      {"emissiveUnits", std::string("W.m^-2.sr^-1")},
                      {"EV", 0.0f}};
  write_exr(folder / "a.exr", image, {.compression = "none"});

  const PlainExr file(bytes_of(folder / "a.exr"));
  EXPECT_EQ(file.strings.at("spectralLayoutVersion"), "1.0");
  EXPECT_EQ(file.strings.at("emissiveUnits"), "W.m^-2.sr^-1");
  EXPECT_EQ(file.floats.at("EV"), 0.0f);
  ASSERT_EQ(file.width, 3);
  ASSERT_EQ(file.height, 2);
  std::map<double, std::string> emissive, reflective;
  for (const auto& [channel, values] : file.channels) {
    const auto name = spectral_name(channel);
    if (!name) continue;
    (name->first == "T" ? reflective : emissive)[name->second] = channel;
  }
  ASSERT_EQ(emissive.size(), 94u);
  EXPECT_EQ(reflective.size(), 1u);
  std::size_t band = 0;
  for (const auto& [wavelength_nm, channel] : emissive) {
    EXPECT_DOUBLE_EQ(wavelength_nm, 362.5 + 5.0 * static_cast<double>(band));
    for (std::size_t p = 0; p < 6; ++p) {
      EXPECT_EQ(file.channels.at(channel)[p], image.pixels[p * image.channel_count() + 3 + band]);
    }
    ++band;
  }
  for (const char* name : {"R", "G", "B"}) EXPECT_TRUE(file.channels.contains(name));
}

}  // namespace
}  // namespace abbe
