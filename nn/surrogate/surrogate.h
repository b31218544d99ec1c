// Robots that move by a network, or by constants, in place of the physics: track kinematics, the
// ground under the tracks, and many robots at once.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "host_sim/core/elementary.h"
#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/standin/planar_pose.h"
#include "nn/batch/batch_network.h"
#include "nn/data/motion_signals.h"
#include "nn/data/preprocessing.h"
#include "nn/model/model_file.h"

namespace screed::nn {

/// Forward, sideways and turn of a frame are linear in these.
enum class TrackInput : std::uint8_t {
  kLeft,      ///< speed of the left track, m/s
  kRight,     ///< of the right one
  kClimb,     ///< magnitude of their mean times the pitch: slip grows uphill
  kLean,      ///< magnitude of their mean times the roll: what slides down sideways
  kLeanAhead  ///< their mean, signed, times the roll: turns its nose downhill
};
inline constexpr int kTrackInputs = 5;

using TrackInputs = Eigen::Matrix<double, kTrackInputs, 1>;
/// Speeds in m/s, pitch and roll of the ground in rad, nose and left side up positive.
TrackInputs track_inputs(double left_m_per_s, double right_m_per_s, double pitch, double roll);

/// Motion from track speeds and the ground's slope by constants, without a state: what anything
/// that stands in for the physics must beat.
struct TrackKinematics {
  Eigen::Matrix<double, 3, kTrackInputs> per_second =
      Eigen::Matrix<double, 3, kTrackInputs>::Zero();

  FrameMotion motion(double left_m_per_s, double right_m_per_s, double pitch, double roll) const;
};

/// The robot goes as its tracks do: `speed_share` of their mean speed, and turns as if they were
/// `tread_m` apart. No slip: 1 and the robot's own tread.
TrackKinematics skid_kinematics(double speed_share, double tread_m);

/// Where the tracks stand, from the robot's origin; the Rover 5's.
struct SupportGeometry {
  double half_length_m = 0.05;   ///< to the support points, ahead and behind
  double half_tread_m = 0.0635;  ///< to the middle of a track
  double wheel_radius_m = 0.03;
};

/// The ground under a robot, from heights alone: pitch and roll as in thesis 6.1, with the four
/// points under the ends of the tracks in place of one ahead, one behind and one at each side.
struct Support {
  double height_m;  ///< mean of the points
  double pitch;     ///< rad, nose up positive
  double roll;      ///< rad, left side up positive
};

/// height(x, y) is the ground's in m.
template <class Height>
Support support_on(const Height& height, const SupportGeometry& geometry, double x_m, double y_m,
                   double cos_heading, double sin_heading) {
  const double ahead_x = geometry.half_length_m * cos_heading;
  const double ahead_y = geometry.half_length_m * sin_heading;
  const double left_x = -geometry.half_tread_m * sin_heading;
  const double left_y = geometry.half_tread_m * cos_heading;
  const double front_left = height(x_m + ahead_x + left_x, y_m + ahead_y + left_y);
  const double front_right = height(x_m + ahead_x - left_x, y_m + ahead_y - left_y);
  const double rear_left = height(x_m - ahead_x + left_x, y_m - ahead_y + left_y);
  const double rear_right = height(x_m - ahead_x - left_x, y_m - ahead_y - left_y);
  const double along = (front_left + front_right) - (rear_left + rear_right);
  const double across = (front_left + rear_left) - (front_right + rear_right);
  return {0.25 * ((front_left + rear_left) + (front_right + rear_right)),
          portable::atan(along / (4.0 * geometry.half_length_m)),
          portable::atan(across / (4.0 * geometry.half_tread_m))};
}

Support support_at(const HeightField& ground, const SupportGeometry& geometry, double x_m,
                   double y_m, double cos_heading, double sin_heading);

/// Robots whose motion a network predicts in place of physics, frame by frame (thesis 6.1), many at
/// once: a row a signal, a column a robot. Knows no motors, no sensors and no firmware.
///
/// A frame is 10 ms. Pitch and roll come from the height map under the tracks, the network outputs
/// the displacements forward and sideways and the turn, and these move the robot's pose:
///   x += forward cos(theta + turn/2) - sideways sin(theta + turn/2), y likewise, theta += turn.
/// A robot whose tracks stand stands, whatever the network says.
/// All arithmetic up to the network's outputs is exact, so any number of robots give the same bits
/// one by one and together.
class Surrogate {
 public:
  enum class Arithmetic : std::uint8_t {
    kInteger,  ///< that of the robot, batched
    kFloat,    ///< the network as it was trained, for comparison; slow
  };

