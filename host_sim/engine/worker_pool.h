// Jobs for a number of workers: each gets one at a time; one that crashes or hangs costs its job
// and is replaced. Knows nothing of what the jobs are.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace screed {

/// The line that a worker is sent, which it answers with one line.
struct PoolJob {
  size_t number = 0;
  std::string request;
  double limit_s = 0.0;  ///< after this time of the clock its worker is killed
};

struct PoolOptions {
  std::vector<std::string> arguments;  ///< of the program, for a worker
  std::filesystem::path log;           ///< what workers say on standard error
  int workers = 1;
  const std::atomic<bool>* stop = nullptr;  ///< becomes true: kill all workers and return
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
void run_pool(const PoolOptions& options, const PoolHandler& handler);

/// Of `workers` those for whom there is memory now, at least one; memory_mb for each, 0: unknown.
int workers_that_fit(double memory_mb, int workers);
/// Memory that is available now, MB; nothing where it cannot be known.
std::optional<double> available_memory_mb();
/// Processors that this process may use.
int usable_processors();

}  // namespace screed
