#include "nn/slip/gated_network.h"

#include <algorithm>
#include <cmath>

#include "host_sim/core/random.h"

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

}  // namespace screed::nn
