#include "nn/slip/gated_trainer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"
#include "nn/training/trainer.h"

namespace screed::nn {
namespace {

Eigen::MatrixXf random_matrix(Eigen::Index rows, Eigen::Index columns, WorldRandom& random) {
  const double deviation = 1.0 / std::sqrt(static_cast<double>(columns));
  Eigen::MatrixXf matrix(rows, columns);
  for (float& weight : matrix.reshaped()) weight = static_cast<float>(deviation * random.normal());
  return matrix;
}

float nearest(float weight) {
  return std::clamp(std::round(weight * kWeightScale), -127.0F, 127.0F) / kWeightScale;
}

}  // namespace

GatedShape GatedNetwork::shape() const {
  const auto units = static_cast<std::uint8_t>(candidates.rows());
  return {static_cast<std::uint8_t>(candidates.cols() - 1 - units), units,
          static_cast<std::uint8_t>(outputs.rows())};
}

GatedNetwork random_network(const GatedShape& shape, std::uint64_t seed) {
  WorldRandom random(seed, "gated network");
  GatedNetwork network;
  network.candidates = random_matrix(shape.units, shape.row_size(), random);
  network.gates = random_matrix(shape.units, shape.row_size(), random);
  network.outputs = random_matrix(shape.outputs, 1 + shape.units, random);
  network.candidates.col(0).setZero();
  network.outputs.col(0).setZero();
  // (bias + 1)^2 / 4 of the way a step: 1 / 100 to 2 / 3.
  for (Eigen::Index i = 0; i < shape.units; ++i) {
    const float share = static_cast<float>(i) / static_cast<float>(std::max(1, shape.units - 1));
    network.gates(i, 0) = -0.8F + 1.4F * share;
  }
  return network;
}

GatedNetwork rounded(GatedNetwork network) {
  for (Eigen::MatrixXf* matrix : {&network.candidates, &network.gates, &network.outputs})
    *matrix = matrix->unaryExpr(&nearest);
  return network;
}

std::vector<std::int8_t> parameters_of(const GatedNetwork& network) {
  std::vector<std::int8_t> parameters;
  for (const Eigen::MatrixXf* matrix : {&network.candidates, &network.gates, &network.outputs}) {
    for (Eigen::Index row = 0; row < matrix->rows(); ++row) {
      for (Eigen::Index column = 0; column < matrix->cols(); ++column) {
        parameters.push_back(
            static_cast<std::int8_t>(std::lround(nearest((*matrix)(row, column)) * kWeightScale)));
      }
    }
  }
  return parameters;
}

GatedRunner::GatedRunner(const GatedShape& shape, std::vector<std::int8_t> parameters)
    : shape_(shape),
      parameters_(std::move(parameters)),
      values_(shape.values()),
      candidates_(shape.units),
      states_(shape.units),
      outputs_(shape.outputs) {}

void GatedRunner::forget() {
  std::fill(values_.begin() + shape_.inputs, values_.end(), std::int8_t{0});
  std::fill(states_.begin(), states_.end(), std::int16_t{0});
}

std::span<const std::int16_t> GatedRunner::step(std::span<const std::int8_t> inputs) {
  std::copy(inputs.begin(), inputs.end(), values_.begin());
  gated_candidates(shape_, parameters_.data(), values_.data(), candidates_.data());
  gated_update(shape_, parameters_.data(), values_.data(), candidates_.data(), states_.data(),
               outputs_.data());
  return outputs_;
}

// ---- training: forward and backward pass, the order of the drives, epochs

namespace {

using Eigen::Index;
using Eigen::MatrixXf;

constexpr Index kWindow = 128;  // steps, 5 s
constexpr Index kLanes = 16;
constexpr float kShareLoss = 3.0F;
constexpr float kUsualSpeed = 0.15F;
constexpr double kFirstRate = 0.01;
constexpr double kFinalRate = 0.02;   // share of it in the last epoch; geometric between
constexpr double kRoundedFrom = 0.4;  // of the epochs
/// Gradient of what is cut at its ends: a little beyond them, so that no unit is lost for ever.
constexpr float kSlopeBeyond = 0.05F;
constexpr float kMaxNorm = 1.0F;  // of a window's gradient
/// Deviations of what is added to the inputs for a window, in their units: other soils, motors and
/// sensors than those of the drives. In the order of slip_watch.h.
constexpr std::array<float, kSlipInputs> kOffsets = {4, 6, 10, 2, 2, 3, 4, 4, 10, 10, 10, 3};

/// A window of all lanes, and what the forward pass keeps for the way back.
struct Window {
  explicit Window(const GatedShape& shape, Index lanes)
      : offsets(MatrixXf::Zero(shape.inputs, lanes)),
        steps(static_cast<std::size_t>(kWindow),
              std::vector<const SlipStep*>(static_cast<std::size_t>(lanes), nullptr)),
        values(kWindow, MatrixXf::Zero(shape.row_size(), lanes)),
        candidates(kWindow),
        gates(kWindow) {}

