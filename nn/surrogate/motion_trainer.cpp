// Backpropagation through time over tiny-dnn's layers. Their forward and backward passes are called
// directly, since a sequence needs the activations of all its frames at once.
#include "nn/surrogate/motion_trainer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"
#include "nn/data/motion_signals.h"
#include "nn/surrogate/surrogate.h"
#include "nn/training/parameter_update.h"
#include "nn/training/tiny_dnn.h"

namespace screed::nn {
namespace {

using tiny_dnn::serial_size_t;
using tiny_dnn::tensor_t;
using tiny_dnn::vec_t;
using Hidden = tiny_dnn::fully_connected_layer<tiny_dnn::activation::tan_h>;
using Last = tiny_dnn::fully_connected_layer<tiny_dnn::activation::identity>;

constexpr std::size_t kMotions = 3;  // forward, sideways, turn
// What an error is measured in, and where it stops counting by its square.
constexpr std::array<double, kMotions> kErrorUnit = {0.002, 0.001, 0.02};
constexpr double kFrameKnee = 0.1;
constexpr double kMaxGradientNorm = 0.5;
constexpr double kRisingShare = 0.1;
constexpr double kLastRate = 0.001;
constexpr double kFirstOutput = 0.1;  // first weights of the last layer, share of the usual

struct Huber {
  double loss;
  double slope;
};

Huber huber(double error, double knee) {
  const double size = std::abs(error);
  if (size < knee) return {0.5 * error * error / knee, error / knee};
  return {size - 0.5 * knee, error > 0.0 ? 1.0 : -1.0};
}

/// Where a signal comes from: the recording, or the network's own answers so many frames ago.
struct Source {
  MotionSignal signal;
  double middle;
  double half_range;
  std::size_t own = kMotions;  ///< index of the motion, kMotions: from the recording
  std::size_t ago = 0;
};

Source source_of(const ModelChannel& channel) {
  const std::optional<MotionSignal> signal = motion_signal_named(channel.feature);
  if (!signal.has_value()) {
    throw InputError("training: input '" + channel.feature + "' is not known to nn/surrogate");
  }
  Source source{*signal, channel.middle, channel.half_range, kMotions, 0};
  const std::size_t row = row_of(*signal);
  const auto among = [&](MotionSignal first, MotionSignal last) {
    return row >= row_of(first) && row <= row_of(last);
  };
  if (among(MotionSignal::kForwardSettling, MotionSignal::kTurnSettling) ||
      among(MotionSignal::kSpeed, MotionSignal::kPivot)) {
    throw InputError("training: input '" + channel.feature +
                     "' is not one that a network of motion learns from");
  }
  if (row <= row_of(MotionSignal::kTurn2)) {
    source.own = row % kMotions;
    source.ago = 1 + row / kMotions;
  }
  return source;
}

double recorded(MotionSignal signal, const std::vector<MotionFrame>& frames, std::size_t frame,
                const std::array<double, kSoilSignals>& soil) {
  const MotionFrame& now = frames[frame];
  const MotionFrame& before = frames[frame - 1];
  switch (signal) {
    case MotionSignal::kTrackLeft:
      return now.track_left_m_per_s;
    case MotionSignal::kTrackRight:
      return now.track_right_m_per_s;
    case MotionSignal::kTrackLeft1:
      return before.track_left_m_per_s;
    case MotionSignal::kTrackRight1:
      return before.track_right_m_per_s;
    case MotionSignal::kTrackLeft2:
      return frames[frame - 2].track_left_m_per_s;
    case MotionSignal::kTrackRight2:
      return frames[frame - 2].track_right_m_per_s;
    case MotionSignal::kWheelLeft:
      return now.track_left_m_per_s / SupportGeometry{}.wheel_radius_m;
    case MotionSignal::kWheelRight:
      return now.track_right_m_per_s / SupportGeometry{}.wheel_radius_m;
    case MotionSignal::kPitch:
      return now.pitch;
    case MotionSignal::kRoll:
      return now.roll;
    default:
      return soil.at(row_of(signal) - row_of(kFirstSoilSignal));
  }
}

double motion_of(const MotionFrame& frame, std::size_t motion) {
  const std::array<double, kMotions> all = {frame.motion.forward_m, frame.motion.sideways_m,
                                            frame.motion.turn_rad};
  return all.at(motion);
}

/// As if left were right.
MotionFrame mirrored(const MotionFrame& frame) {
  MotionFrame other = frame;
  other.motion.sideways_m = -frame.motion.sideways_m;
  other.motion.turn_rad = -frame.motion.turn_rad;
  std::swap(other.track_left_m_per_s, other.track_right_m_per_s);
  other.roll = -frame.roll;
  return other;
}

/// Frames to drive along, and two before them.
struct Sequence {
  std::vector<MotionFrame> frames;
  std::array<double, kSoilSignals> soil;
};
constexpr std::size_t kBefore = 2;

/// What a motion is predicted as a difference to: constant + last x the last frame's + before_last
/// x that of the frame before.
struct Baseline {
  bool settles = false;
  double last() const { return settles ? kSettlingLast : 1.0; }
  double before_last() const { return settles ? kSettlingBeforeLast : 0.0; }
  double constant(const Sequence& sequence, std::size_t frame, std::size_t motion) const {
    if (!settles) return 0.0;
    const auto skid = [&](std::size_t ago) {
      const MotionFrame& at = sequence.frames[frame - ago];
      const FrameMotion usual = kNominalSkid.motion(at.track_left_m_per_s, at.track_right_m_per_s);
      const std::array<double, kMotions> all = {usual.forward_m, 0.0, usual.turn_rad};
      return all.at(motion);
    };
    return settling(0.0, 0.0, skid(0), skid(1), skid(2));
  }
};

}  // namespace

class MotionTrainer::Impl {
 public:
  explicit Impl(const MotionTraining& training)
      : training_(training), random_(training.seed, "stretches of motion") {
    for (const ModelChannel& channel : training.inputs) inputs_.push_back(source_of(channel));
    const std::array<const char*, kMotions> names = {"forward", "sideways", "delta_theta"};
    if (training.outputs.size() != kMotions) {
      throw InputError("training: outputs must be forward, sideways, delta_theta");
    }
    for (std::size_t i = 0; i < kMotions; ++i) {
      const ModelChannel& output = training.outputs[i];
      const std::string name = names.at(i);
      baselines_.at(i).settles = output.baseline == name + "_settling";
      if (output.feature != name || output.middle != 0.0 ||
          (output.baseline != name + "@1" && !baselines_.at(i).settles)) {
        std::string wanted = "training: output " + std::to_string(i + 1) + " must be NAME with ";
        wanted += "NAME@1 or NAME_settling as its baseline and 0 as its middle; NAME is " + name;
        throw InputError(wanted);
      }
    }
    build();
  }

