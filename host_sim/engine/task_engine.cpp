// The loop over workers: hand out, wait, take back. Above it: what is missing, and what became of
// it.
#include "host_sim/engine/task_engine.h"

#include <poll.h>
#include <sched.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <deque>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <utility>

#include "host_sim/core/child_process.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"
#include "host_sim/engine/result_store.h"
#include "host_sim/engine/task_worker.h"

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
std::unique_ptr<ChildProcess> start_worker(const EngineOptions& options) {
  constexpr const char* kThisProgram = "/proc/self/exe";
  ChildStart start{.words = {std::filesystem::read_symlink(kThisProgram).string()},
                   .program = kThisProgram,
                   .is_sent_lines = true,
                   .output_is_read = true,
                   .log = options.folder.log()};
  start.words.insert(start.words.end(), options.worker_arguments.begin(),
                     options.worker_arguments.end());
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

  void start(const EngineOptions& options, PoolJob job) {
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

/// After so many failures one behind the other the cause is not in the tasks: a full disk, a
/// missing file.
constexpr size_t kMaxFailuresInARow = 10;
/// A request stays shorter than what a pipe holds, so that sending never waits for a worker.
constexpr size_t kMaxBatch = 1000;

/// The tasks that are still to be executed, and what became of those that were.
class Queue {
 public:
  Queue(const EngineOptions& options, const EngineJob& job) : options_(options), job_(job) {
    const ResultIndex index(options.folder.results());
    for (const size_t task : job.tasks) {
      all_weight_ += job.list.weight(task);
      if (index.done(job.list.id(task))) {
        ++outcome_.done_before;
        done_weight_ += job.list.weight(task);
      } else {
        waiting_.push_back({task, 1, false});
      }
    }
  }

  EngineOutcome execute() {
    report();
    PoolHandler handler;
    handler.next = [this] { return next(); };
    handler.answered = [this](const PoolJob& job, const std::string& text) {
      answered(take_batch(job), parse_answer(text));
    };
    handler.lost = [this](const PoolJob& job, const std::string& why) {
      lost(take_batch(job), why);
    };
    handler.tick = [this] { report(); };
    if (!waiting_.empty()) run_pool(options_, job_.workers, handler);
    report();
    return std::move(outcome_);
  }

 private:
  struct Task {
    size_t number;
    int attempt;
    bool alone;  ///< in a request of its own
  };
  using Batch = std::vector<Task>;

  /// How many tasks take `batch_s`; towards the end fewer, so that all workers have some.
  size_t batch_size() const {
    if (executed_ == 0 || job_.batch_s <= 0.0) return 1;
    const double mean_s = executed_s_ / static_cast<double>(executed_);
    const double fit = mean_s > 0.0 ? job_.batch_s / mean_s : static_cast<double>(kMaxBatch);
    const size_t share = waiting_.size() / (2 * static_cast<size_t>(std::max(1, job_.workers)));
    const size_t most = std::clamp<size_t>(share, 1, kMaxBatch);
    return static_cast<size_t>(std::clamp(fit, 1.0, static_cast<double>(most)));
  }

  std::optional<PoolJob> next() {
    if (waiting_.empty() || !outcome_.stopped.empty()) return std::nullopt;
    const size_t size = batch_size();
    Batch batch;
    std::vector<size_t> numbers;
    double limit_s = 0.0;
    do {
      batch.push_back(waiting_.front());
      numbers.push_back(batch.back().number);
      limit_s += job_.list.limit_s(batch.back().number);
      waiting_.pop_front();
    } while (batch.size() < size && !waiting_.empty() && !batch.front().alone &&
             !waiting_.front().alone);
    PoolJob request{next_batch_++, execute_request(numbers, batch.front().attempt), limit_s};
    batches_.emplace(request.number, std::move(batch));
    return request;
  }

  Batch take_batch(const PoolJob& job) { return std::move(batches_.extract(job.number).mapped()); }

  void answered(const Batch& batch, const WorkerAnswer& answer) {
    if (answer.kind != WorkerAnswer::Kind::kDone) throw RunError(answer.message);
    executed_ += batch.size();
    executed_s_ += answer.seconds;
    const std::map<size_t, std::string> failures(answer.failures.begin(), answer.failures.end());
    for (const Task& task : batch) {
      const auto failure = failures.find(task.number);
      if (failure != failures.end()) {
        fail(task.number, failure->second);
        continue;
      }
      ++outcome_.done;
      done_weight_ += job_.list.weight(task.number);
      failures_in_a_row_ = 0;
    }
  }

  /// Its worker crashed, or passed the limit.
  void lost(const Batch& batch, const std::string& why) {
    if (batch.size() > 1) {  // by which of them, one by one will show
      for (auto task = batch.rbegin(); task != batch.rend(); ++task)
        waiting_.push_front({task->number, task->attempt, true});
      return;
    }
    const Task task = batch.front();
    store_failure(task, why);
    if (task.attempt <= job_.retries) {
      waiting_.push_front({task.number, task.attempt + 1, true});
    } else {
      fail(task.number, why);
    }
  }

  void store_failure(const Task& task, const std::string& why) {
    if (!writer_) writer_.emplace(options_.folder.results());
    writer_->append({job_.list.id(task.number), ResultStatus::kFailed,
                     Json::object({{"error", why}}).dump(),
                     Json::object({{"version", job_.version}, {"attempt", task.attempt}}).dump()});
  }

  void fail(size_t task, const std::string& why) {
    outcome_.failures.push_back(job_.list.name(task) + " " + why);
    if (++failures_in_a_row_ < kMaxFailuresInARow) return;
    outcome_.stopped =
        "the last " + std::to_string(kMaxFailuresInARow) + " runs all failed; the last one " + why;
  }

  void report() const {
    if (!job_.progress) return;
    job_.progress({job_.tasks.size(), outcome_.done_before + outcome_.done,
                   outcome_.failures.size(), all_weight_ > 0.0 ? done_weight_ / all_weight_ : 1.0});
  }

  const EngineOptions& options_;
  const EngineJob& job_;
  std::deque<Task> waiting_;
  std::map<size_t, Batch> batches_;  ///< that workers have
  size_t next_batch_ = 0;
  std::optional<ResultWriter> writer_;  ///< of failures, from the first on
  EngineOutcome outcome_;
  size_t failures_in_a_row_ = 0;
  size_t executed_ = 0;      ///< tasks of answered requests
  double executed_s_ = 0.0;  ///< that workers took for them
  double all_weight_ = 0.0;
  double done_weight_ = 0.0;
};

}  // namespace

void run_pool(const EngineOptions& options, int workers, const PoolHandler& handler) {
  std::vector<WorkerSlot> slots(static_cast<size_t>(std::max(1, workers)));
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

EngineOutcome run_tasks(const EngineOptions& options, const EngineJob& job) {
  return Queue(options, job).execute();
}

}  // namespace screed
