// Yaw-rate loop and acceleration limit over two simulated tracks.
#include "firmware/control/drive_control.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>

#include "boards/a_star_32u4/board.h"
#include "firmware/math/units.h"
#include "tests/unit/firmware/control/simulated_track.h"

namespace screed {
namespace {

/// A robot whose tracks reach their speeds, and whose body turns by only a share of what they ask
/// for.
class SkidRobot {
 public:
  explicit SkidRobot(double grip, const Parameters& parameters = {})
      : grip_(grip), control_(kBoard, parameters) {}

  DriveOutput tick(const MotionCommand& command) {
    const DriveMeasurement measured = {left_counts_, right_counts_,
                                       static_cast<int32_t>(std::lround(yaw_rate())), 7200};
    const DriveOutput output = control_.tick(command, measured);
    left_counts_ = left_.step(output.duty_left);
    right_counts_ = right_.step(output.duty_right);
    return output;
  }
  void run(const MotionCommand& command, int ticks) {
    for (int i = 0; i < ticks; ++i) tick(command);
  }

  /// Angle units/s.
  double yaw_rate() const {
    const double omega = (right_.speed_mm_per_s - left_.speed_mm_per_s) / kBoard.tread_mm;
    return grip_ * omega * 65536.0 / (2.0 * std::numbers::pi) + disturbance_;
  }
  double speed() const { return (left_.speed_mm_per_s + right_.speed_mm_per_s) / 2.0; }
  double mean_yaw_rate(const MotionCommand& command, int ticks) {
    double sum = 0.0;
    for (int i = 0; i < ticks; ++i) {
      tick(command);
      sum += yaw_rate();
    }
    return sum / ticks;
  }
  DriveControl& control() { return control_; }
  void set_grip(double grip) { grip_ = grip; }
  /// What the ground turns it by, angle units/s.
  void set_disturbance(double rate) { disturbance_ = rate; }

