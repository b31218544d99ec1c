// A robot driving in a world, tick by tick, for closed-loop tests: no files, no main loop,
// everything in reach.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <memory>

#include "boards/a_star_32u4/board.h"
#include "firmware/robot/robot.h"
#include "host_sim/physics/vehicle/urdf/urdf_importer.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/world/world.h"

namespace screed::testing {

inline const Assembly& rover5() {
  static const Assembly model = import_urdf(find_model_file(Experiment{}));
  return model;
}

inline Parameters drive_parameters() {
  Parameters parameters;
  parameters.algorithm() = static_cast<int16_t>(LevelingAlgorithm::kDrive);
  return parameters;
}

class TestDrive {
 public:
  TestDrive(HeightField terrain, const WorldOptions& options,
            const Parameters& parameters = drive_parameters())
      : world(std::move(terrain), rover5(), kBoard, options, nullptr),
        robot(kBoard, parameters, credentials_of(test_key())) {}

  void tick() {
    world.advance();
    SensorSample sample = world.sample();
    if (tamper) tamper(sample);
    robot.tick(sample, output);
    world.apply(output);
  }
  void run(double seconds) {
    const int64_t ticks = std::lround(seconds * kTickRate_hz);
    for (int64_t i = 0; i < ticks; ++i) tick();
  }
  /// Ticks until the condition holds; false when it does not within `seconds`.
  bool run_until(double seconds, const std::function<bool()>& condition) {
    const int64_t ticks = std::lround(seconds * kTickRate_hz);
    for (int64_t i = 0; i < ticks; ++i) {
      tick();
      if (condition()) return true;
    }
    return false;
  }
  bool start() {
    return run_until(10.0, [this] { return robot.supervisor().running(); });
  }

  Eigen::Vector3d position() const { return world.vehicle().chassis().pose.translation(); }
  Attitude attitude() const { return attitude_of(world.vehicle().chassis().pose.linear()); }
  /// Velocity along the chassis' x axis, m/s.
  double forward_speed() const {
    const ChassisState chassis = world.vehicle().chassis();
    return chassis.pose.linear().col(0).dot(chassis.velocity);
  }
  /// Rate about the world's vertical, rad/s.
  double yaw_rate() const {
    const ChassisState chassis = world.vehicle().chassis();
    return (chassis.pose.linear() * chassis.omega_body).z();
  }

  World world;
  Robot robot;
  RobotOutput output{};
  std::function<void(SensorSample&)> tamper;  ///< a fault of the sensors, each tick
};

inline WorldOptions drive_options(double speed_m_per_s, double yaw_rate_deg_per_s) {
  WorldOptions options;
  options.drive = DriveCommand{speed_m_per_s, yaw_rate_deg_per_s};
  return options;
}

}  // namespace screed::testing
