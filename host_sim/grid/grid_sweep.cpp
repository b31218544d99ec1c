// Sweeps: their runs as tasks of the engine, and the table of their results.
#include "host_sim/grid/grid_sweep.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numeric>
#include <optional>
#include <set>
#include <sstream>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/content_hash.h"
#include "host_sim/core/errors.h"
#include "host_sim/engine/folder_lock.h"
#include "host_sim/engine/result_store.h"
#include "host_sim/engine/scratch_folder.h"
#include "host_sim/engine/worker_pool.h"
#include "host_sim/grid/grid_sweep_worker.h"

namespace screed {
namespace {

/// By point, then run.
using Results = std::vector<std::vector<GridResult>>;

constexpr const char* kColumns =
    "point,run,seed,level,cycles,units,least_units,straight_steps,diagonal_steps";
/// Handing a request to a worker takes some 0.1 ms, a run as little as that.
constexpr double kBatch_s = 0.1;
constexpr int kRetries = 1;
/// A cycle of an agent takes some 15 ns: a run that takes this for each up to its cap hangs.
constexpr double kCycleLimit_s = 1e-6;
constexpr double kLimitExtra_s = 60.0;

void check_options(const SweepOptions& options) {
  if (options.runs < 1 || options.runs > static_cast<int>(kMaxSweepRuns)) {
    throw InputError("grid: runs = " + std::to_string(options.runs) + "; allowed is 1 to " +
                     std::to_string(kMaxSweepRuns));
  }
  if (options.workers < 0 || options.workers > 1024) {
    throw InputError("grid: workers = " + std::to_string(options.workers) +
                     "; allowed is 0 (all cores) to 1024");
  }
}

// ---- the table ---------------------------------------------------------------------------------

/// Equal for sweeps whose runs may stand in one file; the number of runs may grow.
std::string first_lines(const std::vector<SweepPoint>& points) {
  ContentHash hash;
  for (const SweepPoint& point : points) {
    hash.add(point.label);
    for (const auto& [name, value] : describe(point.config)) {
      hash.add(name);
      hash.add(value);
    }
  }
  return "# screed grid sweep " + hash.hex() + "\n" + kColumns + "\n";
}

std::string table_text(const std::vector<SweepPoint>& points, const Results& results) {
  std::ostringstream text;
  text << first_lines(points);
  for (size_t point = 0; point < results.size(); ++point) {
    for (size_t run = 0; run < results[point].size(); ++run) {
      const GridResult& r = results[point][run];
      text << point << ',' << run << ',' << points[point].config.seed + run << ','
           << (r.level ? 1 : 0) << ',' << r.cycles << ',' << r.units << ',' << r.min_units << ','
           << r.straight << ',' << r.diagonal << '\n';
    }
  }
  return text.str();
}

/// Nothing of something else is overwritten, and nothing of this sweep that holds more than the
/// `runs` of the new file.
void check_table(const std::filesystem::path& path, const std::string& head, size_t runs) {
  std::ifstream file(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  if (head.starts_with(text)) return;  // none, or one that was hardly begun
  if (!text.starts_with(head)) {
    throw InputError(path.string() +
                     ": holds the runs of another sweep; name another folder or remove the file");
  }
  const auto lines = static_cast<size_t>(std::count(text.begin(), text.end(), '\n')) - 2;
  if (lines > runs) {
    throw InputError(path.string() + ": holds " + std::to_string(lines) +
                     " runs, more than are stored or asked for; ask for as many, name another "
                     "folder or remove the file");
  }
}

// ---- results -----------------------------------------------------------------------------------

/// The number of runs of a point that are stored without a gap, or that are asked for.
size_t runs_of_table(const SweepPlan& plan, const ResultIndex& index, size_t point, size_t runs) {
  while (index.done(plan.id_of(point, runs))) ++runs;
  return runs;
}

/// All results of a complete sweep, those behind the ones asked for included.
Results stored_results(const SweepPlan& plan, const ResultIndex& index, size_t runs) {
  Results results(plan.points.size());
  for (size_t point = 0; point < results.size(); ++point) {
    const size_t count = runs_of_table(plan, index, point, runs);
    results[point].reserve(count);
    for (size_t run = 0; run < count; ++run)
      results[point].push_back(parse_result(index.read(plan.id_of(point, run)).result));
  }
  return results;
}

/// What was stored before the sweep goes on: notes, and whether its table may be written.
void check_stored(const std::vector<SweepPoint>& points, const SweepPlan& plan,
                  const SweepOptions& options) {
  if (options.folder.empty()) return;
  const ResultIndex index(SweepFolder{options.folder}.results());
  size_t rows = 0;
  for (size_t point = 0; point < points.size(); ++point)
    rows += runs_of_table(plan, index, point, static_cast<size_t>(options.runs));
  if (!options.table.empty()) check_table(options.table, first_lines(points), rows);
  if (!options.note) return;
  const std::set<std::string> known(plan.ids.begin(), plan.ids.end());
  for (const std::string& note : index.oddities(
           [&](const std::string& id) { return known.contains(id.substr(0, id.find('-'))); }))
    options.note(note);
}

// ---- execution ---------------------------------------------------------------------------------

EngineOutcome execute(const std::vector<SweepPoint>& points, const SweepPlan& plan,
                      const SweepOptions& options, const SweepFolder& folder) {
  EngineOptions engine;
  engine.results = folder.results();
  engine.log = folder.log();
  engine.worker_arguments = options.worker_arguments;
  engine.worker_arguments.push_back(std::filesystem::absolute(folder.path).string());
  engine.stop = options.stop;

  EngineJob job;
  job.list.id = [&](size_t task) { return plan.id_of(plan.point_of(task), plan.run_of(task)); };
  job.list.name = [&](size_t task) {
    return points[plan.point_of(task)].label + ", run " + std::to_string(plan.run_of(task));
  };
  job.list.weight = [](size_t) { return 1.0; };
  job.list.limit_s = [&](size_t task) {
    const GridConfig& config = plan.points[plan.point_of(task)];
    return kLimitExtra_s + kCycleLimit_s * config.agents * static_cast<double>(config.max_cycles);
  };
  job.tasks.resize(plan.points.size() * static_cast<size_t>(options.runs));
  std::iota(job.tasks.begin(), job.tasks.end(), size_t{0});
  job.version = plan.version;
  job.workers = options.workers > 0 ? options.workers : usable_processors();
  job.retries = kRetries;
  job.batch_s = kBatch_s;
  job.progress = options.progress;
  return run_tasks(engine, job);
}

[[noreturn]] void fail(const EngineOutcome& outcome) {
  if (!outcome.stopped.empty()) throw RunError("grid: " + outcome.stopped);
  throw RunError("grid: " + std::to_string(outcome.failures.size()) +
                 " runs failed; the first: " + outcome.failures.front());
}

}  // namespace

SweepResult run_sweep(const std::vector<SweepPoint>& points, const SweepOptions& options) {
  check_options(options);
  const SweepPlan plan = make_sweep_plan(points, options.version);
  check_stored(points, plan, options);

  std::optional<ScratchFolder> scratch;
  SweepFolder folder{options.folder};
  if (folder.path.empty()) folder.path = scratch.emplace("grid-sweep").path();
  const FolderLock lock(folder.path, "another sweep is writing to it");
  write_file(folder.plan(), sweep_plan_text(plan));
  const EngineOutcome outcome = execute(points, plan, options, folder);
  if (!outcome.failures.empty()) fail(outcome);

  const auto runs = static_cast<size_t>(options.runs);
  SweepResult sweep;
  sweep.resumed = outcome.done_before;
  sweep.complete = outcome.done_before + outcome.done == points.size() * runs;
  if (!sweep.complete) return sweep;
  sweep.results = stored_results(plan, ResultIndex(folder.results()), runs);
  if (!options.table.empty()) write_file(options.table, table_text(points, sweep.results));
  for (auto& of_point : sweep.results) of_point.resize(runs);
  return sweep;
}

Summary summarise(const std::vector<double>& values) {
  Summary summary;
  if (values.empty()) return summary;
  const auto n = static_cast<double>(values.size());
  for (const double value : values) summary.mean += value / n;
  double squares = 0.0;
  for (const double value : values) squares += (value - summary.mean) * (value - summary.mean);
  if (values.size() > 1) summary.standard_error = std::sqrt(squares / (n - 1.0) / n);
  const auto [minimum, maximum] = std::minmax_element(values.begin(), values.end());
  summary.minimum = *minimum;
  summary.maximum = *maximum;
  return summary;
}

}  // namespace screed
