// Forward and backward pass, and the order of the drives.
#include "nn/slip/gated_trainer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>

#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"
#include "nn/training/parameter_update.h"

namespace screed::nn {
namespace {

using Eigen::Index;
using Eigen::MatrixXf;

constexpr Index kWindow = 128;  // steps, 5 s
constexpr Index kLanes = 16;
constexpr float kShareLoss = 3.0F;
constexpr float kUsualSpeed = 0.15F;
constexpr double kRoundedFrom = 0.4;  // of the epochs
/// Gradient of what is cut at its ends: a little beyond them, so that no unit is lost for ever.
constexpr float kBeyond = 0.05F;
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
  return (sums.array().abs() < 1.0F).select(MatrixXf::Ones(sums.rows(), sums.cols()), kBeyond);
}

class Pass {
 public:
  Pass(const GatedNetwork& network, Index lanes, double held_emphasis)
      : network_(network),
        shape_(network.shape()),
        window_(shape_, lanes),
        held_emphasis_(static_cast<float>(held_emphasis)) {}

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
      const float weight = step->held_weight * (step->held > 0.5F ? held_emphasis_ : 1.0F);
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
  float held_emphasis_;
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
        order_(sequences.size()),
        lanes_(kLanes),
        random_(seed + 1000003 * epoch, "offsets") {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    WorldRandom random(seed + 1000003 * epoch, "order of drives");
    for (std::size_t i = order_.size(); i > 1; --i) {
      std::swap(order_[i - 1], order_[(std::uint64_t{random.next()} * i) >> 32U]);
    }
  }

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
  std::vector<std::size_t> order_;
  std::size_t next_ = 0;
  std::vector<std::span<const SlipStep>> lanes_;
  WorldRandom random_;
};

}  // namespace

GatedNetwork train_gated(const std::vector<std::vector<SlipStep>>& sequences,
                         const GatedTrainingOptions& options) {
  std::size_t steps = 0;
  for (const auto& sequence : sequences) steps += sequence.size();
  if (steps == 0) throw RunError("slip: no steps to learn from");
  GatedNetwork network = random_network({kSlipInputs, options.units, kSlipOutputs}, options.seed);
  std::vector<UpdateState> updates(3);
  for (std::size_t epoch = 0; epoch < options.epochs; ++epoch) {
    const double done = static_cast<double>(epoch) / static_cast<double>(options.epochs);
    const double rate = options.learning_rate * std::pow(options.final_rate, done);
    Feed feed(sequences, options.seed, epoch);
    MatrixXf states = MatrixXf::Zero(options.units, kLanes);
    double loss = 0.0;
    std::size_t windows = 0;
    GatedNetwork forward = network;
    Pass pass(forward, kLanes, options.held_emphasis);
    while (feed.fill(pass.window())) {
      forward = done >= kRoundedFrom ? rounded(network) : network;
      GatedNetwork gradient = zeros(network);
      loss += pass.run(states, gradient);
      ++windows;
      float norm = 0.0F;
      for (const MatrixXf* matrix : matrices(gradient)) norm += matrix->squaredNorm();
      const float scale = std::min(1.0F, kMaxNorm / std::sqrt(norm + 1e-12F));
      for (std::size_t i = 0; i < 3; ++i) {
        MatrixXf& of = *matrices(gradient)[i];
        of *= scale;
        MatrixXf& parameters = *matrices(network)[i];
        update_parameters(
            OptimiserKind::kAdam, rate, 0.0, {of.data(), static_cast<std::size_t>(of.size())},
            {parameters.data(), static_cast<std::size_t>(parameters.size())}, updates[i]);
        parameters = parameters.cwiseMax(-kMaxWeight).cwiseMin(kMaxWeight);
      }
    }
    if (options.progress) {
      options.progress(epoch + 1, loss / static_cast<double>(std::max<std::size_t>(1, windows)));
    }
  }
  return rounded(network);
}

GatedGradient gated_gradient(const GatedNetwork& network,
                             const std::vector<std::vector<SlipStep>>& lanes) {
  Pass pass(network, static_cast<Index>(lanes.size()), 1.0);
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
