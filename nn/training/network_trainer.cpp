// tiny-dnn does forward and backward propagation; order, first weights and steps are ours, since
// its own draw from one global generator, and its Adam counts arrays in place of steps.
#include "nn/training/network_trainer.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <sstream>
#include <unordered_map>
#include <utility>

#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"
#include "nn/training/tiny_dnn.h"

namespace screed::nn {
namespace {

using tiny_dnn::batch_normalization_layer;
using tiny_dnn::serial_size_t;
using tiny_dnn::tensor_t;
using tiny_dnn::vec_t;
using Dense = tiny_dnn::fully_connected_layer<tiny_dnn::activation::identity>;
using Tanh = tiny_dnn::linear_layer<tiny_dnn::activation::tan_h>;

/// What nn/infer does to a linear node: cut at -1 and 1. Behind the ends a little of the gradient
/// goes on, so that a node that is always cut can come back.
class CutAtOne : public tiny_dnn::activation::function {
 public:
  float f(const vec_t& v, std::size_t index) const override {
    return std::clamp(v[index], -1.0F, 1.0F);
  }
  using function::df;
  float df(float y) const override { return std::abs(y) < 1.0F ? 1.0F : 0.05F; }
  std::pair<float, float> scale() const override { return {-1.0F, 1.0F}; }
};
using Limited = tiny_dnn::linear_layer<CutAtOne>;

constexpr float kVarianceFloor = 1e-5F;
constexpr float kRunningShare = 0.99F;
constexpr std::size_t kChunkBatches = 64;  ///< that are copied for tiny-dnn at a time

/// y = scale x + offset, a node: what Keras' batch normalisation has and tiny-dnn's has not.
class ScaleLayer : public tiny_dnn::layer {
 public:
  explicit ScaleLayer(serial_size_t nodes)
      : layer({tiny_dnn::vector_type::data, tiny_dnn::vector_type::weight,
               tiny_dnn::vector_type::bias},
              {tiny_dnn::vector_type::data}),
        nodes_(nodes) {}

  std::vector<tiny_dnn::shape3d> in_shape() const override {
    const tiny_dnn::shape3d shape(nodes_, 1, 1);
    return {shape, shape, shape};
  }
  std::vector<tiny_dnn::shape3d> out_shape() const override {
    return {tiny_dnn::shape3d(nodes_, 1, 1)};
  }
  std::string layer_type() const override { return "scale"; }

  void forward_propagation(const std::vector<tensor_t*>& in, std::vector<tensor_t*>& out) override {
    const vec_t& scale = (*in[1])[0];
    const vec_t& offset = (*in[2])[0];
    for (std::size_t sample = 0; sample < in[0]->size(); ++sample) {
      for (std::size_t i = 0; i < nodes_; ++i) {
        (*out[0])[sample][i] = scale[i] * (*in[0])[sample][i] + offset[i];
      }
    }
  }
  void back_propagation(const std::vector<tensor_t*>& in, const std::vector<tensor_t*>& /*out*/,
                        std::vector<tensor_t*>& out_grad,
                        std::vector<tensor_t*>& in_grad) override {
    const vec_t& scale = (*in[1])[0];
    for (std::size_t sample = 0; sample < in[0]->size(); ++sample) {
      for (std::size_t i = 0; i < nodes_; ++i) {
        const float grad = (*out_grad[0])[sample][i];
        (*in_grad[0])[sample][i] = grad * scale[i];
        (*in_grad[1])[sample][i] += grad * (*in[0])[sample][i];
        (*in_grad[2])[sample][i] += grad;
      }
    }
  }

 private:
  serial_size_t nodes_;
};

/// Our update rules behind tiny-dnn's interface. Keeps no state over a reset, which tiny-dnn asks
/// for at every call: state is kept by array.
class Optimiser : public tiny_dnn::optimizer {
 public:
  Optimiser(OptimiserKind kind, double l2) : kind_(kind), l2_(l2) {}

