// `screed nn stuck`: how the robot's slip watch does in seeded drives.
#include <cstdio>
#include <iostream>
#include <memory>

#include "host_sim/core/json.h"
#include "host_sim/core/statistics.h"
#include "nn/slip/slip_campaign.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/nn/slip_options.h"

namespace screed {
namespace {

using nn::ShareError;
using nn::SlipFigures;
using nn::StuckCounts;

struct StuckArguments : SlipCampaignArguments {
  std::string experiment;
  bool json = false;
};

double detected_share(const StuckCounts& counts) {
  return counts.dug_in == 0 ? 0.0 : static_cast<double>(counts.detected) / counts.dug_in;
}

double hours(const StuckCounts& counts) {
  return counts.driven_s / 3600.0;
}

double an_hour(double alarms, const StuckCounts& counts) {
  return counts.driven_s <= 0.0 ? 0.0 : alarms / hours(counts);
}

void print_row(const std::string& name, const StuckCounts& counts) {
  const Interval detected = wilson(counts.detected, counts.dug_in);
  const Interval alarms = poisson(counts.false_alarms);
  std::printf("%-12s", name.c_str());
  if (counts.trapped == 0) {
    std::printf(" %46s", "-");
  } else {
    std::printf(" %4d of %4d %5.1f %% (%3.0f to %3.0f) %4d of %4d", counts.detected, counts.dug_in,
                100.0 * detected_share(counts), 100.0 * detected.low, 100.0 * detected.high,
                counts.early_alarms, counts.trapped);
  }
  if (counts.driven_s > 0.0) {
    std::printf(" %4d in %5.2f h, %5.2f (%.2f to %.2f) an hour", counts.false_alarms, hours(counts),
                an_hour(counts.false_alarms, counts), an_hour(alarms.low, counts),
                an_hour(alarms.high, counts));
  }
  std::printf("\n");
}

void print_share(const std::string& name, const ShareError& error) {
  std::printf("%-12s %6.2f %+8.3f %8.3f %10.3f %12.3f\n", name.c_str(), error.true_mean(),
              error.mean(), error.rms(), error.rms_of_one(), error.rms_of_mean());
}

void print(const SlipFigures& figures) {
  std::printf("%-12s %33s %12s %13s\n", "", "detected within 1 s", "early", "false alarms");
  print_row("all", figures.all);
  for (const auto& [trap, counts] : figures.by_trap) print_row(trap, counts);
  for (const auto& [ground, counts] : figures.by_ground) print_row(ground, counts);
  std::printf("delay %.2f s median, %.2f s 95 %%\n", quantile(figures.delays_s, 0.5),
              quantile(figures.delays_s, 0.95));
  std::printf("alarms as it came free %d, while it hardly moved %d\n", figures.all.recovered_alarms,
              figures.all.other_alarms);
  std::printf("%-12s %6s %8s %8s %10s %12s\n", "travel share", "mean", "error", "rms", "1: rms",
              "mean: rms");
  print_share("all", figures.share);
  for (const auto& [ground, error] : figures.share_by_ground) print_share(ground, error);
  if (figures.failures != 0)
    std::printf("%d drives ended as the physics failed\n", figures.failures);
  if (figures.missed.empty()) return;
  std::printf("missed seeds:");
  for (const std::uint64_t seed : figures.missed)
    std::printf(" %llu", static_cast<unsigned long long>(seed));
  std::printf("\n");
}

Json json_of(const StuckCounts& counts) {
  const Interval detected = wilson(counts.detected, counts.dug_in);
  const Interval alarms = poisson(counts.false_alarms);
  return {{"trapped", counts.trapped},      {"dug_in", counts.dug_in},
          {"detected", counts.detected},    {"detected_low", detected.low},
          {"detected_high", detected.high}, {"early_alarms", counts.early_alarms},
          {"driven_h", hours(counts)},      {"false_alarms", counts.false_alarms},
          {"false_alarms_low", alarms.low}, {"false_alarms_high", alarms.high}};
}

Json json_of(const ShareError& error) {
  return {{"true_mean", error.true_mean()},
          {"mean_error", error.mean()},
          {"rms", error.rms()},
          {"rms_of_one", error.rms_of_one()},
          {"rms_of_mean", error.rms_of_mean()}};
}

void print_json(const StuckArguments& arguments, const SlipFigures& figures) {
  Json json = {{"first_seed", arguments.campaign.seed},
               {"all", json_of(figures.all)},
               {"delay_median_s", quantile(figures.delays_s, 0.5)},
               {"delay_p95_s", quantile(figures.delays_s, 0.95)},
               {"travel_share", json_of(figures.share)},
               {"missed_seeds", figures.missed}};
  for (const auto& [trap, counts] : figures.by_trap) json["traps"][trap] = json_of(counts);
  for (const auto& [ground, counts] : figures.by_ground) json["grounds"][ground] = json_of(counts);
  for (const auto& [ground, error] : figures.share_by_ground)
    json["travel_share_by_ground"][ground] = json_of(error);
  std::cout << json.dump(2) << "\n";
}

int run_stuck(const StuckArguments& arguments) {
  if (!arguments.experiment.empty()) {
    nn::SlipCampaign one = arguments.campaign;
    one.trapped = arguments.experiment == "trapped" ? 1 : 0;
    one.free = arguments.experiment == "free" ? 1 : 0;
    one.ordinary = arguments.experiment == "ordinary" ? 1 : 0;
    std::cout << nn::scenarios(one).at(0).experiment.text();
    return 0;
  }
  const SlipFigures figures = nn::figures_of(run_campaign(arguments));
  if (arguments.json) {
    print_json(arguments, figures);
  } else {
    print(figures);
  }
  return 0;
}

}  // namespace

void register_nn_stuck_command(Command& nn, Program& program) {
  auto arguments = std::make_shared<StuckArguments>();
  arguments->campaign.trapped = 100;
  arguments->campaign.free = 100;
  Command* command = nn.add_subcommand(
      "stuck", "Evaluate the robot's slip watch in seeded drives with and without traps");
  add_campaign_options(*command, *arguments);
  command
      ->add_option("--experiment", arguments->experiment,
                   "Print the experiment of the first seed: trapped, free or ordinary")
      ->one_of({"trapped", "free", "ordinary"});
  command->add_flag("--json", arguments->json, "Print results as JSON");
  command->callback(
      [arguments, &program] { program.action = [arguments] { return run_stuck(*arguments); }; });
}

}  // namespace screed