  double step(const std::vector<MotionSeries>& series) {
    double frames = 0.0;
    for (const MotionSeries& one : series) frames += static_cast<double>(one.frames.size());
    std::vector<Sequence> sequences;
    while (sequences.size() < training_.batch) {
      double at = random_.uniform() * frames;
      std::size_t chosen = 0;
      while (chosen + 1 < series.size() &&
             at >= static_cast<double>(series[chosen].frames.size())) {
        at -= static_cast<double>(series[chosen++].frames.size());
      }
      sequences.push_back(sequence(series[chosen], random_.uniform()));
      if (training_.mirror && sequences.size() % 2 == 0) {
        for (MotionFrame& frame : sequences.back().frames) frame = mirrored(frame);
      }
    }
    const double loss = propagate(sequences, true);
    update();
    ++steps_;
    return loss;
  }

  double loss(const std::vector<MotionSeries>& series) {
    return propagate(first_sequences(series), false);
  }

  std::vector<std::vector<float>> gradient(const std::vector<MotionSeries>& series) {
    propagate(first_sequences(series), true);
    std::vector<std::vector<float>> all;
    for (const vec_t& array : gradients_) all.emplace_back(array.begin(), array.end());
    return all;
  }

  void nudge(std::size_t array, std::size_t index, float by) { parameters_[array][0][index] += by; }

