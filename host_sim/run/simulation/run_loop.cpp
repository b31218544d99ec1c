// The order of things within a tick.
#include "host_sim/run/simulation/run_loop.h"

#include "hal/host/target.h"

namespace screed {

RunLoop::RunLoop(RunWorld& world, const RunParts& parts)
    : world_(world),
      plant_(world.plant()),
      robots_{{parts.robot, parts.recorder}},
      leveling_(parts.leveling),
      stop_(parts.stop),
      progress_(parts.progress),
      pacer_(parts.pacer),
      observer_(parts.observer),
      before_(parts.before) {
  for (const RecordedRobot& robot : parts.further_robots) robots_.push_back(robot);
  frames_.resize(robots_.size());
}

RunEnd RunLoop::run() {
  if (observer_ != nullptr) observer_->on_begin(before_, plant_.terrain());
  leveling_.begin(before_, take_point_);
  FurtherRobots further(
      world_.world(), world_.all_robot_settings(),
      {[this](size_t robot, const SensorSample& sample) { on_sample(robot, sample); },
       [this](size_t robot, const RobotOutput& output) { on_output(robot, output); }});
  CoSimulation* image = world_.image();
  const RunEnd end = image != nullptr ? run_image(*image, further) : run_native(further);
  leveling_.end(plant_.terrain(), take_point_);
  if (observer_ != nullptr) observer_->on_end();
  return end;
}

std::optional<RunEnd> RunLoop::reason_to_end() const {
  bool off_bed = false;
  for (size_t i = 0; i < robots_.size(); ++i)
    off_bed = off_bed || left_bed(before_, plant_.robot(i));
  return stop_.reason(off_bed);
}

// ---- what happens in every tick ----------------------------------------------------------------

/// The robot has read its sensors; the world stands as they saw it.
void RunLoop::on_sample(size_t robot, const SensorSample& sample) {
  WatchedRobot& watched = robots_[robot].robot;
  watched.sample = sample;
  // The shadow answers before the robot does: a frame shows what they think of this sample.
  watched.parity.tick(sample);
  watched.frame = watched.frames.record(plant_.robot(robot), watched.parity.shadow());
  watched.ran = watched.ran || watched.parity.shadow().supervisor().running();
  // A bed of particles casts thousands of rays for its surface: it is asked for where it is needed.
  SessionRecorder& recorder = robots_[robot].recorder;
  if (recorder.records_heights()) recorder.observe_terrain(plant_.terrain());
}

/// The robot has answered the sample; a native world has not taken the answer yet.
void RunLoop::on_output(size_t robot, const RobotOutput& output) {
  WatchedRobot& watched = robots_[robot].robot;
  watched.parity.require_equal(output);
  watched.telemetry.add(static_cast<uint64_t>(plant_.time_s() * 1e6), output);
  robots_[robot].recorder.append(watched.frame, watched.sample, output);
}

void RunLoop::end_tick() {
  const WatchedRobot& first = robots_[0].robot;
  const Robot& shadow = first.parity.shadow();
  stop_.count_tick(shadow.supervisor().state(), shadow.leveling().state());
  progress_.on_tick(stop_, first.frame.time);
  double distance_m = 0.0;
  for (size_t i = 0; i < robots_.size(); ++i) {
    frames_[i] = robots_[i].robot.frame;
    distance_m += robots_[i].robot.frames.distance_m();
  }
  leveling_.on_tick(
      frames_, distance_m, [this]() -> const HeightField& { return plant_.terrain(); },
      take_point_);
  if (observer_ != nullptr) {
    if (robots_.size() > 1) observer_->on_further_robots(std::span(frames_).subspan(1));
    observer_->on_tick(frames_[0], plant_.terrain());
  }
  pacer_.wait_until(plant_.time_s());
}

void RunLoop::on_leveling(const LevelingPoint& point) {
  robots_[0].recorder.record_leveling(point);
  progress_.on_leveling(point);
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
///     }                                // and the robots behind the first do the same
class RunLoop::NativeTarget : public hal::Target {
 public:
  NativeTarget(RunLoop& loop, World& world, FurtherRobots& further)
      : loop_(loop), world_(world), further_(further) {}

  bool wait_for_tick() override {
    end_ = loop_.reason_to_end();
    if (end_.has_value()) return false;
    world_.advance();
    return true;
  }

  void read_sensors(SensorSample& sample) override {
    sample = world_.sample();
    loop_.on_sample(0, sample);
  }

  void write_outputs(const RobotOutput& output) override {
    loop_.on_output(0, output);
    world_.apply(output);
    further_.answer();
    loop_.end_tick();
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
  FurtherRobots& further_;
  std::optional<RunEnd> end_;
};

RunEnd RunLoop::run_native(FurtherRobots& further) {
  NativeTarget target(*this, world_.world(), further);
  hal::run_firmware(target);
  return target.end();
}

// ---- the flash image ---------------------------------------------------------------------------

/// World and microcontroller run on in lockstep until the program marks that it has read its
/// sensors, and then that it has set its outputs; the pins act on the world by themselves. The
/// robots behind the first answer whenever a control tick of the world ends meanwhile.
RunEnd RunLoop::run_image(CoSimulation& image, FurtherRobots& further) {
  image.on_native_tick([&further] { further.answer(); });
  while (true) {
    if (const std::optional<RunEnd> reason = reason_to_end()) return *reason;
    const SensorSample& sample = image.run_to_sample();
    // The program needs some milliseconds to start, so that it makes fewer ticks than a native one
    // in the same time: here the world's clock ends the run.
    if (plant_.time_s() > stop_.duration_s()) return RunEnd::kDone;
    on_sample(0, sample);
    on_output(0, image.run_to_output());
    end_tick();
  }
}

}  // namespace screed
