/// One binary, every processor: the program at each level of this machine, and on one without AVX.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <set>
#include <string>

#include "abbe/image/exr/exr.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

constexpr int kUsage = 2;

/// A folder of this process, removed when it ends.
class Scratch {
 public:
  Scratch() : folder_(fs::path(testing::TempDir()) / ("abbe_isa_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  fs::path operator/(const std::string& name) const { return folder_ / name; }

 private:
  fs::path folder_;
};

fs::path scratch(const std::string& name) {
  static const Scratch kScratch;
  return kScratch / name;
}

std::string text_of(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Exit code of a shell command whose output goes to a log.
int run(const std::string& command, const fs::path& log) {
  const int status = std::system((command + " > '" + log.string() + "' 2>&1").c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::string render_command(const fs::path& output) {
  return std::string("'") + ABBE_PROGRAM + "' render '" + ABBE_SOURCE_DIR +
         "/scenes/prism/prism.gltf' --size 32x18 --spp 1 --threads 1 --quiet -o '" +
         output.string() + "'";
}

/// Renders the prism, small, with the given environment and launcher before the program.
Image render(const std::string& prefix, const std::string& name) {
  const fs::path picture = scratch(name + ".exr");
  const fs::path log = scratch(name + ".log");
  const int code = run(prefix + " " + render_command(picture), log);
  EXPECT_EQ(code, 0) << prefix << ": " << text_of(log);
  return code == 0 ? read_exr(picture) : Image{};
}

bool machine_has(const std::string& level) {
  const int code =
      run("ABBE_ISA=" + level + " " + render_command(scratch("probe.exr")), scratch("probe.log"));
  return code != kUsage;
}

struct Difference {
  double mean_relative = 0.0;  ///< Mean absolute difference over mean value.
  double worst_share = 0.0;    ///< Share of the values that differ by more than 1 in 1000.
};

Difference difference(const Image& a, const Image& b) {
  Difference result;
  double sum = 0.0, absolute = 0.0;
  std::size_t far = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    const double distance = std::abs(static_cast<double>(a.pixels[i]) - b.pixels[i]);
    sum += std::abs(a.pixels[i]);
    absolute += distance;
    if (distance > 1e-3 * std::abs(a.pixels[i])) ++far;
  }
  result.mean_relative = absolute / sum;
  result.worst_share = static_cast<double>(far) / static_cast<double>(a.pixels.size());
  return result;
}

void expect_same_picture(const Image& a, const Image& b) {
  ASSERT_FALSE(a.pixels.empty());
  ASSERT_EQ(a.channels, b.channels);
  ASSERT_EQ(a.pixels.size(), b.pixels.size());
  const Difference d = difference(a, b);
  // Shading rounds differently where a level has fused multiply-add; a ray at an edge may then fall
  // on its other side, in a few pixels of 576.
  EXPECT_LT(d.mean_relative, 1e-3);
  EXPECT_LT(d.worst_share, 0.01);
}

TEST(Isa, program_renders_the_same_picture_at_every_level_of_the_machine) {
  const Image lowest = render("ABBE_ISA=sse4", "sse4");
  for (const std::string level : {"avx2", "avx512"}) {
    if (!machine_has(level)) {
      std::printf("skipped: this machine lacks %s\n", level.c_str());
      continue;
    }
    SCOPED_TRACE(level);
    expect_same_picture(lowest, render("ABBE_ISA=" + level, level));
  }
}

TEST(Isa, program_refuses_an_unknown_level_as_wrong_usage) {
  EXPECT_EQ(
      run("ABBE_ISA=avx3000 " + render_command(scratch("unknown.exr")), scratch("unknown.log")),
      kUsage);
  EXPECT_FALSE(fs::exists(scratch("unknown.exr")));
}

TEST(Isa, program_runs_on_a_processor_without_avx) {
#ifdef ABBE_SANITIZED
  GTEST_SKIP() << "AddressSanitizer does not run under qemu-user";
#endif
  ASSERT_EQ(std::system("qemu-x86_64 --version > /dev/null 2>&1"), 0) << "not installed";
  // Westmere is the first processor with all that Highway's SSE4 needs. An AVX instruction outside
  // dispatched code is an illegal one there. One level is one picture, on any processor.
  const Image native = render("ABBE_ISA=sse4", "native");
  const Image westmere = render("qemu-x86_64 -cpu Westmere", "westmere");
  ASSERT_FALSE(native.pixels.empty());
  EXPECT_EQ(native.channels, westmere.channels);
  EXPECT_TRUE(native.pixels == westmere.pixels) << "the lowest level differs between processors";
}

TEST(Isa, code_above_the_baseline_lies_only_in_functions_compiled_for_a_level) {
#ifdef ABBE_SANITIZED
  GTEST_SKIP() << "the sanitizers' own code is not built for the baseline";
#endif
  const std::string command = std::string("objdump -d --no-show-raw-insn '") + ABBE_PROGRAM + "'";
  std::unique_ptr<FILE, int (*)(FILE*)> listing(popen(command.c_str(), "r"), pclose);
  ASSERT_TRUE(listing);
  // Every VEX and EVEX mnemonic starts with v; the others come with BMI2.
  const std::set<std::string> bmi = {"andn", "bextr", "bzhi", "mulx", "pdep",
                                     "pext", "rorx",  "sarx", "shlx", "shrx"};
  std::string function;
  std::set<std::string> strays;
  std::size_t vector_instructions = 0;
  std::array<char, 4096> buffer{};
  while (std::fgets(buffer.data(), buffer.size(), listing.get()) != nullptr) {
    const std::string line = buffer.data();
    if (line.ends_with(">:\n")) {
      function = line.substr(line.find('<'));
      continue;
    }
    const std::size_t tab = line.find('\t');
    if (tab == std::string::npos) continue;
    const std::string mnemonic = line.substr(tab + 1, line.find_first_of(" \n", tab) - tab - 1);
    if (!mnemonic.starts_with('v') && !bmi.contains(mnemonic)) continue;
    ++vector_instructions;
    if (function.find("N_AVX") == std::string::npos) strays.insert(function);
  }
  EXPECT_GT(vector_instructions, 1000u) << "the program holds no code above its baseline";
  std::string names;
  for (const std::string& stray : strays) names += "\n  " + stray;
  EXPECT_TRUE(strays.empty()) << "AVX outside dispatched code:" << names;
}

}  // namespace
}  // namespace abbe
