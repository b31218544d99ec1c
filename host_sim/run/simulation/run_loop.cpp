// The order of things within a tick.
#include "host_sim/run/simulation/run_loop.h"

#include "hal/host/target.h"

namespace screed {

RunLoop::RunLoop(RunWorld& world, const RunParts& parts)
    : world_(world),
      plant_(world.plant()),
      robot_(parts.robot),
      recorder_(parts.recorder),
      leveling_(parts.leveling),
      stop_(parts.stop),
      progress_(parts.progress),
      pacer_(parts.pacer),
      observer_(parts.observer),
      before_(parts.before) {}

RunEnd RunLoop::run() {
  if (observer_ != nullptr) observer_->on_begin(before_, plant_.terrain());
  leveling_.begin(before_, take_point_);
  World* native = world_.native();
  const RunEnd end = native != nullptr ? run_native(*native) : run_image(*world_.image());
  leveling_.end(plant_.terrain(), take_point_);
  if (observer_ != nullptr) observer_->on_end();
  return end;
}

std::optional<RunEnd> RunLoop::reason_to_end() const {
  return stop_.reason(left_bed(plant_));
}

// ---- what happens in every tick ----------------------------------------------------------------

/// The robot has read its sensors; the world stands as they saw it.
void RunLoop::on_sample(const SensorSample& sample) {
  robot_.sample = sample;
  // The shadow answers before the robot does: a frame shows what they think of this sample.
  robot_.parity.tick(sample);
  robot_.frame = robot_.frames.record(plant_, robot_.parity.shadow());
  recorder_.observe_terrain(plant_.terrain());
}

/// The robot has answered the sample; a native world has not taken the answer yet.
void RunLoop::on_output(const RobotOutput& output) {
  robot_.parity.require_equal(output);
  robot_.telemetry.add(static_cast<uint64_t>(plant_.time_s() * 1e6), output);
  recorder_.append(robot_.frame, robot_.sample, output);
  const Robot& shadow = robot_.parity.shadow();
  stop_.count_tick(shadow.supervisor().state(), shadow.leveling().state());
  progress_.on_tick(stop_, robot_.frame.time, plant_);
  leveling_.on_tick(robot_.frame, robot_.frames.distance_m(), plant_.terrain(), take_point_);
  if (observer_ != nullptr) observer_->on_tick(robot_.frame, plant_.terrain());
  pacer_.wait_until(plant_.time_s());
}

void RunLoop::on_leveling(const LevelingPoint& point) {
  recorder_.record_leveling(point);
  if (observer_ != nullptr) observer_->on_leveling(point);
}

// ---- firmware compiled for this machine --------------------------------------------------------

/// The hardware of the firmware's main loop, which calls these three in turn until the first one
/// says no:
///
///     while (hal::wait_for_tick()) {   // the world advances by 10 ms: physics, sensors, radio
///       hal::read_sensors(sample);     // on_sample()
///       robot.tick(sample, output);
///       hal::write_outputs(output);    // on_output(), then the world takes duty and radio bytes
///     }
class RunLoop::NativeTarget : public hal::Target {
 public:
  NativeTarget(RunLoop& loop, World& world) : loop_(loop), world_(world) {}

  bool wait_for_tick() override {
    end_ = loop_.reason_to_end();
    if (end_.has_value()) return false;
    world_.advance();
    return true;
  }

  void read_sensors(SensorSample& sample) override {
    sample = world_.sample();
    loop_.on_sample(sample);
  }

  void write_outputs(const RobotOutput& output) override {
    loop_.on_output(output);
    world_.apply(output);
  }

  void init() override {}
  const BoardConstants& board_constants() override { return loop_.world_.robot_settings().board; }
  const Parameters& parameters() override { return loop_.world_.robot_settings().parameters; }
  const Credentials& credentials() override { return loop_.world_.robot_settings().credentials; }

  /// After the last tick.
  RunEnd end() const { return end_.value(); }

 private:
  RunLoop& loop_;
  World& world_;
  std::optional<RunEnd> end_;
};

RunEnd RunLoop::run_native(World& world) {
  NativeTarget target(*this, world);
  hal::run_firmware(target);
  return target.end();
}

// ---- the flash image ---------------------------------------------------------------------------

/// World and microcontroller run on in lockstep until the program marks that it has read its
/// sensors, and then that it has set its outputs; the pins act on the world by themselves.
RunEnd RunLoop::run_image(CoSimulation& image) {
  while (true) {
    if (const std::optional<RunEnd> reason = reason_to_end()) return *reason;
    const SensorSample& sample = image.run_to_sample();
    // The program needs some milliseconds to start, so that it makes fewer ticks than a native one
    // in the same time: here the world's clock ends the run.
    if (plant_.time_s() > stop_.duration_s()) return RunEnd::kDone;
    on_sample(sample);
    on_output(image.run_to_output());
  }
}

}  // namespace screed
