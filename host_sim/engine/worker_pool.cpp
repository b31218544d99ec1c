// The loop over workers: hand out, wait, take back.
#include "host_sim/engine/worker_pool.h"

#include <poll.h>
#include <sched.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <fstream>
#include <memory>
#include <sstream>
#include <utility>

#include "host_sim/core/child_process.h"
#include "host_sim/core/errors.h"

namespace screed {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kTick(200);
/// Memory is left for everything else.
constexpr double kUsableMemory = 0.9;

/// Seconds with three digits, without trailing zeros.
std::string seconds_text(double seconds) {
  std::ostringstream text;
  text << std::round(seconds * 1e3) / 1e3 << " s";
  return text.str();
}

/// This same program again, be its file replaced meanwhile.
std::unique_ptr<ChildProcess> start_worker(const PoolOptions& options) {
  constexpr const char* kThisProgram = "/proc/self/exe";
  ChildStart start{.words = {std::filesystem::read_symlink(kThisProgram).string()},
                   .program = kThisProgram,
                   .is_sent_lines = true,
                   .output_is_read = true,
                   .log = options.log};
  start.words.insert(start.words.end(), options.arguments.begin(), options.arguments.end());
  try {
    return std::make_unique<ChildProcess>(std::move(start));
  } catch (const RunError& error) {
    throw RunError(std::string("cannot start a worker: ") + error.what());
  }
}

class WorkerSlot {
 public:
  bool has_worker() const { return worker_ != nullptr; }
  bool is_busy() const { return job_.has_value(); }
  int descriptor() const { return worker_->descriptor(); }
  Clock::time_point deadline() const { return deadline_; }

  void start(const PoolOptions& options, PoolJob job) {
    if (!worker_) worker_ = start_worker(options);
    job_ = std::move(job);
    deadline_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                   std::chrono::duration<double>(job_->limit_s));
    worker_->send(job_->request);
  }

  /// Takes what the worker has said.
  void look(const PoolHandler& handler) {
    const bool alive = worker_->receive(said_);
    const size_t end = said_.find('\n');
    if (end != std::string::npos) {
      const std::string answer = std::exchange(said_, "").substr(0, end);
      if (job_.has_value()) handler.answered(*std::exchange(job_, std::nullopt), answer);
    }
    if (!alive) lose(handler, "");
  }

  void end_if_late(const PoolHandler& handler) {
    if (!job_.has_value() || Clock::now() < deadline_) return;
    kill(worker_->pid(), SIGKILL);
    lose(handler, "did not end within " + seconds_text(job_->limit_s));
  }

  /// The worker has no more to do.
  void dismiss() {
    if (!worker_) return;
    worker_->finish();
    worker_->wait();
    worker_.reset();
  }

 private:
  /// `why` is the reason where it is known already.
  void lose(const PoolHandler& handler, std::string why) {
    worker_->wait();
    const std::string how = worker_->end_text();
    worker_.reset();
    said_.clear();
    if (!job_.has_value()) return;
    const PoolJob job = *std::exchange(job_, std::nullopt);
    handler.lost(job, why.empty() ? "its worker " + how : why);
  }

  std::unique_ptr<ChildProcess> worker_;
  std::string said_;  ///< of a line that is not complete yet
  std::optional<PoolJob> job_;
  Clock::time_point deadline_;
};

/// Waits until a worker has said something, or a tick.
void wait_for_any(const std::vector<WorkerSlot>& slots) {
  std::vector<pollfd> ready;
  for (const WorkerSlot& slot : slots)
    if (slot.has_worker()) ready.push_back({slot.descriptor(), POLLIN, 0});
  Clock::time_point until = Clock::now() + kTick;
  for (const WorkerSlot& slot : slots)
    if (slot.is_busy()) until = std::min(until, slot.deadline());
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now()).count();
  static_cast<void>(poll(ready.data(), ready.size(), static_cast<int>(std::max<int64_t>(left, 0))));
}

}  // namespace

void run_pool(const PoolOptions& options, const PoolHandler& handler) {
  std::vector<WorkerSlot> slots(static_cast<size_t>(std::max(1, options.workers)));
  const auto stopped = [&] { return options.stop != nullptr && *options.stop; };
  while (!stopped()) {
    for (WorkerSlot& slot : slots) {
      if (slot.is_busy()) continue;
      std::optional<PoolJob> job = handler.next();
      if (!job.has_value()) break;
      slot.start(options, std::move(*job));
    }
    if (std::none_of(slots.begin(), slots.end(), [](const WorkerSlot& s) { return s.is_busy(); })) {
      for (WorkerSlot& slot : slots) slot.dismiss();
      return;
    }
    wait_for_any(slots);
    for (WorkerSlot& slot : slots) {
      if (slot.has_worker()) slot.look(handler);
      if (slot.has_worker()) slot.end_if_late(handler);
    }
    if (handler.tick) handler.tick();
  }
}

std::optional<double> available_memory_mb() {
  std::ifstream file("/proc/meminfo");
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string name;
    double kilobytes = 0.0;
    if (words >> name >> kilobytes && name == "MemAvailable:") return kilobytes / 1024.0;
  }
  return std::nullopt;
}

int usable_processors() {
  cpu_set_t set;
  CPU_ZERO(&set);
  if (sched_getaffinity(0, sizeof set, &set) != 0) return 1;
  return std::max(1, CPU_COUNT(&set));
}

int workers_that_fit(double memory_mb, int workers) {
  const std::optional<double> available = available_memory_mb();
  if (!available.has_value() || memory_mb <= 0.0) return workers;
  const double by_memory = std::floor(*available * kUsableMemory / memory_mb);
  return static_cast<int>(std::clamp<double>(by_memory, 1.0, workers));
}

}  // namespace screed
