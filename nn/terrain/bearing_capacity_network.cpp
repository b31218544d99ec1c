#include "nn/terrain/bearing_capacity_network.h"

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"

namespace screed::nn {
namespace {

constexpr std::size_t kMaxHidden = 256;

std::size_t weights_of(std::size_t hidden) {
  return hidden * (BearingCapacityNetwork::kInputs + 1) +
         BearingCapacityNetwork::kOutputs * (hidden + 1);
}

}  // namespace

BearingCapacityNetwork::BearingCapacityNetwork(std::size_t hidden, std::uint64_t seed)
    : hidden_(hidden), weights_(weights_of(hidden)) {
  WorldRandom random(seed, "bearing network");
  const double range = std::sqrt(3.0 / static_cast<double>(kInputs));
  for (std::size_t i = 0; i < hidden * (kInputs + 1); ++i) {
    weights_[i] = static_cast<float>(random.uniform(-range, range));
  }
}

BearingCapacity BearingCapacityNetwork::evaluate(std::span<const float> inputs) const {
  std::array<double, kOutputs> sums{};
  const float* outputs = &weights_[hidden_ * (kInputs + 1)];
  for (std::size_t i = 0; i < kOutputs; ++i) {
    sums.at(i) = static_cast<double>(outputs[i * (hidden_ + 1) + hidden_]);
  }
  for (std::size_t node = 0; node < hidden_; ++node) {
    const float* row = &weights_[node * (kInputs + 1)];
    double sum = static_cast<double>(row[kInputs]);
    for (std::size_t i = 0; i < kInputs; ++i) {
      sum += static_cast<double>(row[i]) * static_cast<double>(inputs[i]);
    }
    const double active = std::tanh(sum);
    for (std::size_t i = 0; i < kOutputs; ++i) {
      sums.at(i) += static_cast<double>(outputs[i * (hidden_ + 1) + node]) * active;
    }
  }
  for (double& sum : sums) sum = std::tanh(sum);
  BearingCapacity bearing;
  bearing.equilibrium_stiffness *= std::exp(1.6 * sums[0]);
  bearing.compaction_stiffness *= std::exp(2.5 * sums[1]);
  bearing.load *= std::exp(0.5 * sums[2]);
  bearing.rear_reduction += 0.8 * sums[3];
  bearing.uplift *= std::exp(2.0 * sums[4]);
  bearing.mass_offset_m += 0.03 * sums[5];
  bearing.relaxation = std::min(1.0, bearing.relaxation + 0.5 * sums[6]);
  return bearing;
}

BearingCapacityNetwork BearingCapacityNetwork::read(const std::filesystem::path& file) {
  std::ifstream stream(file);
  const auto json = nlohmann::json::parse(stream, nullptr, false);
  const auto fail = [&] {
    return InputError(file.string() + ": is not a bearing-capacity network");
  };
  if (json.is_discarded() || !json.is_object() || json.value("format", "") != "screed-bearing-1") {
    throw fail();
  }
  try {
    const auto hidden = json.at("hidden").get<std::size_t>();
    const auto weights = json.at("weights").get<std::vector<float>>();
    if (hidden == 0 || hidden > kMaxHidden || weights.size() != weights_of(hidden)) throw fail();
    BearingCapacityNetwork network(hidden, 0);
    network.weights_ = weights;
    return network;
  } catch (const nlohmann::json::exception&) {
    throw fail();
  }
}

void BearingCapacityNetwork::write(const std::filesystem::path& file) const {
  const nlohmann::ordered_json json = {
      {"format", "screed-bearing-1"}, {"hidden", hidden_}, {"weights", weights_}};
  write_file(file, json.dump() + "\n");
}

}  // namespace screed::nn
