// A sweep as tasks of the engine: its plan, what a worker does, and the table of results.
#include "host_sim/grid/grid_sweep.h"

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <istream>
#include <iterator>
#include <numeric>
#include <optional>
#include <set>
#include <sstream>
#include <vector>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/content_hash.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"
#include "host_sim/engine/result_store.h"
#include "host_sim/engine/task_engine.h"
#include "host_sim/engine/task_folder.h"
#include "host_sim/engine/task_worker.h"
#include "host_sim/grid/grid_run.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

// ---- the plan -----------------------------------------------------------------------------------

constexpr PlanFormat kPlanFormat{"screed-grid-sweep", 1, "sweep"};
/// Part of every identity: raised when the same configuration is to count as another run.
constexpr const char* kIdentityRules = "screed grid run 1";

/// Every value of a configuration with its name: `visit(name, value)`.
template <class Config, class Visit>
void for_each_value(Config& config, Visit visit) {
  visit("algorithm", config.algorithm);
  visit("seed", config.seed);
  visit("agents", config.agents);
  visit("max_cycles", config.max_cycles);
  visit("stop", config.stop.measure);
  visit("epsilon", config.stop.epsilon);
  visit("width", config.noise.width);
  visit("height", config.noise.height);
  visit("mean", config.noise.mean);
  visit("amplitude", config.noise.amplitude);
  visit("lattice", config.noise.lattice);
  visit("border", config.noise.border);
  visit("image", config.image);
  visit("image_width", config.image_width);
  visit("image_height", config.image_height);
  visit("white", config.white);
  visit("image_mean", config.image_mean);
  visit("p_sense", config.p_sense);
  visit("p_turn", config.p_turn);
  visit("p_pick_up", config.p_pick_up);
  visit("p_deposit", config.p_deposit);
  visit("k", config.k);
  visit("memory", config.memory);
  visit("fitness_threshold", config.fitness_threshold);
  visit("chromosomes", config.chromosomes);
  visit("repetitions", config.repetitions);
  visit("fitness_base", config.fitness_base);
  visit("averaging", config.averaging);
  visit("dead_band", config.dead_band);
  visit("patience", config.patience);
  visit("hold_out", config.hold_out);
  visit("follows_slope", config.follows_slope);
  visit("turns_back", config.turns_back);
}

template <class Value>
Json json_of(const Value& value) {
  if constexpr (std::is_enum_v<Value>) {
    return static_cast<int>(value);
  } else {
    return value;
  }
}
Json json_of(const fs::path& path) {
  return path.string();
}
template <class Value>
Json json_of(const std::optional<Value>& value) {
  return value.has_value() ? Json(*value) : Json();
}

template <class Value>
void take(const Json& json, Value& value) {
  value = json.get<Value>();
}
void take(const Json& json, fs::path& path) {
  path = json.get<std::string>();
}
template <class Value>
void take(const Json& json, std::optional<Value>& value) {
  if (!json.is_null()) value = json.get<Value>();
}

Json json_of_config(const GridConfig& config) {
  Json json;
  for_each_value(config,
                 [&json](const char* name, const auto& value) { json[name] = json_of(value); });
  return json;
}

GridConfig config_of_json(const Json& json) {
  GridConfig config;
  for_each_value(config, [&json](const char* name, auto& value) { take(json.at(name), value); });
  return config;
}

}  // namespace

GridConfig SweepPlan::config_of(size_t task) const {
  GridConfig config = points[point_of(task)];
  config.seed += run_of(task);
  return config;
}

SweepPlan make_sweep_plan(const std::vector<SweepPoint>& points, const std::string& version) {
  SweepPlan plan;
  plan.version = version;
  for (const SweepPoint& point : points) {
    check(point.config);
    // What an image does not allow shows when its terrain is made.
    if (!point.config.image.empty()) static_cast<void>(GridRun(point.config));
    plan.points.push_back(with_defaults(point.config));
    plan.ids.push_back(identity_of(point.config, version));
  }
  return plan;
}

std::string identity_of(const GridConfig& config, const std::string& version) {
  ContentHash hash;
  hash.add(kIdentityRules);
  hash.add(version);
  try {
    hash.add(json_of_config(with_defaults(config)).dump());
  } catch (const JsonError&) {
    throw InputError("grid: terrain = " + config.image.string() +
                     "; many runs need a name of the image in UTF-8");
  }
  hash.add(config.image.empty() ? "" : file_hash(config.image));
  return hash.hex();
}

