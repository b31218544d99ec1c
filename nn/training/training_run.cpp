// Threads share nothing but the progress: each has its network and its examples.
#include "nn/training/training_run.h"

#include <cfloat>
#include <exception>
#include <mutex>
#include <thread>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/content_hash.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"
#include "host_sim/core/task_progress.h"
#include "nn/training/predict.h"

namespace screed::nn {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kGoldenVectors = 8;
constexpr std::size_t kRowsToQuantise = 20'000;

double loss_of(const std::vector<FloatLayer>& layers, const Examples& examples) {
  const std::vector<double> wanted(examples.out.begin(), examples.out.end());
  return mean_squared_error(wanted, predict(layers, examples));
}

std::string identity(const TrainingConfiguration& configuration, const PreparedData& data,
                     const NetworkConfiguration& network) {
  ContentHash hash;
  hash.add(configuration.text);
  hash.add(configuration.seed);
  hash.add(std::uint64_t{network.epochs});
  hash.add(data.hash);
  hash.add(network.name());
  return hash.hex();
}

/// Some of what the network will see, evenly spread over the training sessions.
std::vector<double> rows_seen(const PreparedData& data, const std::vector<std::string>& inputs) {
  std::vector<const FeatureTable*> tables;
  for (const FeatureTable& table : data.running) tables.push_back(&table);
  const Examples all = examples_of(tables, inputs, {});
  const std::size_t stride = 1 + all.rows() / kRowsToQuantise;
  std::vector<double> rows;
  for (std::size_t row = 0; row < all.rows(); row += stride) {
    const auto first = all.in.begin() + static_cast<std::ptrdiff_t>(row * all.inputs);
    rows.insert(rows.end(), first, first + static_cast<std::ptrdiff_t>(all.inputs));
  }
  return rows;
}

// ---- checkpoints: the state of a network's training as JSON, whose numbers read back to the same
// bits

struct Checkpoint {
  std::string training;  ///< hash over configuration, seed and data: what it belongs to
  TrainerState state;
  TrainedNetwork result;  ///< so far
};

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

/// The file appears complete or not at all. Throws RunError when it cannot be written.
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

/// Throws InputError, one line with file and place, when it is none.
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

// ---- one network

class Course : public Trainer {
 public:
  Course(const TrainingConfiguration& configuration, const PreparedData& data,
         const NetworkConfiguration& network, const TrainingOptions& options)
      : network_(make_network_trainer(network, configuration.seed)),
        identity_(identity(configuration, data, network)) {
    std::vector<const FeatureTable*> tables;
    for (const FeatureTable& table : data.training) tables.push_back(&table);
    training_ = examples_of(tables, network.inputs, learned_outputs(network));
    choice_ = examples_of({&data.choice}, network.inputs, learned_outputs(network));
    if (options.checkpoints) {
      file_ = *options.checkpoints / (network.name() + ".checkpoint.json");
      if (options.resume && fs::exists(*file_)) resume();
    }
  }

  std::optional<EpochLoss> train_epoch(std::size_t /*epoch*/,
                                       const std::function<bool()>& stop) override {
    if (!network_->train_epoch(training_, stop)) return std::nullopt;
    layers_ = network_->folded();
    return EpochLoss{loss_of(layers_, training_), loss_of(layers_, choice_)};
  }

  void keep() override {
    result.layers = layers_;
    result.kept_epoch = result.losses.size();
  }

  void checkpoint() override {
    if (file_) write_checkpoint(*file_, {identity_, network_->state(), result});
  }

  TrainedNetwork result;  ///< so far; run_training() adds the losses

 private:
  void resume() {
    Checkpoint checkpoint = read_checkpoint(*file_);
    if (checkpoint.training != identity_) {
      throw InputError(file_->string() +
                       ": is of another training (configuration, seed, epochs or sessions "
                       "differ); remove it, or leave out --resume");
    }
    network_->restore(checkpoint.state);
    result = std::move(checkpoint.result);
  }

  std::unique_ptr<NetworkTrainer> network_;
  std::string identity_;
  Examples training_;
  Examples choice_;
  std::optional<fs::path> file_;
  std::vector<FloatLayer> layers_;  ///< after the last epoch
};

}  // namespace

std::vector<TrainedNetwork> train(const TrainingConfiguration& configuration,
                                  const PreparedData& data, const TrainingOptions& options) {
  std::vector<Course> courses;
  courses.reserve(configuration.networks.size());
  for (const NetworkConfiguration& network : configuration.networks) {
    courses.emplace_back(configuration, data, network, options);
  }
  std::mutex mutex;
  std::vector<double> shares(courses.size());
  std::exception_ptr failure;
  std::atomic<bool> failed = false;
  const auto stopped = [&] { return options.stop != nullptr && options.stop->load(); };
  const auto work = [&](std::size_t i) {
    const NetworkConfiguration& network = configuration.networks[i];
    TrainingPlan plan{network.epochs, network.patience, network.keep_best, {}, {}};
    plan.stop = [&] { return stopped() || failed; };
    plan.progress = [&](const std::vector<EpochLoss>& losses, double share) {
      const std::lock_guard lock(mutex);
      shares[i] = share;
      double sum = 0.0;
      for (const double one : shares) sum += one;
      char note[160];
      std::snprintf(note, sizeof note, "%s: epoch %zu, error %.5f, on the choice %.5f",
                    network.name().c_str(), losses.size(), losses.back().training,
                    losses.back().choice);
      if (options.progress) options.progress(sum / static_cast<double>(shares.size()), note);
    };
    try {
      run_training(courses[i], plan, courses[i].result.losses);
    } catch (...) {
      const std::lock_guard lock(mutex);
      failure = std::current_exception();
      failed = true;
    }
  };
  std::vector<std::thread> threads;
  threads.reserve(courses.size());
  for (std::size_t i = 0; i < courses.size(); ++i) threads.emplace_back(work, i);
  for (std::thread& thread : threads) thread.join();
  if (failure) std::rethrow_exception(failure);
  if (stopped()) throw TaskStopped("training; --resume goes on from the checkpoints");
  std::vector<TrainedNetwork> results;
  results.reserve(courses.size());
  for (Course& course : courses) results.push_back(std::move(course.result));
  return results;
}

Model make_model(const TrainingConfiguration& configuration, const PreparedData& data,
                 const std::vector<TrainedNetwork>& networks) {
  Model model;
  model.name = configuration.name;
  model.description = configuration.about;
  model.seed = configuration.seed;
  model.training_data = data.hash;
  model.stages = data.preprocessing.stages();
  for (std::size_t i = 0; i < networks.size(); ++i) {
    const NetworkConfiguration& network = configuration.networks[i];
    const auto channel = [&](const std::string& feature, const std::string& learned) {
      const FeatureScale& scale = data.preprocessing.scale_of(learned);
      return ModelChannel{feature, scale.middle, scale.half_range, ""};
    };
    const IntegerNetwork integers = quantise(networks[i].layers, rows_seen(data, network.inputs));
    ModelNetwork result{{}, {}, integers, networks[i].layers, {}};
    for (const std::string& input : network.inputs) result.inputs.push_back(channel(input, input));
    const std::vector<std::string> learned = learned_outputs(network);
    for (std::size_t output = 0; output < learned.size(); ++output) {
      result.outputs.push_back(channel(network.outputs[output], learned[output]));
      result.outputs.back().baseline = network.baseline;
    }
    result.golden = golden_vectors(integers, kGoldenVectors, configuration.seed);
    model.networks.push_back(std::move(result));
  }
  return model;
}

}  // namespace screed::nn
