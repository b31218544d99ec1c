// Back-propagation through fluxes: what a cell should have gained, the flux into it should have
// carried.
#include "nn/terrain/flux_trainer.h"

#include <Eigen/Dense>
#include <cmath>
#include <numeric>

#include "host_sim/core/elementary.h"
#include "host_sim/core/random.h"
#include "nn/training/parameter_update.h"

namespace screed::nn {
namespace {

using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Columns = Eigen::MatrixXf;  // a column an example

constexpr std::size_t kFluxBatch = 16;
constexpr double kFluxRate = 0.003;
constexpr double kFluxL2 = 1e-6;

Eigen::Index index(std::size_t value) {
  return static_cast<Eigen::Index>(value);
}

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
           std::uint64_t seed, const std::function<void(std::size_t, double)>& progress) {
  constexpr auto kInputs = static_cast<Eigen::Index>(FluxNetwork::kInputs);
  constexpr std::size_t kCells = FluxNetwork::kCells;
  const Eigen::Index hidden = index(network.hidden());
  WorldRandom random(seed, "order of examples");
  std::vector<std::size_t> order(examples.rows());
  std::iota(order.begin(), order.end(), std::size_t{0});
  UpdateState first_state;
  UpdateState second_state;
  // A column a cell of an example.
  Columns x(kInputs + 1, index(kFluxBatch * kCells));
  Columns nodes(hidden + 1, x.cols());
  Columns flux_error(2, x.cols());
  x.row(kInputs).setOnes();
  nodes.row(hidden).setOnes();
  std::vector<float> error(kFluxBatch * kCells);
  for (std::size_t epoch = 0; epoch < epochs; ++epoch) {
    for (std::size_t i = order.size(); i > 1; --i) {
      std::swap(order[i - 1], order[random.next() % i]);
    }
    const double rate =
        kFluxRate * portable::pow(0.1, static_cast<double>(epoch) / static_cast<double>(epochs));
    double squares = 0.0;
    std::size_t batches = 0;
    for (std::size_t at = 0; at + kFluxBatch <= order.size(); at += kFluxBatch, ++batches) {
      for (std::size_t b = 0; b < kFluxBatch; ++b) {
        const std::size_t row = order[at + b];
        const std::span<const float> observation(
            &examples.observations[row * FluxNetwork::kObservation], FluxNetwork::kObservation);
        for (std::size_t cell = 0; cell < kCells; ++cell) {
          FluxNetwork::inputs_of(observation, static_cast<int>(cell % FluxNetwork::kCellsX),
                                 static_cast<int>(cell / FluxNetwork::kCellsX),
                                 &x(0, index(b * kCells + cell)));
          error[b * kCells + cell] = -examples.changes[row * kCells + cell];
        }
      }
      const Eigen::Map<const Matrix> first(network.first().data(), hidden, kInputs + 1);
      const Eigen::Map<const Matrix> second(network.second().data(), 2, hidden + 1);
      nodes.topRows(hidden) = (first * x).array().tanh().matrix();
      const Columns fluxes = second * nodes;
      for (std::size_t b = 0; b < kFluxBatch; ++b) {
        const std::size_t base = b * kCells;
        for (std::size_t flux = 0; flux < FluxNetwork::kFluxes; ++flux) {
          const FluxCells sides = cells_of(flux);
          const float value = fluxes(index(sides.row), index(base + sides.from));
          error[base + sides.from] -= value;
          error[base + sides.to] += value;
        }
      }
      for (float& value : error) {
        squares += static_cast<double>(value) * static_cast<double>(value);
        value *= 2.0F / static_cast<float>(kFluxBatch);
      }
      flux_error.setZero();
      for (std::size_t b = 0; b < kFluxBatch; ++b) {
        const std::size_t base = b * kCells;
        for (std::size_t flux = 0; flux < FluxNetwork::kFluxes; ++flux) {
          const FluxCells sides = cells_of(flux);
          flux_error(index(sides.row), index(base + sides.from)) =
              error[base + sides.to] - error[base + sides.from];
        }
      }
      const Matrix second_gradient = flux_error * nodes.transpose();
      const Columns node_error = ((second.leftCols(hidden).transpose() * flux_error).array() *
                                  (1.0F - nodes.topRows(hidden).array().square()))
                                     .matrix();
      const Matrix first_gradient = node_error * x.transpose();
      const auto span_of = [](const Matrix& matrix) {
        return std::span<const float>(matrix.data(), static_cast<std::size_t>(matrix.size()));
      };
      update_parameters(OptimiserKind::kAdam, rate, kFluxL2, span_of(second_gradient),
                        network.second(), second_state);
      update_parameters(OptimiserKind::kAdam, rate, kFluxL2, span_of(first_gradient),
                        network.first(), first_state);
    }
    constexpr double kOutput_mm = FluxNetwork::kOutput_m * 1e3;
    const auto cells = static_cast<double>(batches * kFluxBatch * kCells);
    if (progress) progress(epoch, squares / cells * kOutput_mm * kOutput_mm);
  }
}

}  // namespace screed::nn