  MatrixXf offsets;                                 ///< added to all inputs of the lane, /128
  std::vector<std::vector<const SlipStep*>> steps;  ///< null: the lane has none
  std::vector<MatrixXf> values;                     ///< 1, inputs, states before the step
  std::vector<MatrixXf> candidates, gates;          ///< sums
};

MatrixXf cut(const MatrixXf& sums) {
  return sums.cwiseMax(-1.0F).cwiseMin(1.0F);
}

MatrixXf inside(const MatrixXf& sums) {
  return (sums.array().abs() < 1.0F).select(MatrixXf::Ones(sums.rows(), sums.cols()), kSlopeBeyond);
}

class Pass {
 public:
  Pass(const GatedNetwork& network, Index lanes)
      : network_(network), shape_(network.shape()), window_(shape_, lanes) {}

  Window& window() { return window_; }

  /// Loss of the window, a mean over its steps; `states` (units x lanes) go on; adds its gradient.
  double run(MatrixXf& states, GatedNetwork& gradient) {
    forward(states);
    return backward(gradient);
  }

 private:
  void forward(MatrixXf& states) {
    states_.assign(1, states);
    for (std::size_t t = 0; t < window_.steps.size(); ++t) {
      MatrixXf& values = window_.values[t];
      values.row(0).setOnes();
      for (Index lane = 0; lane < values.cols(); ++lane) {
        const SlipStep* step = window_.steps[t][static_cast<std::size_t>(lane)];
        if (step == nullptr) continue;
        if (step->forgets) states.col(lane).setZero();
        for (Index i = 0; i < shape_.inputs; ++i) {
          const float input =
              static_cast<float>(step->inputs[static_cast<std::size_t>(i)]) / 128.0F;
          values(1 + i, lane) = std::clamp(input + window_.offsets(i, lane), -1.0F, 1.0F);
        }
      }
      values.bottomRows(shape_.units) = states;
      window_.candidates[t] = network_.candidates * values;
      window_.gates[t] = network_.gates * values;
      const MatrixXf open = (cut(window_.gates[t]).array() + 1.0F) * 0.5F;
      states.array() += open.array().square() * (cut(window_.candidates[t]) - states).array();
      states_.push_back(states);
    }
  }

  /// Gradient of the loss by the outputs of step t; adds the loss.
  MatrixXf by_outputs(std::size_t t, double& loss) const {
    MatrixXf outputs = network_.outputs.rightCols(shape_.units) * states_[t + 1];
    outputs.colwise() += network_.outputs.col(0);
    MatrixXf delta = MatrixXf::Zero(outputs.rows(), outputs.cols());
    for (Index lane = 0; lane < outputs.cols(); ++lane) {
      const SlipStep* step = window_.steps[t][static_cast<std::size_t>(lane)];
      if (step == nullptr) continue;
      const float logit = outputs(0, lane);
      const float weight = step->held_weight;
      loss += static_cast<double>(weight * (std::log1p(std::exp(-std::abs(logit))) +
                                            std::max(logit, 0.0F) - step->held * logit));
      delta(0, lane) = weight * (1.0F / (1.0F + std::exp(-logit)) - step->held);
      const float importance = kShareLoss * step->share_weight / kUsualSpeed;
      const float error = outputs(1, lane) - step->share;
      loss += static_cast<double>(importance * error * error);
      delta(1, lane) = 2.0F * importance * error;
    }
    return delta;
  }

