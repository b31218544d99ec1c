// The program as a user meets it, in a folder of its own: a fixture for tests that run it.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/temp_folder.h"

namespace screed::testing {

/// How a run of the program ended.
struct Result {
  int exit_code;
  std::string out;
  std::string err;
};

class Program : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* program = std::getenv("SCREED_PROGRAM");
    // Thrown, since after a failed assertion the SetUp() of a derived fixture would go on, and
    // write its files and logs into the current folder.
    if (program == nullptr) {
      throw std::runtime_error("SCREED_PROGRAM names the program under test; `make test` sets it");
    }
    program_ = program;
    root_ = folder_.path() / "run";
    std::filesystem::create_directories(root_);
  }

  static std::string read(const std::filesystem::path& path) { return read_text(path); }
  void write(const std::string& name, const std::string& text) const {
    write_text(root_ / name, text);
  }

  /// Runs in root_, without what the user's own configuration says; `before` is shell text in front
  /// of the program.
  Result run(const std::string& arguments, const std::string& before = "") const {
    return execute(before + " '" + program_ + "' " + arguments);
  }
  /// The same of any command of the shell.
  Result execute(const std::string& line) const {
    const std::string command = "cd '" + root_.string() + "' && XDG_CONFIG_HOME='" + log("config") +
                                "' && export XDG_CONFIG_HOME && { " + line + "; } > '" +
                                log("out") + "' 2> '" + log("err") + "' < /dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read(log("out")), read(log("err"))};
  }
  /// The same of what writes nothing that could be waited for: Ctrl-C comes once the program
  /// catches it.
  Result interrupted(const std::string& arguments) const {
    return run(arguments +
               " & pid=$!; until grep -q SigCgt:.*4003$ /proc/$pid/status || ! [ -e "
               "/proc/$pid/fd/1 ]; do :; done; kill -INT $pid; wait $pid");
  }
  /// Beside the folder, where no test looks for what the program left.
  std::string log(const char* which) const { return root_.string() + "." + which; }

  /// One line that says all of `parts`, this exit code, and no folder of a run, half or whole.
  void expect_refused(const Result& result, int exit_code,
                      const std::vector<std::string>& parts) const {
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    for (const std::string& part : parts)
      EXPECT_NE(result.err.find(part), std::string::npos) << part << " in: " << result.err;
    EXPECT_FALSE(std::filesystem::exists(root_ / "out"));
    for (const auto& entry : std::filesystem::directory_iterator(root_)) {
      EXPECT_EQ(entry.path().string().find(".partial"), std::string::npos) << entry.path();
    }
  }

  std::string program_;
  std::filesystem::path root_;

 private:
  const TempFolder folder_;
};

}  // namespace screed::testing