  void add(const vec_t* parameters, bool is_weight) {
    index_[parameters] = states.size();
    states.emplace_back();
    weights_.push_back(is_weight);
  }
  void update(const vec_t& gradient, vec_t& parameters, bool /*parallelize*/) override {
    const std::size_t i = index_.at(&parameters);
    if (watching) {
      seen[i].assign(gradient.begin(), gradient.end());
      return;
    }
    update_parameters(kind_, learning_rate, weights_[i] ? l2_ : 0.0, gradient, parameters,
                      states[i]);
  }

  std::vector<UpdateState> states;
  double learning_rate = 0.0;
  bool watching = false;  ///< note gradients in `seen`, change nothing
  std::vector<std::vector<float>> seen;

 private:
  OptimiserKind kind_;
  double l2_;
  std::unordered_map<const vec_t*, std::size_t> index_;
  std::vector<bool> weights_;
};

/// Running means and variances, which tiny-dnn shows in its text form only.
std::pair<vec_t, vec_t> running_moments(const batch_normalization_layer& layer, std::size_t nodes) {
  std::ostringstream text;
  text.precision(9);  // what a float needs
  layer.save(text);
  std::istringstream numbers(text.str());
  vec_t mean(nodes);
  vec_t variance(nodes);
  for (float& value : mean) numbers >> value;
  for (float& value : variance) numbers >> value;
  return {mean, variance};
}

double learning_rate_of(const NetworkConfiguration& configuration, std::size_t epoch) {
  if (configuration.epochs < 2) return configuration.learning_rate;
  return configuration.learning_rate *
         std::pow(configuration.final_rate,
                  static_cast<double>(epoch) / static_cast<double>(configuration.epochs - 1));
}

class TinyDnnTrainer : public NetworkTrainer {
 public:
  TinyDnnTrainer(const NetworkConfiguration& configuration, std::uint64_t seed)
      : configuration_(configuration),
        seed_(seed),
        optimiser_(configuration.optimiser, configuration.l2) {
    build();
    net_.init_weight();
    draw_weights();
    for (const Stage& stage : stages_) {
      for (vec_t* array : arrays_of(stage)) {
        optimiser_.add(array, array == stage.dense->weights()[0]);
      }
    }
  }

  bool train_epoch(const Examples& examples, const std::function<bool()>& stop) override {
    const std::optional<TrainerState> before = stop ? std::optional(state()) : std::nullopt;
    optimiser_.learning_rate = learning_rate_of(configuration_, epochs_);
    std::vector<std::uint32_t> order = in_order(examples.rows());
    const std::size_t batch = configuration_.batch == 0 ? order.size() : configuration_.batch;
    if (configuration_.batch != 0) {
      order = shuffled(order.size(),
                       {seed_, "order " + configuration_.name() + " " + std::to_string(epochs_)});
    }
    // A last batch of one cannot be normalised.
    const std::size_t rest = order.size() % batch;
    if (rest == 1 && order.size() > 1) order.pop_back();
    const std::size_t chunk = configuration_.batch == 0 ? order.size() : batch * kChunkBatches;
    for (std::size_t first = 0; first < order.size(); first += chunk) {
      if (before.has_value() && stop()) {
        restore(*before);
        return false;
      }
      fit(examples, std::span(order).subspan(first, std::min(chunk, order.size() - first)), batch);
    }
    ++epochs_;
    return true;
  }

  std::vector<float> outputs(const Examples& examples) override {
    net_.set_netphase(tiny_dnn::net_phase::test);
    std::vector<float> result;
    for (std::size_t row = 0; row < examples.rows(); ++row) {
      const vec_t out = net_.predict(row_of(examples.in, examples.inputs, row));
      result.insert(result.end(), out.begin(), out.end());
    }
    return result;
  }

  std::vector<std::vector<float>> gradient(const Examples& examples) override {
    const TrainerState before = state();
    optimiser_.watching = true;
    optimiser_.seen.assign(optimiser_.states.size(), {});
    fit(examples, in_order(examples.rows()), examples.rows());
    optimiser_.watching = false;
    restore(before);
    return optimiser_.seen;
  }

