// Trials, limits, the order of runs.
#include "host_sim/campaign/campaign_engine.h"

#include <algorithm>

#include <deque>
#include <map>

#include "host_sim/core/errors.h"
#include "host_sim/core/task_progress.h"
#include "host_sim/engine/task_worker.h"
#include "host_sim/engine/worker_pool.h"

namespace screed {
namespace {

constexpr size_t kTrials = 4;
constexpr double kTrialLimit_s = 1800.0;  ///< beds of many particles take minutes to settle
constexpr double kLimitFactor = 10.0;
constexpr double kLimitExtra_s = 60.0;

/// Cells spread over all of them.
std::vector<size_t> cells_to_try(size_t cells) {
  std::vector<size_t> chosen;
  const size_t count = std::min(cells, kTrials);
  for (size_t i = 0; i < count; ++i)
    chosen.push_back(count == 1 ? 0 : i * (cells - 1) / (count - 1));
  return chosen;
}

std::string run_name(size_t run) {
  return "run " + std::to_string(run);
}

}  // namespace

double CampaignTrial::mean_s(double simulated_s) const {
  double sum = 0.0;
  for (const RunCost& cost : costs) sum += cost.of(simulated_s);
  return costs.empty() ? 0.0 : sum / static_cast<double>(costs.size());
}

double CampaignTrial::greatest_s(double simulated_s) const {
  double greatest = 0.0;
  for (const RunCost& cost : costs) greatest = std::max(greatest, cost.of(simulated_s));
  return greatest;
}

CampaignTrial try_campaign(const CampaignPlan& plan, const EngineOptions& options) {
  const std::vector<size_t> cells = cells_to_try(plan.cells.size());
  CampaignTrial trial;
  std::string failure;
  size_t next = 0;
  PoolHandler handler;
  handler.next = [&]() -> std::optional<PoolJob> {
    if (next == cells.size()) return std::nullopt;
    const size_t run = cells[next++] * plan.seed_count();
    return PoolJob{run, trial_request(run), kTrialLimit_s};
  };
  handler.answered = [&](const PoolJob& job, const std::string& text) {
    const WorkerAnswer answer = parse_answer(text);
    trial.memory_mb = std::max(trial.memory_mb, answer.memory_mb);
    if (answer.kind == WorkerAnswer::Kind::kTried && answer.failures.empty()) {
      trial.costs.push_back(parse_cost(answer.trial));
    } else {
      failure = run_name(job.number) + " " +
                (answer.failures.empty() ? answer.message : answer.failures.front().second);
    }
  };
  handler.lost = [&](const PoolJob& job, const std::string& why) {
    failure = run_name(job.number) + " " + why;
  };
  PoolOptions pool;
  pool.arguments = options.worker_arguments;
  pool.log = options.log;
  pool.stop = options.stop;
  run_pool(pool, handler);
  if (options.stop != nullptr && *options.stop) throw TaskStopped("trying runs");
  if (trial.costs.empty())
    throw RunError("none of " + std::to_string(cells.size()) + " runs can be tried; the last: " +
                   failure + "; with [campaign] time_limit and memory no trial is needed");
  return trial;
}

double time_limit_s(const CampaignPlan& plan, size_t run,
                    const std::optional<CampaignTrial>& trial) {
  if (plan.settings.time_limit_s.has_value()) return *plan.settings.time_limit_s;
  const double expected = trial.has_value() ? trial->greatest_s(plan.duration_of(run)) : 0.0;
  return kLimitExtra_s + kLimitFactor * expected;
}

EngineOutcome run_campaign(const CampaignPlan& plan, const EngineOptions& options,
                           const CampaignJob& job) {
  EngineJob tasks;
  tasks.list.id = [&plan](size_t run) { return plan.ids[run]; };
  tasks.list.name = run_name;
  tasks.list.weight = [&plan](size_t run) { return plan.duration_of(run); };
  tasks.list.limit_s = [&](size_t run) { return time_limit_s(plan, run, job.trial); };
  tasks.tasks = job.runs;
  const size_t seeds = plan.seed_count();
  std::stable_sort(tasks.tasks.begin(), tasks.tasks.end(),
                   [seeds](size_t a, size_t b) { return a % seeds < b % seeds; });
  tasks.version = plan.version;
  tasks.workers = job.workers;
  tasks.retries = plan.settings.retries;
  tasks.progress = job.progress;
  return run_tasks(options, tasks);
}

}  // namespace screed
