// `screed nn stuck`: the robot's slip watch in seeded drives, and the training of its network.
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/quantile.h"
#include "nn/slip/slip_training.h"
#include "nn/slip/stuck_run.h"
#include "nn/slip/stuck_scenario.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/task_bar.h"

namespace screed {
namespace {

constexpr double kTrapped_s = 14.0;

struct StuckArguments {
  std::uint64_t seed = 1;
  std::size_t runs = 100;
  double free_s = 120.0;
  unsigned threads = std::max(1U, std::thread::hardware_concurrency());
  std::string train;
  std::size_t epochs = nn::SlipTrainingOptions{}.epochs;
  std::size_t hidden = nn::SlipTrainingOptions{}.hidden;
  std::string experiment;
  bool quiet = false;
  bool json = false;
};

std::vector<nn::StuckScenario> scenarios(const StuckArguments& arguments, bool trapped) {
  std::vector<nn::StuckScenario> all;
  for (std::size_t i = 0; i < arguments.runs; ++i) {
    all.push_back(
        nn::stuck_scenario(arguments.seed + i, trapped, trapped ? kTrapped_s : arguments.free_s));
  }
  return all;
}

struct Share {
  int dug_in = 0;
  int detected = 0;
};

struct Figures {
  Share all;
  std::map<std::string, Share> by_trap;
  std::map<std::string, Share> by_ground;
  std::vector<double> delays_s;
  nn::FreeResult free;
  std::map<std::string, nn::FreeResult> free_by_ground;
  int failures = 0;
  std::vector<std::string> missed;
};

void count(Share& share, bool detected) {
  ++share.dug_in;
  share.detected += detected ? 1 : 0;
}

void add(nn::FreeResult& sum, const nn::FreeResult& result) {
  sum.driven_s += result.driven_s;
  sum.false_alarms += result.false_alarms;
  sum.recovered_alarms += result.recovered_alarms;
  sum.other_alarms += result.other_alarms;
}

Figures figures_of(const std::vector<nn::SlipRun>& trapped, const std::vector<nn::SlipRun>& free) {
  Figures figures;
  for (const nn::SlipRun& run : trapped) {
    figures.failures += run.failure.empty() ? 0 : 1;
    const auto dug_in = nn::dug_in_at(run);
    if (!dug_in) continue;
    const nn::DetectionResult result = nn::detection_of(run, *dug_in);
    count(figures.all, result.detected);
    count(figures.by_trap[run.scenario.experiment.trap.kind], result.detected);
    count(figures.by_ground[run.scenario.ground], result.detected);
    if (result.detected) {
      figures.delays_s.push_back(result.delay_s);
    } else {
      figures.missed.push_back(std::to_string(run.scenario.experiment.experiment.seed));
    }
  }
  for (const nn::SlipRun& run : free) {
    figures.failures += run.failure.empty() ? 0 : 1;
    const nn::FreeResult result = nn::alarms_of(run);
    add(figures.free, result);
    add(figures.free_by_ground[run.scenario.ground], result);
  }
  return figures;
}

double rate(const Share& share) {
  return share.dug_in == 0 ? 0.0 : static_cast<double>(share.detected) / share.dug_in;
}

double an_hour(const nn::FreeResult& result) {
  return result.driven_s <= 0.0 ? 0.0 : result.false_alarms / (result.driven_s / 3600.0);
}

void print(const StuckArguments& arguments, const Figures& figures) {
  std::printf("%zu drives into a trap, %d of them dug in\n", arguments.runs, figures.all.dug_in);
  std::printf("  detected within 1 s     %d, %.1f %% (must be 95 %%)\n", figures.all.detected,
              100.0 * rate(figures.all));
  if (!figures.delays_s.empty()) {
    std::printf("  delay                   %.2f s median, %.2f s 95 %%\n",
                quantile(figures.delays_s, 0.5), quantile(figures.delays_s, 0.95));
  }
  for (const auto& [trap, share] : figures.by_trap) {
    std::printf("  %-22s  %d of %d\n", trap.c_str(), share.detected, share.dug_in);
  }
  std::printf("%zu drives without\n", arguments.runs);
  std::printf("  driven                  %.2f h\n", figures.free.driven_s / 3600.0);
  std::printf("  false alarms            %d, %.2f an hour (must be 1)\n", figures.free.false_alarms,
              an_hour(figures.free));
  std::printf("  alarms as it came free  %d\n", figures.free.recovered_alarms);
  std::printf("  alarms while it hardly moved  %d\n", figures.free.other_alarms);
  std::printf("%-12s %14s %22s\n", "ground", "detected", "false alarms");
  for (const auto& [ground, result] : figures.free_by_ground) {
    const auto found = figures.by_ground.find(ground);
    const Share share = found == figures.by_ground.end() ? Share{} : found->second;
    std::printf("%-12s %6d of %4d %8d in %6.2f h\n", ground.c_str(), share.detected, share.dug_in,
                result.false_alarms, result.driven_s / 3600.0);
  }
  if (figures.failures != 0)
    std::printf("%d drives ended as the physics failed\n", figures.failures);
  if (figures.missed.empty()) return;
  std::printf("missed seeds:");
  for (const std::string& seed : figures.missed) std::printf(" %s", seed.c_str());
  std::printf("\n");
}

void print_json(const StuckArguments& arguments, const Figures& figures) {
  const nlohmann::ordered_json json = {
      {"first_seed", arguments.seed},
      {"runs", arguments.runs},
      {"dug_in", figures.all.dug_in},
      {"detected", figures.all.detected},
      {"detection_rate", rate(figures.all)},
      {"delay_median_s", quantile(figures.delays_s, 0.5)},
      {"delay_p95_s", quantile(figures.delays_s, 0.95)},
      {"driven_h", figures.free.driven_s / 3600.0},
      {"false_alarms", figures.free.false_alarms},
      {"false_alarms_per_hour", an_hour(figures.free)},
      {"alarms_as_it_came_free", figures.free.recovered_alarms},
      {"alarms_while_hardly_moving", figures.free.other_alarms},
      {"missed_seeds", figures.missed},
  };
  std::cout << json.dump(2) << "\n";
}

std::vector<nn::SlipRun> drive_all(const StuckArguments& arguments, bool trapped) {
  TaskBar bar(arguments.quiet, trapped ? "with a trap: " : "without a trap: ");
  return nn::drive_all(scenarios(arguments, trapped), arguments.threads, bar.progress());
}

int run_stuck(const StuckArguments& arguments) {
  if (!arguments.experiment.empty()) {
    const bool trapped = arguments.experiment == "trapped";
    const auto scenario =
        nn::stuck_scenario(arguments.seed, trapped, trapped ? kTrapped_s : arguments.free_s);
    std::cout << scenario.experiment.text();
    return 0;
  }
  // Reports an unwritable file before the drives, not after.
  if (!arguments.train.empty()) {
    const AtomicFile place(arguments.train);
  }
  const std::vector<nn::SlipRun> trapped = drive_all(arguments, true);
  const std::vector<nn::SlipRun> free = drive_all(arguments, false);
  if (!arguments.train.empty()) {
    std::vector<nn::SlipRun> all = trapped;
    all.insert(all.end(), free.begin(), free.end());
    nn::SlipTrainingOptions options;
    options.epochs = arguments.epochs;
    options.hidden = arguments.hidden;
    options.progress = [](std::size_t epoch, double error) {
      std::fprintf(stderr, "epoch %zu: cross entropy %.4f\n", epoch, error);
    };
    nn::write_model(arguments.train, nn::train_slip(all, options));
    std::printf("model in %s\n", arguments.train.c_str());
    return 0;
  }
  const Figures figures = figures_of(trapped, free);
  if (arguments.json) {
    print_json(arguments, figures);
  } else {
    print(arguments, figures);
  }
  return 0;
}

}  // namespace

void register_nn_stuck_command(CLI::App& nn, Program& program) {
  auto arguments = std::make_shared<StuckArguments>();
  CLI::App* command = nn.add_subcommand(
      "stuck",
      "Evaluate the robot's slip and stuck detection in seeded drives with and without traps");
  add_number(*command, "--seed", arguments->seed,
             "Seed of the first drive; each further drive adds 1", kSeedRange);
  add_number(*command, "--runs", arguments->runs,
             "Number of drives with a trap, and of drives without one", {1, 100000});
  add_number(*command, "--free", arguments->free_s, "Duration of a drive without a trap [s]",
             {5.0, 36000.0});
  add_number(*command, "--threads", arguments->threads,
             "Number of drives run in parallel (default: one per core)", {1, 256});
  command
      ->add_option("--train", arguments->train,
                   "Train the network on these drives and write this model file")
      ->type_name("FILE");
  add_number(*command, "--epochs", arguments->epochs, "Number of training epochs", {1, 1e6});
  add_number(*command, "--hidden", arguments->hidden, "Number of nodes of the hidden layer",
             {1, 255});
  command
      ->add_option("--experiment", arguments->experiment,
                   "Print the experiment of the first seed: trapped or free")
      ->check(CLI::IsMember({"trapped", "free"}));
  command->add_flag("--quiet", arguments->quiet, "Show no progress");
  command->add_flag("--json", arguments->json, "Print results as JSON");
  command->callback(
      [arguments, &program] { program.action = [arguments] { return run_stuck(*arguments); }; });
}

}  // namespace screed
