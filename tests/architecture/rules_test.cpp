/// The checker itself, on texts made to break each rule.
#include "architecture/rules.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace abbe::architecture {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(Rules, include_of_lower_floors_and_of_the_own_module_passes) {
  EXPECT_THAT(
      include_violations("optics/fresnel.cpp",
                         "#include \"abbe/optics/fresnel.h\"\n\n#include <cmath>\n"
                         "#include <hwy/highway.h>\n#include <glm/vec3.hpp>\n\n"
                         "#include \"abbe/base/error.h\"\n#include \"abbe/spectrum/spectrum.h\"\n"),
      IsEmpty());
}

TEST(Rules, include_of_a_higher_floor_fails_with_its_line) {
  EXPECT_THAT(
      include_violations("optics/fresnel.h", "#pragma once\n#include \"abbe/scene/scene.h\"\n"),
      ElementsAre("optics/fresnel.h:2: optics (floor 3) includes scene (floor 4), expected "
                  "only lower floors"));
}

TEST(Rules, include_sideways_fails) {
  EXPECT_THAT(include_violations("color/uplift.cpp", "#include \"abbe/optics/snell.h\"\n"),
              ElementsAre(HasSubstr("color (floor 3) includes optics (floor 3)")));
  EXPECT_THAT(include_violations("accel/kd_tree.cpp", "  #  include <abbe/spectrum/spectrum.h>\n"),
              ElementsAre(HasSubstr("accel (floor 2) includes spectrum (floor 2)")));
}

TEST(Rules, include_by_a_relative_path_fails) {
  EXPECT_THAT(include_violations("math/ray.cpp", "#include \"../base/error.h\"\n"),
              testing::Contains(HasSubstr("expected abbe/module/file.h")));
}

TEST(Rules, include_of_ours_without_our_prefix_fails) {
  EXPECT_THAT(include_violations("math/ray.cpp", "#include \"base/error.h\"\n"),
              ElementsAre(HasSubstr("expected abbe/base/error.h")));
}

TEST(Rules, parts_that_include_each_other_fail) {
  // A file beside folders may be the ground of one part and the roof of another.
  EXPECT_THAT(part_violations({{"accel/build.cpp", "#include \"abbe/accel/kd/tree.h\"\n"},
                               {"accel/kd/tree.h", "#include \"abbe/accel/leaf/solids.h\"\n"},
                               {"accel/kd/build/sah.h", "#include \"abbe/accel/kd/layout.h\"\n"},
                               {"accel/leaf/solids.h", "#include \"abbe/accel/query.h\"\n"}}),
              IsEmpty());
  EXPECT_THAT(part_violations({{"accel/kd/tree.h", "\n#include \"abbe/accel/leaf/solids.h\"\n"},
                               {"accel/leaf/solids.h", "#include \"abbe/accel/query.h\"\n"},
                               {"accel/leaf/order.h", "#include \"abbe/accel/grid/cells.h\"\n"},
                               {"accel/grid/cells.h", "#include \"abbe/accel/kd/tree.h\"\n"}}),
              testing::Contains(HasSubstr("accel/kd and accel/leaf include each other: "
                                          "accel/kd/tree.h:2 includes accel/leaf/solids.h")));
}

TEST(Rules, folder_of_too_many_files_fails) {
  std::map<std::string, std::string> texts;
  for (int i = 0; i < 20; ++i) texts["accel/kd_" + std::to_string(i) + ".h"];
  EXPECT_THAT(crowd_violations(texts), IsEmpty());
  texts["accel/kd_20.cpp"];
  EXPECT_THAT(crowd_violations(texts), ElementsAre(HasSubstr("accel: 21 source files")));
}

TEST(Rules, file_of_an_unknown_module_fails) {
  EXPECT_THAT(include_violations("utils/strings.cpp", ""),
              ElementsAre(HasSubstr("src/abbe/utils is no module")));
}

TEST(Rules, quoted_include_that_names_no_module_fails) {
  EXPECT_THAT(include_violations("load/gltf.cpp", "#include \"nowhere/strings.h\"\n"),
              ElementsAre(HasSubstr("names no module")));
}