 private:
  double grip_;
  double disturbance_ = 0.0;
  DriveControl control_;
  SimulatedTrack left_;
  SimulatedTrack right_;
  int16_t left_counts_ = 0;
  int16_t right_counts_ = 0;
};

TEST(DriveControl, TurnsAsCommandedThoughTheTracksSlip) {
  for (const double grip : {1.0, 0.6, 0.4}) {
    for (const int16_t degrees_per_s : std::initializer_list<int16_t>{-40, 20, 40}) {
      SkidRobot robot(grip);
      const MotionCommand command = {80, yaw_rate_from_degrees(degrees_per_s)};
      robot.run(command, 300);
      EXPECT_NEAR(robot.mean_yaw_rate(command, 100), command.yaw_rate,
                  0.05 * std::abs(command.yaw_rate))
          << grip << " " << degrees_per_s;
      EXPECT_NEAR(robot.speed(), 80.0, 8.0);
    }
  }
}

// At full speed a track comes to its limit: then the speed is reduced and the heading is kept. What
// turned the robot while it had no room is turned back.
TEST(DriveControl, KeepsItsHeadingAtFullSpeed) {
  for (const int16_t degrees_per_s : std::initializer_list<int16_t>{0, 20, -45}) {
    SkidRobot robot(0.6);
    const MotionCommand command = {static_cast<int16_t>(kBoard.full_speed_mm_per_s),
                                   yaw_rate_from_degrees(degrees_per_s)};
    robot.run(command, 200);
    double lost = 0.0;  // degrees
    const auto drive = [&](int ticks, double disturbance_degrees_per_s) {
      robot.set_disturbance(disturbance_degrees_per_s * 65536.0 / 360.0);
      for (int i = 0; i < ticks; ++i) {
        robot.tick(command);
        lost += (command.yaw_rate - robot.yaw_rate()) * 360.0 / 65536.0 / kTickRate_hz;
      }
    };
    for (int i = 0; i < 10; ++i) {
      drive(100, 25.0);
      drive(300, 0.0);
    }
    EXPECT_NEAR(lost, 0.0, 3.0) << degrees_per_s;
    EXPECT_GT(robot.speed(), 30.0) << degrees_per_s;
  }
}

TEST(DriveControl, DrivesStraightOnAfterASpin) {
  SkidRobot robot(0.6);
  robot.run({0, yaw_rate_from_degrees(90)}, 400);
  robot.run({200, 0}, 300);
  EXPECT_NEAR(robot.mean_yaw_rate({200, 0}, 100), 0.0, yaw_rate_from_degrees(1));
  EXPECT_NEAR(robot.speed(), 200.0, 10.0);
}

TEST(DriveControl, DrivesStraightOnAfterItWasStuck) {
  // Stuck in a turn the integral fills up; freed, the tracks have no room for that and for the
  // speed of a climb at once. The integral must get out of this by itself.
  SkidRobot robot(0.0);
  robot.run({0, yaw_rate_from_degrees(30)}, 1000);
  robot.set_grip(0.6);
  robot.run({200, 0}, 300);
  EXPECT_NEAR(robot.mean_yaw_rate({200, 0}, 100), 0.0, yaw_rate_from_degrees(1));
  EXPECT_NEAR(robot.speed(), 200.0, 10.0);
}

TEST(DriveControl, ARobotThatCannotTurnIsNotDrivenFasterAndFaster) {
  // Stuck: the body does not turn. The correction stays within 90 degrees/s, and freed, it comes
  // back at once.
  SkidRobot stuck(0.0);
  const MotionCommand command = {0, yaw_rate_from_degrees(30)};
  stuck.run(command, 1000);
  const double most = std::numbers::pi * 2.0 / 360.0 * 120.0 * kBoard.tread_mm / 2.0;
  EXPECT_LE(std::abs(stuck.control().targets().right), most + 1.0);
  EXPECT_GT(std::abs(stuck.control().targets().right), 0.8 * most);
}

TEST(DriveControl, TargetsChangeByNoMoreThanTheAccelerationLimit) {
  Parameters parameters;
  parameters.accel_limit() = 600;
  SkidRobot robot(0.8, parameters);
  TrackSpeeds last = {0, 0};
  const MotionCommand commands[] = {
      {200, 0}, {-200, 8000}, {0, -16000}, {INT16_MAX, INT16_MAX}, {0, 0}};
  for (const MotionCommand& command : commands) {
    for (int tick = 0; tick < 100; ++tick) {
      robot.tick(command);
      const TrackSpeeds now = robot.control().targets();
      ASSERT_LE(std::abs(now.left - last.left), 6);
      ASSERT_LE(std::abs(now.right - last.right), 6);
      last = now;
    }
  }
  EXPECT_EQ(last.left, 0);
  EXPECT_EQ(last.right, 0);
}

TEST(DriveControl, SlowestAccelerationStillMoves) {
  Parameters parameters;
  parameters.accel_limit() = 50;
  SkidRobot robot(0.8, parameters);
  robot.run({100, 0}, 100);
  EXPECT_GT(robot.control().targets().left, 45);
}

TEST(DriveControl, IdleForgetsTheMotion) {
  SkidRobot robot(0.6);
  robot.run({100, 5000}, 200);
  robot.control().idle({0, 0, 0, 7200});
  EXPECT_EQ(robot.control().targets().left, 0);
  EXPECT_EQ(robot.control().targets().right, 0);
}

TEST(DriveControl, ExtremeMeasurementsStayWithinTheDutyRange) {
  Parameters strongest;
  strongest.yaw_kp() = 1024;
  strongest.yaw_ki() = 4096;
  strongest.accel_limit() = 5000;
  for (const int32_t rate : {INT32_MIN / 2, -32768, 32767, INT32_MAX / 2}) {
    for (const int16_t yaw : std::initializer_list<int16_t>{INT16_MIN, INT16_MAX}) {
      DriveControl control(kBoard, strongest);
      for (int tick = 0; tick < 200; ++tick) {
        const DriveOutput output = control.tick({INT16_MIN, yaw}, {INT16_MIN, INT16_MAX, rate, 0});
        ASSERT_LE(std::max(std::abs(output.duty_left), std::abs(output.duty_right)), kDutyMax);
      }
    }
  }
}

/// The yaw loop of drive_control.h in floating point: the rate that the tracks are asked for.
class YawLoopInNumbers {
 public:
  YawLoopInNumbers(double kp, double ki) : kp_(kp / 256.0), ki_(ki / 256.0) {}
  double rate(double wanted, double measured) {
    error_ += (std::clamp(wanted - measured, -16000.0, 16000.0) - error_) / 16.0;
    integral_ = std::clamp(integral_ + ki_ * error_ / 100.0, -16384.0, 16384.0);
    return wanted + std::clamp(kp_ * error_ + integral_, -16384.0, 16384.0);
  }
  void forget() { error_ = integral_ = 0.0; }

