// A worker: another process of a program, which is sent lines and answers with lines.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace screed {

class WorkerProcess {
 public:
  /// Starts this same program with these arguments, in a process group of its own: Ctrl-C does not
  /// reach it. It ends when this process does, however that ends. What it writes on standard error
  /// goes to the end of `log`. Throws RunError.
  WorkerProcess(const std::vector<std::string>& arguments, const std::filesystem::path& log);
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;
  /// Kills it.
  ~WorkerProcess();

  pid_t pid() const { return pid_; }
  /// To wait on until it answers or ends.
  int descriptor() const { return output_; }

  /// A worker that is gone takes nothing, which receive() shows.
  void send(const std::string& line) const;
  /// Puts the lines that have come behind `lines`, without waiting for any. False when the worker
  /// has ended.
  bool receive(std::vector<std::string>& lines);
  /// No more is sent: an orderly worker ends by itself.
  void finish();
  /// Ends it at once.
  void kill();
  /// Waits for its end and says how it came: "ended by signal 11 (Segmentation fault)".
  std::string wait();

 private:
  void close_pipes();

  pid_t pid_ = -1;
  int input_ = -1;
  int output_ = -1;
  std::string received_;  ///< half a line
};

}  // namespace screed