TEST(Rules, third_party_header_outside_its_rim_fails) {
  const auto complaint = [](const std::string& path, const std::string& header) {
    return include_violations(path, "#include <" + header + ">\n");
  };
  EXPECT_THAT(complaint("film/film.cpp", "OpenEXR/ImfHeader.h"), ElementsAre(HasSubstr("OpenEXR")));
  EXPECT_THAT(complaint("film/film.cpp", "ImfHeader.h"), ElementsAre(HasSubstr("OpenEXR")));
  EXPECT_THAT(complaint("scene/scene.cpp", "Imath/half.h"), ElementsAre(HasSubstr("OpenEXR")));
  EXPECT_THAT(complaint("world/texture.cpp", "OpenImageIO/texture.h"),
              ElementsAre(HasSubstr("OpenImageIO outside its rim")));
  EXPECT_THAT(complaint("image/exr.cpp", "OpenColorIO/OpenColorIO.h"),
              ElementsAre(HasSubstr("OpenColorIO outside its rim")));
  EXPECT_THAT(complaint("scene/scene.cpp", "tiny_gltf.h"), ElementsAre(HasSubstr("tinygltf")));
  EXPECT_THAT(complaint("load/gltf.cpp", "CLI/CLI.hpp"), ElementsAre(HasSubstr("CLI11")));
  EXPECT_THAT(complaint("accel/kd_tree.cpp", "embree3/rtcore.h"), ElementsAre(HasSubstr("Embree")));
  EXPECT_THAT(complaint("base/error.cpp", "gtest/gtest.h"), ElementsAre(HasSubstr("GoogleTest")));
  EXPECT_THAT(complaint("scene/scene.cpp", "nlohmann/json.hpp"), ElementsAre(HasSubstr("json")));
}

TEST(Rules, third_party_header_inside_its_module_passes) {
  EXPECT_THAT(include_violations("image/exr.cpp", "#include <OpenEXR/ImfHeader.h>\n"), IsEmpty());
  EXPECT_THAT(leak_violations({{"load/nodes.h", "#include <tiny_gltf.h>\n"},
                               {"load/gltf.h", "#include \"abbe/base/notes.h\"\n"},
                               {"load/gltf.cpp", "#include \"abbe/load/nodes.h\"\n"},
                               {"world/world.cpp", "#include \"abbe/load/gltf.h\"\n"}}),
              IsEmpty());
}

TEST(Rules, header_that_carries_a_third_party_out_of_its_module_fails) {
  EXPECT_THAT(leak_violations({{"load/nodes.h", "#include <tiny_gltf.h>\n"},
                               {"load/gltf.h", "#include \"abbe/load/nodes.h\"\n"},
                               {"cli/render.cpp", "\n#include \"abbe/load/gltf.h\"\n"}}),
              ElementsAre("cli/render.cpp:2: load/gltf.h brings tinygltf out of its module"));
}

TEST(Rules, link_edge_up_or_sideways_fails) {
  EXPECT_THAT(link_violations("math/CMakeLists.txt",
                              "abbe_module(math DEPENDS base PUBLIC_LIBRARIES glm::glm)\n"),
              IsEmpty());
  EXPECT_THAT(link_violations("math/CMakeLists.txt",
                              "abbe_module(math LIBRARIES glm::glm\n  DEPENDS base scene)\n"),
              ElementsAre(HasSubstr("math (floor 1) links scene (floor 4)")));
  EXPECT_THAT(link_violations("color/CMakeLists.txt", "abbe_module(color DEPENDS base optics)\n"),
              ElementsAre(HasSubstr("color (floor 3) links optics (floor 3)")));
  EXPECT_THAT(link_violations("color/CMakeLists.txt", "add_library(color color.cpp)\n"),
              ElementsAre(HasSubstr("declares no abbe_module")));
}

TEST(Rules, unknown_top_level_folder_fails) {
  EXPECT_THAT(top_level_violations({"src", "tests", ".ci", "spectra", "scenes", "config"}),
              IsEmpty());
  EXPECT_THAT(top_level_violations({"src", "docs"}), ElementsAre(HasSubstr("docs/")));
}

TEST(Rules, machine_path_fails_with_its_line) {
  // Written in two parts, so that this file passes the rule it tests.
  const std::string home = std::string("/ho") + "me/ada/abbe";
  EXPECT_THAT(machine_path_violations("README.md", "one\ncd " + home + "\n"),
              ElementsAre(HasSubstr("README.md:2: ")));
  EXPECT_THAT(machine_path_violations("a.gltf", "\"uri\": \"file://" + home + "\""),
              testing::SizeIs(1));
  EXPECT_THAT(machine_path_violations("a.cpp", std::string("\"/wo") + "rk/main\""),
              testing::SizeIs(1));
  EXPECT_THAT(machine_path_violations("README.md", "scenes/home/a.gltf, ${x}/home/a, ../work/b"),
              IsEmpty());
}

TEST(Rules, name_without_a_subject_fails) {
  EXPECT_THAT(name_violations("src/math/utils.h"), testing::SizeIs(1));
  EXPECT_THAT(name_violations("src/common/ray.h"), testing::SizeIs(1));
  EXPECT_THAT(name_violations("src/load/gltf_helpers.cpp"), testing::SizeIs(1));
  EXPECT_THAT(name_violations("src/load/gltf.cpp"), IsEmpty());
  EXPECT_THAT(name_violations("src/film/miscut.cpp"), IsEmpty());
}

}  // namespace
}  // namespace abbe::architecture
