/// `--accel`: another accelerator, the same image.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "abbe/accel/accelerator.h"
#include "program.h"

namespace abbe::test {
namespace {

using testing::HasSubstr;

class AcceleratorTest : public ProgramTest {
 protected:
  Outcome render(const std::string& name) const {
    return abbe({"render", "scene.gltf", "--size", "24x16", "--spp", "2", "--accel", name, "-o",
                 name + ".exr", "--stats", name + ".json"});
  }
};

TEST_F(AcceleratorTest, every_name_gives_the_same_bytes_and_is_in_the_statistics) {
  for (const std::string& name : accelerator_names()) {
    const Outcome run = render(name);
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(bytes(name + ".exr"), bytes(accelerator_names().front() + ".exr")) << name;
    EXPECT_EQ(nlohmann::json::parse(bytes(name + ".json"))["accelerator"], name);
  }
}

TEST_F(AcceleratorTest, unknown_name_lists_the_valid_ones) {
  const Outcome run = render("octree");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_TRUE(is_one_error_line(run.err));
  EXPECT_THAT(run.err, HasSubstr("--accel"));
  for (const std::string& name : accelerator_names()) EXPECT_THAT(run.err, HasSubstr(name));
}

}  // namespace
}  // namespace abbe::test
