// Baselines of rollouts: constants that fit a drive, found again.
#include "nn/surrogate/slip_law.h"

#include <gtest/gtest.h>

#include <cmath>

namespace screed::nn {
namespace {

constexpr double kExact = 1e-9;

/// Frames of a robot that moves by these constants, over ground that goes up and down.
MotionSeries driven_by(const TrackKinematics& kinematics) {
  MotionSeries series;
  for (int i = 0; i < 400; ++i) {
    MotionFrame frame{};
    frame.track_left_m_per_s = 0.2 * std::sin(0.11 * i);
    frame.track_right_m_per_s = 0.2 * std::sin(0.07 * i + 1.0);
    frame.pitch = 0.3 * std::sin(0.13 * i + 2.0);
    frame.roll = 0.2 * std::cos(0.05 * i);
    frame.motion = kinematics.motion(frame.track_left_m_per_s, frame.track_right_m_per_s,
                                     frame.pitch, frame.roll);
    series.push_back(frame);
  }
  return series;
}

double largest_difference(const TrackKinematics& a, const TrackKinematics& b) {
  return (a.per_second - b.per_second).cwiseAbs().maxCoeff();
}

TEST(TrackKinematics, WithoutSlipTheRobotGoesAsItsTracksDo) {
  const FrameMotion straight = skid_kinematics(1.0, 0.2).motion(0.1, 0.1, 0.2, 0.1);
  EXPECT_NEAR(straight.forward_m, 0.001, kExact);
  EXPECT_NEAR(straight.turn_rad, 0.0, kExact);
  const FrameMotion spin = skid_kinematics(1.0, 0.2).motion(-0.1, 0.1, 0.0, 0.0);
  EXPECT_NEAR(spin.forward_m, 0.0, kExact);
  EXPECT_NEAR(spin.sideways_m, 0.0, kExact);
  EXPECT_NEAR(spin.turn_rad, 0.01, kExact);  // counter-clockwise
}

TEST(SlipLaw, EachFindsItsOwnConstantsAgain) {
  TrackKinematics constant = skid_kinematics(0.85, 0.3);
  TrackKinematics by_slope = constant;
  by_slope.per_second(0, static_cast<int>(TrackInput::kClimb)) = -0.4;
  by_slope.per_second(1, static_cast<int>(TrackInput::kLean)) = -0.3;
  by_slope.per_second(2, static_cast<int>(TrackInput::kLeanAhead)) = 0.7;
  TrackKinematics centres;  // at 0.12 m to the left, 0.15 m to the right, 0.04 m ahead
  centres.per_second.row(0).head<2>() << 0.15 / 0.27, 0.12 / 0.27;
  centres.per_second.row(1).head<2>() << 0.04 / 0.27, -0.04 / 0.27;
  centres.per_second.row(2).head<2>() << -1.0 / 0.27, 1.0 / 0.27;
  TrackKinematics both = centres;
  both.per_second.col(static_cast<int>(TrackInput::kClimb)) = Eigen::Vector3d(-0.4, 0.0, 0.0);
  for (const auto& [law, truth] : {std::pair{SlipLaw::kConstant, constant},
                                   {SlipLaw::kBySlope, by_slope},
                                   {SlipLaw::kRotationCentres, centres},
                                   {SlipLaw::kRotationCentresAndSlope, both}}) {
    const MotionSeries drive = driven_by(truth);
    EXPECT_LT(largest_difference(fitted_kinematics(law, {&drive, 1}), truth), 1e-8) << name_of(law);
  }
}

// One who has more constants is nowhere worse on the drive that it is fitted to.
TEST(SlipLaw, TheSquaresAreTheLessTheMoreConstantsThereAre) {
  MotionSeries drive = driven_by(skid_kinematics(0.9, 0.25));
  for (MotionFrame& frame : drive) {
    const double speed = 0.5 * (frame.track_left_m_per_s + frame.track_right_m_per_s);
    frame.motion.forward_m -= 0.005 * std::abs(speed) * frame.pitch;
    frame.motion.forward_m += 0.001 * speed * speed;
  }
  const auto squares = [&](SlipLaw law) {
    const TrackKinematics fitted = fitted_kinematics(law, {&drive, 1});
    double sum = 0.0;
    for (const MotionFrame& frame : drive) {
      const FrameMotion motion = fitted.motion(frame.track_left_m_per_s, frame.track_right_m_per_s,
                                               frame.pitch, frame.roll);
      sum += std::pow(motion.forward_m - frame.motion.forward_m, 2);
    }
    return sum;
  };
  EXPECT_LT(squares(SlipLaw::kBySlope), 0.2 * squares(SlipLaw::kConstant));
  EXPECT_LE(squares(SlipLaw::kRotationCentres), squares(SlipLaw::kConstant) * (1.0 + 1e-9));
  EXPECT_LE(squares(SlipLaw::kRotationCentresAndSlope), squares(SlipLaw::kBySlope) * (1.0 + 1e-9));
}

// A drive straight ahead says nothing of turns: no constant is made up for them.
TEST(SlipLaw, WhatADriveDoesNotTellIsLeftOut) {
  MotionSeries drive = driven_by(skid_kinematics(0.9, 0.25));
  for (MotionFrame& frame : drive) {
    frame.track_right_m_per_s = frame.track_left_m_per_s;
    frame.motion = {0.009 * frame.track_left_m_per_s, 0.0, 0.0};
  }
  const TrackKinematics fitted = fitted_kinematics(SlipLaw::kRotationCentres, {&drive, 1});
  EXPECT_TRUE(fitted.per_second.allFinite());
  EXPECT_NEAR(fitted.motion(0.1, 0.1, 0.0, 0.0).forward_m, 0.0009, 1e-9);
  EXPECT_NEAR(fitted.motion(-0.1, 0.1, 0.0, 0.0).turn_rad, 0.0, 1e-9);
}

}  // namespace
}  // namespace screed::nn
