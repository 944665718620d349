/// Ctrl-C: a whole file that says it is not complete.
#include <gmock/gmock.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "abbe/image/exr/exr.h"
#include "program.h"
#include "scenes.h"

namespace abbe::test {
namespace {

class InterruptTest : public ProgramTest {
 protected:
  /// Hours of work, started; it says its first word when it can be interrupted.
  static Arguments endless() {
    return {"render", "dark.gltf", "-o",    "a.exr",  "-o",        "a.png",
            "--size", "64x64",     "--spp", "100000", "--threads", "2"};
  }

  static void wait_for_first_word(const Process& process) {
    using namespace std::chrono_literals;
    for (int i = 0; i < 3000 && process.err().empty(); ++i) std::this_thread::sleep_for(10ms);
  }
};

TEST_F(InterruptTest, sigint_writes_whole_files_marked_incomplete) {
  write("dark.gltf", dark_scene());
  Process process(endless(), folder());
  wait_for_first_word(process);
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  process.send(SIGINT);
  const Outcome run = process.wait(30.0);
  EXPECT_FALSE(run.timed_out);
  EXPECT_EQ(run.exit_code, 130) << run.err;
  EXPECT_THAT(run.err, testing::HasSubstr("interrupted"));
  EXPECT_THAT(new_files(), testing::ElementsAre("a.exr", "a.png"));
  const Image image = read_exr(file("a.exr"));
  EXPECT_EQ(image.width, 64);
  EXPECT_EQ(std::get<int>(image.attributes.at("abbe:complete")), 0);
}

TEST_F(InterruptTest, sigkill_leaves_no_file_at_the_target) {
  write("dark.gltf", dark_scene());
  Process process(endless(), folder());
  wait_for_first_word(process);
  process.send(SIGKILL);
  EXPECT_EQ(process.wait(30.0).signal, SIGKILL);
  EXPECT_THAT(new_files(), testing::IsEmpty());
}

}  // namespace
}  // namespace abbe::test