  /// Throws InputError when an input or output of the model is not known here, or when the network
  /// in floating point is asked for and not in the model.
  Surrogate(const Model& model, const SupportGeometry& geometry, std::size_t robots,
            Arithmetic arithmetic = Arithmetic::kInteger,
            std::optional<InstructionSet> kernel = std::nullopt);
  /// No network: these constants move the robots.
  Surrogate(const TrackKinematics& kinematics, const SupportGeometry& geometry, std::size_t robots);

  std::size_t robots() const { return robots_; }

  /// Puts a robot somewhere with what it has just done: the last frame's motion.
  void set_pose(std::size_t robot, const PlanarPose& pose, const FrameMotion& last = {});
  /// Something else moves a robot by this in the frame that has just ended.
  void displace(std::size_t robot, double x_m, double y_m);

  /// One frame of all robots; the speeds their tracks have at its end, a number a robot. Robots do
  /// not interact.
  void step(const HeightField& ground, std::span<const double> left_m_per_s,
            std::span<const double> right_m_per_s);

  /// The same, all robots on ground of this inclination.
  void step_on_slope(double pitch, double roll, std::span<const double> left_m_per_s,
                     std::span<const double> right_m_per_s);

  const SupportGeometry& geometry() const { return geometry_; }
  PlanarPose pose(std::size_t robot) const { return {x_[robot], y_[robot], heading_[robot]}; }
  /// Of the last frame.
  FrameMotion motion(std::size_t robot) const {
    return {row(MotionSignal::kForward1)[robot], row(MotionSignal::kSideways1)[robot],
            row(MotionSignal::kTurn1)[robot]};
  }
  /// The terrain's inclination in the last frame.
  double pitch(std::size_t robot) const { return row(MotionSignal::kPitch)[robot]; }
  double roll(std::size_t robot) const { return row(MotionSignal::kRoll)[robot]; }

 private:
  enum class Output : std::uint8_t { kForward, kSideways, kTurn, kDistance };
  struct Channel {
    std::size_t row;  ///< signal, or Output
    double scale;     ///< activation = value * scale + offset, in steps of 2^-15
    double offset;
    double half_range;
    double middle;
    std::optional<std::size_t> baseline;  ///< row of a signal
    /// Of an output with a baseline: the range in which the network receives it in the next frame.
    /// Without these ends a network that goes on adding would run away.
    double lowest;
    double highest;
  };
  struct Network {
    BatchNetwork batch;
    std::vector<Channel> inputs;
    std::vector<Channel> outputs;
    std::vector<FloatLayer> trained;
    std::vector<InputPreprocessing>
        stages;  ///< one an input; none: the model has no stage of run time
  };

  double* row(MotionSignal signal) { return &signals_[row_of(signal) * robots_]; }
  const double* row(MotionSignal signal) const { return &signals_[row_of(signal) * robots_]; }
  void update_tracks(std::span<const double> left_m_per_s, std::span<const double> right_m_per_s);
  void update_products();
  void update_slope(const HeightField& ground);
  void predict();
  void prepare_inputs(Network& network);
  void predict_integer(const Network& network);
  void predict_float(const Network& network);
  void store_output(const Channel& channel, const std::int16_t* activations);
  void hold_standing();
  void move();

  SupportGeometry geometry_;
  std::size_t robots_;
  Arithmetic arithmetic_ = Arithmetic::kInteger;
  std::optional<TrackKinematics> kinematics_;
  std::vector<Network> networks_;
  bool products_wanted_ = false;  ///< an input is one of those from kSpeed to kPivot
  std::vector<double> signals_;   ///< kSignals rows
  std::vector<double> x_;
  std::vector<double> y_;
  std::vector<double> heading_;
  std::vector<double> cos_;
  std::vector<double> sin_;
  std::array<std::vector<double>, 3> motion_;  ///< the new frame's: forward, sideways, turn
  std::vector<double> prepared_;  ///< normalised inputs behind the stages of run time, by input
  std::vector<std::int16_t> in_;
  std::vector<std::int16_t> out_;
};

}  // namespace screed::nn
