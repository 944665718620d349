/// EXR files as the program writes them: kept in every way, and opened by other programs.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>

#include "abbe/image/exr/exr.h"
#include "abbe/image/raster/raster.h"
#include "program.h"

namespace abbe::test {
namespace {

using ::testing::HasSubstr;

class ExrTest : public ProgramTest {
 protected:
  void render(const std::string& output, const Arguments& more) const {
    Arguments arguments{"render", "scene.gltf", "-o", output, "--size", "40x24", "--spp", "1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome run = abbe(arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
  }
  /// What a program says about a file; empty where it is not installed.
  std::string said_by(const std::string& program, const std::string& options,
                      const std::string& name) const {
    if (std::system(("command -v " + program + " > /dev/null 2>&1").c_str()) != 0) return "";
    const std::string command = "cd '" + folder().string() + "' && " + program + " " + options +
                                " '" + name + "' > said.txt 2>&1";
    const int status = std::system(command.c_str());
    // exrinfo of OpenEXR 3.1 ends with whatever its stack holds: what it prints has to do.
    if (program != "exrinfo") {
      EXPECT_EQ(status, 0) << bytes("said.txt");
    }
    return bytes("said.txt");
  }
};

const std::vector<Arguments> kWays{{},
                                   {"--half", "--compression", "piz"},
                                   {"--tiles", "16"},
                                   {"--multipart"},
                                   {"--multipart", "--tiles", "16", "--compression", "none"}};

TEST_F(ExrTest, values_are_the_same_however_they_are_kept) {
  const Arguments content{"--bands", "400:700:100", "--aov", "Z,N,albedo,objectId,materialId"};
  render("plain.exr", content);
  const Image plain = read_exr(file("plain.exr"));
  for (const Arguments& way : kWays) {
    if (!way.empty() && way.front() == "--half") continue;
    Arguments arguments = content;
    arguments.insert(arguments.end(), way.begin(), way.end());
    render("kept.exr", arguments);
    const Image kept = read_exr(file("kept.exr"));
    EXPECT_EQ(kept.channels, plain.channels);
    EXPECT_EQ(kept.pixels, plain.pixels);
  }
}

TEST_F(ExrTest, other_programs_open_every_kind_of_file) {
  bool any = false;
  for (const Arguments& way : kWays) {
    Arguments arguments{"--bands", "360:830:5", "--aov", "Z,N,albedo,objectId"};
    arguments.insert(arguments.end(), way.begin(), way.end());
    render("a.exr", arguments);
    const std::string header = said_by("exrheader", "", "a.exr");
    const std::string info = said_by("exrinfo", "", "a.exr");
    const std::string oiio = said_by("oiiotool", "--info -v -a --stats", "a.exr");
    for (const std::string* said : {&header, &info, &oiio}) {
      if (said->empty()) continue;
      any = true;
      EXPECT_THAT(*said, HasSubstr("S0.362,500000nm"));
      EXPECT_THAT(*said, HasSubstr("S0.827,500000nm"));
      EXPECT_THAT(*said, HasSubstr("objectId"));
    }
  }
  EXPECT_TRUE(any) << "none of exrheader, exrinfo and oiiotool is installed";
}

TEST_F(ExrTest, ids_have_the_names_of_the_scene) {
  render("a.exr", {"--aov", "objectId,materialId"});
  const Image image = read_exr(file("a.exr"));
  ASSERT_EQ(image.id_names.size(), 2u);
  for (const IdNames& ids : image.id_names) {
    if (ids.channel != "objectId") continue;
    EXPECT_EQ(ids.names.at(1), "ball");
    EXPECT_EQ(ids.names.at(2), "wall");
  }
  const auto id = image.channel_index("objectId");
  ASSERT_TRUE(id);
  EXPECT_EQ(image.at(20, 12, *id), 1.0f);
}

TEST_F(ExrTest, sixteen_bits_and_dither_are_by_choice) {
  render("a.png", {});
  render("deep.png", {"--bits", "16"});
  render("noisy.png", {"--dither"});
  EXPECT_NE(bytes("a.png"), bytes("noisy.png"));
  const Image a = read_raster(file("a.png"));
  const Image deep = read_raster(file("deep.png"));
  bool finer = false;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    EXPECT_NEAR(a.pixels[i], deep.pixels[i], 0.51f / 255.0f);  // half a code of 8 bits
    finer |= a.pixels[i] != deep.pixels[i];
  }
  EXPECT_TRUE(finer);
}

TEST_F(ExrTest, every_scene_linear_space_is_written_and_shown_alike) {
  render("a.exr", {"--aov", "albedo,direct"});
  ASSERT_EQ(abbe({"display", "a.exr", "-o", "a.png"}).exit_code, 0);
  for (const char* space :
       {"ACES2065-1", "ACEScg", "Linear P3-D65", "Linear Rec.2020", "CIE-XYZ-D65", "CIE-XYZ-E"}) {
    render("b.exr", {"--colorspace", space, "--aov", "albedo,direct"});
    ASSERT_EQ(abbe({"display", "b.exr", "-o", "b.png"}).exit_code, 0);
    // One code: rounding on another way through matrices of floats.
    EXPECT_EQ(abbe({"diff", "b.png", "a.png", "--fail", "max=0.0040"}).exit_code, 0) << space;
    const Outcome colors = abbe({"diff", "b.exr", "a.exr", "--fail", "de2000.max=0.05"});
    EXPECT_EQ(colors.exit_code, 0) << space << colors.out;
    // All layers of colours are in that space.
    const Image a = read_exr(file("a.exr"));
    const Image b = read_exr(file("b.exr"));
    double apart = 0.0;
    for (int x = 0; x < a.width; ++x) {
      apart += std::abs(a.at(x, 12, a.channel_index("direct.R").value()) -
                        b.at(x, 12, b.channel_index("direct.R").value()));
    }
    EXPECT_GT(apart, 0.0) << space;
  }
  for (const char* space : {"ACEScct", "sRGB - Texture", "Raw", "nonsense"}) {
    const Outcome run = abbe({"render", "scene.gltf", "-o", "x.exr", "--colorspace", space});
    EXPECT_EQ(run.exit_code, 2) << space;
    EXPECT_THAT(run.err, HasSubstr("CIE-XYZ-D65"));
  }
}

TEST_F(ExrTest, wrong_ways_to_keep_a_file_are_usage_errors_that_list_the_right_ones) {
  const std::vector<std::pair<Arguments, std::string>> mistakes{
      {{"--compression", "lzw"}, "none, rle, zips, zip, piz"},
      {{"--tiles", "3"}, "8 to 4096"},
      {{"--bits", "10"}, "8 or 16"}};
  for (const auto& [options, says] : mistakes) {
    Arguments arguments{"render", "scene.gltf", "-o", "a.exr"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome run = abbe(arguments);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_THAT(run.err, HasSubstr(says));
  }
}

}  // namespace
}  // namespace abbe::test
