// Threads share nothing but the progress: each has its network and its examples.
#include "nn/training/training_run.h"

#include <algorithm>
#include <exception>
#include <mutex>
#include <thread>

#include "host_sim/core/content_hash.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/task_progress.h"
#include "nn/training/checkpoint.h"
#include "nn/training/predict.h"

namespace screed::nn {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kCheckpoints = 50;
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

/// The course of one network.
class Course {
 public:
  Course(const TrainingConfiguration& configuration, const PreparedData& data,
         const NetworkConfiguration& network, const TrainingOptions& options)
      : network_(network),
        options_(options),
        trainer_(network, configuration.seed),
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

  bool done() const {
    const std::size_t epochs = result_.losses.size();
    return epochs >= network_.epochs ||
           (network_.patience > 0 && epochs - std::min(epochs, best_epoch_) >= network_.patience);
  }

  /// One epoch; says what is new. Nothing: it was stopped.
  std::optional<std::string> step() {
    const auto stop = [this] { return options_.stop != nullptr && options_.stop->load(); };
    if (!trainer_.train_epoch(training_, stop)) return std::nullopt;
    std::vector<FloatLayer> layers = trainer_.folded();
    result_.losses.push_back({loss_of(layers, training_), loss_of(layers, choice_)});
    const std::size_t epoch = result_.losses.size();
    const bool better = result_.losses.back().choice < best_loss_;
    if (better) {
      best_loss_ = result_.losses.back().choice;
      best_epoch_ = epoch;
    }
    if (better || !network_.keep_best) {
      result_.layers = std::move(layers);
      result_.kept_epoch = epoch;
    }
    const std::size_t interval = std::max<std::size_t>(1, network_.epochs / kCheckpoints);
    if (file_ && (epoch % interval == 0 || done())) save();
    char note[160];
    std::snprintf(note, sizeof note, "%s: epoch %zu, error %.5f, on the choice %.5f",
                  network_.name().c_str(), epoch, result_.losses.back().training,
                  result_.losses.back().choice);
    return std::string(note);
  }

  void save() const {
    if (file_) write_checkpoint(*file_, {identity_, trainer_.state(), result_});
  }

  double share() const {
    return done()
               ? 1.0
               : static_cast<double>(result_.losses.size()) / static_cast<double>(network_.epochs);
  }
  TrainedNetwork take_result() { return std::move(result_); }

 private:
  void resume() {
    Checkpoint checkpoint = read_checkpoint(*file_);
    if (checkpoint.training != identity_) {
      throw InputError(file_->string() +
                       ": is of another training (configuration, seed, epochs or sessions "
                       "differ); remove it, or leave out --resume");
    }
    trainer_.restore(checkpoint.state);
    result_ = std::move(checkpoint.result);
    for (std::size_t i = 0; i < result_.losses.size(); ++i) {
      if (result_.losses[i].choice < best_loss_) {
        best_loss_ = result_.losses[i].choice;
        best_epoch_ = i + 1;
      }
    }
  }

  const NetworkConfiguration& network_;
  const TrainingOptions& options_;
  NetworkTrainer trainer_;
  std::string identity_;
  Examples training_;
  Examples choice_;
  std::optional<fs::path> file_;
  TrainedNetwork result_;
  double best_loss_ = 1e300;
  std::size_t best_epoch_ = 0;
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
  const auto stopped = [&] { return options.stop != nullptr && options.stop->load(); };
  const auto work = [&](std::size_t i) {
    try {
      while (!courses[i].done() && !stopped()) {
        const std::optional<std::string> note = courses[i].step();
        if (!note.has_value()) break;
        const std::lock_guard lock(mutex);
        if (failure) return;
        shares[i] = courses[i].share();
        double sum = 0.0;
        for (const double share : shares) sum += share;
        if (options.progress) options.progress(sum / static_cast<double>(shares.size()), *note);
      }
      if (stopped()) courses[i].save();
    } catch (...) {
      const std::lock_guard lock(mutex);
      failure = std::current_exception();
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
  for (Course& course : courses) results.push_back(course.take_result());
  return results;
}

Model make_model(const TrainingConfiguration& configuration, const PreparedData& data,
                 const std::vector<TrainedNetwork>& networks) {
  Model model;
  model.name = configuration.name;
  model.description = configuration.about;
  model.seed = configuration.seed;
  model.training_data = data.hash;
  model.stages = model_preprocessing_stages(configuration, data.preprocessing);
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