 private:
  double kp_;
  double ki_;
  double error_ = 0.0;
  double integral_ = 0.0;
};

TEST(DriveControl, TheYawLoopFollowsItsLawInNumbers) {
  struct Part {
    MotionCommand command;
    int32_t measured;  ///< rate, angle units/s
    int ticks;
    bool idle;
  };
  const Part parts[] = {{{100, 0}, 1500, 150, false},    {{100, 3000}, 1000, 100, false},
                        {{0, 4000}, 9000, 100, false},   {{0, 0}, 2000, 30, false},
                        {{-80, -2000}, 0, 200, false},   {{50, 0}, 40000, 300, false},
                        {{0, 0}, 0, 30, true},           {{50, 0}, 200, 60, false},
                        {{50, 0}, -40000, 300, false},   {{0, 0}, 0, 1, true},
                        {{120, 500}, -14800, 60, false}, {{120, 500}, 16100, 60, false}};
  for (const auto& [kp, ki] : {std::pair{0, 768}, {128, 0}, {512, 300}, {1024, 2000}}) {
    Parameters parameters;
    parameters.yaw_kp() = static_cast<int16_t>(kp);
    parameters.yaw_ki() = static_cast<int16_t>(ki);
    parameters.accel_limit() = 5000;
    DriveControl control(kBoard, parameters);
    YawLoopInNumbers law(kp, ki);
    const SkidSteer kinematics(kBoard.tread_mm);
    double left = 0.0;
    double right = 0.0;
    for (const Part& part : parts) {
      for (int tick = 0; tick < part.ticks; ++tick) {
        const DriveMeasurement measured = {0, 0, part.measured, 7200};
        if (part.idle) {
          control.idle(measured);
          law.forget();
          left = right = 0.0;
        } else {
          control.tick(part.command, measured);
          TrackSpeeds wanted = {0, 0};
          if (part.command.speed_mm_per_s == 0 && part.command.yaw_rate == 0) {
            law.forget();
          } else {
            const auto rate =
                static_cast<int32_t>(std::lround(law.rate(part.command.yaw_rate, part.measured)));
            wanted = kinematics.tracks(part.command.speed_mm_per_s, rate,
                                       static_cast<int16_t>(kBoard.full_speed_mm_per_s));
          }
          left = std::clamp(1.0 * wanted.left, left - 50.0, left + 50.0);
          right = std::clamp(1.0 * wanted.right, right - 50.0, right + 50.0);
        }
        ASSERT_NEAR(control.targets().left, left, 3.0)
            << "gains " << kp << " " << ki << ", measured " << part.measured << ", tick " << tick;
        ASSERT_NEAR(control.targets().right, right, 3.0) << part.measured << ", tick " << tick;
      }
    }
  }
}

TEST(DriveControl, TheAccelerationLimitIsRoundedUpToWholeStepsATick) {
  for (const auto& [limit, step] : {std::pair{600, 6}, {601, 7}, {599, 6}, {700, 7}, {50, 1}}) {
    Parameters parameters;
    parameters.accel_limit() = static_cast<int16_t>(limit);
    DriveControl control(kBoard, parameters);
    control.tick({200, 0}, {0, 0, 0, 7200});
    EXPECT_EQ(control.targets().left, step) << limit;
    EXPECT_EQ(control.targets().right, step) << limit;
  }
}

TEST(DriveControl, AtOnceIsWithoutThatLimit) {
  DriveControl control(kBoard, Parameters{});
  control.tick({250, 0}, {0, 0, 0, 7200}, true);
  EXPECT_EQ(control.targets().left, 250);
  control.tick({-250, 0}, {0, 0, 0, 7200}, true);
  EXPECT_EQ(control.targets().right, -250);
  control.tick({250, 0}, {0, 0, 0, 7200});
  EXPECT_LT(control.targets().left, -200);
}

TEST(DriveControl, MotorsThatAreOffAreStillObserved) {
  DriveControl control(kBoard, Parameters{});
  for (int tick = 0; tick < 200; ++tick) control.idle({2, -3, 0, 7200});
  EXPECT_NEAR(control.speed_left_dmm_per_s(), 2 * 9048.0 / 16.0, 3.0);
  EXPECT_NEAR(control.speed_right_dmm_per_s(), -3 * 9048.0 / 16.0, 3.0);
}

}  // namespace
}  // namespace screed
