// `screed nn ...`: networks from recorded sessions to the robot.
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>

#include "commands.h"
#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"
#include "nn/batch/batch_network.h"
#include "nn/data/features.h"
#include "nn/model/model_file.h"
#include "nn/training/evaluation.h"
#include "nn/training/training_run.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/progress_bar.h"
#include "tools/screed/nn/nn_tables.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

struct NnArguments {
  std::string configuration;
  std::string model;
  std::string sessions = "out/sessions";
  std::string out;
  std::optional<std::uint64_t> seed;
  std::optional<std::size_t> epochs;
  std::size_t vectors = 1'000'000;
  bool resume = false;
  bool json = false;
  bool markdown = false;
  bool pictures = true;
};

nn::TrainingConfiguration configuration_of(const NnArguments& arguments) {
  nn::TrainingConfiguration configuration =
      nn::read_training_configuration(arguments.configuration);
  if (arguments.seed) configuration.seed = *arguments.seed;
  if (arguments.epochs) {
    for (nn::NetworkConfiguration& network : configuration.networks) {
      network.epochs = *arguments.epochs;
    }
  }
  return configuration;
}

fs::path out_folder(const NnArguments& arguments, const std::string& name) {
  return arguments.out.empty() ? fs::path("out") / "nn" / name : fs::path(arguments.out);
}

// ---- preprocess

void write_table(AtomicFile& file, const nn::FeatureTable& table) {
  std::string text = "frame";
  for (const std::string& name : table.names) text += "," + name;
  text += "\n";
  char number[40];
  for (std::size_t row = 0; row < table.rows(); ++row) {
    text += std::to_string(table.frames[row]);
    for (const std::vector<double>& column : table.columns) {
      std::snprintf(number, sizeof number, ",%.9g", column[row]);
      text += number;
    }
    text += "\n";
  }
  file.write(text);
}

int run_preprocess(const NnArguments& arguments) {
  const nn::TrainingConfiguration configuration = configuration_of(arguments);
  TaskBar bar(false);
  const TaskProgress progress = bar.progress();
  const nn::PreparedData data = nn::prepare(configuration, arguments.sessions, progress);
  std::vector<std::pair<std::string, const nn::FeatureTable*>> tables;
  std::size_t kept = 0;
  for (const nn::FeatureTable& table : data.training) {
    tables.emplace_back("train_" + table.source + ".csv", &table);
    kept += table.rows();
  }
  for (const nn::TestTable& test : data.tests) {
    if (test.form == "as trained") tables.emplace_back("test_" + test.label + ".csv", &test.table);
  }
  MadeFolders folders;
  const fs::path folder = folders.make(out_folder(arguments, configuration.name));
  // All tables or none.
  std::vector<std::unique_ptr<AtomicFile>> files;
  for (const auto& [name, table] : tables) {
    report_progress(progress, "writing tables", files.size(), tables.size());
    files.push_back(std::make_unique<AtomicFile>(folder / name));
    write_table(*files.back(), *table);
  }
  stop_if_interrupted("writing tables");
  for (const std::unique_ptr<AtomicFile>& file : files) file->commit();
  bar.clear();
  std::printf("%zu of %zu training frames stay\n", kept, data.training_frames);
  std::printf("%-24s %14s %14s\n", "feature", "middle", "half range");
  for (const nn::FeatureScale& scale : data.preprocessing.scales()) {
    std::printf("%-24s %14.6g %14.6g\n", scale.feature.c_str(), scale.middle, scale.half_range);
  }
  for (const nn::PreprocessingStage& stage : data.preprocessing.stages()) {
    if (stage.feature.empty()) continue;
    std::printf("%-24s stays within %.6g and %.6g\n", stage.feature.c_str(), stage.low, stage.high);
  }
  std::printf("training data %s\ntables in %s\n", data.hash.c_str(), folder.c_str());
  return 0;
}

// ---- train

