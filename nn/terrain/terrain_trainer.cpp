// Large matrices by Eigen. Back-propagation through fluxes: what a cell should have gained, the
// flux into it should have carried. Through the window's linear layers, which are then folded into
// one.
#include "nn/terrain/terrain_trainer.h"

#include <Eigen/Dense>
#include <cmath>
#include <numeric>

#include "host_sim/core/elementary.h"
#include "host_sim/core/random.h"

namespace screed::nn {
namespace {

using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Columns = Eigen::MatrixXf;  // a column an example
using Vector = Eigen::VectorXf;

Eigen::Index index(std::size_t value) {
  return static_cast<Eigen::Index>(value);
}

/// Whole batches of examples in an order that goes on changing; the loss is the mean squared error
/// of the heights' change, in mm^2.
class BatchTrainer : public Trainer {
 public:
  std::optional<EpochLoss> train_epoch(std::size_t epoch,
                                       const std::function<bool()>& /*stop*/) override {
    for (std::size_t i = order_.size(); i > 1; --i) {
      std::swap(order_[i - 1], order_[random_.next() % i]);
    }
    double squares = 0.0;
    std::size_t batches = 0;
    for (std::size_t at = 0; at + batch_ <= order_.size(); at += batch_, ++batches) {
      learn(epoch, std::span(order_).subspan(at, batch_), squares);
    }
    const double output_mm = output_m_ * 1e3;
    const auto numbers = static_cast<double>(batches * batch_ * outputs_);
    const double loss = squares / numbers * output_mm * output_mm;
    return EpochLoss{loss, loss};
  }

 protected:
  /// `outputs` numbers an example, one in them is so many metres.
  BatchTrainer(std::size_t examples, std::size_t batch, std::size_t outputs, double output_m,
               WorldRandom random)
      : random_(random), batch_(batch), outputs_(outputs), output_m_(output_m), order_(examples) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
  }

  /// A step by these examples; adds their squared errors.
  virtual void learn(std::size_t epoch, std::span<const std::size_t> rows, double& squares) = 0;

  WorldRandom random_;

 private:
  std::size_t batch_;
  std::size_t outputs_;
  double output_m_;
  std::vector<std::size_t> order_;
};

// ---- fluxes

constexpr std::size_t kFluxBatch = 16;
constexpr double kFluxRate = 0.003;
constexpr double kFluxL2 = 1e-6;

class FluxTrainer : public BatchTrainer {
 public:
  FluxTrainer(FluxNetwork& network, const FluxExamples& examples, std::size_t epochs,
              std::uint64_t seed)
      : BatchTrainer(examples.rows(), kFluxBatch, kCells, FluxNetwork::kOutput_m,
                     {seed, "order of examples"}),
        network_(network),
        examples_(examples),
        epochs_(static_cast<double>(epochs)),
        hidden_(index(network.hidden())),
        x_(kInputs + 1, index(kFluxBatch * kCells)),
        nodes_(hidden_ + 1, x_.cols()),
        flux_error_(2, x_.cols()),
        error_(kFluxBatch * kCells) {
    x_.row(kInputs).setOnes();
    nodes_.row(hidden_).setOnes();
  }

 private:
  static constexpr auto kInputs = static_cast<Eigen::Index>(FluxNetwork::kInputs);
  static constexpr std::size_t kCells = FluxNetwork::kCells;

