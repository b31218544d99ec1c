// Tables to examples.
#include "nn/training/prepared_data.h"

#include <algorithm>
#include <initializer_list>
#include <string_view>

#include "host_sim/core/content_hash.h"

namespace screed::nn {
namespace {

namespace fs = std::filesystem;

bool has_stage(const Preprocessing& preprocessing, std::initializer_list<std::string_view> names) {
  return std::any_of(preprocessing.stages().begin(), preprocessing.stages().end(),
                     [&](const PreprocessingStage& stage) {
                       return std::find(names.begin(), names.end(), stage.stage) != names.end();
                     });
}

/// A session in every form that its stages make different.
void add_test(const TestSession& test, const std::vector<std::string>& features,
              const Preprocessing& preprocessing, const fs::path& sessions,
              std::vector<TestTable>& tests) {
  using Extent = Preprocessing::Extent;
  const FeatureTable recorded = read_features(find_session(sessions, test.session), features);
  const auto add = [&](const char* form, Extent extent) {
    tests.push_back({test.label, form, recorded});
    preprocessing.apply(tests.back().table, extent);
  };
  const bool smooths = has_stage(preprocessing, {"mean", "exponential"});
  const bool rounds = has_stage(preprocessing, {"quantise"});
  add("as trained", Extent::kAll);
  if (smooths && rounds) add("smoothed", Extent::kNotRounded);
  if (smooths || rounds) add("raw", Extent::kRaw);
}

/// All test sessions.
std::vector<TestTable> tests_of(const TrainingConfiguration& configuration,
                                const Preprocessing& preprocessing, const fs::path& sessions,
                                const TaskProgress& progress) {
  std::vector<TestTable> tests;
  std::size_t done = 0;
  for (const TestSession& test : configuration.test) {
    report_progress(progress, "reading test sessions", done++, configuration.test.size());
    add_test(test, configuration.features(), preprocessing, sessions, tests);
  }
  return tests;
}

std::string hash_of(const std::vector<FeatureTable>& tables) {
  ContentHash hash;
  for (const FeatureTable& table : tables) {
    hash.add(std::uint64_t{table.rows()});
    for (std::size_t i = 0; i < table.names.size(); ++i) {
      hash.add(table.names[i]);
      for (const double value : table.columns[i]) hash.add(value);
    }
  }
  return hash.hex();
}

/// What was learned, from a model's file.
Preprocessing preprocessing_of(const Model& model) {
  std::vector<FeatureScale> scales;
  const auto add = [&](const std::string& feature, const ModelChannel& channel) {
    if (std::none_of(scales.begin(), scales.end(),
                     [&](const FeatureScale& scale) { return scale.feature == feature; })) {
      scales.push_back({feature, channel.middle, channel.half_range});
    }
  };
  for (const ModelNetwork& network : model.networks) {
    for (const ModelChannel& channel : network.inputs) add(channel.feature, channel);
    for (const ModelChannel& channel : network.outputs) {
      add(channel.baseline.empty() ? channel.feature : channel.feature + "-" + channel.baseline,
          channel);
    }
  }
  return Preprocessing(model.stages, std::move(scales));
}

}  // namespace

std::vector<std::string> learned_outputs(const NetworkConfiguration& network) {
  if (network.outputs.size() == 1) return {network.learned_output()};
  return network.outputs;
}

PreparedData prepare(const TrainingConfiguration& configuration, const fs::path& sessions,
                     const TaskProgress& progress) {
  PreparedData data;
  data.preprocessing = Preprocessing(configuration.stages);
  const std::vector<std::string> features = configuration.features();
  for (const std::string& name : configuration.train) {
    report_progress(progress, "reading training sessions", data.training.size(),
                    configuration.train.size());
    data.training.push_back(read_features(find_session(sessions, name), features));
    data.training_frames += data.training.back().rows();
  }
  data.running = data.training;
  data.preprocessing.learn(data.training, progress);
  const auto& stages = configuration.stages;
  const bool rounds = std::any_of(stages.begin(), stages.end(), [](const PreprocessingStage& one) {
    return one.stage == "quantise" && one.run_time;
  });
  for (FeatureTable& table : data.running) {
    data.preprocessing.apply(
        table, rounds ? Preprocessing::Extent::kAll : Preprocessing::Extent::kNotRounded);
  }
  data.choice = read_features(find_session(sessions, configuration.choice), features);
  data.preprocessing.apply(data.choice, Preprocessing::Extent::kAll);
  data.tests = tests_of(configuration, data.preprocessing, sessions, progress);
  data.hash = hash_of(data.training);
  return data;
}

std::vector<TestTable> prepare_tests(const TrainingConfiguration& configuration, const Model& model,
                                     const fs::path& sessions, const TaskProgress& progress) {
  return tests_of(configuration, preprocessing_of(model), sessions, progress);
}

Examples examples_of(const std::vector<const FeatureTable*>& tables,
                     const std::vector<std::string>& inputs,
                     const std::vector<std::string>& outputs) {
  Examples examples{inputs.size(), outputs.size(), {}, {}};
  const auto add = [](const FeatureTable& table, const std::vector<std::string>& names,
                      std::vector<float>& to) {
    std::vector<const std::vector<double>*> columns;
    columns.reserve(names.size());
    for (const std::string& name : names) columns.push_back(&table.column(name));
    for (std::size_t row = 0; row < table.rows(); ++row) {
      for (const std::vector<double>* column : columns) {
        to.push_back(static_cast<float>((*column)[row]));
      }
    }
  };
  for (const FeatureTable* table : tables) {
    add(*table, inputs, examples.in);
    add(*table, outputs, examples.out);
  }
  return examples;
}

}  // namespace screed::nn