  std::vector<FloatLayer> layers() const {
    std::vector<FloatLayer> layers;
    for (std::size_t i = 0; i + 1 < widths_.size(); ++i) {
      FloatLayer layer{widths_[i], widths_[i + 1], i + 2 == widths_.size(), {}, {}};
      const vec_t& weights = parameters_[2 * i][0];
      for (std::size_t node = 0; node < layer.outputs; ++node) {
        for (std::size_t in = 0; in < layer.inputs; ++in) {
          layer.weights.push_back(static_cast<double>(weights[in * layer.outputs + node]));
        }
        layer.bias.push_back(static_cast<double>(parameters_[2 * i + 1][0][node]));
      }
      layers.push_back(std::move(layer));
    }
    return layers;
  }

  std::size_t steps() const { return steps_; }

 private:
  void build() {
    widths_ = {training_.inputs.size()};
    widths_.insert(widths_.end(), training_.hidden.begin(), training_.hidden.end());
    widths_.push_back(kMotions);
    WorldRandom random(training_.seed, "first weights of motion");
    for (std::size_t i = 0; i + 1 < widths_.size(); ++i) {
      const auto in = static_cast<serial_size_t>(widths_[i]);
      const auto out = static_cast<serial_size_t>(widths_[i + 1]);
      const bool last = i + 2 == widths_.size();
      layers_.push_back(last ? std::shared_ptr<tiny_dnn::layer>(std::make_shared<Last>(in, out))
                             : std::make_shared<Hidden>(in, out));
      const double range =
          (last ? kFirstOutput : 1.0) * std::sqrt(6.0 / static_cast<double>(in + out));
      vec_t weights(std::size_t{in} * out);
      for (float& weight : weights) weight = static_cast<float>(random.uniform(-range, range));
      parameters_.push_back({weights});
      parameters_.push_back({vec_t(out, 0.0F)});
    }
    updates_.resize(parameters_.size());
  }

  /// A sequence somewhere in a series; where: 0 to 1.
  Sequence sequence(const MotionSeries& series, double where) const {
    const std::size_t last = series.frames.size() - training_.window;
    if (series.frames.size() < training_.window + kBefore + 1) {
      throw InputError("training: session " + series.source + " is shorter than a sequence");
    }
    const auto begin =
        kBefore + static_cast<std::size_t>(where * static_cast<double>(last - kBefore));
    const auto from = series.frames.begin() + static_cast<std::ptrdiff_t>(begin - kBefore);
    return {{from, from + static_cast<std::ptrdiff_t>(training_.window + kBefore)},
            soil_signals(series.soil)};
  }

  std::vector<Sequence> first_sequences(const std::vector<MotionSeries>& series) const {
    std::vector<Sequence> sequences;
    sequences.reserve(series.size());
    for (const MotionSeries& one : series) sequences.push_back(sequence(one, 0.0));
    return sequences;
  }

  void make_room(std::size_t batch) {
    activations_.assign(training_.window, {});
    sums_.assign(training_.window, {});
    for (std::size_t k = 0; k < training_.window; ++k) {
      for (const std::size_t width : widths_) {
        activations_[k].emplace_back(batch, vec_t(width));
        sums_[k].emplace_back(batch, vec_t(width));
      }
    }
    slopes_.clear();
    sum_slopes_.clear();
    parameter_slopes_.clear();
    for (const std::size_t width : widths_) {
      slopes_.emplace_back(batch, vec_t(width));
      sum_slopes_.emplace_back(batch, vec_t(width));
    }
    for (const tensor_t& array : parameters_) {
      parameter_slopes_.emplace_back(batch, vec_t(array[0].size()));
    }
  }

