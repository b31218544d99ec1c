// Stages by a table: the name, how it is read, what it learns, what it does.
#include "nn/data/preprocessing.h"

#include <algorithm>
#include <cfloat>
#include <cmath>

#include "host_sim/core/errors.h"

namespace screed::nn {
namespace {

constexpr double kMaxMeanWidth = 100'000.0;
constexpr double kOne = 4294967296.0;   // 2^32
constexpr double kMaxFixedPoint = 1e6;  // of a normalised value: sums of the widest mean stay exact
constexpr const char* kBeyond = "remove_beyond";
constexpr const char* kAbove = "remove_above";
constexpr const char* kFarOff = "remove_far";
constexpr const char* kNormalise = "normalise";
constexpr const char* kQuantise = "quantise";
constexpr const char* kExponential = "exponential";
constexpr const char* kMean = "mean";

constexpr PreprocessingStageKind kKinds[] = {
    {kBeyond, "feature, low, high", "drops frames whose feature lies below low or above high"},
    {kAbove, "feature, sigmas",
     "drops frames with feature - mean > sigmas x standard deviation (thesis 6.2.2)"},
    {kFarOff, "feature, sigmas",
     "drops frames with |feature - mean| >= sigmas x standard deviation (thesis 6.3.2)"},
    {kNormalise, "", "least value of each feature to -1, greatest to 1"},
    {kQuantise, "step", "rounds towards zero to steps of step, at most 1 - step (thesis 6.2.2)"},
    {kExponential, "alpha", "y_i = alpha x_i + (1 - alpha) y_(i-1)"},
    {kMean, "width", "mean over so many frames around each (thesis 6.3.2)"},
};

bool removes(const PreprocessingStage& stage) {
  return stage.stage == kBeyond || stage.stage == kAbove || stage.stage == kFarOff;
}

struct Moments {
  double mean = 0.0;
  double deviation = 0.0;  ///< of the population
};

Moments moments_of(const std::string& feature, const std::vector<FeatureTable>& tables) {
  double sum = 0.0;
  double count = 0.0;
  for (const FeatureTable& table : tables) {
    for (const double value : table.column(feature)) sum += value;
    count += static_cast<double>(table.rows());
  }
  const double mean = sum / count;
  double squares = 0.0;
  for (const FeatureTable& table : tables) {
    for (const double value : table.column(feature)) squares += (value - mean) * (value - mean);
  }
  return {mean, std::sqrt(squares / count)};
}

/// The ends between which values stay.
void learn_bounds(PreprocessingStage& stage, const std::vector<FeatureTable>& tables) {
  if (stage.stage == kBeyond) return;
  const Moments moments = moments_of(stage.feature, tables);
  const double reach = stage.value * moments.deviation;
  stage.low = -DBL_MAX;
  stage.high = moments.mean + reach;
  if (stage.stage == kAbove) return;
  // >= is out: the ends themselves do not stay.
  stage.low = std::nextafter(moments.mean - reach, DBL_MAX);
  stage.high = std::nextafter(stage.high, -DBL_MAX);
}

void remove_outside(FeatureTable& table, const PreprocessingStage& stage) {
  const std::vector<double>& column = table.column(stage.feature);
  std::vector<std::uint8_t> marks(column.size());
  std::transform(column.begin(), column.end(), marks.begin(), [&](double value) {
    return static_cast<std::uint8_t>(value >= stage.low && value <= stage.high);
  });
  table.keep(marks);
}

std::vector<FeatureScale> scales_of(const std::vector<FeatureTable>& tables) {
  std::vector<FeatureScale> scales;
  for (const std::string& name : tables.front().names) {
    double low = DBL_MAX;
    double high = -DBL_MAX;
    for (const FeatureTable& table : tables) {
      for (const double value : table.column(name)) {
        low = std::min(low, value);
        high = std::max(high, value);
      }
    }
    if (!(high > low)) {
      throw InputError("training data: " + name +
                       " is the same in every frame; allowed is a feature that changes");
    }
    // The printed formula subtracts half of the range; the middle is meant.
    scales.push_back({name, 0.5 * (low + high), 0.5 * (high - low)});
  }
  return scales;
}

void normalise(FeatureTable& table, const std::vector<FeatureScale>& scales) {
  for (const FeatureScale& scale : scales) {
    for (double& value : table.column(scale.feature)) {
      value = (value - scale.middle) / scale.half_range;
    }
  }
}

/// Stages that need nothing learned.
void transform(FeatureTable& table, const PreprocessingStage& stage) {
  for (std::vector<double>& column : table.columns) {
    if (stage.stage == kQuantise) {
      for (double& value : column) value = quantised(value, stage.value);
    } else if (stage.stage == kExponential) {
      smooth_exponentially(column, stage.value);
    } else {
      smooth_by_mean(column, static_cast<std::size_t>(stage.value));
    }
  }
}

}  // namespace

double quantised(double value, double step) {
  // One part in 10^9 of slack: 0.6 / 0.2 is a little less than 3.
  const double steps = std::trunc(value / step * (1.0 + 1e-9));
  const double most = std::round(1.0 / step) - 1.0;
  return std::clamp(steps, -most, most) * step;
}

void smooth_exponentially(std::vector<double>& series, double alpha) {
  for (std::size_t i = 1; i < series.size(); ++i) {
    series[i] = alpha * series[i] + (1.0 - alpha) * series[i - 1];
  }
}

void smooth_by_mean(std::vector<double>& series, std::size_t width) {
  const std::size_t behind = (width - 1) / 2;
  const std::size_t before = width / 2;
  std::vector<double> sums(series.size() + 1, 0.0);
  for (std::size_t i = 0; i < series.size(); ++i) sums[i + 1] = sums[i] + series[i];
  for (std::size_t i = 0; i < series.size(); ++i) {
    const std::size_t first = i > before ? i - before : 0;
    const std::size_t end = std::min(series.size(), i + behind + 1);
    series[i] = (sums[end] - sums[first]) / static_cast<double>(end - first);
  }
}

std::span<const PreprocessingStageKind> preprocessing_stage_kinds() {
  return kKinds;
}

std::vector<PreprocessingStage> read_preprocessing_stages(const JsonValue& list) {
  std::vector<PreprocessingStage> stages;
  for (const JsonValue& value : list.list()) {
    PreprocessingStage stage;
    stage.stage = value.at("stage").one_of(
        {kBeyond, kAbove, kFarOff, kNormalise, kQuantise, kExponential, kMean});
    if (removes(stage)) stage.feature = value.at("feature").text();
    if (stage.stage == kBeyond) {
      value.only({"stage", "feature", "low", "high"});
      stage.low = value.at("low").number(-DBL_MAX, DBL_MAX);
      stage.high = value.at("high").number(stage.low, DBL_MAX);
    } else if (stage.stage == kAbove || stage.stage == kFarOff) {
      value.only({"stage", "feature", "sigmas"});
      stage.value = value.at("sigmas").number(0.0, DBL_MAX);
    } else if (stage.stage == kQuantise) {
      value.only({"stage", "step"});
      stage.value = value.at("step").number(1e-6, 0.5);
    } else if (stage.stage == kExponential) {
      value.only({"stage", "alpha"});
      stage.value = value.at("alpha").number(0.0, 1.0);
    } else if (stage.stage == kMean) {
      value.only({"stage", "width"});
      stage.value = static_cast<double>(
          value.at("width").integer(1, static_cast<std::int64_t>(kMaxMeanWidth)));
    } else {
      value.only({"stage"});
      if (std::any_of(stages.begin(), stages.end(), [](const PreprocessingStage& earlier) {
            return earlier.stage == kNormalise;
          })) {
        value.refuse("a second normalisation; allowed is one");
      }
    }
    stages.push_back(stage);
  }
  return stages;
}

void Preprocessing::learn(std::vector<FeatureTable>& training, const TaskProgress& progress) {
  scales_.clear();
  std::size_t done = 0;
  for (PreprocessingStage& stage : stages_) {
    if (removes(stage)) learn_bounds(stage, training);
    if (stage.stage == kNormalise) scales_ = scales_of(training);
    for (FeatureTable& table : training) {
      report_progress(progress, "pre-processing", done++, stages_.size() * training.size());
      if (removes(stage)) {
        remove_outside(table, stage);
      } else if (stage.stage == kNormalise) {
        normalise(table, scales_);
      } else {
        transform(table, stage);
      }
      if (table.rows() == 0) {
        throw InputError(table.source + ": no frame is left after stage " + stage.stage +
                         (stage.feature.empty() ? "" : " of " + stage.feature));
      }
    }
  }
}

void Preprocessing::apply(FeatureTable& table, Extent extent) const {
  for (const PreprocessingStage& stage : stages_) {
    if (removes(stage)) {
      remove_outside(table, stage);
    } else if (stage.stage == kNormalise) {
      normalise(table, scales_);
    } else if (extent == Extent::kAll ||
               (extent == Extent::kNotRounded && stage.stage != kQuantise)) {
      transform(table, stage);
    }
  }
}

const FeatureScale& Preprocessing::scale_of(const std::string& feature) const {
  for (const FeatureScale& scale : scales_) {
    if (scale.feature == feature) return scale;
  }
  throw InputError("pre-processing: no scale of '" + feature + "'; a stage normalise gives it one");
}

InputPreprocessing::InputPreprocessing(std::span<const PreprocessingStage> stages,
                                       std::size_t robots) {
  for (const PreprocessingStage& from : stages) {
    if (!from.run_time || from.stage == kNormalise) continue;
    StageState stage{};
    if (from.stage == kQuantise) {
      stage.kind = Kind::kQuantise;
      stage.step = from.value;
    } else if (from.stage == kExponential) {
      stage.kind = Kind::kExponential;
      stage.alpha = from.value;
      stage.smooth.resize(robots);
    } else if (from.stage == kMean) {
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
