// A world: robots with what drives and surrounds them, advanced together over one terrain.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "firmware/parameters/board_constants.h"
#include "firmware/parameters/parameters.h"
#include "firmware/robot/robot.h"
#include "firmware/security/command_mac.h"
#include "hal/host/target.h"
#include "hal/sample.h"
#include "host_sim/devices/mcu/cycle_report.h"
#include "host_sim/devices/radio/radio_link.h"
#include "host_sim/devices/sensors/imu_model.h"
#include "host_sim/ground_station/station/command_key.h"
#include "host_sim/ground_station/station/ground_station.h"
#include "host_sim/physics/vehicle/vehicle_state.h"
#include "host_sim/physics/world/environment.h"
#include "host_sim/physics/world/plant_options.h"

namespace screed {

// What a world is made of beside its terrain and the robots' bodies: sensors, radio, ground
// station, scripted events, and what each robot is driven by.

/// What firmware starts with.
struct RobotSettings {
  BoardConstants board{};
  Parameters parameters;
  Credentials credentials = credentials_of(test_key());
};

/// A flash image, and the board that it runs on.
struct RobotImage {
  std::string elf;
  std::string board;                           ///< a folder in boards/
  std::optional<int> gdb_port = std::nullopt;  ///< where it waits for a debugger
};

/// What is one robot's own.
struct RobotOptions {
  RobotSettings settings;
  /// Drives it, with parameters and credentials in its EEPROM; without one it is firmware compiled
  /// for this machine.
  std::optional<RobotImage> image;
  std::optional<DriveCommand> drive;   ///< the ground station commands it
  ParameterChanges changes;            ///< the ground station makes them
  CommandKey ground_key = test_key();  ///< what the ground station signs with
  /// Programs outside at the ground end of the radio; may be null, must outlive the world.
  GroundPort* ground_port = nullptr;
  /// May be null, must outlive the world.
  std::ostream* telemetry_log = nullptr;
  /// The robot is laid on its left side at this time, s: a fault to inject.
  std::optional<double> lay_on_side_at_s;
};

struct WorldOptions : PlantOptions {
  std::vector<RobotOptions> robots{1};  ///< as many as there are starts
  uint64_t seed = 1;                    ///< each robot's is made of it (seed_of_robot())
  ImuErrors imu;
  RadioOptions radio;
  bool ground_station_arms = true;
  PositionFixOptions fixes;
  /// The IMU feels a person turning the robot over (imu_model.h) instead of its own
  /// motion.
  bool calibration_motion = false;
  double encoder_counts_per_turn = 1000.0 / 3.0;
};

// What tells the robots of a world apart. Number 0 is what the experiment says, so that a robot is
// the same alone as in company.

/// Of its sensors, radio and ground station.
uint64_t seed_of_robot(uint64_t seed, size_t number);
/// Its random walk is another one.
Parameters parameters_of_robot(const Parameters& parameters, size_t number);
/// The same key under another id: no robot takes a command for another one.
CommandKey key_of_robot(const CommandKey& key, size_t number);
Credentials credentials_of_robot(const Credentials& credentials, size_t number);

// Somebody who sees every sample and every answer of the robots of a world, and may tamper with
// both.

class RobotWatch {
 public:
  virtual ~RobotWatch() = default;

  /// A robot has read its sensors, and the world stands as they saw it. Returns whether it is to
  /// answer; if not, the world stops here. What is changed in `sample` the firmware of a native
  /// robot reads so; an image has read it already.
  virtual bool on_sample(std::size_t /*robot*/, SensorSample& /*sample*/) { return true; }
  /// A robot has answered. A native one's answer goes to its motors and its radio as it is left
  /// here; an image has set its pins already.
  virtual void on_output(std::size_t /*robot*/, RobotOutput& /*output*/) {}

 protected:
  RobotWatch() = default;
  RobotWatch(const RobotWatch&) = default;
  RobotWatch& operator=(const RobotWatch&) = default;
};

/// What firmware reads of encoders and battery at an end of a tick, into the sample.
void measure_drive(const RobotView& robot, double encoder_counts_per_turn,
                   const BoardConstants& board, SensorSample& sample);

// Everything round one robot that is neither its bodies nor its microcontroller: IMU, encoders, the
// radio with the ground station at its other end, and the events that an experiment scripts.
//
// It exists once, for the firmware compiled for the host (NativeRobot) and for the flash image
// (mcu_robot.h). These differ in when they look: the one once a control tick, the other at the
// moment of each measurement, edge and byte. Each device draws from a generator of its own, so the
// order in which devices are asked changes nothing.
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
  double encoder_counts_per_turn() const { return encoder_counts_per_turn_; }

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

// A robot of a world: its brain, and all that surrounds it but the bodies, which the world steps
// for all robots together.
//
// There are two kinds of brain. The firmware compiled for this machine looks at the world once a
// control tick (NativeRobot); the flash image lives through every microsecond of it
// (mcu_robot.h).

class RobotController {
 public:
  /// How far a brain came.
  enum class Progress : uint8_t {
    kNoAnswer,  ///< in this step
    kAnswered,  ///< a sample
    kOver,      ///< the watch did not want an answer
  };

  /// Of robot `number` of a plant, which must outlive the controller.
  RobotController(const WorldOptions& options, Environment& plant, size_t number)
      : number_(number),
        plant_(plant),
        robot_(plant.robot(number)),
        settings_(options.robots[number].settings),
        devices_(options, number, robot_) {}
  RobotController(const RobotController&) = delete;
  RobotController& operator=(const RobotController&) = delete;
  virtual ~RobotController() = default;

