// How far a long piece of work has come, reported to whoever waits for it, who may stop it.
#pragma once

#include <cstddef>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace screed {

/// Receives the name of a task ("laying particles") and its done share, 0..1, which never falls
/// within a task. Several calls a second; the work goes on when it returns. Stops the work by
/// throwing TaskStopped. Sees no state of the work, so that it cannot change a result.
using TaskProgress = std::function<void(std::string_view task, double share)>;

/// The user stopped a task. Its text is the task's name.
class TaskStopped : public std::runtime_error {
 public:
  explicit TaskStopped(std::string_view task) : std::runtime_error(std::string(task)) {}
};

/// Nothing when `progress` is empty.
inline void report_progress(const TaskProgress& progress, std::string_view task, double share) {
  if (progress) progress(task, share);
}

/// `done` of `all` parts; nothing of nothing counts as done.
inline void report_progress(const TaskProgress& progress, std::string_view task, std::size_t done,
                            std::size_t all) {
  report_progress(progress, task,
                  all == 0 ? 1.0 : static_cast<double>(done) / static_cast<double>(all));
}

}  // namespace screed
