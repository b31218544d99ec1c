// Everything round one robot that is neither its bodies nor its microcontroller: IMU, encoders, the
// radio with the ground station at its other end, and the events that an experiment scripts.
//
// It exists once, for the firmware compiled for the host (native_robot.h) and for the flash image
// (mcu_robot.h). These differ in when they look: the one once a control tick, the other at the
// moment of each measurement, edge and byte. Each device draws from a generator of its own, so the
// order in which devices are asked changes nothing.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "host_sim/devices/radio/radio_link.h"
#include "host_sim/devices/sensors/imu_model.h"
#include "host_sim/ground_station/station/ground_end.h"
#include "host_sim/ground_station/station/ground_station.h"
#include "host_sim/physics/vehicle/vehicle_state.h"
#include "host_sim/physics/world/environment.h"
#include "host_sim/run/world/world_options.h"

namespace screed {

class RobotDevices {
 public:
  /// Of a robot of the options. The ground station stands where it is now.
  RobotDevices(const WorldOptions& options, size_t number, const RobotView& robot);

  /// Executes what is scripted for this control tick, counted from 1. Before its physics.
  void execute_events(uint64_t tick, RobotView& robot);

  /// One control tick at the ground end of the radio, with the robot where it is now: the ground
  /// station's bytes go into the uplink, what has come down the downlink is taken out.
  void exchange_radio(uint64_t now_us, const RobotView& robot);

  /// Of a side's encoder, counts since the robot was built; rises when the track drives forward.
  /// The counter shows the whole counts below it.
  double encoder_position(const RobotView& robot, Side side) const;

  ImuModel& imu() { return imu_; }
  RadioLink& uplink() { return uplink_; }      ///< to the robot
  RadioLink& downlink() { return downlink_; }  ///< from the robot
  GroundStation& ground_station() { return ground_; }
  const GroundStation& ground_station() const { return ground_; }

 private:
  RobotDevices(const WorldOptions& options, const RobotOptions& own, uint64_t seed,
               const RobotView& robot);

  ImuModel imu_;
  RadioLink uplink_;
  RadioLink downlink_;
  GroundStation ground_;
  GroundEnd ground_end_;
  Eigen::Vector3d station_m_;
  double encoder_counts_per_turn_;
  std::optional<uint64_t> lay_on_side_tick_;
};

}  // namespace screed