  std::vector<FloatLayer> folded() const override {
    std::vector<FloatLayer> layers;
    for (const Stage& stage : stages_) layers.push_back(folded(stage));
    return layers;
  }

  TrainerState state() const override {
    TrainerState state;
    state.epochs = epochs_;
    state.updates = optimiser_.states;
    for (const Stage& stage : stages_) {
      for (const vec_t* array : arrays_of(stage)) {
        state.parameters.emplace_back(array->begin(), array->end());
      }
      if (stage.norm == nullptr) continue;
      const auto [mean, variance] = running_moments(*stage.norm, stage.outputs);
      state.parameters.emplace_back(mean.begin(), mean.end());
      state.parameters.emplace_back(variance.begin(), variance.end());
    }
    return state;
  }

  void restore(const TrainerState& state) override {
    std::size_t next = 0;
    const auto taken = [&](std::size_t size) {
      if (next >= state.parameters.size() || state.parameters[next].size() != size) {
        throw InputError("the state of the training does not fit the network's layers");
      }
      const std::vector<float>& values = state.parameters[next++];
      return vec_t(values.begin(), values.end());
    };
    for (const Stage& stage : stages_) {
      for (vec_t* array : arrays_of(stage)) *array = taken(array->size());
      if (stage.norm == nullptr) continue;
      stage.norm->set_mean(taken(stage.outputs));
      stage.norm->set_variance(taken(stage.outputs));
    }
    if (next != state.parameters.size() || state.updates.size() != optimiser_.states.size()) {
      throw InputError("the state of the training does not fit the network's layers");
    }
    optimiser_.states = state.updates;
    epochs_ = state.epochs;
  }

 private:
  /// A layer of ours: what tiny-dnn has as up to four.
  struct Stage {
    std::size_t inputs = 0;
    std::size_t outputs = 0;
    bool linear = false;
    std::shared_ptr<Dense> dense;
    std::shared_ptr<batch_normalization_layer> norm;
    std::shared_ptr<ScaleLayer> scale;
    std::shared_ptr<Tanh> tanh;
    std::shared_ptr<Limited> limited;
  };

  void build() {
    std::size_t inputs = configuration_.inputs.size();
    std::vector<std::size_t> widths = configuration_.hidden;
    widths.push_back(configuration_.outputs.size());
    for (std::size_t i = 0; i < widths.size(); ++i) {
      Stage stage;
      stage.inputs = inputs;
      stage.outputs = widths[i];
      stage.linear = i + 1 == widths.size() && configuration_.linear_output;
      const auto in = static_cast<serial_size_t>(inputs);
      const auto out = static_cast<serial_size_t>(widths[i]);
      stage.dense = std::make_shared<Dense>(in, out);
      net_ << *stage.dense;
      if (configuration_.batch_normalisation != BatchNormalisation::kNone) {
        // One number wide, a channel a node: with the two the other way round, it would take the
        // mean over the nodes.
        stage.norm =
            std::make_shared<batch_normalization_layer>(1U, out, kVarianceFloor, kRunningShare);
        stage.norm->set_mean(vec_t(out, 0.0F));
        stage.norm->set_variance(vec_t(out, 1.0F));
        net_ << *stage.norm;
      }
      if (configuration_.batch_normalisation == BatchNormalisation::kScaled) {
        stage.scale = std::make_shared<ScaleLayer>(out);
        net_ << *stage.scale;
      }
      if (!stage.linear && configuration_.limited) {
        stage.limited =
            std::make_shared<Limited>(out, static_cast<float>(configuration_.steepness));
        net_ << *stage.limited;
      } else if (!stage.linear) {
        stage.tanh = std::make_shared<Tanh>(out, static_cast<float>(configuration_.steepness));
        net_ << *stage.tanh;
      }
      stages_.push_back(std::move(stage));
      inputs = widths[i];
    }
  }

