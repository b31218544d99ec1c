// A progress bar on a terminal; on anything else, a line now and then. Looks at the wall clock,
// decides nothing.
#pragma once

#include <chrono>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>

#include "host_sim/core/task_progress.h"
#include "tools/screed/cli/interrupt.h"

namespace screed {

class ProgressBar {
 public:
  explicit ProgressBar(std::ostream& out);

  /// Shows simulated time, real-time factor since the first call, the time that is left at this
  /// speed, and `note`. Cheap when called often: draws ten times a second at most.
  void show(double time_s, double duration_s, const std::string& note);
  /// The same for work that is not simulated time: the share that is done, 0 to 1.
  void show_share(double share, const std::string& note);
  /// Draws the last state and ends the line.
  void finish();
  /// Removes the bar from a terminal; lines elsewhere stay.
  void clear();

 private:
  void draw();

  std::ostream& out_;
  bool terminal_;
  bool begun_ = false;
  bool visible_ = false;
  bool is_share_ = false;
  double time_s_ = 0.0;
  double duration_s_ = 0.0;
  double begin_time_s_ = 0.0;
  std::string note_;
  std::chrono::steady_clock::time_point begin_;
  std::chrono::steady_clock::time_point shown_;
  std::chrono::steady_clock::time_point drawn_;
};

/// Progress of long tasks on standard error, and Ctrl-C in the midst of them: one bar for each task
/// in turn. A bar disappears from a terminal when its task is done; a task of
/// less than 0.1 s shows none.
class TaskBar {
 public:
  /// While it lives a signal stops the task that reports, by TaskStopped. `quiet`: shows nothing
  /// and stops all the same. `label` stands in front of each task's name.
  explicit TaskBar(bool quiet, std::string label = "");
  TaskBar(const TaskBar&) = delete;
  TaskBar& operator=(const TaskBar&) = delete;
  ~TaskBar() { clear(); }

  /// To hand to the work; refers to this object.
  TaskProgress progress();
  /// Removes the bar, before something else is written.
  void clear();

 private:
  void show(std::string_view task, double share);

  CatchInterrupts signals_;
  bool quiet_;
  std::string label_;
  std::string task_;
  std::optional<ProgressBar> bar_;
};

}  // namespace screed
