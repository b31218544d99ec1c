// A whole calibration without a radio: the simulated IMU in the simulated person's hands.
#include "host_sim/ground_station/calibration/imu_collector.h"

#include <gtest/gtest.h>

#include "firmware/parameters/parameter_table.h"
#include "firmware/protocol/messages.h"
#include "hal/sample.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/gravity.h"
#include "host_sim/devices/sensors/calibration_motion.h"
#include "host_sim/devices/sensors/imu_model.h"

namespace screed {
namespace {

template <class Message>
CanFrame frame_with(const int16_t (&counts)[3]) {
  Message message{};
  message.x = counts[0];
  message.y = counts[1];
  message.z = counts[2];
  return frame_of(message);
}

/// Frames as a robot sends them: accelerometer and gyro ten times a second, magnetometer twice.
void hold(ImuModel& imu, double from_s, double to_s, ImuCollector& collector) {
  SensorSample sample{};
  for (int tick = static_cast<int>(from_s * kTickRate_hz); tick < to_s * kTickRate_hz; ++tick) {
    imu.measure(calibration_motion(static_cast<double>(tick) / kTickRate_hz), sample);
    if (tick % 10 == 0) collector.add_frame(frame_with<message::AccelRaw>(sample.imu.accel()));
    if (tick % 10 == 5) collector.add_frame(frame_with<message::GyroRaw>(sample.imu.gyro()));
    if (tick % 50 == 0) collector.add_frame(frame_with<message::MagRaw>(sample.imu.mag()));
  }
}

ImuTruth level_at_rest() {
  ImuTruth truth;
  truth.mean_rate_rad_per_s = Eigen::Vector3d::Zero();
  truth.mean_specific_force = {0.0, 0.0, kGravity_m_per_s2};
  truth.body_to_world = Eigen::Matrix3d::Identity();
  truth.altitude_m = 0.0;
  return truth;
}

TEST(Handling, TheMotionIsOneThatABodyCanMake) {
  for (double t = 0.02; t < kCalibrationMotionPeriod_s + 1.0; t += 0.37) {
    const ImuTruth now = calibration_motion(t);
    const ImuTruth before = calibration_motion(t - 0.01);
    EXPECT_NEAR(now.mean_specific_force.norm(), kGravity_m_per_s2, 1e-9);
    // Nobody turns a robot faster than the gyro can say.
    EXPECT_LT(now.mean_rate_rad_per_s.norm(), 10.0);
    // Rate and attitude belong together.
    const Eigen::Vector3d turn = now.mean_rate_rad_per_s * 0.01;
    const Eigen::Matrix3d expected =
        before.body_to_world *
        Eigen::AngleAxisd(turn.norm(), turn.norm() > 0.0 ? Eigen::Vector3d(turn.normalized())
                                                         : Eigen::Vector3d(1.0, 0.0, 0.0))
            .toRotationMatrix();
    EXPECT_LT((expected - now.body_to_world).norm(), 1e-6) << t;
  }
}

TEST(ImuCollector, ARobotInTheHandIsCalibrated) {
  for (const uint64_t seed : {1ULL, 2ULL, 3ULL}) {
    ImuModel imu(seed, ImuErrors::uncalibrated());
    ImuCollector collector;
    EXPECT_NE(collector.advice().find("level"), std::string::npos);
    hold(imu, 0.0, 56.0, collector);
    EXPECT_TRUE(collector.positions_done()) << collector.advice();
    EXPECT_FALSE(collector.complete());
    EXPECT_NE(collector.advice().find("all directions"), std::string::npos);
    hold(imu, 56.0, kCalibrationMotionPeriod_s, collector);
    ASSERT_TRUE(collector.complete()) << collector.mag_coverage();
    const ImuCalibration found = collector.fit();

    // What the sensors say at rest, level, is what the calibration says of them.
    constexpr int kMeasurements = 2000;
    Eigen::Vector3d rate = Eigen::Vector3d::Zero();
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    for (int i = 0; i < kMeasurements; ++i) {
      rate += imu.gyro_dps(level_at_rest()) / kMeasurements;
      force += imu.accel_mg(level_at_rest()) / kMeasurements;
    }
    EXPECT_LT((found.gyro.bias * 0.070 - rate).norm(), 0.05);
    const Eigen::Vector3d corrected = found.accelerometer.correction.apply(force / 0.244) * 0.244;
    EXPECT_LT((corrected - Eigen::Vector3d(0.0, 0.0, 1000.0)).norm(), 6.0);

    EXPECT_GT(found.accelerometer.residual_before, 0.01);
    EXPECT_LT(found.accelerometer.residual_after, 0.001);
    EXPECT_GT(found.magnetometer.residual_before, 0.05);
    EXPECT_LT(found.magnetometer.residual_offset, found.magnetometer.residual_before);
    EXPECT_LT(found.magnetometer.residual_after, 0.013);  // 5 mG of noise in 520

    // Every parameter is one that the robot has, and lies in its range.
    for (const CalibrationParameter& parameter : calibration_parameters(found)) {
      bool known = false;
      for (const ParameterInfo& info : kParameterTable) {
        if (parameter.name != info.name) continue;
        known = parameter.value >= info.min && parameter.value <= info.max;
      }
      EXPECT_TRUE(known) << parameter.name << " = " << parameter.value;
    }
  }
}

TEST(ImuCollector, ARobotThatIsNeverStillIsNotCalibrated) {
  ImuModel imu(1, ImuErrors::uncalibrated());
  ImuCollector collector;
  hold(imu, 60.0, kCalibrationMotionPeriod_s, collector);
  EXPECT_FALSE(collector.complete());
  EXPECT_THROW(static_cast<void>(collector.fit()), RunError);
}

TEST(ImuCollector, ProgressNeverFallsAndIsEnoughOnlyAtTheEnd) {
  for (const uint64_t seed : {1ULL, 2ULL, 3ULL}) {
    ImuModel imu(seed, ImuErrors::uncalibrated());
    ImuCollector collector;
    double before = 0.0;
    for (double t = 0.0; t < kCalibrationMotionPeriod_s; t += 0.5) {
      hold(imu, t, t + 0.5, collector);
      const double now = collector.mag_coverage();
      EXPECT_GE(now, before) << "seed " << seed << ", " << t << " s";
      // A robot that stands where it stood has been turned nowhere.
      if (t < 4.0) {
        EXPECT_LT(now, 0.05) << t;
      }
      if (t < 56.0) {
        EXPECT_LT(now, ImuCollector::kEnoughCoverage) << t;
      }
      before = now;
    }
    EXPECT_TRUE(collector.complete());
    EXPECT_GE(before, ImuCollector::kEnoughCoverage);
  }
}

}  // namespace
}  // namespace screed
