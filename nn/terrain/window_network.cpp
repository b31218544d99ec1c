// A stack of linear layers, learned as such and folded.
#include "nn/terrain/window_network.h"

#include <Eigen/Dense>
#include <cmath>
#include <fstream>
#include <numeric>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"
#include "host_sim/core/random.h"
#include "nn/training/parameter_update.h"

namespace screed::nn {
namespace {

using Columns = Eigen::MatrixXf;  // a column an example
using Vector = Eigen::VectorXf;

constexpr const char* kFormat = "screed-window-1";
constexpr std::size_t kBatch = 32;
constexpr double kRate = 0.001;
constexpr double kL2 = 0.0001;      // thesis 6.3.1
constexpr double kWeights = 0.05;   // likewise: uniform in +-
constexpr float kMomentum = 0.99F;  // of Keras' running statistics
constexpr float kEpsilon = 0.001F;  // likewise
constexpr double kSpeed_rad_per_s = 8.0;
constexpr double kTilt_rad = 0.4;

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
      weight = static_cast<float>(random.uniform(-kWeights, kWeights));
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
    weights_.update(rate, kL2);
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

/// The nodes of a field in the cells of the window round a stride's end.
template <class Visit>
void for_nodes(const HeightField& ground, const Stride& stride, Visit&& visit) {
  const int per_cell =
      std::max(1, static_cast<int>(std::lround(WindowNetwork::kCell_m / ground.spacing_m())));
  const int nodes = per_cell * WindowNetwork::kSide;
  const int west =
      static_cast<int>(std::lround((stride.x_m - ground.x_min()) / ground.spacing_m())) - nodes / 2;
  const int south =
      static_cast<int>(std::lround((stride.y_m - ground.y_min()) / ground.spacing_m())) - nodes / 2;
  const auto wrapped_node = [&](int at, int count) {
    if (!ground.wrap()) return at >= 0 && at < count ? at : -1;
    const int within = at % count;
    return within < 0 ? within + count : within;
  };
  for (int iy = 0; iy < nodes; ++iy) {
    const int y = wrapped_node(south + iy, ground.ny());
    for (int ix = 0; ix < nodes; ++ix) {
      const int x = wrapped_node(west + ix, ground.nx());
      if (x < 0 || y < 0) continue;
      visit(static_cast<std::size_t>(iy / per_cell) * WindowNetwork::kSide +
                static_cast<std::size_t>(ix / per_cell),
            x, y, 1.0 / (per_cell * per_cell));
    }
  }
}

/// What changed in the window, in units of the outputs.
void observe(const HeightField& before, const HeightField& after, const Stride& stride,
             std::span<float> cells) {
  std::fill(cells.begin(), cells.end(), 0.0F);
  for_nodes(before, stride, [&](std::size_t cell, int x, int y, double share) {
    const double change = static_cast<double>(after.node(x, y)) - before.node(x, y);
    cells[cell] += static_cast<float>(change * kHeightUnit_m * share / WindowNetwork::kOutput_m);
  });
}

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
    observe(before, after, drive[i], now);
    drive.advance(i, before);
    WindowNetwork::add_motion(drive[i], motion);
    examples.inputs.insert(examples.inputs.end(), last.begin(), last.end());
    examples.inputs.insert(examples.inputs.end(), motion.begin(), motion.end());
    examples.outputs.insert(examples.outputs.end(), now.begin(), now.end());
    last = now;
  }
}

}  // namespace

void WindowNetwork::add_motion(const Stride& stride, std::span<float> inputs) {
  inputs[0] = static_cast<float>(stride.v_left / kSpeed_rad_per_s);
  inputs[1] = static_cast<float>(stride.v_right / kSpeed_rad_per_s);
  inputs[2] = static_cast<float>(stride.pitch / kTilt_rad);
  inputs[3] = static_cast<float>(stride.roll / kTilt_rad);
}

