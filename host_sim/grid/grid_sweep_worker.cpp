// From a task of a sweep to its result as text, and back.
#include "host_sim/grid/grid_sweep_worker.h"

#include <array>
#include <cinttypes>
#include <cstdio>
#include <istream>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/engine/task_worker.h"
#include "host_sim/grid/grid_run.h"
#include "host_sim/grid/grid_sweep_plan.h"

namespace screed {
namespace {

/// JSON. A library for it takes longer than handing over and storing together.
constexpr char kResultForm[] =
    "{\"level\":%d,\"cycles\":%" SCNu64 ",\"units\":%" SCNu64 ",\"least_units\":%" SCNu64
    ",\"straight_steps\":%" SCNu64 ",\"diagonal_steps\":%" SCNu64 "}";

/// The runs of a plan, executed in this process.
class SweepExecutor : public TaskExecutor {
 public:
  explicit SweepExecutor(const SweepFolder& folder)
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

void serve_sweep(const SweepFolder& folder, const std::string& program_version,
                 std::istream& requests, const std::function<void(const std::string&)>& answer) {
  SweepExecutor executor(folder);
  serve_tasks(executor, folder.results(), {{"version", program_version}}, requests, answer);
}

}  // namespace screed
