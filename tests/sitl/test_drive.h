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
#include "host_sim/physics/world/plant.h"
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

/// The options with firmware of the default board in the first robot, that starts so.
inline WorldOptions with_firmware(WorldOptions options, const Parameters& parameters) {
  options.robots[0].settings.board = kBoard;
  options.robots[0].settings.parameters = parameters;
  return options;
}

class TestDrive : private RobotWatch {
 public:
  /// In any kind of world, of one robot.
  TestDrive(std::unique_ptr<Environment> plant, const WorldOptions& options,
            const Parameters& parameters = drive_parameters())
      : world(std::move(plant), with_firmware(options, parameters)),
        robot(world.firmware()),
        output(world.output()) {}
  TestDrive(HeightField terrain, const WorldOptions& options,
            const Parameters& parameters = drive_parameters())
      : TestDrive(std::make_unique<Plant>(std::move(terrain), rover5(), options), options,
                  parameters) {}

  void tick() { world.advance(this); }
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
  const Robot& robot;
  const RobotOutput& output;
  std::function<void(SensorSample&)> tamper;  ///< a fault of the sensors, each tick

 private:
  bool on_sample(size_t /*robot*/, SensorSample& sample) override {
    if (tamper) tamper(sample);
    return true;
  }
};

inline WorldOptions drive_options(double speed_m_per_s, double yaw_rate_deg_per_s) {
  WorldOptions options;
  options.robots[0].drive = DriveCommand{speed_m_per_s, yaw_rate_deg_per_s};
  return options;
}

}  // namespace screed::testing