WindowNetwork::WindowNetwork(const std::vector<const DriveStrides*>& drives, std::size_t epochs,
                             std::uint64_t seed,
                             const std::function<void(std::size_t, double)>& progress) {
  WindowExamples examples;
  for (const DriveStrides* drive : drives) add_examples(*drive, examples);
  WorldRandom random(seed, "window network");
  std::vector<Layer> layers;
  Eigen::Index width = kInputs;
  for (std::size_t i = 0; i < kHiddenLayers; ++i) {
    layers.emplace_back(width, kHiddenNodes, true, random);
    width = kHiddenNodes;
  }
  layers.emplace_back(width, kCells, false, random);

  const std::size_t rows = examples.outputs.size() / kCells;
  std::vector<std::size_t> order(rows);
  std::iota(order.begin(), order.end(), std::size_t{0});
  Columns x(kInputs, kBatch);
  Columns wanted(kCells, kBatch);
  for (std::size_t epoch = 0; epoch < epochs; ++epoch) {
    for (std::size_t i = rows; i > 1; --i) std::swap(order[i - 1], order[random.next() % i]);
    double squares = 0.0;
    std::size_t batches = 0;
    for (std::size_t at = 0; at + kBatch <= rows; at += kBatch, ++batches) {
      for (std::size_t b = 0; b < kBatch; ++b) {
        const std::size_t row = order[at + b];
        const auto column = static_cast<Eigen::Index>(b);
        x.col(column) = Eigen::Map<const Vector>(&examples.inputs[row * kInputs], kInputs);
        wanted.col(column) = Eigen::Map<const Vector>(&examples.outputs[row * kCells], kCells);
      }
      Columns y = x;
      for (Layer& layer : layers) y = layer.forward(y);
      Columns error = y - wanted;
      squares += static_cast<double>(error.squaredNorm());
      error *= 2.0F / static_cast<float>(kBatch * kCells);
      for (auto layer = layers.rbegin(); layer != layers.rend(); ++layer) {
        error = layer->backward(error);
      }
      for (Layer& layer : layers) layer.update(kRate);
    }
    constexpr double kOutput_mm = kOutput_m * 1e3;
    if (progress) {
      progress(epoch,
               squares / static_cast<double>(batches * kBatch * kCells) * kOutput_mm * kOutput_mm);
    }
  }
  Columns matrix = Columns::Identity(kInputs, kInputs);
  Vector constant = Vector::Zero(kInputs);
  for (const Layer& layer : layers) layer.fold_into(matrix, constant);
  const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> by_rows = matrix;
  matrix_.assign(by_rows.data(), by_rows.data() + by_rows.size());
  constant_.assign(constant.data(), constant.data() + constant.size());
}

WindowNetwork WindowNetwork::read(const std::filesystem::path& file) {
  std::ifstream stream(file);
  const Json json = Json::parse_or_null(stream);
  const auto fail = [&] { return InputError(file.string() + ": is not a window network"); };
  if (!json.is_object() || json.value("format", "") != kFormat) throw fail();
  try {
    WindowNetwork network;
    network.matrix_ = json.at("matrix").get<std::vector<float>>();
    network.constant_ = json.at("constant").get<std::vector<float>>();
    if (network.matrix_.size() != kCells * kInputs || network.constant_.size() != kCells) {
      throw fail();
    }
    return network;
  } catch (const JsonError&) {
    throw fail();
  }
}

void WindowNetwork::write(const std::filesystem::path& file) const {
  const Json json = {{"format", kFormat}, {"matrix", matrix_}, {"constant", constant_}};
  write_file(file, json.dump() + "\n");
}

void WindowNetwork::apply(HeightField& ground, const Stride& stride,
                          std::vector<float>& last) const {
  std::vector<float> inputs(last);
  inputs.resize(kInputs);
  add_motion(stride, std::span(inputs).subspan(kCells));
  for (std::size_t cell = 0; cell < kCells; ++cell) {
    float sum = constant_[cell];
    for (std::size_t i = 0; i < kInputs; ++i) sum += matrix_[cell * kInputs + i] * inputs[i];
    last[cell] = sum;
  }
  for_nodes(ground, stride, [&](std::size_t cell, int x, int y, double /*share*/) {
    const double units = static_cast<double>(last[cell]) * kOutput_m / kHeightUnit_m;
    ground.set_node(x, y, ground.node(x, y) + static_cast<Height>(std::lround(units)));
  });
}

}  // namespace screed::nn
