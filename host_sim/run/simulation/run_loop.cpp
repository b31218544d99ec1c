// The loop, its pace and its progress.
#include "host_sim/run/simulation/run_loop.h"

#include <thread>

#include "hal/sample.h"

namespace screed {

WallClock::Time WallClock::now() const {
  return std::chrono::steady_clock::now();
}

void WallClock::sleep_until(Time time) {
  std::this_thread::sleep_until(time);
}

Pacer::Pacer(WallClock& clock, bool realtime)
    : clock_(clock), realtime_(realtime), begin_(clock.now()) {}

void Pacer::wait_until(double simulated_s) {
  if (!realtime_) return;
  clock_.sleep_until(begin_ + std::chrono::duration_cast<WallClock::Time::duration>(
                                  std::chrono::duration<double>(simulated_s)));
}

double Pacer::elapsed_s() const {
  return std::chrono::duration<double>(clock_.now() - begin_).count();
}

// When to tell.

namespace {

constexpr uint64_t kProgressTicks = kTickRate_hz / 10;

}  // namespace

void Progress::on_leveling(const LevelingPoint& point) {
  now_m_ = point.level_deviation;
  if (!before_m_.has_value()) before_m_ = now_m_;
}

void Progress::on_tick(const StopCondition& stop, double time_s) const {
  if (!callback_) return;
  if (stop.ticks() % kProgressTicks == 0 || stop.done())
    callback_({stop.counted_s(time_s), stop.duration_s(), before_m_.value_or(0.0), now_m_});
}

// The order of things within a tick.

RunLoop::RunLoop(World& world, const RunParts& parts)
    : world_(world),
      plant_(world.plant()),
      robots_(parts.robots),
      leveling_(parts.leveling),
      stop_(parts.stop),
      progress_(parts.progress),
      pacer_(parts.pacer),
      observer_(parts.observer),
      before_(parts.before) {
  frames_.resize(robots_.size());
}

RunEnd RunLoop::run() {
  if (observer_ != nullptr) observer_->on_begin(before_, plant_.terrain());
  leveling_.begin(before_, take_point_);
  const RunEnd end = drive();
  leveling_.end(plant_.terrain(), take_point_);
  if (observer_ != nullptr) observer_->on_end();
  return end;
}

RunEnd RunLoop::drive() {
  while (true) {
    if (const std::optional<RunEnd> reason = reason_to_end()) return *reason;
    if (!world_.advance(this)) return RunEnd::kDone;
    end_tick();
  }
}

std::optional<RunEnd> RunLoop::reason_to_end() const {
  bool off_bed = false;
  for (size_t i = 0; i < robots_.size(); ++i)
    off_bed = off_bed || left_bed(before_, plant_.robot(i));
  return stop_.reason(off_bed);
}

/// An image needs some milliseconds to start, so that it makes fewer ticks than a native robot in
/// the same time: there the world's clock ends the run.
bool RunLoop::on_sample(size_t robot, SensorSample& sample) {
  if (stop_.is_over(plant_.time_s())) return false;
  WatchedRobot& watched = robots_[robot].robot;
  watched.sample = sample;
  // The shadow answers before the robot does: a frame shows what they think of this sample.
  watched.parity.tick(sample);
  watched.frame =
      watched.frames.record(plant_.time_s(), plant_.robot(robot), watched.parity.shadow());
  watched.ran = watched.ran || watched.parity.shadow().supervisor().running();
  // A bed of particles casts thousands of rays for its surface: it is asked for where it is needed.
  SessionRecorder& recorder = robots_[robot].recorder;
  if (recorder.records_heights()) recorder.observe_terrain(plant_.terrain());
  return true;
}

void RunLoop::on_output(size_t robot, RobotOutput& output) {
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
    observer_->on_tick(frames_, plant_.terrain());
  }
  pacer_.wait_until(plant_.time_s());
}

void RunLoop::on_leveling(const LevelingPoint& point) {
  robots_[0].recorder.record_leveling(point);
  progress_.on_leveling(point);
  if (observer_ != nullptr) observer_->on_leveling(point);
}

}  // namespace screed