  /// Drives along the sequences and, when asked, leaves the gradient in gradients_. Returns the
  /// loss.
  double propagate(const std::vector<Sequence>& sequences, bool backwards) {
    const std::size_t batch = sequences.size();
    const std::size_t window = training_.window;
    make_room(batch);
    // The two frames before the sequence, and those of it.
    std::vector<std::vector<std::array<double, kMotions>>> driven(
        window + 2, std::vector<std::array<double, kMotions>>(batch));
    for (std::size_t b = 0; b < batch; ++b) {
      for (std::size_t k = 0; k < 2; ++k) {
        for (std::size_t m = 0; m < kMotions; ++m) {
          driven[k][b].at(m) = motion_of(sequences[b].frames[k], m);
        }
      }
    }
    for (std::size_t k = 0; k < window; ++k) {
      for (std::size_t b = 0; b < batch; ++b) {
        for (std::size_t i = 0; i < inputs_.size(); ++i) {
          const Source& from = inputs_[i];
          const Sequence& along = sequences[b];
          const double value = from.own < kMotions
                                   ? driven[k + 2 - from.ago][b].at(from.own)
                                   : recorded(from.signal, along.frames, k + kBefore, along.soil);
          activations_[k][0][b][i] =
              static_cast<float>(std::clamp((value - from.middle) / from.half_range, -1.0, 1.0));
        }
      }
      forward(k);
      for (std::size_t b = 0; b < batch; ++b) {
        for (std::size_t m = 0; m < kMotions; ++m) {
          const Baseline& baseline = baselines_.at(m);
          driven[k + 2][b].at(m) =
              baseline.constant(sequences[b], k + kBefore, m) +
              baseline.last() * driven[k + 1][b].at(m) +
              baseline.before_last() * driven[k][b].at(m) +
              training_.outputs[m].half_range * static_cast<double>(activations_[k].back()[b][m]);
        }
      }
    }

    // Errors of frames and of means, in units of kErrorUnit.
    double loss = 0.0;
    const double frame_share =
        training_.frame_weight / static_cast<double>(window * batch * kMotions);
    const double mean_share = training_.mean_weight / static_cast<double>(batch * kMotions);
    std::vector<std::vector<std::array<double, kMotions>>> slope(
        window + 2, std::vector<std::array<double, kMotions>>(batch));
    for (std::size_t b = 0; b < batch; ++b) {
      for (std::size_t m = 0; m < kMotions; ++m) {
        double sum = 0.0;
        for (std::size_t k = 0; k < window; ++k) {
          const double real = motion_of(sequences[b].frames[k + kBefore], m);
          const double error = (driven[k + 2][b].at(m) - real) / kErrorUnit.at(m);
          const Huber of_frame = huber(error, kFrameKnee);
          loss += frame_share * of_frame.loss;
          slope[k + 2][b].at(m) = frame_share * of_frame.slope / kErrorUnit.at(m);
          sum += error;
        }
        const Huber of_mean = huber(sum / static_cast<double>(window), training_.mean_knee);
        loss += mean_share * of_mean.loss;
        for (std::size_t k = 0; k < window; ++k) {
          slope[k + 2][b].at(m) +=
              mean_share * of_mean.slope / (static_cast<double>(window) * kErrorUnit.at(m));
        }
      }
    }
    if (!backwards) return loss;

    for (std::size_t k = window; k-- > 0;) {
      for (std::size_t b = 0; b < batch; ++b) {
        for (std::size_t m = 0; m < kMotions; ++m) {
          slopes_.back()[b][m] =
              static_cast<float>(slope[k + 2][b].at(m) * training_.outputs[m].half_range);
          slope[k + 1][b].at(m) += baselines_.at(m).last() * slope[k + 2][b].at(m);
          slope[k][b].at(m) += baselines_.at(m).before_last() * slope[k + 2][b].at(m);
        }
      }
      backward(k);
      for (std::size_t i = 0; i < inputs_.size(); ++i) {
        const Source& from = inputs_[i];
        if (from.own == kMotions) continue;
        for (std::size_t b = 0; b < batch; ++b) {
          const float in = activations_[k][0][b][i];
          if (in <= -1.0F || in >= 1.0F) continue;  // cut off
          slope[k + 2 - from.ago][b].at(from.own) +=
              static_cast<double>(slopes_[0][b][i]) / from.half_range;
        }
      }
    }
    gradients_.clear();
    for (const tensor_t& array : parameter_slopes_) {
      vec_t sum(array[0].size(), 0.0F);
      for (const vec_t& one : array) {
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += one[i];
      }
      gradients_.push_back(std::move(sum));
    }
    return loss;
  }