void write_losses(const fs::path& file, const nn::TrainedNetwork& network) {
  std::string text = "epoch,training,choice\n";
  char line[80];
  for (std::size_t i = 0; i < network.losses.size(); ++i) {
    std::snprintf(line, sizeof line, "%zu,%.9g,%.9g\n", i + 1, network.losses[i].training,
                  network.losses[i].choice);
    text += line;
  }
  write_file(file, text);
}

int run_train(const NnArguments& arguments) {
  const nn::TrainingConfiguration configuration = configuration_of(arguments);
  TaskBar tasks(false);
  const nn::PreparedData data = nn::prepare(configuration, arguments.sessions, tasks.progress());
  tasks.clear();
  MadeFolders folders;
  const fs::path folder = out_folder(arguments, configuration.name);
  nn::TrainingOptions options;
  options.checkpoints = folders.make(folder / "checkpoints");
  options.resume = arguments.resume;
  options.stop = &interrupted();
  ProgressBar bar(std::cerr);
  options.progress = [&](double share, const std::string& note) { bar.show_share(share, note); };
  const std::vector<nn::TrainedNetwork> networks = [&] {
    try {
      return nn::train(configuration, data, options);
    } catch (const TaskStopped&) {
      bar.clear();
      throw;
    }
  }();
  bar.finish();

  const nn::Model model = nn::make_model(configuration, data, networks);
  const fs::path file = folder / "model.json";
  nn::write_model(file, model);
  for (std::size_t i = 0; i < networks.size(); ++i) {
    write_losses(folder / ("loss_" + configuration.networks[i].name() + ".csv"), networks[i]);
  }
  if (arguments.pictures) nn::draw_losses(configuration, networks, folder);
  const nn::Evaluation evaluation = nn::evaluate(model, data.tests, tasks.progress());
  tasks.clear();
  if (arguments.json) {
    std::cout << evaluation_json(evaluation);
    return 0;
  }
  std::cout << evaluation_text(evaluation, configuration) << "\n";
  for (std::size_t i = 0; i < networks.size(); ++i) {
    const std::size_t epoch = networks[i].kept_epoch;
    std::printf("%s: error of the choice (%s) %.6f, epoch %zu\n",
                configuration.networks[i].name().c_str(), configuration.choice.c_str(),
                networks[i].losses[epoch - 1].choice, epoch);
  }
  std::printf("model in %s\n", file.c_str());
  return 0;
}

// ---- quantise

/// What a training makes of its networks in floating point, from those that a model carries.
int run_quantise(const NnArguments& arguments) {
  const nn::TrainingConfiguration configuration = configuration_of(arguments);
  nn::Model model = nn::read_model(arguments.model);
  TaskBar bar(false);
  const nn::PreparedData data = nn::prepare(configuration, arguments.sessions, bar.progress());
  bar.clear();
  if (model.training_data != data.hash || model.name != configuration.name ||
      model.seed != configuration.seed || model.networks.size() != configuration.networks.size()) {
    throw InputError(
        arguments.model + ": is of " + model.name + ", seed " + std::to_string(model.seed) +
        ", training data " + model.training_data +
        "; allowed is the model of this configuration and these sessions: " + configuration.name +
        ", " + std::to_string(configuration.seed) + ", " + data.hash);
  }
  std::vector<nn::TrainedNetwork> networks;
  for (nn::ModelNetwork& network : model.networks) {
    if (network.trained.empty()) {
      throw InputError(arguments.model + ": has no network in floating point");
    }
    networks.push_back({std::move(network.trained), 0, {}});
  }
  const fs::path file = arguments.out.empty() ? fs::path(arguments.model) : fs::path(arguments.out);
  nn::write_model(file, nn::make_model(configuration, data, networks));
  std::printf("%zu networks in integers, in %s\n", networks.size(), file.c_str());
  return 0;
}

// ---- eval

