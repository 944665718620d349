#include "support/hostile_inputs.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

namespace abbe::test {
namespace {

namespace fs = std::filesystem;

const fs::path kFolder = fs::path(ABBE_SOURCE_DIR) / "tests/reference/hostile";
constexpr int kDepth = 100000;

std::vector<HostileInput> read_manifest() {
  std::vector<HostileInput> inputs;
  std::ifstream stream(kFolder / "manifest.tsv");
  std::string line;
  std::getline(stream, line);  // The names of the columns.
  while (std::getline(stream, line)) {
    std::istringstream columns(line);
    std::string name, category, what, expected;
    std::getline(columns, name, '\t');
    std::getline(columns, category, '\t');
    std::getline(columns, what, '\t');
    std::getline(columns, expected, '\t');
    inputs.push_back({name, what, expected.empty() ? '?' : expected.front()});
  }
  return inputs;
}

/// A folder of this process for the files that are made, emptied when it ends.
class MadeFiles {
 public:
  MadeFiles() : folder_(fs::temp_directory_path() / ("abbe_hostile_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~MadeFiles() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  fs::path write(const std::string& name, const std::string& text) const {
    const fs::path file = folder_ / name;
    if (!fs::exists(file)) std::ofstream(file) << text;
    return file;
  }

 private:
  fs::path folder_;
};

/// The control, its mesh at the end of a chain of nodes.
std::string chain_of_nodes() {
  nlohmann::json document = nlohmann::json::parse(std::ifstream(kFolder / "00_control_ok.gltf"));
  nlohmann::json& nodes = document["nodes"];
  const std::size_t first = nodes.size();
  for (std::size_t i = 0; i < kDepth; ++i) nodes.push_back({{"children", {first + i + 1}}});
  nodes.push_back({{"mesh", 0}});
  document["scenes"][0]["nodes"] = {1, 2, first};
  return document.dump();
}

std::string nested_arrays() {
  return R"({"asset":{"version":"2.0"},"extras":)" + std::string(kDepth, '[') +
         std::string(kDepth, ']') + "}";
}

}  // namespace

const std::vector<HostileInput>& hostile_inputs() {
  static const std::vector<HostileInput> kInputs = read_manifest();
  return kInputs;
}

fs::path hostile_file(const HostileInput& input) {
  static const MadeFiles kMade;
  if (input.name == "g14_chain_100k.gltf") return kMade.write(input.name, chain_of_nodes());
  if (input.name == "j08_nest_100k.gltf") return kMade.write(input.name, nested_arrays());
  return kFolder / input.name;
}

std::string case_name(const HostileInput& input) {
  std::string name = input.name;
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
}

}  // namespace abbe::test
