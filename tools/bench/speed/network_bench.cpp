// `make bench`: one inference of the thesis' networks, 4-20-1 and 13 hidden layers of 7, by our
// integers and by the libraries that one would take otherwise. Every figure is the time of one
// network for one robot; weights are random, which no engine minds.
#include <benchmark/benchmark.h>
#include <fixedfann.h>

#include <Eigen/Core>
#include <algorithm>
#include <string>
#include <vector>

#include "host_sim/core/random.h"
#include "nn/batch/batch_network.h"
#include "nn/model/quantiser.h"
#include "nn/training/tiny_dnn.h"
#include "tools/bench/require.h"

namespace screed::nn {
namespace {

constexpr std::size_t kRobots = 1024;  ///< of a batch
constexpr std::size_t kInputs = 4;

std::vector<std::size_t> widths(bool deep) {
  std::vector<std::size_t> all = {kInputs};
  if (deep) {
    all.insert(all.end(), 13, 7);
  } else {
    all.push_back(20);
  }
  all.push_back(1);
  return all;
}

std::vector<FloatLayer> layers(bool deep) {
  WorldRandom random(1, "bench");
  const std::vector<std::size_t> all = widths(deep);
  std::vector<FloatLayer> result;
  for (std::size_t i = 1; i < all.size(); ++i) {
    FloatLayer layer{all[i - 1], all[i], false, {}, {}};
    for (std::size_t n = 0; n < layer.inputs * layer.outputs; ++n) {
      layer.weights.push_back(random.uniform(-0.6, 0.6));
    }
    for (std::size_t n = 0; n < layer.outputs; ++n) layer.bias.push_back(random.uniform(-0.1, 0.1));
    result.push_back(layer);
  }
  return result;
}

void per_robot(benchmark::State& state, std::size_t robots) {
  state.counters["per_network"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * static_cast<double>(robots),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void ours_scalar(benchmark::State& state, bool deep) {
  const IntegerNetwork network = quantise(layers(deep));
  std::vector<std::int16_t> in = {1000, -2000, 3000, -4000};
  std::vector<std::int16_t> out(1);
  while (state.KeepRunning()) {
    network.run(in, out);
    in[0] = static_cast<std::int16_t>(in[0] ^ out[0]);
  }
  per_robot(state, 1);
}

bool has_kernel(benchmark::State& state, InstructionSet kernel) {
  const std::vector<InstructionSet>& kernels = instruction_sets();
  const bool has = std::find(kernels.begin(), kernels.end(), kernel) != kernels.end();
  if (!has) state.SkipWithError("this processor does not have it");
  return has;
}

/// One robot, whose next input waits for its last output.
void ours_alone(benchmark::State& state, bool deep, InstructionSet kernel) {
  if (!has_kernel(state, kernel)) return;
  const IntegerNetwork scalar = quantise(layers(deep));
  const BatchNetwork network(scalar, kernel);
  std::vector<std::int16_t> in = {1000, -2000, 3000, -4000};
  std::vector<std::int16_t> out(1);
  while (state.KeepRunning()) {
    network.run(in.data(), out.data(), 1, 1);
    in[0] = static_cast<std::int16_t>(in[0] ^ out[0]);
  }
  in[0] = static_cast<std::int16_t>(in[0] ^ out[0]);  // as it was the last time
  std::vector<std::int16_t> expected(1);
  scalar.run(in, expected);
  require(state, out[0] == expected[0], "a robot alone gets other bits");
  per_robot(state, 1);
}

void ours_batched(benchmark::State& state, bool deep, InstructionSet kernel) {
  if (!has_kernel(state, kernel)) return;
  const IntegerNetwork scalar = quantise(layers(deep));
  const BatchNetwork network(scalar, kernel);
  WorldRandom random(2, "bench");
  std::vector<std::int16_t> in(kInputs * kRobots);
  std::vector<std::int16_t> out(kRobots);
  for (std::int16_t& value : in) value = static_cast<std::int16_t>(random.next() >> 16U);
  while (state.KeepRunning()) {
    network.run(in.data(), out.data(), kRobots, kRobots);
    benchmark::ClobberMemory();
  }
  std::vector<std::int16_t> one_in(kInputs);
  std::vector<std::int16_t> one_out(1);
  for (const std::size_t robot : {std::size_t{0}, kRobots - 1}) {
    for (std::size_t i = 0; i < kInputs; ++i) one_in[i] = in[i * kRobots + robot];
    scalar.run(one_in, one_out);
    require(state, out[robot] == one_out[0], "a batch gives other bits than one robot");
  }
  per_robot(state, kRobots);
}

void tiny_dnn_float(benchmark::State& state, bool deep) {
  using Layer = tiny_dnn::fully_connected_layer<tiny_dnn::activation::tan_h>;
  tiny_dnn::network<tiny_dnn::sequential> network;
  const std::vector<std::size_t> all = widths(deep);
  for (std::size_t i = 1; i < all.size(); ++i) {
    network << Layer(static_cast<tiny_dnn::serial_size_t>(all[i - 1]),
                     static_cast<tiny_dnn::serial_size_t>(all[i]));
  }
  network.init_weight();
  tiny_dnn::vec_t in = {0.1F, -0.2F, 0.3F, -0.4F};
  while (state.KeepRunning()) {
    const tiny_dnn::vec_t out = network.predict(in);
    in[0] = 0.1F + 0.1F * out[0];
  }
  per_robot(state, 1);
}

void fann_fixed(benchmark::State& state, bool deep) {
  const std::vector<std::size_t> all = widths(deep);
  const std::vector<unsigned> sizes(all.begin(), all.end());
  fann* const network =
      fann_create_standard_array(static_cast<unsigned>(sizes.size()), sizes.data());
  if (!require(state, network != nullptr, "FANN makes no network")) return;
  fann_set_activation_function_hidden(network, FANN_SIGMOID_SYMMETRIC_STEPWISE);
  fann_set_activation_function_output(network, FANN_SIGMOID_SYMMETRIC_STEPWISE);
  const auto one = static_cast<fann_type>(fann_get_multiplier(network));
  fann_randomize_weights(network, -one, one);
  fann_type in[kInputs] = {one / 10, -one / 5, one / 3, -one / 2};
  while (state.KeepRunning()) {
    const fann_type* out = fann_run(network, in);
    in[0] = out[0] / 2;
  }
  fann_destroy(network);
  per_robot(state, 1);
}

/// Dimensions known to the compiler, the fastest that Eigen has for one vector.
template <int kOutputs, int kIn>
struct FixedLayer {
  Eigen::Matrix<float, kOutputs, kIn> weights = Eigen::Matrix<float, kOutputs, kIn>::Random();
  Eigen::Matrix<float, kOutputs, 1> bias = Eigen::Matrix<float, kOutputs, 1>::Random();
  Eigen::Matrix<float, kOutputs, 1> operator()(const Eigen::Matrix<float, kIn, 1>& in) const {
    return (weights * in + bias).array().tanh().matrix();
  }
};

void eigen_float(benchmark::State& state, bool deep) {
  const FixedLayer<20, 4> wide;
  const FixedLayer<1, 20> wide_end;
  const FixedLayer<7, 4> first;
  const std::vector<FixedLayer<7, 7>> middle(12);
  const FixedLayer<1, 7> last;
  Eigen::Vector4f in(0.1F, -0.2F, 0.3F, -0.4F);
  while (state.KeepRunning()) {
    if (deep) {
      Eigen::Matrix<float, 7, 1> values = first(in);
      for (const auto& layer : middle) values = layer(values);
      in[0] = last(values)[0];
    } else {
      in[0] = wide_end(wide(in))[0];
    }
  }
  benchmark::DoNotOptimize(in);
  per_robot(state, 1);
}

void eigen_float_batched(benchmark::State& state, bool deep) {
  std::vector<Eigen::MatrixXf> weights;
  std::vector<Eigen::VectorXf> bias;
  for (const FloatLayer& layer : layers(deep)) {
    weights.push_back(Eigen::MatrixXf::Random(static_cast<Eigen::Index>(layer.outputs),
                                              static_cast<Eigen::Index>(layer.inputs)));
    bias.push_back(Eigen::VectorXf::Random(static_cast<Eigen::Index>(layer.outputs)));
  }
  const Eigen::MatrixXf in = Eigen::MatrixXf::Random(kInputs, kRobots);
  while (state.KeepRunning()) {
    Eigen::MatrixXf values = in;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      values = ((weights[i] * values).colwise() + bias[i]).array().tanh().matrix();
    }
    benchmark::DoNotOptimize(values.data());
  }
  per_robot(state, kRobots);
}

BENCHMARK_CAPTURE(ours_scalar, v1_4_20_1, false);
BENCHMARK_CAPTURE(ours_alone, v1_4_20_1_avx2, false, InstructionSet::kAvx2);
BENCHMARK_CAPTURE(ours_alone, v1_4_20_1_avx512, false, InstructionSet::kAvx512);
BENCHMARK_CAPTURE(ours_batched, v1_4_20_1_avx2, false, InstructionSet::kAvx2);
BENCHMARK_CAPTURE(ours_batched, v1_4_20_1_avx512, false, InstructionSet::kAvx512);
BENCHMARK_CAPTURE(tiny_dnn_float, v1_4_20_1, false);
BENCHMARK_CAPTURE(fann_fixed, v1_4_20_1, false);
BENCHMARK_CAPTURE(eigen_float, v1_4_20_1, false);
BENCHMARK_CAPTURE(eigen_float_batched, v1_4_20_1, false);
BENCHMARK_CAPTURE(ours_scalar, v2_13x7, true);
BENCHMARK_CAPTURE(ours_alone, v2_13x7_avx2, true, InstructionSet::kAvx2);
BENCHMARK_CAPTURE(ours_alone, v2_13x7_avx512, true, InstructionSet::kAvx512);
BENCHMARK_CAPTURE(ours_batched, v2_13x7_avx2, true, InstructionSet::kAvx2);
BENCHMARK_CAPTURE(ours_batched, v2_13x7_avx512, true, InstructionSet::kAvx512);
BENCHMARK_CAPTURE(tiny_dnn_float, v2_13x7, true);
BENCHMARK_CAPTURE(fann_fixed, v2_13x7, true);
BENCHMARK_CAPTURE(eigen_float, v2_13x7, true);
BENCHMARK_CAPTURE(eigen_float_batched, v2_13x7, true);

}  // namespace
}  // namespace screed::nn
