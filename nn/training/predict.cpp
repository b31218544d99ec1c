// Whole blocks by Eigen, which multiplies matrices much faster than a row at a time.
#include "nn/training/predict.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "nn/batch/batch_network.h"

namespace screed::nn {
namespace {

using Matrix = Eigen::MatrixXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr std::size_t kBlock = 1024;

double mean_of(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double correlation(std::span<const double> a, std::span<const double> b) {
  const double mean_a = mean_of(a);
  const double mean_b = mean_of(b);
  double ab = 0.0;
  double aa = 0.0;
  double bb = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += (a[i] - mean_a) * (b[i] - mean_b);
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
  }
  return aa > 0.0 && bb > 0.0 ? ab / std::sqrt(aa * bb) : 0.0;
}

std::vector<double> ranks(std::span<const double> values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::vector<double> result(values.size());
  for (std::size_t first = 0; first < order.size();) {
    std::size_t end = first + 1;
    while (end < order.size() && values[order[end]] == values[order[first]]) ++end;
    const double rank = 0.5 * static_cast<double>(first + end - 1);
    for (std::size_t i = first; i < end; ++i) result[order[i]] = rank;
    first = end;
  }
  return result;
}

}  // namespace

std::vector<double> predict(const std::vector<FloatLayer>& network, const Examples& examples) {
  std::vector<double> result(examples.rows() * network.back().outputs);
  for (std::size_t first = 0; first < examples.rows(); first += kBlock) {
    const std::size_t rows = std::min(kBlock, examples.rows() - first);
    Matrix values(examples.inputs, rows);
    for (std::size_t row = 0; row < rows; ++row) {
      for (std::size_t i = 0; i < examples.inputs; ++i) {
        values(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(row)) = std::clamp(
            static_cast<double>(examples.in[(first + row) * examples.inputs + i]), -1.0, 1.0);
      }
    }
    for (const FloatLayer& layer : network) {
      const Eigen::Map<const RowMajor> weights(layer.weights.data(),
                                               static_cast<Eigen::Index>(layer.outputs),
                                               static_cast<Eigen::Index>(layer.inputs));
      const Eigen::Map<const Eigen::VectorXd> bias(layer.bias.data(),
                                                   static_cast<Eigen::Index>(layer.outputs));
      Matrix sums = weights * values;
      sums.colwise() += bias;
      if (!layer.linear) sums = sums.unaryExpr([](double sum) { return std::tanh(sum); });
      values = std::move(sums);
    }
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      result[first * network.back().outputs + static_cast<std::size_t>(i)] =
          std::clamp(values.data()[i], -1.0, 1.0);
    }
  }
  return result;
}

std::vector<double> predict(const IntegerNetwork& network, const Examples& examples) {
  const BatchNetwork batch(network);
  const std::size_t rows = examples.rows();
  std::vector<std::int16_t> in(rows * network.inputs());
  std::vector<std::int16_t> out(rows * network.outputs());
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t i = 0; i < network.inputs(); ++i) {
      in[i * rows + row] =
          to_activation(static_cast<double>(examples.in[row * network.inputs() + i]));
    }
  }
  batch.run(in.data(), out.data(), rows, rows);
  std::vector<double> result(out.size());
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t i = 0; i < network.outputs(); ++i) {
      result[row * network.outputs() + i] = to_value(out[i * rows + row]);
    }
  }
  return result;
}

double mean_squared_error(std::span<const double> a, std::span<const double> b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum / static_cast<double>(a.size());
}

double squared_correlation(std::span<const double> a, std::span<const double> b) {
  const double r = correlation(a, b);
  return r * r;
}

double explained_variance(std::span<const double> real, std::span<const double> predicted) {
  const double mean = mean_of(real);
  double squares = 0.0;
  for (const double value : real) squares += (value - mean) * (value - mean);
  if (squares == 0.0) return 0.0;
  return 1.0 - mean_squared_error(real, predicted) * static_cast<double>(real.size()) / squares;
}

double spearman(std::span<const double> a, std::span<const double> b) {
  return correlation(ranks(a), ranks(b));
}

}  // namespace screed::nn
