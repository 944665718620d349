/// Runs the built program as a user does.
#pragma once

#include <gtest/gtest.h>
#include <sys/types.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace abbe::test {

using Arguments = std::vector<std::string>;

/// What a run left behind.
struct Outcome {
  int exit_code = -1;      ///< −1 when it was killed.
  int signal = 0;          ///< By which it was killed.
  bool timed_out = false;  ///< Killed here, because it took too long.
  std::string out, err;
};

/// A started program. Its stdout and stderr go to files in `folder`, which is its working folder.
class Process {
 public:
  Process(const Arguments& arguments, const std::filesystem::path& folder,
          const std::map<std::string, std::string>& environment = {});
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void send(int signal) const;
  /// What it has said on stderr so far.
  std::string err() const;
  /// Waits until it ends, or kills it.
  Outcome wait(double timeout_seconds);

 private:
  std::filesystem::path out_file_, err_file_;
  pid_t pid_ = -1;
};

/// A test with a folder of its own, empty but for `scene.gltf` (see scenes.h).
class ProgramTest : public testing::Test {
 protected:
  ProgramTest();
  ~ProgramTest() override;

  /// A variable of the environment of all runs that follow.
  void set_environment(const std::string& name, const std::string& value) {
    environment_[name] = value;
  }

  /// Runs `abbe` in the folder. A run of a minute hangs: the scenes here take a second.
  Outcome abbe(const Arguments& arguments, double timeout_seconds = 60.0) const;
  /// The same for a run that succeeds in silence and prints JSON.
  nlohmann::json parsed(const Arguments& arguments) const;
  std::filesystem::path file(const std::string& name) const { return folder_ / name; }
  const std::filesystem::path& folder() const { return folder_; }
  /// Names of the files in the folder, hidden ones included, without the inputs.
  std::vector<std::string> new_files() const;
  void write(const std::string& name, const std::string& text) const;
  std::string bytes(const std::string& name) const;

 private:
  std::filesystem::path folder_;
  std::map<std::string, std::string> environment_;
  mutable std::vector<std::string> inputs_;
};

/// Exactly one line, which begins with "abbe: error: ".
testing::AssertionResult is_one_error_line(const std::string& err);

}  // namespace abbe::test
