// A robot whose firmware is compiled for this machine. Its sensors are read, and its answer is
// applied, at the end of each control tick of the world.
#pragma once

#include <ostream>

#include "firmware/parameters/board_constants.h"
#include "hal/sample.h"
#include "host_sim/run/world/robot_controller.h"

namespace screed {

class NativeRobot : public RobotController {
 public:
  NativeRobot(const WorldOptions& options, const BoardConstants& board, RobotView& robot,
              std::ostream* telemetry_log)
      : RobotController(options, robot, telemetry_log),
        board_(board),
        calibration_motion_(options.calibration_motion) {}

  void begin_tick(uint64_t tick) override;
  DutyRatio duty_ratio() const override { return duty_ratio_; }
  /// After the last step of a tick: reads the sensors.
  void end_step() override;

  /// What the sensors said at the end of the last tick.
  const SensorSample& sample() const { return sample_; }
  /// The firmware's answer, until the next one.
  void apply(const RobotOutput& output);

 private:
  void measure();
  void receive_radio();

  BoardConstants board_;
  bool calibration_motion_;
  uint64_t end_of_tick_steps_ = 0;  ///< the plant's, with which the tick ends
  SensorSample sample_{};
  DutyRatio duty_ratio_{0.0, 0.0};
};

}  // namespace screed
