// `screed nn escape`: how often the robot gets itself out of traps, against an oracle.
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "host_sim/core/json.h"
#include "host_sim/core/statistics.h"
#include "nn/slip/escape_run.h"
#include "nn/slip/slip_drive.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/progress_bar.h"

namespace screed {
namespace {

struct EscapeArguments {
  std::uint64_t seed = 1;
  std::size_t runs = 100;
  unsigned threads = std::max(1U, std::thread::hardware_concurrency());
  bool no_oracle = false;
  bool all = false;
  bool quiet = false;
  bool json = false;
};

struct Counts {
  int stuck = 0;
  int alone = 0;
  int escaped = 0;
  int recoverable = 0;
  int held = 0;
  int other_faults = 0;
};

void count(Counts& counts, const nn::EscapeResult& result) {
  ++counts.stuck;
  counts.alone += result.out_alone ? 1 : 0;
  counts.escaped += result.out_escape ? 1 : 0;
  counts.recoverable += result.recoverable ? 1 : 0;
  counts.held += result.held ? 1 : 0;
  counts.other_faults += result.fault.empty() ? 0 : 1;
}

struct Figures {
  Counts all;
  std::map<std::string, Counts> by_trap;
  std::map<std::string, Counts> by_ground;
  std::vector<double> times_s;
  std::map<std::string, int> faults;      ///< that ended a drive before the alarm
  std::map<std::string, int> backed_off;  ///< drives in which the robot did so before the alarm
  std::vector<std::string> failed;  ///< seeds of recoverable ones that the escape did not get out
};

std::string trap_of(const nn::EscapeResult& result) {
  return result.scenario.experiment.trap.kind;
}

Figures figures_of(const std::vector<nn::EscapeResult>& results) {
  Figures figures;
  for (const nn::EscapeResult& result : results) {
    if (!result.stuck) {
      if (result.backed_off) ++figures.backed_off[trap_of(result)];
      if (!result.fault.empty()) ++figures.faults[trap_of(result) + ": " + result.fault];
      continue;
    }
    count(figures.all, result);
    count(figures.by_trap[trap_of(result)], result);
    count(figures.by_ground[result.scenario.ground], result);
    if (result.out_escape) {
      figures.times_s.push_back(result.escape_s);
    } else if (result.recoverable) {
      const std::string why = result.held ? "held" : result.fault.empty() ? "time" : result.fault;
      figures.failed.push_back(std::to_string(result.scenario.experiment.experiment.seed) + " (" +
                               trap_of(result) + ", " + result.scenario.ground + ": " + why + ")");
    }
  }
  return figures;
}

std::string share_text(int part, int whole) {
  const Interval interval = wilson(part, whole);
  char text[64];
  std::snprintf(text, sizeof text, "%3d of %3d  %3.0f-%3.0f %%", part, whole, 100.0 * interval.low,
                100.0 * interval.high);
  return text;
}

void print_row(const std::string& name, const Counts& c) {
  std::printf("%-12s %5d   %s   %s   %s   %4d  %4d\n", name.c_str(), c.stuck,
              share_text(c.alone, c.stuck).c_str(), share_text(c.recoverable, c.stuck).c_str(),
              share_text(c.escaped, c.recoverable).c_str(), c.held, c.other_faults);
}

void print(const EscapeArguments& arguments, const Figures& figures) {
  std::printf("%zu drives into a trap; ranges are Wilson's, 95 %%\n", arguments.runs);
  std::printf("%-12s %5s   %-22s   %-22s   %-22s   %4s  %s\n", "", "stuck", "out without escape",
              "recoverable", "out of recoverable", "held", "other faults");
  for (const auto& [trap, counts] : figures.by_trap) print_row(trap, counts);
  print_row("all", figures.all);
  for (const auto& [ground, counts] : figures.by_ground) print_row(ground, counts);
  if (!figures.times_s.empty()) {
    std::printf("time to get out  %.1f s median, %.1f s 95 %%\n", quantile(figures.times_s, 0.5),
                quantile(figures.times_s, 0.95));
  }
  for (const auto& [trap, drives] : figures.backed_off)
    std::printf("backed off before the alarm, %s: %d\n", trap.c_str(), drives);
  for (const auto& [fault, drives] : figures.faults)
    std::printf("ended before the alarm, %s: %d\n", fault.c_str(), drives);
  for (const std::string& failed : figures.failed) std::printf("not out: %s\n", failed.c_str());
}

void print_manoeuvres(const std::vector<nn::EscapeResult>& results) {
  const std::vector<nn::Manoeuvre>& all = nn::oracle_manoeuvres();
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::map<std::string, int> out;
    int sum = 0;
    for (const nn::EscapeResult& result : results) {
      if (!result.stuck || i >= result.out_by.size() || !result.out_by[i]) continue;
      ++out[trap_of(result)];
      ++sum;
    }
    std::printf("%-26s %4d  ", all[i].name.c_str(), sum);
    for (const auto& [trap, times] : out) std::printf(" %s %d", trap.c_str(), times);
    std::printf("\n");
  }
}

Json json_of(const Counts& c) {
  const Interval interval = wilson(c.escaped, c.recoverable);
  return {{"stuck", c.stuck},
          {"out_without_escape", c.alone},
          {"recoverable", c.recoverable},
          {"out", c.escaped},
          {"out_of_recoverable_low", interval.low},
          {"out_of_recoverable_high", interval.high},
          {"held", c.held},
          {"other_faults", c.other_faults}};
}

void print_json(const EscapeArguments& arguments, const Figures& figures) {
  Json traps;
  for (const auto& [trap, counts] : figures.by_trap) traps[trap] = json_of(counts);
  Json backed_off = Json::object();
  for (const auto& [trap, count] : figures.backed_off) backed_off[trap] = count;

  const Json json = {{"first_seed", arguments.seed},
                     {"runs", arguments.runs},
                     {"all", json_of(figures.all)},
                     {"traps", traps},
                     {"backed_off_before_the_alarm", backed_off},
                     {"time_median_s", quantile(figures.times_s, 0.5)},
                     {"time_p95_s", quantile(figures.times_s, 0.95)},
                     {"not_out", figures.failed}};
  std::cout << json.dump(2) << "\n";
}

std::vector<nn::EscapeResult> run_trials(const EscapeArguments& arguments) {
  TaskBar bar(arguments.quiet, "getting out: ");
  const TaskProgress progress = bar.progress();
  std::vector<nn::EscapeResult> results(arguments.runs);
  std::size_t done = 0;
  std::mutex mutex;
  const TaskProgress show = [&](std::string_view task, double /*of_one*/) {
    const std::scoped_lock lock(mutex);
    report_progress(progress, task, done, arguments.runs);
  };
  nn::in_threads(arguments.runs, arguments.threads, [&](std::size_t i) {
    results[i] = nn::escape_trials(arguments.seed + i, {arguments.all, !arguments.no_oracle}, show);
    const std::scoped_lock lock(mutex);
    ++done;
  });
  return results;
}

int run_escape(const EscapeArguments& arguments) {
  const std::vector<nn::EscapeResult> results = run_trials(arguments);
  const Figures figures = figures_of(results);
  if (arguments.json) {
    print_json(arguments, figures);
    return 0;
  }
  print(arguments, figures);
  if (arguments.all) print_manoeuvres(results);
  return 0;
}

}  // namespace

void register_nn_escape_command(Command& nn, Program& program) {
  auto arguments = std::make_shared<EscapeArguments>();
  Command* command = nn.add_subcommand(
      "escape", "Evaluate how the robot gets itself out of traps, against the best manoeuvre");
  add_number(*command, "--seed", arguments->seed,
             "Seed of the first drive; each further drive adds 1", kSeedRange);
  add_number(*command, "--runs", arguments->runs, "Number of drives", {1, 100000});
  add_number(*command, "--threads", arguments->threads,
             "Number of drives run in parallel (default: one per core)", {1, 256});
  command->add_flag("--no-oracle", arguments->no_oracle,
                    "Do not search for a manoeuvre that gets the robot out");
  command->add_flag("--all-manoeuvres", arguments->all,
                    "Try every manoeuvre of the oracle in every drive, and list what each does");
  command->add_flag("--quiet", arguments->quiet, "Show no progress");
  command->add_flag("--json", arguments->json, "Print results as JSON");
  command->callback(
      [arguments, &program] { program.action = [arguments] { return run_escape(*arguments); }; });
}

}  // namespace screed