  double backward(GatedNetwork& gradient) const {
    double loss = 0.0;
    const Index units = shape_.units;
    const Index lanes = window_.values[0].cols();
    const float scale = 1.0F / static_cast<float>(window_.steps.size() * lanes);
    MatrixXf by_state = MatrixXf::Zero(units, lanes);
    for (std::size_t t = window_.steps.size(); t-- > 0;) {
      const MatrixXf by_output = by_outputs(t, loss) * scale;
      gradient.outputs.col(0) += by_output.rowwise().sum();
      gradient.outputs.rightCols(units) += by_output * states_[t + 1].transpose();
      by_state += network_.outputs.rightCols(units).transpose() * by_output;
      const MatrixXf before = window_.values[t].bottomRows(units);
      const MatrixXf open = (cut(window_.gates[t]).array() + 1.0F) * 0.5F;
      const MatrixXf gate = open.array().square();
      const MatrixXf by_candidate =
          by_state.cwiseProduct(gate).cwiseProduct(inside(window_.candidates[t]));
      const MatrixXf by_gate = by_state.cwiseProduct(cut(window_.candidates[t]) - before)
                                   .cwiseProduct(open)
                                   .cwiseProduct(inside(window_.gates[t]));
      gradient.candidates += by_candidate * window_.values[t].transpose();
      gradient.gates += by_gate * window_.values[t].transpose();
      by_state = by_state.cwiseProduct(MatrixXf::Ones(units, lanes) - gate).eval();
      by_state += network_.candidates.rightCols(units).transpose() * by_candidate +
                  network_.gates.rightCols(units).transpose() * by_gate;
      for (Index lane = 0; lane < lanes; ++lane) {
        const SlipStep* step = window_.steps[t][static_cast<std::size_t>(lane)];
        if (step == nullptr || step->forgets) by_state.col(lane).setZero();
      }
    }
    return loss * static_cast<double>(scale);
  }

  const GatedNetwork& network_;
  GatedShape shape_;
  Window window_;
  std::vector<MatrixXf> states_;  ///< before the first step and after each
};

GatedNetwork zeros(const GatedNetwork& like) {
  return {MatrixXf::Zero(like.candidates.rows(), like.candidates.cols()),
          MatrixXf::Zero(like.gates.rows(), like.gates.cols()),
          MatrixXf::Zero(like.outputs.rows(), like.outputs.cols())};
}

std::vector<MatrixXf*> matrices(GatedNetwork& network) {
  return {&network.candidates, &network.gates, &network.outputs};
}

/// The lanes' way through the sequences, in an order by seed and epoch.
class Feed {
 public:
  Feed(const std::vector<std::vector<SlipStep>>& sequences, std::uint64_t seed, std::size_t epoch)
      : sequences_(sequences),
        order_(shuffled(sequences.size(), {seed + 1000003 * epoch, "order of drives"})),
        lanes_(kLanes),
        random_(seed + 1000003 * epoch, "offsets") {}

  /// False when too few lanes still have steps.
  bool fill(Window& window) {
    for (Index lane = 0; lane < window.offsets.cols(); ++lane) {
      for (Index i = 0; i < window.offsets.rows(); ++i) {
        window.offsets(i, lane) =
            kOffsets[static_cast<std::size_t>(i)] / 128.0F * static_cast<float>(random_.normal());
      }
    }
    std::size_t filled = 0;
    for (auto& of_step : window.steps) {
      for (std::size_t lane = 0; lane < lanes_.size(); ++lane) {
        of_step[lane] = next_of(lanes_[lane]);
        filled += of_step[lane] != nullptr ? 1 : 0;
      }
    }
    return filled * 2 > window.steps.size() * lanes_.size();
  }

