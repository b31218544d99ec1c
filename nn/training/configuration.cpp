// Keys of a network that stand in "training" hold for all networks; a network's own go first.
#include "nn/training/configuration.h"

#include <algorithm>
#include <fstream>
#include <optional>
#include <sstream>

#include "host_sim/core/errors.h"
#include "nn/data/features.h"

namespace screed::nn {
namespace {

constexpr std::int64_t kMaxNodes = 255;
constexpr std::int64_t kMaxEpochs = 1'000'000;

std::vector<std::string> texts(const JsonValue& list) {
  std::vector<std::string> result;
  for (const JsonValue& value : list.list(1)) result.push_back(value.text());
  return result;
}

std::string known_feature(const JsonValue& value) {
  const std::string name = value.text();
  try {
    return NamedFeature(name).name();
  } catch (const InputError& error) {
    value.refuse(error.what());
  }
}

std::vector<std::string> known_features(const JsonValue& list) {
  std::vector<std::string> names;
  for (const JsonValue& value : list.list(1, kMaxNodes)) names.push_back(known_feature(value));
  return names;
}

/// A key of the network itself, or of all networks.
class Keys {
 public:
  Keys(const JsonValue& own, const JsonValue* common) : own_(own), common_(common) {}
  template <class Read>
  void if_there(const char* name, Read&& read) const {
    if (own_.has(name)) {
      read(own_.at(name));
    } else if (common_ != nullptr && common_->has(name)) {
      read(common_->at(name));
    }
  }
  template <class Read>
  void needed(const char* name, Read&& read) const {
    if (!own_.has(name) && (common_ == nullptr || !common_->has(name))) {
      own_.refuse(std::string("'") + name + "' is missing, here and in training");
    }
    if_there(name, read);
  }

