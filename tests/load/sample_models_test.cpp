// Sample models that others made. They are not part of the project: the group reads them where
// ABBE_REFERENCE_DIR says, and says so where there are none.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "abbe/base/error.h"
#include "abbe/load/gltf.h"
#include "abbe/load/gltf/codec/draco.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

const fs::path kFolder = fs::path(ABBE_REFERENCE_DIR) / "gltf";

// Rows of a tab-separated file, by the names in its first line; none where the file is absent.
std::vector<std::map<std::string, std::string>> read_rows(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  const auto split = [](const std::string& text) {
    std::vector<std::string> fields;
    std::istringstream parts(text);
    for (std::string field; std::getline(parts, field, '\t');) fields.push_back(field);
    return fields;
  };
  std::vector<std::map<std::string, std::string>> rows;
  if (!std::getline(stream, line)) return rows;
  const std::vector<std::string> names = split(line);
  while (std::getline(stream, line)) {
    const std::vector<std::string> fields = split(line);
    std::map<std::string, std::string> row;
    for (std::size_t i = 0; i < std::min(names.size(), fields.size()); ++i) {
      row[names[i]] = fields[i];
    }
    if (!row.empty()) rows.push_back(std::move(row));
  }
  return rows;
}

struct SampleModel {
  std::string path, expectation;
  std::size_t triangles = 0;

  friend void PrintTo(const SampleModel& model, std::ostream* out) { *out << model.path; }
};

std::vector<SampleModel> sample_models() {
  std::vector<SampleModel> models;
  for (auto& row : read_rows(kFolder / "MANIFEST.tsv")) {
    models.push_back({row["path"], row["expectation"], std::stoul("0" + row["triangles"])});
  }
  return models;
}

std::string case_name(const testing::TestParamInfo<SampleModel>& tested) {
  std::string name = tested.param.path;
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
}

class SampleModels : public testing::TestWithParam<SampleModel> {};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(SampleModels);

TEST_P(SampleModels, load_meets_the_manifest) {
  const SampleModel& model = GetParam();
  Notes notes;
  std::optional<Scene> scene;
  std::string error;
  try {
    scene = load_gltf(kFolder / model.path, Catalogue::standard(), {}, notes);
  } catch (const Error& failure) {
    error = failure.what();
  }
  const bool needs_decoder = model.expectation.starts_with("needs-decoder");
  if (model.expectation == "must-render" || (needs_decoder && gltf::has_draco())) {
    ASSERT_TRUE(scene) << error;
    std::size_t triangles = 0;
    for (const Mesh& mesh : scene->meshes) triangles += mesh.triangles.size();
    EXPECT_EQ(triangles, model.triangles);
  } else if (needs_decoder) {
    ASSERT_FALSE(scene);
    EXPECT_NE(error.find("KHR_draco_mesh_compression"), std::string::npos) << error;
  } else if (model.expectation.rfind("missing file", 0) == 0) {
    ASSERT_FALSE(scene);
    const std::string missing = model.expectation.substr(model.expectation.rfind(' ') + 1);
    EXPECT_NE(error.find(missing), std::string::npos) << error;
  } else {
    // Rendered or refused; then the error names the file.
    const std::string file = std::filesystem::path(model.path).filename();
    EXPECT_TRUE(scene || error.find(file) != std::string::npos) << error;
  }
}

INSTANTIATE_TEST_SUITE_P(others, SampleModels, testing::ValuesIn(sample_models()), case_name);

TEST(sample_models, are_there_or_skipped_aloud) {
  if (!fs::exists(kFolder)) {
    GTEST_SKIP() << "no sample models at " << kFolder
                 << "; ABBE_REFERENCE_DIR names a folder whose gltf/ has them";
  }
  EXPECT_GE(sample_models().size(), 40u);
}

}  // namespace
}  // namespace abbe
