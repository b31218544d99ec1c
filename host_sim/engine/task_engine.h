// Executes tasks on the processors of this machine, in worker processes, until each has a result.
// Knows nothing of what the tasks are: campaigns and sweeps of the grid world are two kinds.
//
// Everything is on disk as soon as a task has ended (result_store.h), so this may be killed at any
// time: executed again, it goes on with what is missing.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/engine/task_folder.h"

namespace screed {

/// Where tasks are executed, and by whom.
struct EngineOptions {
  TaskFolder folder;                          ///< of it: results, and workers' standard error
  std::vector<std::string> worker_arguments;  ///< of the program, for a worker (task_worker.h)
  const std::atomic<bool>* stop = nullptr;    ///< becomes true: kill all workers and return
};

/// What the engine has to know of tasks, by their numbers.
struct TaskList {
  std::function<std::string(size_t)> id;    ///< of the result
  std::function<std::string(size_t)> name;  ///< in messages: "run 7"
  std::function<double(size_t)> weight;     ///< share of the work, in any unit
  std::function<double(size_t)> limit_s;    ///< time of the clock that it may take
};

struct EngineProgress {
  size_t tasks = 0;    ///< all that were asked for
  size_t done = 0;     ///< of them, those before included
  size_t failed = 0;   ///< now
  double share = 0.0;  ///< that is done, by weight
};

struct EngineJob {
  TaskList list;
  /// To be executed, in the order in which they are begun; those that are done already included.
  std::vector<size_t> tasks;
  std::string version;  ///< of the program, for what is said of a failure's origin
  int workers = 1;
  int retries = 1;  ///< of a task that crashes or passes its limit
  /// Tasks are handed out together so that they take this time, by those before them; 0: one by
  /// one. Together they are cheaper; those of a worker that ends are tried again one by one.
  double batch_s = 0.0;
  std::function<void(const EngineProgress&)> progress;
};

struct EngineOutcome {
  size_t done_before = 0;
  size_t done = 0;                    ///< now
  std::vector<std::string> failures;  ///< one message a task
  /// Why the engine stopped before all tasks were tried; empty: it did not.
  std::string stopped;
};

/// A task that crashes or passes its limit is tried again, one that fails is not. Throws RunError
/// when results cannot be stored, InputError when those that are stored contradict each other.
EngineOutcome run_tasks(const EngineOptions& options, const EngineJob& job);

// Below it: jobs for a number of workers. Each gets one at a time; one that crashes or hangs costs
// its job and is replaced.

/// The line that a worker is sent, which it answers with one line.
struct PoolJob {
  size_t number = 0;
  std::string request;
  double limit_s = 0.0;  ///< after this time of the clock its worker is killed
};

/// All are called by the thread that runs the pool.
struct PoolHandler {
  /// The next job; nothing while there is none. Asked again after each of the two below.
  std::function<std::optional<PoolJob>()> next;
  std::function<void(const PoolJob&, const std::string& answer)> answered;
  /// Its worker ended, or was killed at the limit: why, in words.
  std::function<void(const PoolJob&, const std::string& why)> lost;
  /// Now and then.
  std::function<void()> tick;
};

/// Returns when next() gives nothing and no worker has a job, or when told to stop. Whatever a
/// callback throws ends the workers and passes. Throws RunError when a worker cannot be started.
void run_pool(const EngineOptions& options, int workers, const PoolHandler& handler);

/// Of `workers` those for whom there is memory now, at least one; memory_mb for each, 0: unknown.
int workers_that_fit(double memory_mb, int workers);
/// Memory that is available now, MB; nothing where it cannot be known.
std::optional<double> available_memory_mb();
/// Processors that this process may use.
int usable_processors();

}  // namespace screed