std::string sweep_plan_text(const SweepPlan& plan) {
  Json points = Json::array();
  for (size_t i = 0; i < plan.points.size(); ++i)
    points.push_back({{"id", plan.ids[i]}, {"config", json_of_config(plan.points[i])}});
  const Json json = {{"format", kPlanFormat.format},
                     {"format_version", kPlanFormat.version},
                     {"version", plan.version},
                     {"points", points}};
  return json.dump(1) + "\n";
}

SweepPlan read_sweep_plan(const fs::path& file) {
  SweepPlan plan;
  read_plan_file(file, kPlanFormat, [&plan](const Json& json) {
    plan.version = json.at("version").get<std::string>();
    for (const Json& point : json.at("points")) {
      plan.ids.push_back(point.at("id").get<std::string>());
      plan.points.push_back(config_of_json(point.at("config")));
    }
  });
  if (plan.points.empty()) throw InputError(file.string() + ": the plan has no points");
  return plan;
}

// ---- the worker ---------------------------------------------------------------------------------

namespace {

/// JSON. A library for it takes longer than handing over and storing together.
constexpr char kResultForm[] =
    "{\"level\":%d,\"cycles\":%" SCNu64 ",\"units\":%" SCNu64 ",\"least_units\":%" SCNu64
    ",\"straight_steps\":%" SCNu64 ",\"diagonal_steps\":%" SCNu64 "}";

/// The runs of a plan, executed in this process.
class SweepExecutor : public TaskExecutor {
 public:
  explicit SweepExecutor(const TaskFolder& folder)
      : plan_(read_sweep_plan(folder.plan())), is_checked_(plan_.points.size()) {}

  size_t count() const override { return plan_.points.size() * kMaxSweepRuns; }
  std::string id(size_t task) const override {
    return plan_.id_of(plan_.point_of(task), plan_.run_of(task));
  }
  std::string execute(size_t task) override {
    check_identity(plan_.point_of(task));
    return result_text(run_grid(plan_.config_of(task)));
  }

 private:
  /// Nothing has changed since the plan was made: neither the image nor the program.
  void check_identity(size_t point) {
    if (is_checked_[point]) return;
    if (identity_of(plan_.points[point], plan_.version) != plan_.ids[point])
      throw InputError("the image of the terrain or the program has changed meanwhile");
    is_checked_[point] = true;
  }

  SweepPlan plan_;
  std::vector<bool> is_checked_;
};

}  // namespace

std::string result_text(const GridResult& result) {
  std::array<char, 256> text{};
  const int size =
      std::snprintf(text.data(), text.size(), kResultForm, result.level ? 1 : 0, result.cycles,
                    result.units, result.min_units, result.straight, result.diagonal);
  return {text.data(), static_cast<size_t>(size)};
}

GridResult parse_result(const std::string& text) {
  GridResult result;
  int level = 0;
  if (std::sscanf(text.c_str(), kResultForm, &level, &result.cycles, &result.units,
                  &result.min_units, &result.straight, &result.diagonal) != 6) {
    throw RunError("a stored result is not that of a run of the grid world: " + text);
  }
  result.level = level != 0;
  return result;
}

void serve_sweep(const TaskFolder& folder, const std::string& program_version,
                 std::istream& requests, const std::function<void(const std::string&)>& answer) {
  SweepExecutor executor(folder);
  serve_tasks(executor, folder.results(), {{"version", program_version}}, requests, answer);
}

// ---- the sweep ----------------------------------------------------------------------------------

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
void check_table(const fs::path& path, const std::string& head, size_t runs) {
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
  const ResultIndex index(TaskFolder{options.folder}.results());
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

EngineOutcome execute(const std::vector<SweepPoint>& points, const SweepPlan& plan,
                      const SweepOptions& options, const TaskFolder& folder) {
  EngineOptions engine;
  engine.folder = folder;
  engine.worker_arguments = options.worker_arguments;
  engine.worker_arguments.push_back(fs::absolute(folder.path).string());
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
  TaskFolder folder{options.folder};
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
