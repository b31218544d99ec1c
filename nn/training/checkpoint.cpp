// As JSON: numbers in it read back to the same bits.
#include "nn/training/checkpoint.h"

#include <cfloat>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/json.h"

namespace screed::nn {
namespace {

template <class T>
std::vector<T> numbers(const JsonValue& list) {
  std::vector<T> values;
  for (const JsonValue& value : list.list()) {
    values.push_back(static_cast<T>(value.number(-DBL_MAX, DBL_MAX)));
  }
  return values;
}

std::size_t count(const JsonValue& value) {
  return static_cast<std::size_t>(value.integer(0, INT64_MAX));
}

}  // namespace

void write_checkpoint(const std::filesystem::path& file, const Checkpoint& checkpoint) {
  Json updates = Json::array();
  for (const UpdateState& update : checkpoint.state.updates) {
    updates.push_back(
        {{"first", update.first}, {"second", update.second}, {"steps", update.steps}});
  }
  Json layers = Json::array();
  for (const FloatLayer& layer : checkpoint.result.layers) {
    layers.push_back({{"inputs", layer.inputs},
                      {"outputs", layer.outputs},
                      {"linear", layer.linear},
                      {"weights", layer.weights},
                      {"bias", layer.bias}});
  }
  Json losses = Json::array();
  for (const EpochLoss& loss : checkpoint.result.losses) {
    losses.push_back({loss.training, loss.choice});
  }
  const Json root = {{"format", "screed-training"},
                     {"training", checkpoint.training},
                     {"epochs", checkpoint.state.epochs},
                     {"parameters", checkpoint.state.parameters},
                     {"updates", updates},
                     {"kept_epoch", checkpoint.result.kept_epoch},
                     {"layers", layers},
                     {"losses", losses}};
  write_file(file, root.dump() + "\n");
}

Checkpoint read_checkpoint(const std::filesystem::path& file) {
  const Json json = read_json_file(file);
  const JsonValue root(json, file.string());
  root.at("format").one_of({"screed-training"});
  Checkpoint checkpoint;
  checkpoint.training = root.at("training").text();
  checkpoint.state.epochs = count(root.at("epochs"));
  for (const JsonValue& array : root.at("parameters").list()) {
    checkpoint.state.parameters.push_back(numbers<float>(array));
  }
  for (const JsonValue& update : root.at("updates").list()) {
    checkpoint.state.updates.push_back({numbers<float>(update.at("first")),
                                        numbers<float>(update.at("second")),
                                        count(update.at("steps"))});
  }
  checkpoint.result.kept_epoch = count(root.at("kept_epoch"));
  for (const JsonValue& layer : root.at("layers").list()) {
    checkpoint.result.layers.push_back(
        {count(layer.at("inputs")), count(layer.at("outputs")), layer.at("linear").flag(),
         numbers<double>(layer.at("weights")), numbers<double>(layer.at("bias"))});
  }
  for (const JsonValue& loss : root.at("losses").list()) {
    const std::vector<double> both = numbers<double>(loss);
    if (both.size() != 2) loss.refuse("allowed are two errors");
    checkpoint.result.losses.push_back({both[0], both[1]});
  }
  return checkpoint;
}

}  // namespace screed::nn
