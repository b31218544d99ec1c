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
#include "nn/data/features.h"
#include "nn/model/model_file.h"

namespace screed::nn {

/// Scale of a feature: normalised = (value - middle) / half_range.
struct FeatureScale {
  std::string feature;
  double middle = 0.0;
  double half_range = 1.0;
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

/// Learns from training tables and applies to any.
class Preprocessing {
 public:
  /// With the scales, and the ends of the outlier stages, where they were learned before.
  explicit Preprocessing(std::vector<PreprocessingStage> stages,
                         std::vector<FeatureScale> scales = {})
      : stages_(std::move(stages)), scales_(std::move(scales)) {}

  /// Goes through the stages over the training tables, learning on the way, and leaves the tables
  /// processed. Throws InputError when nothing is left or a feature never changes.
  void learn(std::vector<FeatureTable>& training, const TaskProgress& progress = {});

  /// Which of the stages apply: all; all but rounding; without smoothing either, the raw data of an
  /// evaluation.
  enum class Extent : std::uint8_t { kAll, kNotRounded, kRaw };
  /// Needs learn() or learned values.
  void apply(FeatureTable& table, Extent extent = Extent::kAll) const;

  /// Those that drop frames have the learned ends.
  const std::vector<PreprocessingStage>& stages() const { return stages_; }
  /// Of the normalisation; empty when there is none.
  const std::vector<FeatureScale>& scales() const { return scales_; }
  const FeatureScale& scale_of(const std::string& feature) const;

 private:
  std::vector<PreprocessingStage> stages_;
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

/// What a running world does to one input of a network before the network sees it: the stages of
/// the model's pre-processing that are marked run_time, in their order, on normalised values of any
/// number of robots. Smoothing looks back alone: the frames ahead, which a centred mean of recorded
/// data has, are not there yet.
class InputPreprocessing {
 public:
  /// Takes those marked run_time; normalise among them changes nothing more. Throws InputError for
  /// a stage that says nothing of a single frame.
  InputPreprocessing(std::span<const PreprocessingStage> stages, std::size_t robots);

  bool empty() const { return stages_.empty(); }
  /// A robot begins anew: what its input was before does not count.
  void reset(std::size_t robot);
  /// A frame's values, one a robot.
  void apply(std::span<double> values);

 private:
  enum class Kind : std::uint8_t { kQuantise, kExponential, kMean };
  struct StageState {
    Kind kind;
    double step = 0.0;   ///< of kQuantise
    double alpha = 0.0;  ///< of kExponential
    /// Of kMean: the last `width` values of all robots, a row a frame, in steps of 2^-32, so that
    /// their sums are exact however long the world runs.
    std::size_t width = 0;
    std::size_t next_row = 0;
    std::vector<std::int64_t> last;
    std::vector<std::int64_t> sums;
    std::vector<double> smooth;       ///< of kExponential, a value a robot
    std::vector<std::size_t> frames;  ///< that count, a number a robot
  };
  static void smooth_exponentially(StageState& stage, std::span<double> values);
  static void take_mean(StageState& stage, std::span<double> values);

  std::vector<StageState> stages_;
};

}  // namespace screed::nn