  /// The world begins a control tick, counted from 1. Before its physics.
  virtual void begin_tick(uint64_t tick) = 0;
  /// What the motors get in the next physics step.
  virtual DutyRatio duty_ratio() const = 0;
  /// The plant has taken a physics step, of all robots: what happened to this one's devices.
  virtual void end_step() = 0;
  /// The brain lives through that step. The watch may be null.
  virtual Progress live(RobotWatch* watch) = 0;

  /// What its firmware started with.
  const RobotSettings& settings() const { return settings_; }
  /// The newest that it has read and answered.
  virtual const SensorSample& sample() const = 0;
  virtual const RobotOutput& output() const = 0;
  /// Its firmware; null where that is an image.
  virtual const Robot* firmware() const { return nullptr; }
  /// What a microcontroller's time went into; nothing where there is none.
  virtual std::optional<CycleReport> cycles() const { return std::nullopt; }

  RobotDevices& devices() { return devices_; }
  const RobotDevices& devices() const { return devices_; }

 protected:
  size_t number() const { return number_; }
  const Environment& plant() const { return plant_; }
  RobotView& robot() { return robot_; }
  const RobotView& robot() const { return robot_; }
  /// The world's clock after so many steps, and now.
  uint64_t us_at(uint64_t steps) const {
    return steps * kTickPeriod_us / static_cast<uint64_t>(plant_.steps_per_tick());
  }
  uint64_t world_us() const { return us_at(plant_.steps()); }

 private:
  size_t number_;
  const Environment& plant_;
  RobotView& robot_;
  RobotSettings settings_;
  RobotDevices devices_;
};

// A robot whose firmware is compiled for this machine. Its sensors are read, and it answers, at the
// end of each control tick of the world; it asks for the ones and gives the other through hal.h, as
// on the robot.

class NativeRobot : public RobotController, private hal::Target {
 public:
  NativeRobot(const WorldOptions& options, Environment& plant, size_t number);

  void begin_tick(uint64_t tick) override;
  DutyRatio duty_ratio() const override { return duty_ratio_; }
  void end_step() override;
  Progress live(RobotWatch* watch) override;

  const SensorSample& sample() const override { return measured_; }
  const RobotOutput& output() const override { return output_; }
  const Robot* firmware() const override { return &firmware_; }

 private:
  bool at_end_of_tick() const { return plant().steps() == end_of_tick_steps_; }
  void measure();
  void receive_radio();

  const BoardConstants& board_constants() override { return settings().board; }
  const Parameters& parameters() override { return settings().parameters; }
  const Credentials& credentials() override { return settings().credentials; }
  void read_sensors(SensorSample& sample) override { sample = offered_; }
  void write_outputs(const RobotOutput& output) override;

  bool calibration_motion_;
  Robot firmware_;
  uint64_t end_of_tick_steps_ = 0;  ///< the plant's, with which the tick ends
  SensorSample measured_{};
  SensorSample offered_{};  ///< the same, after the watch
  SensorSample sample_{};
  RobotOutput output_{};
  RobotWatch* watch_ = nullptr;  ///< of this tick
  DutyRatio duty_ratio_{0.0, 0.0};
};

// Robots in one world, of physics or of what stands in for it, advanced together.
//
// The world owns its clock and its seeded generators; nothing in it looks at the wall clock or at
// global random state, so the same configuration gives the same bytes on every run and any number
// of worlds live side by side.

class World {
 public:
  /// The robots of this plant, which nobody has stepped yet; of the options those count that are
  /// not the plant's. Throws InputError for an image that cannot be run, and for options of another
  /// number of robots.
  World(std::unique_ptr<Environment> plant, const WorldOptions& options);

  /// Advances all until each robot has answered. Native ones do at the end of each control tick of
  /// the world, an image a moment later and, while it starts, less often. The watch, which may be
  /// null, sees it; returns false when it wanted no answer. Throws RunError when the physics
  /// diverges or an image crashes, hangs or misuses a chip.
  bool advance(RobotWatch* watch = nullptr);

  size_t robots() const { return robots_.size(); }
  RobotController& robot(size_t number = 0) { return *robots_[number]; }
  const RobotController& robot(size_t number = 0) const { return *robots_[number]; }
  /// What a robot has read and answered, newest.
  const SensorSample& sample(size_t robot = 0) const { return robots_[robot]->sample(); }
  const RobotOutput& output(size_t robot = 0) const { return robots_[robot]->output(); }
  /// The firmware of a native robot.
  const Robot& firmware(size_t robot = 0) const { return *robots_[robot]->firmware(); }
  const GroundStation& ground_station(size_t robot = 0) const {
    return robots_[robot]->devices().ground_station();
  }
  GroundStation& ground_station(size_t robot = 0) {
    return robots_[robot]->devices().ground_station();
  }

  /// Control ticks begun, and as a time.
  uint64_t ticks() const { return ticks_; }
  double time_s() const { return static_cast<double>(ticks_) / kTickRate_hz; }
  const Environment& plant() const { return *plant_; }
  Environment& plant() { return *plant_; }
  const HeightField& terrain() const { return plant_->terrain(); }
  const VehicleState& vehicle(size_t robot = 0) const { return plant_->robot(robot).vehicle(); }
  const Battery& battery(size_t robot = 0) const { return plant_->robot(robot).battery(); }

 private:
  /// Plant, sensors and radio, by one physics step.
  void step();

  std::unique_ptr<Environment> plant_;
  std::vector<std::unique_ptr<RobotController>> robots_;
  std::vector<DutyRatio> duty_ratios_;
  uint64_t ticks_ = 0;
};

}  // namespace screed