  void learn(std::size_t epoch, std::span<const std::size_t> rows, double& squares) override {
    for (std::size_t b = 0; b < kFluxBatch; ++b) {
      const std::span<const float> observation(
          &examples_.observations[rows[b] * FluxNetwork::kObservation], FluxNetwork::kObservation);
      for (std::size_t cell = 0; cell < kCells; ++cell) {
        FluxNetwork::inputs_of(observation, static_cast<int>(cell % FluxNetwork::kCellsX),
                               static_cast<int>(cell / FluxNetwork::kCellsX),
                               &x_(0, index(b * kCells + cell)));
        error_[b * kCells + cell] = -examples_.changes[rows[b] * kCells + cell];
      }
    }
    const Eigen::Map<const Rows> first(network_.first().data(), hidden_, kInputs + 1);
    const Eigen::Map<const Rows> second(network_.second().data(), 2, hidden_ + 1);
    nodes_.topRows(hidden_) = (first * x_).array().tanh().matrix();
    const Columns fluxes = second * nodes_;
    for_fluxes([&](std::size_t from, std::size_t to, Eigen::Index row) {
      const float value = fluxes(row, index(from));
      error_[from] -= value;
      error_[to] += value;
    });
    for (float& value : error_) {
      squares += static_cast<double>(value) * static_cast<double>(value);
      value *= 2.0F / static_cast<float>(kFluxBatch);
    }
    flux_error_.setZero();
    for_fluxes([&](std::size_t from, std::size_t to, Eigen::Index row) {
      flux_error_(row, index(from)) = error_[to] - error_[from];
    });
    const Rows second_gradient = flux_error_ * nodes_.transpose();
    const Columns node_error = ((second.leftCols(hidden_).transpose() * flux_error_).array() *
                                (1.0F - nodes_.topRows(hidden_).array().square()))
                                   .matrix();
    const Rows first_gradient = node_error * x_.transpose();
    const double rate = kFluxRate * portable::pow(0.1, static_cast<double>(epoch) / epochs_);
    const auto update = [&](const Rows& gradient, std::vector<float>& weights, UpdateState& state) {
      update_parameters(OptimiserKind::kAdam, rate, kFluxL2,
                        {gradient.data(), static_cast<std::size_t>(gradient.size())}, weights,
                        state);
    };
    update(second_gradient, network_.second(), second_state_);
    update(first_gradient, network_.first(), first_state_);
  }

  /// Every flux of every example of a batch: the columns that it leads from and to.
  template <class Visit>
  static void for_fluxes(Visit&& visit) {
    for (std::size_t b = 0; b < kFluxBatch; ++b) {
      for (std::size_t flux = 0; flux < FluxNetwork::kFluxes; ++flux) {
        const FluxCells sides = cells_of(flux);
        visit(b * kCells + sides.from, b * kCells + sides.to, index(sides.row));
      }
    }
  }

  FluxNetwork& network_;
  const FluxExamples& examples_;
  double epochs_;
  Eigen::Index hidden_;
  // A column a cell of an example.
  Columns x_;
  Columns nodes_;
  Columns flux_error_;
  std::vector<float> error_;
  UpdateState first_state_;
  UpdateState second_state_;
};

// ---- the window

constexpr std::size_t kWindowBatch = 32;
constexpr double kWindowRate = 0.001;
constexpr double kWindowL2 = 0.0001;    // thesis 6.3.1
constexpr double kFirstWeights = 0.05;  // likewise: uniform in +-
constexpr float kMomentum = 0.99F;      // of Keras' running statistics
constexpr float kEpsilon = 0.001F;      // likewise

struct Learned {
  std::vector<float> values;
  std::vector<float> gradient;
  UpdateState state;

  void update(double rate, double l2) {
    update_parameters(OptimiserKind::kAdam, rate, l2, gradient, values, state);
  }
};

/// Weights, and batch normalisation with a scale and an offset a node where it has one.
class Layer {
 public:
  Layer(Eigen::Index inputs, Eigen::Index outputs, bool normalised, WorldRandom& random)
      : inputs_(inputs), outputs_(outputs), normalised_(normalised) {
    weights_.values.resize(static_cast<std::size_t>(inputs * outputs));
    for (float& weight : weights_.values) {
      weight = static_cast<float>(random.uniform(-kFirstWeights, kFirstWeights));
    }
    offset_.values.resize(static_cast<std::size_t>(outputs));
    scale_.values.assign(static_cast<std::size_t>(outputs), 1.0F);
    mean_ = Vector::Zero(outputs);
    variance_ = Vector::Ones(outputs);
  }

