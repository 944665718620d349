#include "program.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <thread>

#include "scenes.h"

namespace abbe::test {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

void redirect(const fs::path& file, int descriptor) {
  const int opened = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (opened < 0 || ::dup2(opened, descriptor) < 0) std::_Exit(126);
}

// Beside the folder of the test, which holds only what the program itself writes.
fs::path log_file(const fs::path& folder, const char* suffix) {
  static std::atomic<int> counter{0};
  return folder.string() + "-" + std::to_string(counter++) + suffix;
}

}  // namespace

Process::Process(const Arguments& arguments, const fs::path& folder,
                 const std::map<std::string, std::string>& environment)
    : out_file_(log_file(folder, ".out")), err_file_(log_file(folder, ".err")) {
  std::vector<std::string> words{ABBE_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_ = ::fork();
  if (pid_ != 0) return;
  redirect(out_file_, STDOUT_FILENO);
  redirect(err_file_, STDERR_FILENO);
  // What the caller has set for itself is not for the tests.
  for (const char* name : {"OCIO", "ABBE_SPECTRA_PATH"}) ::unsetenv(name);
  for (const auto& [name, value] : environment) ::setenv(name.c_str(), value.c_str(), 1);
  if (::chdir(folder.c_str()) != 0) std::_Exit(126);
  ::execv(argv.front(), argv.data());
  std::_Exit(127);
}

Process::~Process() {
  if (pid_ > 0) {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  std::error_code ignored;
  fs::remove(out_file_, ignored);
  fs::remove(err_file_, ignored);
}

void Process::send(int signal) const {
  ::kill(pid_, signal);
}

std::string Process::err() const {
  return text_of(err_file_);
}

Outcome Process::wait(double timeout_seconds) {
  const auto end =
      std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_seconds);
  Outcome run;
  int status = 0;
  while (::waitpid(pid_, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > end) {
      run.timed_out = true;
      ::kill(pid_, SIGKILL);
      ::waitpid(pid_, &status, 0);
      break;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  pid_ = -1;
  if (WIFEXITED(status)) run.exit_code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) run.signal = WTERMSIG(status);
  run.out = text_of(out_file_);
  run.err = text_of(err_file_);
  return run;
}

ProgramTest::ProgramTest() {
  std::string name = (fs::temp_directory_path() / "abbe-cli-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) std::abort();
  folder_ = name;
  write("scene.gltf", small_scene());
}

ProgramTest::~ProgramTest() {
  fs::remove_all(folder_);
}

Outcome ProgramTest::abbe(const Arguments& arguments, double timeout_seconds) const {
  return Process(arguments, folder_, environment_).wait(timeout_seconds);
}

nlohmann::json ProgramTest::parsed(const Arguments& arguments) const {
  const Outcome run = abbe(arguments);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  return nlohmann::json::parse(run.out);
}

std::vector<std::string> ProgramTest::new_files() const {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder_)) {
    const std::string name = entry.path().filename().string();
    if (std::find(inputs_.begin(), inputs_.end(), name) == inputs_.end()) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

void ProgramTest::write(const std::string& name, const std::string& text) const {
  std::ofstream(folder_ / name, std::ios::binary) << text;
  inputs_.push_back(name);
}

std::string ProgramTest::bytes(const std::string& name) const {
  return text_of(folder_ / name);
}

testing::AssertionResult is_one_error_line(const std::string& err) {
  if (!err.starts_with("abbe: error: ")) {
    return testing::AssertionFailure() << "no error message first: " << err;
  }
  if (std::count(err.begin(), err.end(), '\n') != 1 || err.back() != '\n') {
    return testing::AssertionFailure() << "not one line: " << err;
  }
  return testing::AssertionSuccess();
}

}  // namespace abbe::test