 private:
  const JsonValue& own_;
  const JsonValue* common_;
};

const std::initializer_list<std::string_view> kNetworkKeys = {
    "inputs",  "outputs",      "baseline",   "hidden",    "output",        "steepness",
    "weights", "weight_range", "batch_norm", "optimiser", "learning_rate", "final_rate",
    "l2",      "batch",        "epochs",     "patience",  "keep",          "nodes"};

NetworkConfiguration network_of(const JsonValue& value, const JsonValue* common) {
  value.only(kNetworkKeys);
  NetworkConfiguration network;
  const Keys keys(value, common);
  keys.needed("inputs", [&](const JsonValue& v) { network.inputs = known_features(v); });
  keys.needed("outputs", [&](const JsonValue& v) { network.outputs = known_features(v); });
  keys.if_there("baseline", [&](const JsonValue& v) {
    network.baseline = known_feature(v);
    if (network.outputs.size() != 1) v.refuse("several outputs; allowed is one with a baseline");
  });
  keys.needed("hidden", [&](const JsonValue& v) {
    for (const JsonValue& nodes : v.list(0, kMaxNodes)) {
      network.hidden.push_back(static_cast<std::size_t>(nodes.integer(1, kMaxNodes)));
    }
  });
  keys.if_there("nodes", [&](const JsonValue& v) {
    network.limited = v.one_of({"tanh", "limited"}) == "limited";
  });
  keys.if_there("output", [&](const JsonValue& v) {
    network.linear_output = v.one_of({"tanh", "linear"}) == "linear";
  });
  keys.if_there("steepness", [&](const JsonValue& v) { network.steepness = v.number(0.01, 10.0); });
  keys.if_there("weights", [&](const JsonValue& v) {
    network.initialisation = v.one_of({"normalised", "uniform"}) == "uniform"
                                 ? Initialisation::kUniform
                                 : Initialisation::kNormalised;
  });
  keys.if_there("weight_range",
                [&](const JsonValue& v) { network.initial_range = v.number(0.0, 10.0); });
  keys.if_there("batch_norm", [&](const JsonValue& v) {
    const std::string kind = v.one_of({"none", "plain", "scaled"});
    network.batch_normalisation = kind == "none"    ? BatchNormalisation::kNone
                                  : kind == "plain" ? BatchNormalisation::kPlain
                                                    : BatchNormalisation::kScaled;
  });
  keys.needed("optimiser", [&](const JsonValue& v) {
    const std::string kind = v.one_of({"irprop-", "sgd", "adam"});
    network.optimiser = kind == "irprop-" ? OptimiserKind::kIrprop
                        : kind == "sgd"   ? OptimiserKind::kSgd
                                          : OptimiserKind::kAdam;
  });
  keys.if_there("learning_rate",
                [&](const JsonValue& v) { network.learning_rate = v.number(1e-9, 100.0); });
  keys.if_there("final_rate",
                [&](const JsonValue& v) { network.final_rate = v.number(1e-6, 1.0); });
  keys.if_there("l2", [&](const JsonValue& v) { network.l2 = v.number(0.0, 1.0); });
  keys.if_there("batch", [&](const JsonValue& v) {
    network.batch = static_cast<std::size_t>(v.integer(0, kMaxEpochs));
  });
  keys.needed("epochs", [&](const JsonValue& v) {
    network.epochs = static_cast<std::size_t>(v.integer(1, kMaxEpochs));
  });
  keys.if_there("patience", [&](const JsonValue& v) {
    network.patience = static_cast<std::size_t>(v.integer(0, kMaxEpochs));
  });
  keys.if_there("keep", [&](const JsonValue& v) {
    network.keep_best = v.one_of({"best", "last"}) == "best";
  });
  if (network.batch_normalisation != BatchNormalisation::kNone && network.batch == 1) {
    value.refuse("batch normalisation with a batch of 1; allowed is 2 or more");
  }
  return network;
}

std::vector<TestSession> tests_of(const JsonValue& list) {
  std::vector<TestSession> tests;
  for (const JsonValue& value : list.list(1)) {
    value.only({"label", "session"});
    tests.push_back({value.at("label").text(), value.at("session").text()});
  }
  return tests;
}

TrainingConfiguration configuration_of(const JsonValue& root) {
  root.only({"name", "about", "seed", "train", "choice", "test", "stages", "run_time", "training",
             "networks", "thesis"});
  TrainingConfiguration configuration;
  configuration.name = root.at("name").text();
  if (root.has("about")) configuration.about = root.at("about").text();
  if (root.has("seed")) configuration.seed = root.at("seed").unsigned_integer();
  configuration.train = texts(root.at("train"));
  configuration.choice = root.at("choice").text();
  configuration.test = tests_of(root.at("test"));
  for (const TestSession& test : configuration.test) {
    if (test.session == configuration.choice) {
      root.at("choice").refuse("is a test as well; what chooses is no test");
    }
  }
  configuration.stages = read_preprocessing_stages(root.at("stages"));
  if (std::none_of(configuration.stages.begin(), configuration.stages.end(),
                   [](const PreprocessingStage& stage) { return stage.stage == "normalise"; })) {
    root.at("stages").refuse("no stage 'normalise'; networks need numbers within -1 and 1");
  }
  if (root.has("run_time")) {
    for (const JsonValue& value : root.at("run_time").list()) {
      const std::string name = value.one_of({"quantise", "exponential", "mean"});
      bool there = false;
      for (PreprocessingStage& stage : configuration.stages) {
        if (stage.stage == name) stage.run_time = there = true;
      }
      if (!there) value.refuse("'" + name + "' is none of the stages");
    }
  }
  for (const PreprocessingStage& stage : configuration.stages) {
    if (!stage.feature.empty()) static_cast<void>(NamedFeature(stage.feature));
  }
  if (root.has("thesis")) {
    for (const JsonValue& value : root.at("thesis").list()) {
      value.only({"output", "test", "mse", "r2"});
      configuration.thesis.push_back({value.at("output").text(), value.at("test").text(),
                                      value.at("mse").number(0.0, 1.0),
                                      value.at("r2").number(0.0, 1.0)});
    }
  }
  std::optional<JsonValue> common;
  if (root.has("training")) {
    common = root.at("training");
    common->only(kNetworkKeys);
  }
  for (const JsonValue& value : root.at("networks").list(1)) {
    configuration.networks.push_back(network_of(value, common ? &*common : nullptr));
  }
  return configuration;
}

}  // namespace

std::string NetworkConfiguration::name() const {
  std::string text;
  for (const std::string& output : outputs) text += (text.empty() ? "" : "+") + output;
  return text;
}

std::string NetworkConfiguration::learned_output() const {
  return baseline.empty() ? outputs.front() : outputs.front() + "-" + baseline;
}

std::vector<std::string> TrainingConfiguration::features() const {
  std::vector<std::string> names;
  const auto add = [&](const std::string& feature) {
    if (!feature.empty() && std::find(names.begin(), names.end(), feature) == names.end()) {
      names.push_back(feature);
    }
  };
  for (const NetworkConfiguration& network : networks) {
    std::for_each(network.inputs.begin(), network.inputs.end(), add);
    std::for_each(network.outputs.begin(), network.outputs.end(), add);
    add(network.baseline);
    if (!network.baseline.empty()) add(network.learned_output());
  }
  for (const PreprocessingStage& stage : stages) add(stage.feature);
  return names;
}

TrainingConfiguration parse_training_configuration(const std::string& text,
                                                   const std::string& name) {
  const Json json = read_json_text(text, name);
  TrainingConfiguration configuration = configuration_of(JsonValue(json, name));
  configuration.text = text;
  return configuration;
}

TrainingConfiguration read_training_configuration(const std::filesystem::path& file) {
  static_cast<void>(read_json_file(file));  // refuses what cannot be read
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return parse_training_configuration(text.str(), file.string());
}

}  // namespace screed::nn
