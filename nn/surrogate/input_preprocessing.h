// What a running world does to one input of a network before the network sees it: the stages of the
// model's pre-processing that are marked run_time, in their order, on normalised values of any
// number of robots. Smoothing looks back alone: the frames ahead, which a centred mean of recorded
// data has, are not there yet.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "nn/model/model_file.h"

namespace screed::nn {

class InputPreprocessing {
 public:
  /// Takes those marked run_time; normalise among them changes nothing more. Throws InputError for
  /// a stage that says nothing of a single frame.
  InputPreprocessing(std::span<const ModelPreprocessingStage> stages, std::size_t robots);

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