  Columns forward(const Columns& x) {
    x_ = x;
    Columns y = weights() * x;
    if (normalised_) {
      const Vector mean = y.rowwise().mean();
      y.colwise() -= mean;
      const Vector variance = y.array().square().rowwise().mean();
      deviation_ = (variance.array() + kEpsilon).sqrt();
      y.array().colwise() /= deviation_.array();
      normal_ = y;
      mean_ = kMomentum * mean_ + (1.0F - kMomentum) * mean;
      variance_ = kMomentum * variance_ + (1.0F - kMomentum) * variance;
      y.array().colwise() *= map(scale_).array();
    }
    y.colwise() += map(offset_);
    return y;
  }

  Columns backward(Columns error) {
    store(offset_, error.rowwise().sum());
    if (normalised_) {
      store(scale_, (error.array() * normal_.array()).rowwise().sum().matrix());
      error.array().colwise() *= map(scale_).array();
      const Vector mean = error.rowwise().mean();
      const Vector along = (error.array() * normal_.array()).rowwise().mean();
      error.colwise() -= mean;
      error.array() -= normal_.array().colwise() * along.array();
      error.array().colwise() /= deviation_.array();
    }
    const Columns gradient = error * x_.transpose();
    weights_.gradient.assign(gradient.data(), gradient.data() + gradient.size());
    return weights().transpose() * error;
  }

  void update(double rate) {
    weights_.update(rate, kWindowL2);
    offset_.update(rate, 0.0);
    if (normalised_) scale_.update(rate, 0.0);
  }

  /// Applies the layer as it is used, by its running statistics, to a linear map.
  void fold_into(Columns& matrix, Vector& constant) const {
    matrix = weights() * matrix;
    constant = weights() * constant;
    if (normalised_) {
      const Vector factor = (map(scale_).array() / (variance_.array() + kEpsilon).sqrt()).matrix();
      constant = ((constant - mean_).array() * factor.array()).matrix();
      matrix.array().colwise() *= factor.array();
    }
    constant += map(offset_);
  }

 private:
  Eigen::Map<const Columns> weights() const { return {weights_.values.data(), outputs_, inputs_}; }
  static Eigen::Map<const Vector> map(const Learned& learned) {
    return {learned.values.data(), static_cast<Eigen::Index>(learned.values.size())};
  }
  static void store(Learned& learned, const Vector& gradient) {
    learned.gradient.assign(gradient.data(), gradient.data() + gradient.size());
  }

  Eigen::Index inputs_;
  Eigen::Index outputs_;
  bool normalised_;
  Learned weights_;
  Learned offset_;
  Learned scale_;
  Vector mean_;
  Vector variance_;
  Columns x_;
  Columns normal_;
  Vector deviation_;
};

struct WindowExamples {
  std::vector<float> inputs;
  std::vector<float> outputs;
};

void add_examples(const DriveStrides& drive, WindowExamples& examples) {
  HeightField before = drive.initial_terrain();
  HeightField after = before;
  std::vector<float> last(WindowNetwork::kCells);
  std::vector<float> now(WindowNetwork::kCells);
  std::vector<float> motion(WindowNetwork::kMotions);
  for (std::size_t i = 0; i < drive.size(); ++i) {
    drive.advance(i, after);
    WindowNetwork::observe(before, after, drive[i], now);
    drive.advance(i, before);
    WindowNetwork::add_motion(drive[i], motion);
    examples.inputs.insert(examples.inputs.end(), last.begin(), last.end());
    examples.inputs.insert(examples.inputs.end(), motion.begin(), motion.end());
    examples.outputs.insert(examples.outputs.end(), now.begin(), now.end());
    last = now;
  }
}

class WindowTrainer : public BatchTrainer {
 public:
  WindowTrainer(const WindowExamples& examples, std::uint64_t seed)
      : BatchTrainer(examples.outputs.size() / kCells, kWindowBatch, kCells,
                     WindowNetwork::kOutput_m, {seed, "window network"}),
        examples_(examples) {
    Eigen::Index width = kInputs;
    for (std::size_t i = 0; i < WindowNetwork::kHiddenLayers; ++i) {
      layers_.emplace_back(width, WindowNetwork::kHiddenNodes, true, random_);
      width = WindowNetwork::kHiddenNodes;
    }
    layers_.emplace_back(width, kCells, false, random_);
  }

