#include "golden/golden_cases.h"

#include <fmt/format.h>

#include <cstdlib>
#include <stdexcept>

#include "image/exr.h"

namespace abbe::golden {

std::filesystem::path Case::reference() const {
  return std::filesystem::path(ABBE_SOURCE_DIR) / "tests/golden/images" / (name + ".exr");
}

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const std::string scene : {"prism", "whitted"}) {
    for (const std::string mode : {"spectral", "rgb", "rgb3"}) {
      all.push_back({scene + "_" + mode, "scenes/" + scene + "/" + scene + ".gltf",
                     "--size 80x45 --spp 8 --mode " + mode});
    }
  }
  for (const std::string scene : {"chart", "metamers", "soap", "metals", "diamond"}) {
    all.push_back({scene + "_spectral", "scenes/" + scene + "/" + scene + ".gltf",
                   "--size 64x36 --spp 4 --mode spectral"});
  }
  return all;
}

void render_to(const Case& golden, const std::filesystem::path& file, const std::string& more) {
  const std::string command =
      fmt::format("\"{}\" render \"{}\" -o \"{}\" --quiet {} {}", ABBE_PROGRAM,
                  (std::filesystem::path(ABBE_SOURCE_DIR) / golden.scene).string(), file.string(),
                  golden.options, more);
  if (std::system(command.c_str()) != 0) throw std::runtime_error("failed: " + command);
}

Image render(const Case& golden, const std::string& more) {
  // One file per process and case: ctest runs cases side by side.
  const std::filesystem::path file = failure_folder() / (golden.name + ".exr");
  render_to(golden, file, more);
  return read_exr(file);
}

std::filesystem::path failure_folder() {
  const std::filesystem::path folder =
      std::filesystem::path(ABBE_PROGRAM).parent_path().parent_path() / "golden";
  std::filesystem::create_directories(folder);
  return folder;
}

}  // namespace abbe::golden
