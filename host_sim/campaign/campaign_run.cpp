// What a worker does for a run; trials, limits and the order of runs.
#include "host_sim/campaign/campaign_run.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <istream>
#include <optional>
#include <system_error>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"
#include "host_sim/core/task_progress.h"
#include "host_sim/engine/task_engine.h"
#include "host_sim/engine/task_folder.h"
#include "host_sim/engine/task_worker.h"
#include "host_sim/run/session/session_layout.h"
#include "host_sim/run/simulation/simulation.h"

namespace screed {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr double kTrial_s = 1.0;  ///< of the clock, in the run's loop

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// Keeps the leveling curve of a run; a point of the time of the last one takes its place.
class CurveKeeper : public SimulationObserver {
 public:
  void on_begin(const HeightField& /*before*/, const HeightField& /*terrain*/) override {}
  void on_tick(std::span<const SimFrame> /*frames*/, const HeightField& /*terrain*/) override {}
  void on_end() override {}
  void on_leveling(const LevelingPoint& point) override {
    if (!points_.empty() && points_.back().time >= point.time) points_.pop_back();
    points_.push_back(point);
  }

  /// A list a point, in the order of kLevelingColumns.
  Json json() const {
    Json rows = Json::array();
    for (const LevelingPoint& point : points_) {
      Json row = Json::array();
#define SCREED_LEVELING_VALUE(name, unit, meaning) row.push_back(point.name);
      SCREED_LEVELING_COLUMNS(SCREED_LEVELING_VALUE)
#undef SCREED_LEVELING_VALUE
      rows.push_back(std::move(row));
    }
    return rows;
  }

 private:
  std::vector<LevelingPoint> points_;
};

/// The runs of a plan, executed in this process.
class CampaignExecutor : public TaskExecutor {
 public:
  CampaignExecutor(const TaskFolder& folder, const OptionsOfWorld& options_of_world)
      : folder_(folder), options_of_world_(options_of_world), plan_(read_plan(folder.plan())) {}

  size_t count() const override { return plan_.run_count(); }
  std::string id(size_t run) const override { return plan_.ids[run]; }

  /// The summary, and the curve where it is kept.
  std::string execute(size_t run) override {
    const Emptied scratch(scratch_);
    const CampaignRun resolved = resolve(run);
    SimulationOptions options = options_of(resolved);
    if (resolved.keep == CampaignKeep::kSession) {
      options.out = folder_.runs() / plan_.ids[run];
      std::error_code ignored;  // of a run whose worker was killed
      fs::remove_all(*options.out, ignored);
      fs::remove_all(options.out->string() + ".partial", ignored);
    }
    CurveKeeper curve;
    if (resolved.keep != CampaignKeep::kSummary) options.observer = &curve;
    const SimulationSummary summary = run_simulation(resolved.experiment, options);
    Json result = Json::parse(summary_json(summary));
    result.erase("version");  // provenance
    if (resolved.keep != CampaignKeep::kSummary) result["curve"] = curve.json();
    return result.dump();
  }

  /// Runs for about a second of the clock. A RunCost.
  std::string attempt(size_t run) override {
    const Emptied scratch(scratch_);
    const CampaignRun resolved = resolve(run);
    SimulationOptions options = options_of(resolved);
    const Clock::time_point begin = Clock::now();
    std::optional<Clock::time_point> first;
    double simulated_s = 0.0;
    std::atomic<bool> stop = false;
    options.stop = &stop;
    options.progress = [&](const SimulationProgress& progress) {
      if (!first.has_value()) first = Clock::now();
      simulated_s = progress.time_s;
      if (seconds_since(*first) > kTrial_s) stop = true;
    };
    const SimulationSummary summary = run_simulation(resolved.experiment, options);
    const double all_s = seconds_since(begin);
    simulated_s = std::max(simulated_s, summary.time_s);
    RunCost cost;
    cost.per_second_s = simulated_s > 0.0 ? summary.wall_s / simulated_s : 0.0;
    const double before_s =
        first.has_value() ? std::chrono::duration<double>(*first - begin).count() : 0.0;
    cost.setup_s = std::min(before_s, all_s - summary.wall_s);
    cost.finish_s = all_s - summary.wall_s - cost.setup_s;
    return cost_text(cost);
  }

 private:
  /// Empties a folder at the end of a run, however that comes.
  class Emptied {
   public:
    explicit Emptied(const ScratchFolder& folder) : folder_(folder) {}
    Emptied(const Emptied&) = delete;
    Emptied& operator=(const Emptied&) = delete;
    ~Emptied() { folder_.clear(); }

   private:
    const ScratchFolder& folder_;
  };

  /// Nothing has changed since the plan was made: neither data files nor the program.
  CampaignRun resolve(size_t run) const {
    CampaignRun resolved = resolve_run(plan_, run);
    if (identity_of(resolved, plan_.version) != plan_.ids[run])
      throw InputError("run " + std::to_string(run) +
                       " is another one than planned: a height map, a robot model or the program "
                       "has changed meanwhile");
    return resolved;
  }

  SimulationOptions options_of(const CampaignRun& run) const {
    SimulationOptions options = options_of_world_(run.world);
    options.table = false;
    options.pictures = false;
    options.out = scratch_.path() / "run";
    return options;
  }

  TaskFolder folder_;
  OptionsOfWorld options_of_world_;
  CampaignPlan plan_;
  ScratchFolder scratch_{"campaign"};
};

}  // namespace

std::string cost_text(const RunCost& cost) {
  return Json({{"setup_s", cost.setup_s},
               {"per_second_s", cost.per_second_s},
               {"finish_s", cost.finish_s}})
      .dump();
}

RunCost parse_cost(const std::string& text) {
  try {
    const Json json = Json::parse(text);
    return {json.at("setup_s").get<double>(), json.at("per_second_s").get<double>(),
            json.at("finish_s").get<double>()};
  } catch (const JsonError&) {
    throw RunError("a worker said of a trial '" + text + "'");
  }
}

void serve_campaign(const TaskFolder& folder, const std::string& program_version,
                    const OptionsOfWorld& options_of_world, std::istream& requests,
                    const std::function<void(const std::string&)>& answer) {
  CampaignExecutor executor(folder, options_of_world);
  serve_tasks(executor, folder.results(),
              {{"version", program_version}, {"arithmetic", arithmetic()}}, requests, answer);
}

// ---- of all runs --------------------------------------------------------------------------------

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
  run_pool(options, 1, handler);
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
