// Every hostile and every sample file of the reference material, each loaded in this process.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "abbe/base/error.h"
#include "abbe/load/gltf.h"
#include "abbe/scene/validation.h"

namespace abbe {
namespace {

namespace fs = std::filesystem;

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

fs::path reference() {
  return ABBE_REFERENCE_DIR;
}

std::string printable(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
}

struct Outcome {
  std::optional<Scene> scene;
  Notes notes;
  std::string error;
};

Outcome load(const fs::path& file) {
  Outcome outcome;
  try {
    outcome.scene = load_gltf(file, Catalogue::standard(), {}, outcome.notes);
  } catch (const Error& error) {
    outcome.error = error.what();
    EXPECT_EQ(error.detail().kind, ErrorKind::Input) << outcome.error;
    EXPECT_FALSE(error.detail().found.empty() && error.detail().expected.empty());
  }
  return outcome;
}

struct BadFile {
  std::string name, what, expected;

  friend void PrintTo(const BadFile& file, std::ostream* out) { *out << file.name; }
};

std::vector<BadFile> bad_files() {
  std::vector<BadFile> files;
  for (auto& row : read_rows(reference() / "bad/manifest.tsv")) {
    files.push_back({row["name"], row["what"], row["expected"]});
  }
  return files;
}

class HostileFile : public testing::TestWithParam<BadFile> {};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(HostileFile);

std::string content_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::string text_of(const Notes& notes) {
  std::string text;
  for (const Note& note : notes.all()) text += note.where + ": " + note.text + "\n";
  return text;
}

TEST_P(HostileFile, load_meets_the_manifest) {
  const BadFile& file = GetParam();
  const fs::path folder = reference() / "bad";
  const bool is_control = file.expected == "R";
  const std::string control = "00_control_ok" + fs::path(file.name).extension().string();
  if (!is_control && content_of(folder / file.name) == content_of(folder / control)) {
    GTEST_SKIP() << file.name << " holds the bytes of " << control << ": nothing is wrong with it";
  }
  const Outcome outcome = load(folder / file.name);
  if (file.expected == "E") {
    ASSERT_FALSE(outcome.scene) << file.what << ": loaded, but is an error";
    EXPECT_NE(outcome.error.find(file.name), std::string::npos) << outcome.error;
    EXPECT_EQ(outcome.error.find('\n'), std::string::npos) << outcome.error;
  } else if (file.expected == "R") {
    EXPECT_TRUE(outcome.scene) << file.what << ": " << outcome.error;
  } else {
    EXPECT_TRUE(!outcome.scene || !outcome.notes.all().empty())
        << file.what << ": loaded without a word";
  }
  // Whatever loads is fit to be rendered, with a default camera and lights if need be.
  if (outcome.scene) {
    Scene scene = *outcome.scene;
    add_default_camera(scene);
    add_default_lights(scene);
    EXPECT_NO_THROW(validate(scene, file.name));
    const Box3f box = bounds_of(scene);
    if (!box.is_empty()) {
      EXPECT_TRUE(std::isfinite(glm::length(box.size())));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(reference, HostileFile, testing::ValuesIn(bad_files()),
                         [](const auto& file) { return printable(file.param.name); });

struct SampleFile {
  std::string path, expectation;
  std::size_t triangles = 0;

  friend void PrintTo(const SampleFile& file, std::ostream* out) { *out << file.path; }
};

std::vector<SampleFile> sample_files() {
  std::vector<SampleFile> files;
  for (auto& row : read_rows(reference() / "gltf/MANIFEST.tsv")) {
    files.push_back({row["path"], row["expectation"], std::stoul("0" + row["triangles"])});
  }
  return files;
}

class SampleModel : public testing::TestWithParam<SampleFile> {};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(SampleModel);

TEST_P(SampleModel, load_meets_the_manifest) {
  const SampleFile& file = GetParam();
  const Outcome outcome = load(reference() / "gltf" / file.path);
  if (file.expectation == "must-render") {
    ASSERT_TRUE(outcome.scene) << outcome.error;
    std::size_t triangles = 0;
    for (const Mesh& mesh : outcome.scene->meshes) triangles += mesh.triangles.size();
    EXPECT_EQ(triangles, file.triangles) << text_of(outcome.notes);
  } else if (file.expectation.rfind("needs-decoder", 0) == 0) {
    ASSERT_FALSE(outcome.scene);
    EXPECT_NE(outcome.error.find("KHR_draco_mesh_compression"), std::string::npos) << outcome.error;
  } else if (file.expectation.rfind("missing file", 0) == 0) {
    ASSERT_FALSE(outcome.scene);
    const std::string missing = file.expectation.substr(file.expectation.rfind(' ') + 1);
    EXPECT_NE(outcome.error.find(missing), std::string::npos) << outcome.error;
  } else {
    EXPECT_TRUE(outcome.scene || !outcome.error.empty());
  }
}

INSTANTIATE_TEST_SUITE_P(reference, SampleModel, testing::ValuesIn(sample_files()),
                         [](const auto& file) { return printable(file.param.path); });

TEST(gltf_reference, oracle_scenes_load_without_a_warning) {
  if (!fs::exists(reference() / "oracles")) {
    GTEST_SKIP() << "no reference material at " << reference() << ": the oracle scenes are skipped";
  }
  for (const auto& entry : fs::directory_iterator(reference() / "oracles")) {
    if (entry.path().extension() != ".gltf") continue;
    const Outcome outcome = load(entry.path());
    ASSERT_TRUE(outcome.scene) << outcome.error;
    EXPECT_EQ(text_of(outcome.notes), "");
    EXPECT_EQ(outcome.scene->cameras.size(), 1u);
  }
}

TEST(gltf_reference, the_manifests_are_read) {
  if (!fs::exists(reference())) {
    GTEST_SKIP() << "no reference material at " << reference()
                 << ": hostile files and sample models are skipped";
  }
  EXPECT_GE(bad_files().size(), 100u);
  EXPECT_GE(sample_files().size(), 40u);
}

}  // namespace
}  // namespace abbe
