// The worker's side of the engine: executes the tasks that it is sent, one after the other in one
// process, and stores what they yield.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/core/json.h"

namespace screed {

/// What tasks are, for one kind of them. They are numbered from 0.
class TaskExecutor {
 public:
  TaskExecutor() = default;
  TaskExecutor(const TaskExecutor&) = delete;
  TaskExecutor& operator=(const TaskExecutor&) = delete;
  virtual ~TaskExecutor() = default;

  virtual size_t count() const = 0;
  /// Identity of the result: without blanks.
  virtual std::string id(size_t task) const = 0;
  /// The result as JSON text, the same for the same task. Whatever it throws counts as the task's
  /// failure.
  virtual std::string execute(size_t task) = 0;
  /// What a short trial of the task shows, as JSON text. Throws as execute() does.
  virtual std::string attempt(size_t task);
};

/// Requests: to execute tasks, the how manieth time (from 1), and to try one.
std::string execute_request(const std::vector<size_t>& tasks, int attempt);
std::string trial_request(size_t task);

/// What a worker answers to a request, in one line.
struct WorkerAnswer {
  enum class Kind : uint8_t {
    kDone,   ///< all executed and stored; those in `failures` could not be, which is stored as well
    kTried,  ///< `trial`; or it failed
    kStop,   ///< nothing can be stored, or the request is none: `message` says why
  };
  Kind kind = Kind::kStop;
  std::string message;
  std::vector<std::pair<size_t, std::string>> failures;  ///< task, and why
  std::string trial;                                     ///< JSON text
  double seconds = 0.0;                                  ///< of the clock, for the whole request
  double memory_mb = 0.0;                                ///< most that the worker had so far
};
std::string answer_text(const WorkerAnswer& answer);
/// What is no answer counts as kStop.
WorkerAnswer parse_answer(const std::string& text);

/// Answers requests until `requests` ends. Results go into files of the folder `results`, each as
/// soon as its task has ended, with `origin`, the host and the time.
void serve_tasks(TaskExecutor& executor, const std::filesystem::path& results, const Json& origin,
                 std::istream& requests, const std::function<void(const std::string&)>& answer);

}  // namespace screed
