// Progress of long tasks on standard error, and Ctrl-C in the midst of them.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "host_sim/core/task_progress.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/progress_bar.h"

namespace screed {

/// One bar for each task in turn. A bar disappears from a terminal when its task is done; a task of
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
