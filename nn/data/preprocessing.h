// Pre-processing of feature tables: named stages in an order of choice, each with the numbers it
// needs (thesis 6.2.2 and 6.3.2). What a stage has to know of the data, means, deviations and ends
// of ranges, it learns from the training sessions and applies to all others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host_sim/core/json_reader.h"
#include "host_sim/core/task_progress.h"
#include "nn/data/feature_table.h"

namespace screed::nn {

/// Scale of a feature: normalised = (value - middle) / half_range.
struct FeatureScale {
  std::string feature;
  double middle = 0.0;
  double half_range = 1.0;
};

/// A stage as configured.
struct PreprocessingStage {
  std::string stage;
  std::string feature;  ///< of an outlier stage
  double low = 0.0;     ///< outside: removed
  double high = 0.0;
  double value = 0.0;  ///< sigmas, alpha, width or step
};

/// What is known of a stage before its numbers.
struct PreprocessingStageKind {
  const char* name;
  const char* parameters;  ///< in words
  const char* meaning;
};

/// Every stage there is.
std::span<const PreprocessingStageKind> preprocessing_stage_kinds();

/// A list of objects {"stage": NAME, ...}. Throws InputError with the place.
std::vector<PreprocessingStage> read_preprocessing_stages(const JsonValue& list);

/// What an outlier stage learned: the ends between which values stay.
struct Bounds {
  std::string feature;
  double low;
  double high;
};

/// Learns from training tables and applies to any.
class Preprocessing {
 public:
  explicit Preprocessing(std::vector<PreprocessingStage> stages);
  /// With what was learned before.
  Preprocessing(std::vector<PreprocessingStage> stages, std::vector<Bounds> bounds,
                std::vector<FeatureScale> scales);

  /// Goes through the stages over the training tables, learning on the way, and leaves the tables
  /// processed. Throws InputError when nothing is left or a feature never changes.
  void learn(std::vector<FeatureTable>& training, const TaskProgress& progress = {});

  /// Which of the stages apply: all; all but rounding; without smoothing either, the raw data of an
  /// evaluation.
  enum class Extent : std::uint8_t { kAll, kNotRounded, kRaw };
  /// Needs learn() or learned values.
  void apply(FeatureTable& table, Extent extent = Extent::kAll) const;

  const std::vector<PreprocessingStage>& stages() const { return stages_; }
  /// Of the normalisation; empty when there is none.
  const std::vector<FeatureScale>& scales() const { return scales_; }
  const FeatureScale& scale_of(const std::string& feature) const;
  const std::vector<Bounds>& bounds() const { return bounds_; }

 private:
  void learn_stage(const PreprocessingStage& stage, const std::vector<FeatureTable>& training);

  std::vector<PreprocessingStage> stages_;
  std::vector<Bounds> bounds_;  ///< one an outlier stage, in order
  std::vector<FeatureScale> scales_;
};

// The stages' arithmetic on one series.

/// Rounds towards zero to steps of `step`, between -(1 - step) and 1 - step (the printed table, for
/// a step of 0.2).
double quantised(double value, double step);
/// y_i = alpha x_i + (1 - alpha) y_(i-1), y_0 = x_0.
void smooth_exponentially(std::vector<double>& series, double alpha);
/// Mean over `width` values around each; at the ends over those that there are. Of an even width,
/// one more lies before than behind.
void smooth_by_mean(std::vector<double>& series, std::size_t width);

}  // namespace screed::nn
