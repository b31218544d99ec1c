// A robot whose firmware is compiled for this machine. Its sensors are read, and it answers, at the
// end of each control tick of the world; it asks for the ones and gives the other through hal.h, as
// on the robot.
#pragma once

#include "firmware/robot/robot.h"
#include "hal/host/target.h"
#include "hal/sample.h"
#include "host_sim/run/world/robot_controller.h"

namespace screed {

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

}  // namespace screed