  void draw_weights() {
    WorldRandom random(seed_, "first weights " + configuration_.name());
    for (const Stage& stage : stages_) {
      const double range = configuration_.initialisation == Initialisation::kUniform
                               ? configuration_.initial_range
                               : std::sqrt(6.0 / static_cast<double>(stage.inputs + stage.outputs));
      for (float& weight : *stage.dense->weights()[0]) {
        weight = static_cast<float>(random.uniform(-range, range));
      }
      std::fill(stage.dense->weights()[1]->begin(), stage.dense->weights()[1]->end(), 0.0F);
      if (stage.scale == nullptr) continue;
      std::fill(stage.scale->weights()[0]->begin(), stage.scale->weights()[0]->end(), 1.0F);
      std::fill(stage.scale->weights()[1]->begin(), stage.scale->weights()[1]->end(), 0.0F);
    }
  }

  static std::vector<vec_t*> arrays_of(const Stage& stage) {
    std::vector<vec_t*> arrays = stage.dense->weights();
    if (stage.scale != nullptr) {
      for (vec_t* array : stage.scale->weights()) arrays.push_back(array);
    }
    return arrays;
  }

  static std::vector<std::uint32_t> in_order(std::size_t count) {
    std::vector<std::uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0U);
    return order;
  }

  static vec_t row_of(const std::vector<float>& values, std::size_t width, std::size_t row) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(row * width);
    return vec_t(begin, begin + static_cast<std::ptrdiff_t>(width));
  }

  void fit(const Examples& examples, std::span<const std::uint32_t> order, std::size_t batch) {
    std::vector<vec_t> in;
    std::vector<vec_t> out;
    for (const std::uint32_t row : order) {
      in.push_back(row_of(examples.in, examples.inputs, row));
      out.push_back(row_of(examples.out, examples.outputs, row));
    }
    net_.fit<tiny_dnn::mse>(optimiser_, in, out, batch, 1);
  }

  FloatLayer folded(const Stage& stage) const {
    FloatLayer layer{stage.inputs, stage.outputs, stage.linear || stage.limited != nullptr, {}, {}};
    const vec_t& weights = *stage.dense->weights()[0];
    const vec_t& bias = *stage.dense->weights()[1];
    std::pair<vec_t, vec_t> moments;
    if (stage.norm != nullptr) moments = running_moments(*stage.norm, stage.outputs);
    for (std::size_t node = 0; node < stage.outputs; ++node) {
      double gain = 1.0;
      double offset = static_cast<double>(bias[node]);
      if (stage.norm != nullptr) {
        const double variance = static_cast<double>(moments.second[node]);
        gain = 1.0 / std::sqrt(variance + static_cast<double>(kVarianceFloor));
        offset = (offset - static_cast<double>(moments.first[node])) * gain;
      }
      if (stage.scale != nullptr) {
        const auto scale = static_cast<double>((*stage.scale->weights()[0])[node]);
        gain *= scale;
        offset = offset * scale + static_cast<double>((*stage.scale->weights()[1])[node]);
      }
      if (!stage.linear) {
        gain *= configuration_.steepness;
        offset *= configuration_.steepness;
      }
      for (std::size_t i = 0; i < stage.inputs; ++i) {
        layer.weights.push_back(gain * static_cast<double>(weights[i * stage.outputs + node]));
      }
      layer.bias.push_back(offset);
    }
    return layer;
  }

  NetworkConfiguration configuration_;
  std::uint64_t seed_;
  std::vector<Stage> stages_;
  tiny_dnn::network<tiny_dnn::sequential> net_;
  Optimiser optimiser_;
  std::size_t epochs_ = 0;
};

}  // namespace

std::unique_ptr<NetworkTrainer> make_network_trainer(const NetworkConfiguration& configuration,
                                                     std::uint64_t seed) {
  return std::make_unique<TinyDnnTrainer>(configuration, seed);
}

}  // namespace screed::nn