int run_eval(const NnArguments& arguments) {
  const nn::TrainingConfiguration configuration = configuration_of(arguments);
  const nn::Model model = nn::read_model(arguments.model);
  TaskBar bar(false);
  const std::vector<nn::TestTable> tests =
      nn::prepare_tests(configuration, model, arguments.sessions, bar.progress());
  const nn::Evaluation evaluation = nn::evaluate(model, tests, bar.progress());
  bar.clear();
  std::cout << (arguments.json       ? evaluation_json(evaluation)
                : arguments.markdown ? evaluation_markdown(evaluation, configuration)
                                     : evaluation_text(evaluation, configuration));
  if (arguments.pictures && !arguments.markdown) {
    MadeFolders folders;
    const fs::path folder = folders.make(out_folder(arguments, configuration.name));
    const std::vector<fs::path> files = nn::draw_evaluation(model, tests, folder, bar.progress());
    bar.clear();
    if (!arguments.json) std::printf("\n%zu charts in %s\n", files.size(), folder.c_str());
  }
  return 0;
}

// ---- export, show, check

int run_export(const NnArguments& arguments) {
  const nn::Model model = nn::read_model(arguments.model);
  const std::string header = nn::model_header(model);
  if (arguments.out.empty()) {
    std::cout << header;
  } else {
    write_file(arguments.out, header);
  }
  return 0;
}

int run_show(const NnArguments& arguments) {
  std::cout << model_description(nn::read_model(arguments.model));
  return 0;
}

/// An activation: any, or one of the edges.
std::int16_t random_activation(WorldRandom& random) {
  constexpr std::int16_t kEdges[] = {INT16_MIN, INT16_MAX, 0, -1};
  const std::uint32_t bits = random.next();
  return bits >> 28U < 4 ? kEdges[bits >> 28U] : static_cast<std::int16_t>(bits & 0xFFFFU);
}

int run_check(const NnArguments& arguments) {
  constexpr std::size_t kBlock = 1000;
  const nn::Model model = nn::read_model(arguments.model);
  WorldRandom random(arguments.seed.value_or(1), "check of vectors");
  for (const nn::ModelNetwork& network : model.networks) {
    const std::size_t inputs = network.network.inputs();
    const std::size_t outputs = network.network.outputs();
    std::vector<std::int16_t> in(inputs * kBlock);
    std::vector<std::int16_t> out(outputs * kBlock);
    std::vector<std::int16_t> one_in(inputs);
    std::vector<std::int16_t> one_out(outputs);
    std::vector<std::int16_t> alone_out(outputs);
    std::string kernels;
    std::vector<nn::BatchNetwork> batches;
    for (const InstructionSet kernel : instruction_sets()) {
      batches.emplace_back(network.network, kernel);
      kernels += std::string(kernels.empty() ? "" : ", ") + name_of(kernel);
    }
    ProgressBar bar(std::cerr);
    for (std::size_t done = 0; done < arguments.vectors; done += kBlock) {
      bar.show_share(static_cast<double>(done) / static_cast<double>(arguments.vectors),
                     "checking " + network.outputs.front().feature);
      for (std::int16_t& value : in) value = random_activation(random);
      for (const nn::BatchNetwork& batch : batches) {
        batch.run(in.data(), out.data(), kBlock, kBlock);
        for (std::size_t row = 0; row < kBlock; ++row) {
          for (std::size_t i = 0; i < inputs; ++i) one_in[i] = in[i * kBlock + row];
          network.network.run(one_in, one_out);
          // A robot alone goes another way than a block of them.
          batch.run(one_in.data(), alone_out.data(), 1, 1);
          for (std::size_t i = 0; i < outputs; ++i) {
            if (one_out[i] == out[i * kBlock + row] && one_out[i] == alone_out[i]) continue;
            throw RunError(model.name + ": " + name_of(batch.instructions()) +
                           " differs from a layer at a time in vector " +
                           std::to_string(done + row));
          }
        }
      }
    }
    bar.clear();
    std::printf("%s %s: %zu random and edge vectors, no bit differs (%s)\n", model.name.c_str(),
                network.outputs.front().feature.c_str(), arguments.vectors, kernels.c_str());
  }
  return 0;
}

