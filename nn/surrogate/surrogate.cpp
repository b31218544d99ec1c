#include "nn/surrogate/surrogate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "host_sim/core/constants.h"
#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"

namespace screed::nn {
namespace {

constexpr double kActivationOfOne = 32768.0;
constexpr double kNoLimit = std::numeric_limits<double>::infinity();
constexpr double kFloorBias = 65536.0;  // makes what is rounded towards zero positive

[[noreturn]] void refuse(const Model& model, const std::string& what) {
  throw InputError("model '" + model.name + "': " + what);
}

/// A distance has no sign; the tracks have (thesis 6.1). Tracks that turn against each other leave
/// it to the last digit of their speeds: it goes from one to the other steadily.
double direction(double left_m_per_s, double right_m_per_s) {
  constexpr double kSure_m_per_s = 0.02;
  return std::clamp(0.5 * (left_m_per_s + right_m_per_s) / kSure_m_per_s, -1.0, 1.0);
}

std::string known_inputs() {
  std::string names;
  for (const MotionSignalInfo& info : motion_signals()) {
    names += (names.empty() ? "" : ", ") + std::string(info.name);
  }
  return names;
}

}  // namespace

TrackInputs track_inputs(double left_m_per_s, double right_m_per_s, double pitch, double roll) {
  const double mean = 0.5 * (left_m_per_s + right_m_per_s);
  TrackInputs inputs;
  inputs << left_m_per_s, right_m_per_s, std::abs(mean) * pitch, std::abs(mean) * roll, mean * roll;
  return inputs;
}

FrameMotion TrackKinematics::motion(double left_m_per_s, double right_m_per_s, double pitch,
                                    double roll) const {
  const Eigen::Vector3d moved =
      kTick_s * per_second * track_inputs(left_m_per_s, right_m_per_s, pitch, roll);
  return {moved.x(), moved.y(), moved.z()};
}

TrackKinematics skid_kinematics(double speed_share, double tread_m) {
  TrackKinematics kinematics;
  kinematics.per_second.row(0).head<2>().setConstant(0.5 * speed_share);
  kinematics.per_second.row(2).head<2>() << -1.0 / tread_m, 1.0 / tread_m;
  return kinematics;
}

Support support_at(const HeightField& ground, const SupportGeometry& geometry, double x_m,
                   double y_m, double cos_heading, double sin_heading) {
  const auto height = [&](double x, double y) { return ground.at(x, y).height; };
  return support_on(height, geometry, x_m, y_m, cos_heading, sin_heading);
}

Surrogate::Surrogate(const TrackKinematics& kinematics, const SupportGeometry& geometry,
                     std::size_t robots)
    : geometry_(geometry),
      robots_(robots),
      kinematics_(kinematics),
      signals_(kMotionSignals * robots),
      x_(robots),
      y_(robots),
      heading_(robots),
      cos_(robots, 1.0),
      sin_(robots),
      motion_{std::vector<double>(robots), std::vector<double>(robots),
              std::vector<double>(robots)} {}

Surrogate::Surrogate(const Model& model, const SupportGeometry& geometry, std::size_t robots,
                     Arithmetic arithmetic, std::optional<InstructionSet> kernel)
    : Surrogate(TrackKinematics{}, geometry, robots) {
  kinematics_.reset();
  arithmetic_ = arithmetic;
  std::size_t max_inputs = 0;
  std::size_t max_outputs = 0;
  std::array<bool, 3> known{};
  for (const ModelNetwork& from : model.networks) {
    Network network{
        kernel.has_value() ? BatchNetwork(from.network, *kernel) : BatchNetwork(from.network),
        {},
        {},
        from.trained,
        {}};
    const auto signal = [&](const std::string& name, const char* what) {
      const std::optional<MotionSignal> found = motion_signal_named(name);
      if (!found.has_value()) {
        refuse(model, std::string(what) + " '" + name +
                          "' is not known to the surrogate world; allowed is " + known_inputs());
      }
      return row_of(*found);
    };
    for (const ModelChannel& channel : from.inputs) {
      const double scale = kActivationOfOne / channel.half_range;
      network.inputs.push_back({signal(channel.feature, "input"), scale, -channel.middle * scale,
                                channel.half_range, channel.middle, std::nullopt, -kNoLimit,
                                kNoLimit});
      const std::size_t from_row = network.inputs.back().row;
      if (from_row >= row_of(MotionSignal::kSpeed) && from_row <= row_of(MotionSignal::kPivot)) {
        products_wanted_ = true;
      }
      InputPreprocessing stages(model.stages, robots_);
      if (!stages.empty()) network.stages.push_back(std::move(stages));
    }
    for (const ModelChannel& channel : from.outputs) {
      Output output = Output::kDistance;
      if (channel.feature == "forward") output = Output::kForward;
      if (channel.feature == "sideways") output = Output::kSideways;
      if (channel.feature == "delta_theta") output = Output::kTurn;
      if (output == Output::kDistance && channel.feature != "v") {
        refuse(model, "output '" + channel.feature +
                          "' is not known to the surrogate world; allowed is forward, sideways, "
                          "delta_theta, v");
      }
      known.at(output == Output::kDistance ? 0 : static_cast<std::size_t>(output)) = true;
      Channel to{static_cast<std::size_t>(output),
                 0.0,
                 0.0,
                 channel.half_range,
                 channel.middle,
                 std::nullopt,
                 -kNoLimit,
                 kNoLimit};
      if (!channel.baseline.empty()) {
        to.baseline = signal(channel.baseline, "baseline");
        for (const Channel& input : network.inputs) {
          if (input.row != *to.baseline) continue;
          to.lowest = input.middle - input.half_range;
          to.highest = input.middle + input.half_range;
        }
      }
      network.outputs.push_back(to);
    }
    if (arithmetic == Arithmetic::kFloat && from.trained.empty()) {
      refuse(model, "has no network in floating point");
    }
    max_inputs = std::max(max_inputs, network.inputs.size());
    max_outputs = std::max(max_outputs, network.outputs.size());
    networks_.push_back(std::move(network));
  }
  if (!known[0] || !known[2]) {
    refuse(model, "predicts no motion; needed are forward (or v) and delta_theta");
  }
  if (!networks_.front().stages.empty()) prepared_.resize(max_inputs * robots_);
  in_.resize(max_inputs * robots_);
  out_.resize(max_outputs * robots_);
}

void Surrogate::set_pose(std::size_t robot, const PlanarPose& pose, const FrameMotion& last) {
  x_[robot] = pose.x_m;
  y_[robot] = pose.y_m;
  heading_[robot] = pose.heading_rad;
  row(MotionSignal::kForward1)[robot] = last.forward_m;
  row(MotionSignal::kSideways1)[robot] = last.sideways_m;
  row(MotionSignal::kTurn1)[robot] = last.turn_rad;
  for (Network& network : networks_) {
    for (InputPreprocessing& stages : network.stages) stages.reset(robot);
  }
}

void Surrogate::displace(std::size_t robot, double x_m, double y_m) {
  const double middle = heading_[robot] - 0.5 * row(MotionSignal::kTurn1)[robot];
  const auto [s, c] = portable::sine_cosine(middle);
  x_[robot] += x_m;
  y_[robot] += y_m;
  row(MotionSignal::kForward1)[robot] += c * x_m + s * y_m;
  row(MotionSignal::kSideways1)[robot] += c * y_m - s * x_m;
}

void Surrogate::update_slope(const HeightField& ground) {
  double* pitch = row(MotionSignal::kPitch);
  double* roll = row(MotionSignal::kRoll);
  for (std::size_t i = 0; i < robots_; ++i) {
    const auto [sine, cosine] = portable::sine_cosine(heading_[i]);
    cos_[i] = cosine;
    sin_[i] = sine;
    const Support support = support_at(ground, geometry_, x_[i], y_[i], cos_[i], sin_[i]);
    pitch[i] = support.pitch;
    roll[i] = support.roll;
  }
}

void Surrogate::store_output(const Channel& channel, const std::int16_t* activations) {
  const double* baseline =
      channel.baseline.has_value() ? &signals_[*channel.baseline * robots_] : nullptr;
  const bool is_distance = channel.row == static_cast<std::size_t>(Output::kDistance);
  std::vector<double>& values = motion_.at(is_distance ? 0 : channel.row);
  const double step = channel.half_range / kActivationOfOne;
  const double middle = channel.middle + 0.5 * step;
  const double* left = row(MotionSignal::kTrackLeft);
  const double* right = row(MotionSignal::kTrackRight);
  for (std::size_t i = 0; i < robots_; ++i) {
    double value = middle + step * activations[i];
    if (baseline != nullptr)
      value = std::clamp(value + baseline[i], channel.lowest, channel.highest);
    if (is_distance) value *= direction(left[i], right[i]);
    values[i] = value;
  }
}

void Surrogate::prepare_inputs(Network& network) {
  for (std::size_t input = 0; input < network.stages.size(); ++input) {
    const Channel& channel = network.inputs[input];
    const double* from = &signals_[channel.row * robots_];
    double* to = &prepared_[input * robots_];
    for (std::size_t i = 0; i < robots_; ++i) {
      to[i] = (from[i] - channel.middle) / channel.half_range;
    }
    network.stages[input].apply({to, robots_});
  }
}

void Surrogate::predict_integer(const Network& network) {
  const bool prepared = !network.stages.empty();
  for (std::size_t input = 0; input < network.inputs.size(); ++input) {
    const Channel& channel = network.inputs[input];
    const double* from = prepared ? &prepared_[input * robots_] : &signals_[channel.row * robots_];
    const double scale = prepared ? kActivationOfOne : channel.scale;
    const double offset = prepared ? 0.0 : channel.offset;
    std::int16_t* to = &in_[input * robots_];
    for (std::size_t i = 0; i < robots_; ++i) {
      const double q =
          std::clamp(from[i] * scale + offset, -kActivationOfOne, kActivationOfOne - 1.0);
      to[i] = static_cast<std::int16_t>(static_cast<std::int32_t>(q + kFloorBias) -
                                        static_cast<std::int32_t>(kFloorBias));
    }
  }
  network.batch.run(in_.data(), out_.data(), robots_, robots_);
  for (std::size_t output = 0; output < network.outputs.size(); ++output) {
    store_output(network.outputs[output], &out_[output * robots_]);
  }
}

void Surrogate::predict_float(const Network& network) {
  for (std::size_t i = 0; i < robots_; ++i) {
    std::vector<double> values;
    for (std::size_t input = 0; input < network.inputs.size(); ++input) {
      const Channel& channel = network.inputs[input];
      const double value =
          network.stages.empty()
              ? (signals_[channel.row * robots_ + i] - channel.middle) / channel.half_range
              : prepared_[input * robots_ + i];
      values.push_back(std::clamp(value, -1.0, 1.0));
    }
    values = run(network.trained, std::move(values));
    for (std::size_t output = 0; output < network.outputs.size(); ++output) {
      const Channel& channel = network.outputs[output];
      const bool is_distance = channel.row == static_cast<std::size_t>(Output::kDistance);
      double value = channel.middle + channel.half_range * std::clamp(values[output], -1.0, 1.0);
      if (channel.baseline.has_value()) {
        value = std::clamp(value + signals_[*channel.baseline * robots_ + i], channel.lowest,
                           channel.highest);
      }
      if (is_distance)
        value *= direction(row(MotionSignal::kTrackLeft)[i], row(MotionSignal::kTrackRight)[i]);
      motion_.at(is_distance ? 0 : channel.row)[i] = value;
    }
  }
}

/// What is not driven stands: at rest a network's answer is nearly, but not quite nothing.
void Surrogate::hold_standing() {
  constexpr double kStanding_m_per_s = 1e-3;
  const double* left = row(MotionSignal::kTrackLeft);
  const double* right = row(MotionSignal::kTrackRight);
  for (std::size_t i = 0; i < robots_; ++i) {
    if (std::max(std::abs(left[i]), std::abs(right[i])) >= kStanding_m_per_s) continue;
    for (std::vector<double>& values : motion_) values[i] = 0.0;
  }
}

void Surrogate::move() {
  std::copy_n(motion_[0].data(), robots_, row(MotionSignal::kForward1));
  std::copy_n(motion_[1].data(), robots_, row(MotionSignal::kSideways1));
  std::copy_n(motion_[2].data(), robots_, row(MotionSignal::kTurn1));
  for (std::size_t i = 0; i < robots_; ++i) {
    PlanarPose pose{x_[i], y_[i], heading_[i]};
    pose.move({motion_[0][i], motion_[1][i], motion_[2][i]});
    x_[i] = pose.x_m;
    y_[i] = pose.y_m;
    heading_[i] = pose.heading_rad;
  }
}

void Surrogate::update_tracks(std::span<const double> left_m_per_s,
                              std::span<const double> right_m_per_s) {
  std::copy_n(left_m_per_s.data(), robots_, row(MotionSignal::kTrackLeft));
  std::copy_n(right_m_per_s.data(), robots_, row(MotionSignal::kTrackRight));
  const double* tracks = row(MotionSignal::kTrackLeft);
  double* wheels = row(MotionSignal::kWheelLeft);
  for (std::size_t i = 0; i < 2 * robots_; ++i) wheels[i] = tracks[i] / geometry_.wheel_radius_m;
}

void Surrogate::update_products() {
  const double* left = row(MotionSignal::kWheelLeft);
  const double* right = row(MotionSignal::kWheelRight);
  for (std::size_t i = 0; i < robots_; ++i) {
    const double mean = 0.5 * (left[i] + right[i]);
    const double difference = right[i] - left[i];
    const double along = portable::sin(row(MotionSignal::kPitch)[i]);
    const double across = portable::sin(row(MotionSignal::kRoll)[i]);
    row(MotionSignal::kSpeed)[i] = std::abs(mean);
    row(MotionSignal::kSpin)[i] = std::abs(difference);
    row(MotionSignal::kClimb)[i] = along * mean;
    row(MotionSignal::kLean)[i] = across * difference;
    row(MotionSignal::kSlide)[i] = across * mean;
    row(MotionSignal::kPivot)[i] = along * difference;
  }
}

void Surrogate::predict() {
  if (products_wanted_) update_products();
  if (kinematics_.has_value()) {
    for (std::size_t i = 0; i < robots_; ++i) {
      const FrameMotion motion =
          kinematics_->motion(row(MotionSignal::kTrackLeft)[i], row(MotionSignal::kTrackRight)[i],
                              row(MotionSignal::kPitch)[i], row(MotionSignal::kRoll)[i]);
      motion_[0][i] = motion.forward_m;
      motion_[1][i] = motion.sideways_m;
      motion_[2][i] = motion.turn_rad;
    }
  }
  for (Network& network : networks_) {
    prepare_inputs(network);
    if (arithmetic_ == Arithmetic::kFloat) {
      predict_float(network);
    } else {
      predict_integer(network);
    }
  }
  if (!networks_.empty()) hold_standing();
  move();
}

void Surrogate::step(const HeightField& ground, std::span<const double> left_m_per_s,
                     std::span<const double> right_m_per_s) {
  update_tracks(left_m_per_s, right_m_per_s);
  update_slope(ground);
  predict();
}

void Surrogate::step_on_slope(double pitch, double roll, std::span<const double> left_m_per_s,
                              std::span<const double> right_m_per_s) {
  update_tracks(left_m_per_s, right_m_per_s);
  std::fill_n(row(MotionSignal::kPitch), robots_, pitch);
  std::fill_n(row(MotionSignal::kRoll), robots_, roll);
  predict();
}

}  // namespace screed::nn
