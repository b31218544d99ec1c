// What is missing, who does it, what became of it.
#include "host_sim/engine/task_engine.h"

#include <algorithm>
#include <deque>
#include <map>
#include <optional>

#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"
#include "host_sim/engine/result_store.h"
#include "host_sim/engine/task_worker.h"
#include "host_sim/engine/worker_pool.h"

namespace screed {
namespace {

/// After so many failures one behind the other the cause is not in the tasks: a full disk, a
/// missing file.
constexpr size_t kMaxFailuresInARow = 10;
/// A request stays shorter than what a pipe holds, so that sending never waits for a worker.
constexpr size_t kMaxBatch = 1000;

/// The tasks that are still to be executed, and what became of those that were.
class Queue {
 public:
  Queue(const EngineOptions& options, const EngineJob& job) : options_(options), job_(job) {
    const ResultIndex index(options.results);
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
    if (!waiting_.empty()) {
      PoolOptions pool;
      pool.arguments = options_.worker_arguments;
      pool.log = options_.log;
      pool.workers = job_.workers;
      pool.stop = options_.stop;
      run_pool(pool, handler);
    }
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
    if (!writer_) writer_.emplace(options_.results);
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

EngineOutcome run_tasks(const EngineOptions& options, const EngineJob& job) {
  return Queue(options, job).execute();
}

}  // namespace screed