int run_features() {
  std::printf("%-14s %-10s %s\n", "feature", "unit", "");
  for (const nn::Feature& feature : nn::features()) {
    std::printf("%-14s %-10s %s\n", feature.name, feature.unit, feature.meaning);
  }
  std::printf("\n%-16s %-20s %s\n", "stage", "numbers", "");
  for (const nn::PreprocessingStageKind& stage : nn::preprocessing_stage_kinds()) {
    std::printf("%-16s %-20s %s\n", stage.name, stage.parameters, stage.meaning);
  }
  return 0;
}

}  // namespace

void register_nn_command(Command& root, Program& program) {
  auto arguments = std::make_shared<NnArguments>();
  Command* nn = root.add_subcommand("nn", "Train, evaluate and export networks");
  const auto add = [&](const char* name, const char* help, int (*run)(const NnArguments&)) {
    Command* command = nn->add_subcommand(name, help);
    command->callback(
        [arguments, run, &program] { program.action = [=] { return run(*arguments); }; });
    return command;
  };
  const auto configuration = [&](Command* command) {
    command
        ->add_option("CONFIGURATION", arguments->configuration,
                     "Training configuration (nn/configurations/*.json)")
        ->required();
    command->add_option("--sessions", arguments->sessions, "Folder with the recorded sessions")
        ->type_name("FOLDER")
        ->show_default();
  };
  const auto model = [&](Command* command) {
    command->add_option("MODEL", arguments->model, "Trained model (nn/models/*.json)")->required();
  };
  const auto folder = [&](Command* command) {
    command->add_option("--out", arguments->out, "Output folder (default: out/nn/NAME)")
        ->type_name("FOLDER");
  };
  const auto json = [&](Command* command) {
    command->add_flag("--json", arguments->json, "Print results as JSON");
    command->add_flag("!--no-pictures", arguments->pictures, "Draw no charts");
  };

  Command* preprocess =
      add("preprocess", "Convert sessions to training tables: outliers, normalisation, smoothing",
          run_preprocess);
  configuration(preprocess);
  folder(preprocess);

  Command* train = add("train", "Train the networks of a configuration", run_train);
  configuration(train);
  folder(train);
  add_number(*train, "--epochs", arguments->epochs, "Number of epochs; overrides the configuration",
             {1, 1e6});
  add_number(*train, "--seed", arguments->seed, "Seed; overrides the configuration", kSeedRange);
  train->add_flag("--resume", arguments->resume,
                  "Resume from the checkpoints in the output folder");
  json(train);

  Command* quantise =
      add("quantise", "Quantise a trained model again, from its training data", run_quantise);
  model(quantise);
  configuration(quantise);
  quantise->add_option("--out", arguments->out, "Model file to write (default: MODEL)")
      ->type_name("FILE");

  Command* eval =
      add("eval", "Evaluate a model: the thesis' tables 6.1 to 6.3, and charts", run_eval);
  model(eval);
  configuration(eval);
  folder(eval);
  json(eval);
  eval->add_flag("--markdown", arguments->markdown,
                 "Print the tables as a section of a page in Markdown, and draw nothing")
      ->excludes(eval->option("--json"));

  Command* header = add("export", "Export a model as a C++ header for the robot", run_export);
  model(header);
  header->add_option("--header", arguments->out, "Header file to write (default: standard output)")
      ->type_name("FILE");

  model(add("show", "Describe a model", run_show));

  Command* check =
      add("check", "Compare scalar and SIMD inference on random and edge-case vectors", run_check);
  model(check);
  add_number(*check, "--vectors", arguments->vectors, "Number of vectors", kCountRange);
  add_number(*check, "--seed", arguments->seed, "Seed of the vectors", kSeedRange);

  Command* features = nn->add_subcommand("features", "List all features and preprocessing stages");
  features->callback([&program] { program.action = [] { return run_features(); }; });

  register_nn_subcommands(*nn, program);
}

}  // namespace screed
