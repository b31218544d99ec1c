// `screed nn slip`: trains the network of the robot's slip watch, chooses its threshold and exports
// it to the firmware.
#include <cstdio>
#include <memory>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/content_hash.h"
#include "nn/slip/gated_trainer.h"
#include "nn/slip/slip_choice.h"
#include "nn/slip/slip_model.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/nn/slip_options.h"

namespace screed {
namespace {

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

}  // namespace

void register_nn_slip_command(Command& nn, Program& program) {
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

}  // namespace screed