 private:
  const SlipStep* next_of(std::span<const SlipStep>& rest) {
    while (rest.empty()) {
      if (next_ == order_.size()) return nullptr;
      rest = sequences_[order_[next_++]];
    }
    const SlipStep* step = &rest.front();
    rest = rest.subspan(1);
    return step;
  }

  const std::vector<std::vector<SlipStep>>& sequences_;
  std::vector<std::uint32_t> order_;
  std::size_t next_ = 0;
  std::vector<std::span<const SlipStep>> lanes_;
  WorldRandom random_;
};

class GatedTrainer : public Trainer {
 public:
  GatedTrainer(const std::vector<std::vector<SlipStep>>& sequences,
               const GatedTrainingOptions& options)
      : network(random_network({kSlipInputs, options.units, kSlipOutputs}, options.seed)),
        sequences_(sequences),
        options_(options) {}

  std::optional<EpochLoss> train_epoch(std::size_t epoch,
                                       const std::function<bool()>& /*stop*/) override {
    const double done = static_cast<double>(epoch) / static_cast<double>(options_.epochs);
    const double rate = kFirstRate * std::pow(kFinalRate, done);
    Feed feed(sequences_, options_.seed, epoch);
    MatrixXf states = MatrixXf::Zero(options_.units, kLanes);
    double loss = 0.0;
    std::size_t windows = 0;
    GatedNetwork forward = network;
    Pass pass(forward, kLanes);
    while (feed.fill(pass.window())) {
      forward = done >= kRoundedFrom ? rounded(network) : network;
      GatedNetwork gradient = zeros(network);
      loss += pass.run(states, gradient);
      ++windows;
      update(gradient, rate);
    }
    loss /= static_cast<double>(std::max<std::size_t>(1, windows));
    return EpochLoss{loss, loss};
  }

  GatedNetwork network;

 private:
  void update(GatedNetwork& gradient, double rate) {
    float norm = 0.0F;
    for (const MatrixXf* matrix : matrices(gradient)) norm += matrix->squaredNorm();
    const float scale = std::min(1.0F, kMaxNorm / std::sqrt(norm + 1e-12F));
    for (std::size_t i = 0; i < updates_.size(); ++i) {
      MatrixXf& of = *matrices(gradient)[i];
      of *= scale;
      MatrixXf& parameters = *matrices(network)[i];
      update_parameters(
          OptimiserKind::kAdam, rate, 0.0, {of.data(), static_cast<std::size_t>(of.size())},
          {parameters.data(), static_cast<std::size_t>(parameters.size())}, updates_[i]);
      parameters = parameters.cwiseMax(-kMaxWeight).cwiseMin(kMaxWeight);
    }
  }

  const std::vector<std::vector<SlipStep>>& sequences_;
  const GatedTrainingOptions& options_;
  std::array<UpdateState, 3> updates_;
};

}  // namespace

GatedNetwork train_gated(const std::vector<std::vector<SlipStep>>& sequences,
                         const GatedTrainingOptions& options) {
  if (std::all_of(sequences.begin(), sequences.end(), [](const auto& one) { return one.empty(); }))
    throw RunError("slip: no steps to learn from");
  GatedTrainer trainer(sequences, options);
  run_epochs(trainer, options.epochs, options.progress);
  return rounded(trainer.network);
}

GatedGradient gated_gradient(const GatedNetwork& network,
                             const std::vector<std::vector<SlipStep>>& lanes) {
  Pass pass(network, static_cast<Index>(lanes.size()));
  for (std::size_t t = 0; t < pass.window().steps.size(); ++t) {
    for (std::size_t lane = 0; lane < lanes.size(); ++lane) {
      if (t < lanes[lane].size()) pass.window().steps[t][lane] = &lanes[lane][t];
    }
  }
  MatrixXf states = MatrixXf::Zero(network.shape().units, static_cast<Index>(lanes.size()));
  GatedGradient result{0.0, zeros(network)};
  result.loss = pass.run(states, result.gradient);
  return result;
}

}  // namespace screed::nn
