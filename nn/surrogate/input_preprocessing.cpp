#include "nn/surrogate/input_preprocessing.h"

#include <algorithm>
#include <cmath>

#include "host_sim/core/errors.h"
#include "nn/data/preprocessing.h"

namespace screed::nn {
namespace {

constexpr double kOne = 4294967296.0;   // 2^32
constexpr double kMaxFixedPoint = 1e6;  // of a normalised value: sums of the widest mean stay exact

}  // namespace

InputPreprocessing::InputPreprocessing(std::span<const ModelPreprocessingStage> stages,
                                       std::size_t robots) {
  for (const ModelPreprocessingStage& from : stages) {
    if (!from.run_time || from.stage == "normalise") continue;
    StageState stage{};
    if (from.stage == "quantise") {
      stage.kind = Kind::kQuantise;
      stage.step = from.value;
    } else if (from.stage == "exponential") {
      stage.kind = Kind::kExponential;
      stage.alpha = from.value;
      stage.smooth.resize(robots);
    } else if (from.stage == "mean") {
      stage.kind = Kind::kMean;
      stage.width = std::max<std::size_t>(1, static_cast<std::size_t>(from.value));
      stage.last.resize(stage.width * robots);
      stage.sums.resize(robots);
    } else {
      throw InputError("stage '" + from.stage +
                       "' cannot be one of run time; allowed is normalise, quantise, exponential, "
                       "mean");
    }
    stage.frames.resize(robots);
    stages_.push_back(std::move(stage));
  }
}

void InputPreprocessing::reset(std::size_t robot) {
  for (StageState& stage : stages_) {
    stage.frames[robot] = 0;
    if (stage.kind == Kind::kMean) stage.sums[robot] = 0;
  }
}

void InputPreprocessing::apply(std::span<double> values) {
  for (StageState& stage : stages_) {
    switch (stage.kind) {
      case Kind::kQuantise:
        for (double& value : values) value = quantised(value, stage.step);
        break;
      case Kind::kExponential:
        smooth_exponentially(stage, values);
        break;
      case Kind::kMean:
        take_mean(stage, values);
        break;
    }
  }
}

void InputPreprocessing::smooth_exponentially(StageState& stage, std::span<double> values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (stage.frames[i]++ > 0) {
      values[i] = stage.alpha * values[i] + (1.0 - stage.alpha) * stage.smooth[i];
    }
    stage.smooth[i] = values[i];
  }
}

void InputPreprocessing::take_mean(StageState& stage, std::span<double> values) {
  std::int64_t* row = &stage.last[stage.next_row * values.size()];
  stage.next_row = (stage.next_row + 1) % stage.width;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (stage.frames[i] == stage.width) {
      stage.sums[i] -= row[i];
    } else {
      ++stage.frames[i];
    }
    row[i] = std::llround(std::clamp(values[i], -kMaxFixedPoint, kMaxFixedPoint) * kOne);
    stage.sums[i] += row[i];
    values[i] = static_cast<double>(stage.sums[i]) / (kOne * static_cast<double>(stage.frames[i]));
  }
}

}  // namespace screed::nn