  WindowNetwork folded() const {
    Columns matrix = Columns::Identity(kInputs, kInputs);
    Vector constant = Vector::Zero(kInputs);
    for (const Layer& layer : layers_) layer.fold_into(matrix, constant);
    const Rows by_rows = matrix;
    return {{by_rows.data(), by_rows.data() + by_rows.size()},
            {constant.data(), constant.data() + constant.size()}};
  }

 private:
  static constexpr std::size_t kInputs = WindowNetwork::kInputs;
  static constexpr std::size_t kCells = WindowNetwork::kCells;

  void learn(std::size_t /*epoch*/, std::span<const std::size_t> rows, double& squares) override {
    Columns y(kInputs, kWindowBatch);
    Columns wanted(kCells, kWindowBatch);
    for (std::size_t b = 0; b < kWindowBatch; ++b) {
      y.col(index(b)) = Eigen::Map<const Vector>(&examples_.inputs[rows[b] * kInputs], kInputs);
      wanted.col(index(b)) = Eigen::Map<const Vector>(&examples_.outputs[rows[b] * kCells], kCells);
    }
    for (Layer& layer : layers_) y = layer.forward(y);
    Columns error = y - wanted;
    squares += static_cast<double>(error.squaredNorm());
    error *= 2.0F / static_cast<float>(kWindowBatch * kCells);
    for (auto layer = layers_.rbegin(); layer != layers_.rend(); ++layer) {
      error = layer->backward(error);
    }
    for (Layer& layer : layers_) layer.update(kWindowRate);
  }

  const WindowExamples& examples_;
  std::vector<Layer> layers_;
};

}  // namespace

void add_examples(const DriveStrides& drive, std::size_t every, FluxExamples& examples) {
  HeightField before = drive.initial_terrain();
  HeightField after = before;
  std::vector<float> observation(FluxNetwork::kObservation);
  for (std::size_t i = 0; i < drive.size(); ++i) {
    drive.advance(i, after);
    if (i % every == 0) {
      const FluxNetwork::WheelSupport support =
          FluxNetwork::wheel_support(before, drive.wheels(), drive[i]);
      for (std::size_t w = 0; w < drive.wheels().size(); ++w) {
        const WheelPosition& wheel = drive.wheels()[w];
        const FluxNetwork::Patch patch = FluxNetwork::patch_under(wheel, drive[i]);
        FluxNetwork::observe(before, patch, wheel, support.height_m[w], support.support_m[w],
                             drive[i], observation);
        examples.observations.insert(examples.observations.end(), observation.begin(),
                                     observation.end());
        for (int iy = 0; iy < FluxNetwork::kCellsY; ++iy) {
          for (int ix = 0; ix < FluxNetwork::kCellsX; ++ix) {
            const auto at = patch.cell(ix, iy);
            const double change = after.at(at[0], at[1]).height - before.at(at[0], at[1]).height;
            examples.changes.push_back(static_cast<float>(change / FluxNetwork::kOutput_m));
          }
        }
      }
    }
    drive.advance(i, before);
  }
}

void train(FluxNetwork& network, const FluxExamples& examples, std::size_t epochs,
           std::uint64_t seed, const EpochProgress& progress) {
  FluxTrainer trainer(network, examples, epochs, seed);
  run_epochs(trainer, epochs, progress);
}

WindowNetwork train_window(const std::vector<const DriveStrides*>& drives, std::size_t epochs,
                           std::uint64_t seed, const EpochProgress& progress) {
  WindowExamples examples;
  for (const DriveStrides* drive : drives) add_examples(*drive, examples);
  WindowTrainer trainer(examples, seed);
  run_epochs(trainer, epochs, progress);
  return trainer.folded();
}

}  // namespace screed::nn
