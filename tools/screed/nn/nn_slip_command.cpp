// `screed nn slip`: trains the network of the robot's slip watch, chooses its threshold and exports
// it to the firmware. `screed nn stuck`: how the watch does in seeded drives.

#include <cstdio>
#include <iostream>
#include <memory>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/content_hash.h"
#include "host_sim/core/json.h"
#include "host_sim/core/statistics.h"
#include "nn/slip/gated_trainer.h"
#include "nn/slip/slip_campaign.h"
#include "nn/slip/slip_model.h"
#include "nn/slip/stuck_rules.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/progress_bar.h"

namespace screed {
namespace {

struct SlipCampaignArguments {
  nn::SlipCampaign campaign;
  bool quiet = false;
};

void add_campaign_options(Command& command, SlipCampaignArguments& arguments) {
  nn::SlipCampaign& campaign = arguments.campaign;
  constexpr NumberRange kDrives{0, 100000};
  add_number(command, "--seed", campaign.seed,
             "Seed of the first drive of each kind; each further drive adds 1", kSeedRange);
  add_number(command, "--trapped", campaign.trapped, "Number of drives into a trap (14 s)",
             kDrives);
  add_number(command, "--free", campaign.free, "Number of drives without a trap, slopes to 8 deg",
             kDrives);
  add_number(command, "--ordinary", campaign.ordinary,
             "Number of drives of leveling algorithms, slopes to 20 deg, or in beds with walls",
             kDrives);
  add_number(command, "--duration", campaign.duration_s, "Duration of a drive without a trap [s]",
             {5.0, 36000.0});
  add_number(command, "--threads", campaign.threads, "Number of drives run in parallel", {1, 256});
  command
      .add_option("--drives", campaign.folder,
                  "Folder to keep drives in; those that are there are not driven again")
      ->type_name("DIR");
  command.add_flag("--quiet", arguments.quiet, "Show no progress");
}

/// The drives, with a bar of progress.
std::vector<nn::SlipDrive> run_campaign(const SlipCampaignArguments& arguments) {
  TaskBar bar(arguments.quiet, "");
  return nn::run(arguments.campaign, bar.progress());
}

// ---- slip

struct SlipArguments : SlipCampaignArguments {
  std::string model = "nn/models/slip.json";
  std::string header = "firmware/estimation/slip_model.h";
  nn::GatedTrainingOptions training;
  double false_per_hour = 0.7;
  double early_per_drive = 0.03;
};

double percent(int part, int whole) {
  return whole == 0 ? 0.0 : 100.0 * part / whole;
}

int drive(const SlipArguments& arguments) {
  std::printf("%zu drives\n", run_campaign(arguments).size());
  return 0;
}

int train(SlipArguments& arguments) {
  // Reports an unwritable file before the drives, not after.
  const AtomicFile place(arguments.model);
  std::vector<std::vector<nn::SlipStep>> sequences;
  ContentHash hash;
  for (const nn::SlipDrive& drive : run_campaign(arguments)) {
    sequences.push_back(nn::slip_steps(drive, nn::TrueMotion(drive)));
    for (const nn::SlipStep& step : sequences.back()) {
      for (const std::int8_t input : step.inputs) hash.add(input);
      for (const float label : {step.held, step.held_weight, step.share, step.share_weight})
        hash.add(static_cast<double>(label));
    }
  }
  arguments.training.progress = [](std::size_t epoch, double loss) {
    if (epoch % 10 == 0) std::fprintf(stderr, "epoch %zu: loss %.4f\n", epoch, loss);
  };
  const nn::GatedNetwork network = nn::train_gated(sequences, arguments.training);
  nn::SlipModel model;
  model.training_data = hash.hex();
  model.seed = arguments.training.seed;
  model.shape = network.shape();
  model.parameters = nn::parameters_of(network);
  nn::write_slip_model(arguments.model, model);
  std::printf("model in %s\n", arguments.model.c_str());
  return 0;
}

int choose(const SlipArguments& arguments) {
  nn::SlipModel model = nn::read_slip_model(arguments.model);
  const auto results = nn::try_thresholds(model, run_campaign(arguments));
  std::printf("%8s %22s %26s %24s\n", "evidence", "detected", "early alarms", "false alarms");
  for (const nn::ThresholdResult& result : results) {
    const nn::StuckCounts& counts = result.counts;
    std::printf("%8d %6d of %4d, %5.1f %% %6d of %4d, %5.1f %% %6d, %5.2f an hour\n", result.stuck,
                counts.detected, counts.dug_in, percent(counts.detected, counts.dug_in),
                counts.early_alarms, counts.trapped, percent(counts.early_alarms, counts.trapped),
                counts.false_alarms,
                counts.driven_s <= 0.0 ? 0.0 : counts.false_alarms * 3600.0 / counts.driven_s);
  }
  model.thresholds.stuck =
      nn::choose_threshold(results, arguments.false_per_hour, arguments.early_per_drive);
  nn::write_slip_model(arguments.model, model);
  std::printf("stuck from %d on, in %s\n", model.thresholds.stuck, arguments.model.c_str());
  return 0;
}

int export_header(const SlipArguments& arguments) {
  write_file(arguments.header, nn::slip_model_header(nn::read_slip_model(arguments.model)));
  return 0;
}

void add_slip(Command& nn, Program& program) {
  Command* slip = nn.add_subcommand(
      "slip", "Train the network of the robot's slip watch and choose its threshold");
  const auto add = [&](const char* name, const char* description, auto action, bool drives) {
    auto arguments = std::make_shared<SlipArguments>();
    Command* command = slip->add_subcommand(name, description);
    if (drives) add_campaign_options(*command, *arguments);
    command->callback([arguments, action, &program] {
      program.action = [arguments, action] { return action(*arguments); };
    });
    return std::pair(command, arguments);
  };
  const auto add_model = [](auto& added) {
    added.first->add_option("--model", added.second->model, "Model file")->type_name("FILE");
  };
  add("drive", "Only drive, and keep the drives in the folder", drive, true);
  auto of_train = add("train", "Train the network on drives", train, true);
  add_model(of_train);
  nn::GatedTrainingOptions& training = of_train.second->training;
  add_number(*of_train.first, "--training-seed", training.seed,
             "Seed of the first weights and of the order of drives", kSeedRange);
  add_number(*of_train.first, "--epochs", training.epochs, "Number of training epochs", {1, 1e6});
  add_number(*of_train.first, "--units", training.units, "Number of units", {1, 100});
  auto of_choose = add("choose", "Choose the threshold of stuck on drives", choose, true);
  add_model(of_choose);
  add_number(*of_choose.first, "--false-alarms", of_choose.second->false_per_hour,
             "Most false alarms an hour, without a trap", {0.0, 1e6});
  add_number(*of_choose.first, "--early-alarms", of_choose.second->early_per_drive,
             "Most early alarms a drive into a trap", {0.0, 1e6});
  auto of_export = add("export", "Write the header of the firmware", export_header, false);
  add_model(of_export);
  of_export.first->add_option("--header", of_export.second->header, "Header file")
      ->type_name("FILE");
}

// ---- stuck

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

void add_stuck(Command& nn, Program& program) {
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

}  // namespace

void register_nn_slip_command(Command& nn, Program& program) {
  add_slip(nn, program);
  add_stuck(nn, program);
}

}  // namespace screed