  void forward(std::size_t k) {
    for (std::size_t i = 0; i < layers_.size(); ++i) {
      const std::vector<tensor_t*> in = {&activations_[k][i], &parameters_[2 * i],
                                         &parameters_[2 * i + 1]};
      std::vector<tensor_t*> out = {&activations_[k][i + 1], &sums_[k][i + 1]};
      layers_[i]->forward_propagation(in, out);
    }
  }

  void backward(std::size_t k) {
    for (std::size_t i = layers_.size(); i-- > 0;) {
      const std::vector<tensor_t*> in = {&activations_[k][i], &parameters_[2 * i],
                                         &parameters_[2 * i + 1]};
      const std::vector<tensor_t*> out = {&activations_[k][i + 1], &sums_[k][i + 1]};
      std::vector<tensor_t*> out_slope = {&slopes_[i + 1], &sum_slopes_[i + 1]};
      std::vector<tensor_t*> in_slope = {&slopes_[i], &parameter_slopes_[2 * i],
                                         &parameter_slopes_[2 * i + 1]};
      layers_[i]->back_propagation(in, out, out_slope, in_slope);
    }
  }

  void update() {
    double square = 0.0;
    for (const vec_t& array : gradients_) {
      for (const float value : array) {
        square += static_cast<double>(value) * static_cast<double>(value);
      }
    }
    const double length = std::sqrt(square);
    const auto shrink =
        static_cast<float>(length > kMaxGradientNorm ? kMaxGradientNorm / length : 1.0);
    for (std::size_t i = 0; i < gradients_.size(); ++i) {
      for (float& value : gradients_[i]) value *= shrink;
      update_parameters(OptimiserKind::kAdam, learning_rate(), 0.0, gradients_[i],
                        parameters_[i][0], updates_[i]);
    }
  }

  /// Up in a line, down along a cosine.
  double learning_rate() const {
    const double done = static_cast<double>(steps_) / static_cast<double>(training_.steps);
    if (done < kRisingShare) {
      return training_.learning_rate * std::max(done / kRisingShare, kLastRate);
    }
    const double falling = std::min((done - kRisingShare) / (1.0 - kRisingShare), 1.0);
    return training_.learning_rate *
           std::max(0.5 * (1.0 + std::cos(std::numbers::pi * falling)), kLastRate);
  }

  MotionTraining training_;
  WorldRandom random_;
  std::vector<Source> inputs_;
  std::array<Baseline, kMotions> baselines_;
  std::vector<std::size_t> widths_;  ///< inputs, hidden layers, outputs
  std::vector<std::shared_ptr<tiny_dnn::layer>> layers_;
  std::vector<tensor_t> parameters_;  ///< a layer's weights, then its biases
  std::vector<UpdateState> updates_;
  std::vector<vec_t> gradients_;
  std::size_t steps_ = 0;

  // Of a batch: by frame of the sequence, then by layer.
  std::vector<std::vector<tensor_t>> activations_;
  std::vector<std::vector<tensor_t>> sums_;
  // Derivatives of the loss, by layer, for the frame at hand.
  std::vector<tensor_t> slopes_;
  std::vector<tensor_t> sum_slopes_;
  std::vector<tensor_t> parameter_slopes_;  ///< an example each, over all frames
};

MotionTrainer::MotionTrainer(const MotionTraining& training)
    : impl_(std::make_unique<Impl>(training)) {}
MotionTrainer::~MotionTrainer() = default;

double MotionTrainer::step(const std::vector<MotionSeries>& series) {
  return impl_->step(series);
}
std::size_t MotionTrainer::steps() const {
  return impl_->steps();
}
std::vector<FloatLayer> MotionTrainer::layers() const {
  return impl_->layers();
}
double MotionTrainer::loss(const std::vector<MotionSeries>& series) {
  return impl_->loss(series);
}
std::vector<std::vector<float>> MotionTrainer::gradient(const std::vector<MotionSeries>& series) {
  return impl_->gradient(series);
}
void MotionTrainer::nudge(std::size_t array, std::size_t index, float by) {
  impl_->nudge(array, index, by);
}

}  // namespace screed::nn
