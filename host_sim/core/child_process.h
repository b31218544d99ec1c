// The one way to run another program: beside this one, or to its end for what it prints.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace screed {

struct ChildStart {
  std::vector<std::string> words;      ///< words[0] is found on the path
  std::filesystem::path program = {};  ///< is run in place of words[0], which stays its name
  std::filesystem::path folder = {};   ///< where it runs; empty: here
  bool is_sent_lines = false;          ///< otherwise its input is empty
  bool output_is_read = false;         ///< what it writes on standard output is received here
  bool errors_are_read = false;        ///< the same of standard error
  std::filesystem::path log = {};      ///< the rest of the two is added to it; empty: it is dropped
};

/// A program that runs beside this one and does not outlive it.
class ChildProcess {
 public:
  /// It runs in a process group of its own: Ctrl-C on the terminal does not reach it. Throws
  /// RunError when it cannot be run.
  explicit ChildProcess(ChildStart start);
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  /// Kills it and what it has started, when they still run. The kernel does so to the program
  /// itself when this process is killed.
  ~ChildProcess();

  /// Whether a program of that name was found on the path.
  bool found() const { return child_ > 0; }
  pid_t pid() const { return child_; }
  /// To wait on until it says something or ends; -1 when nothing is read.
  int descriptor() const { return output_; }

  /// What is gone takes nothing; what is read of it shows that.
  void send(const std::string& line) const;
  /// No more is sent.
  void finish();
  /// Adds to `text` what has come, waiting at most so long for some, or for a signal. False when
  /// no more can come.
  bool receive(std::string& text, int wait_ms = 0);
  /// Its exit code once it has ended; -1 when a signal ended it.
  std::optional<int> ended();
  /// Waits for its end; as ended().
  int wait();
  /// How it ended, once it has: "ended by signal 11 (Segmentation fault)".
  std::string end_text() const;

 private:
  std::optional<int> take_end(int flags);

  pid_t child_ = 0;
  int input_ = -1;   ///< the end of the pipe to it
  int output_ = -1;  ///< the end of the pipe from it
  std::optional<int> status_;
};

struct ShellOutput {
  int exit_code = -1;  ///< -1 when a signal ended it, or when it could not be run
  std::string text;
};
/// What a command of the shell prints on standard output, and on standard error with `2>&1`.
ShellOutput shell_output(const std::string& command);

}  // namespace screed
