// Keeping pace with the clock, or counting frames; a play head over a session.
#include "tools/screed/viewer/run_viewers.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <tuple>

#include "hal/sample.h"
#include "host_sim/core/errors.h"
#include "host_sim/run/experiment/robot_model.h"
#include "host_sim/run/experiment/run_setup.h"
#include "host_sim/run/session/export.h"
#include "host_sim/run/session/run_folder.h"
#include "host_sim/run/simulation/simulation.h"
#include "schema/values.h"
#include "tools/screed/cli/interrupt.h"

namespace screed::viewer {
namespace {

constexpr double kDriveSpeed_m_per_s = 0.18;
constexpr double kDriveTurn_deg_per_s = 60.0;
constexpr double kFullPaceFramesPerSecond = 20.0;  // most of the time is for the simulation
constexpr double kMaxLag_s = 0.25;                 // what is lost beyond it is not made good
constexpr int kPausedWait_ms = 15;

std::chrono::steady_clock::duration seconds(double value) {
  return std::chrono::duration_cast<std::chrono::steady_clock::duration>(
      std::chrono::duration<double>(value));
}

}  // namespace

LiveViewer::LiveViewer(const Experiment& experiment, const std::string& board,
                       const ViewerOptions& options, KeyboardDriver& driver,
                       std::function<void()> end_run)
    : options_(options),
      setup_(
          display_setup(experiment, experiment.soil.preset, make_robot_model(experiment, board))),
      driver_(driver),
      end_run_(std::move(end_run)) {
  // A training drive lasts for its frames, and some seconds before them.
  if (experiment.experiment.algorithm != kTrainingDriveName)
    check_screenshot_time(options_, setup_.duration_s, "the run");
}

void LiveViewer::on_begin(const HeightField& before, const HeightField& ground) {
  watch_.emplace(ground);
  display_.emplace(options_, setup_, before, ground);
  display_->set_driver(driver_.driver());
}

void LiveViewer::on_tick(std::span<const SimFrame> frames, const HeightField& ground) {
  display_->change_terrain(watch_->changes(ground));
  display_->set_frames(frames);
  for (size_t i = 0; i < frames.size(); ++i) {
    ShownRobot& shown = display_->robots()[i];
    shown.robot.travel_left_m += frames[i].track_left / kTickRate_hz;
    shown.robot.travel_right_m += frames[i].track_right / kTickRate_hz;
    if (ticks_ % kTrailTicks == 0) shown.trail.push_back(trail_point(frames[i]));
  }
  ++ticks_;
  time_s_ = frames.front().time;
  if (!options_.window) {
    display_->handle_input(time_s_, 0);
    steer();
    if (display_->capture_is_due()) display_->show();
  } else if (options_.frames.has_value()) {
    show_counted(time_s_);
  } else {
    keep_pace(time_s_);
  }
  display_->save_when_due(time_s_, false);
  if (display_->controls().closed || display_->all_shown()) end_run_();
}

void LiveViewer::on_leveling(const LevelingPoint& point) {
  display_->add_leveling(point);
}

void LiveViewer::steer() {
  Controls& controls = display_->controls();
  if (controls.hand_back) driver_.hand_back();
  if (controls.clear_fault) driver_.clear_fault();
  if (controls.emergency_stop) driver_.emergency_stop();
  controls.hand_back = false;
  controls.clear_fault = false;
  controls.emergency_stop = false;
  if (controls.drives() || driver_.drives()) {
    driver_.drive(
        {controls.forward() * kDriveSpeed_m_per_s, controls.left() * kDriveTurn_deg_per_s},
        controls.driven_by_gamepad());
  }
  display_->set_driver(driver_.driver(), driver_.description());
}

void LiveViewer::show_counted(double time_s) {
  display_->handle_input(time_s, 0);
  steer();
  // Nobody presses a key that would end a pause.
  while (!display_->all_shown() && (time_s >= next_show_s_ || display_->controls().paused)) {
    display_->show();
    next_show_s_ += display_->controls().pace / ViewerDisplay::kFramesPerSecond;
    if (display_->controls().pace == 0.0) break;
  }
}

void LiveViewer::keep_pace(double time_s) {
  Controls& controls = display_->controls();
  Clock::time_point now = Clock::now();
  if (!anchor_.has_value() || controls.pace != anchor_pace_) {
    anchor_ = now;
    anchor_s_ = time_s;
    anchor_pace_ = controls.pace;
  }
  Clock::time_point target = now;
  if (controls.pace > 0.0) target = *anchor_ + seconds((time_s - anchor_s_) / controls.pace);
  if (now > target + seconds(kMaxLag_s)) anchor_.reset();
  for (;;) {
    if (now >= next_show_) {
      display_->handle_input(time_s, 0);
      steer();
      display_->show();
      const double rate =
          controls.pace == 0.0 ? kFullPaceFramesPerSecond : ViewerDisplay::kFramesPerSecond;
      next_show_ = std::max(next_show_ + seconds(1.0 / rate), now);
    }
    if (controls.closed || interrupted()) return;
    if (controls.paused) {
      anchor_.reset();
      if (controls.steps > 0) {
        --controls.steps;
        return;
      }
      display_->handle_input(time_s, kPausedWait_ms);
    } else {
      // A new pace begins with the next tick.
      if (now >= target || controls.pace != anchor_pace_) return;
      std::this_thread::sleep_until(std::min(target, next_show_));
    }
    now = Clock::now();
  }
}

void LiveViewer::on_end() {
  display_->save_when_due(time_s_, true);
}

void LiveViewer::hold(const std::string& notice) {
  if (!display_.has_value() || !options_.window || options_.frames.has_value()) return;
  display_->set_notice(notice);
  while (!display_->controls().closed && !interrupted()) {
    display_->show();
    display_->handle_input(time_s_, kPausedWait_ms);
  }
}

namespace {

constexpr uint64_t kBlockRows = 1024;
constexpr const char* kNoHeights =
    "Heights of the ticks were not recorded (sim --heights does): the terrain is that of the "
    "start, at the end that of the end.";

/// The terrain from which changes count, as in the summary of the run. Throws InputError.
HeightMap terrain_before(const SessionReader& session, const std::filesystem::path& run) {
  std::optional<HeightMap> before = session.terrain_before();
  if (!before && session.has_heights()) before = session.heights_after(0);
  if (!before) throw InputError(run.string() + ": the session holds no height map");
  const std::optional<HeightMap> after = session.terrain_after();
  if ((session.has_heights() && session.heights_after(0).geometry != before->geometry) ||
      (after && after->geometry != before->geometry)) {
    throw InputError(run.string() + ": the recorded terrains have different grids");
  }
  return std::move(*before);
}

}  // namespace

RecordedViewer::RecordedViewer(const std::filesystem::path& run, const ViewerOptions& options)
    : options_(options) {
  for (SessionReader& session : open_robots(run)) robots_.emplace_back(std::move(session));
  if (session().frames() == 0) throw InputError(run.string() + ": no frame was recorded");
  const HeightMap before = terrain_before(session(), run);
  const RunSetup setup = setup_of(session().info(), run);
  tick_s_ = 1.0 / session().info().tick_rate_hz;
  duration_s_ = static_cast<double>(session().frames()) * tick_s_;
  check_screenshot_time(options_, duration_s_, run.string());
  if (options_.window) require_screen();
  algorithm_ = setup.experiment.experiment.algorithm;
  DisplaySetup shown =
      display_setup(setup.experiment, setup.soil, robot_model(setup, session().info().board_name));
  shown.duration_s = duration_s_;
  shown.recorded = true;
  for (Recorded& robot : robots_) read_trail(robot);
  display_.emplace(options_, std::move(shown), field_of(before),
                   field_of(session().has_heights() ? session().heights_after(0) : before));
  for (const Recorded& robot : robots_) display_->robots().push_back({{}, robot.trail});
  for (const LevelingPoint& point : session().leveling()) display_->add_leveling(point);
  if (!session().has_heights()) {
    after_ = session().terrain_after();
    if (after_ && after_->heights == before.heights) after_.reset();
    if (after_) display_->set_notice(kNoHeights);
  }
  go_to(tick_s_);
}

void RecordedViewer::read_trail(Recorded& robot) {
  double left_m = 0.0;
  double right_m = 0.0;
  std::vector<SimFrame> rows;
  for (uint64_t first = 0; first < robot.session.frames(); first += rows.size()) {
    report_progress(options_.progress, "reading the run", first, robot.session.frames());
    rows.resize(std::min(kBlockRows, robot.session.frames() - first));
    robot.session.read(first, std::span(rows));
    for (size_t i = 0; i < rows.size(); ++i) {
      const SimFrame& row = rows[i];
      left_m += std::isfinite(row.track_left) ? row.track_left * tick_s_ : 0.0;
      right_m += std::isfinite(row.track_right) ? row.track_right * tick_s_ : 0.0;
      if ((first + i) % kTrailTicks != 0) continue;
      robot.trail.push_back(trail_point(row));
      robot.travel_m.emplace_back(left_m, right_m);
    }
  }
}

const SimFrame& RecordedViewer::frame(Recorded& robot, uint64_t row) {
  std::vector<SimFrame>& block = robot.block;
  if (block.empty() || row < robot.block_first || row >= robot.block_first + block.size()) {
    robot.block_first = row / kBlockRows * kBlockRows;
    block.resize(std::min(kBlockRows, robot.session.frames() - robot.block_first));
    robot.session.read(robot.block_first, std::span(block));
  }
  return block[row - robot.block_first];
}

/// The path and the ground up to this time.
void RecordedViewer::go_to(double time_s) {
  time_s_ = std::clamp(time_s, tick_s_, duration_s_);
  const auto ticks = std::clamp<uint64_t>(static_cast<uint64_t>(std::llround(time_s_ / tick_s_)), 1,
                                          session().frames());
  const size_t point = std::min(robots_.front().trail.size() - 1, (ticks - 1) / kTrailTicks);
  display_->show_trail_points(point + 1);
  std::vector<SimFrame> frames;
  for (size_t i = 0; i < robots_.size(); ++i) {
    frames.push_back(frame(robots_[i], ticks - 1));
    RobotMarker& shown = display_->robots()[i].robot;
    std::tie(shown.travel_left_m, shown.travel_right_m) = robots_[i].travel_m[point];
  }
  display_->set_frames(frames);
  Driver driver;
  driver.replay = true;
  driver.algorithm = algorithm_;
  if (frames.front().leveling_state == static_cast<int32_t>(message::LevelingState::kDrive))
    driver.kind = Driver::Kind::kUnknownStation;
  display_->set_driver(driver);
  show_terrain_after(ticks);
}

void RecordedViewer::show_terrain_after(uint64_t ticks) {
  const HeightMap* target = nullptr;
  std::optional<HeightMap> before;
  if (session().has_heights()) {
    target = &session().heights_after(ticks);
  } else if (after_) {
    const bool end = ticks == session().frames();
    if (end == at_end_) return;
    at_end_ = end;
    if (!end) before = session().terrain_before();
    target = end ? &*after_ : &*before;
  } else {
    return;
  }
  changes_.clear();
  const HeightField& shown = display_->ground();
  for (size_t i = 0; i < target->heights.size(); ++i) {
    const Height by = target->heights[i] - shown.node(i);
    if (by != 0) changes_.push_back({static_cast<uint32_t>(i), by});
  }
  display_->change_terrain(changes_);
}

void RecordedViewer::take_jumps() {
  Controls& controls = display_->controls();
  if (controls.to_share.has_value()) go_to(*controls.to_share * duration_s_);
  if (controls.jump_s.has_value()) go_to(time_s_ + *controls.jump_s);
  controls.to_share.reset();
  controls.jump_s.reset();
  for (; controls.steps > 0; --controls.steps) go_to(time_s_ + tick_s_);
}

void RecordedViewer::capture_frames() {
  constexpr double kCaptureFramesPerSecond = 25.0;
  const double pace = options_.pace > 0.0 ? options_.pace : 1.0;
  for (;;) {
    report_progress(options_.progress, "drawing frames", time_s_ / duration_s_);
    display_->handle_input(time_s_, 0);
    take_jumps();
    display_->show();
    display_->save_when_due(time_s_, false);
    if (!display_->failure().empty()) {
      display_->discard_film();
      return;
    }
    if (time_s_ >= duration_s_ || display_->controls().closed) break;
    go_to(time_s_ + pace / kCaptureFramesPerSecond);
  }
  display_->save_when_due(time_s_, true);
}

void RecordedViewer::run() {
  if (options_.window) {
    play();
  } else if (!options_.frames_dir.empty()) {
    try {
      capture_frames();
    } catch (const TaskStopped&) {
      display_->discard_film();
      throw;
    }
  } else {
    // Keys before that time are pressed: a picture of help, or of slopes.
    const double at = options_.screenshot_at.value_or(duration_s_);
    go_to(at);
    display_->handle_input(at, 0);
    take_jumps();
    display_->save_when_due(time_s_, true);
  }
  if (!display_->failure().empty()) throw RunError(display_->failure());
}

void RecordedViewer::play() {
  using Clock = std::chrono::steady_clock;
  Clock::time_point last = Clock::now();
  Clock::time_point next_show = last;
  constexpr std::chrono::microseconds kFramePeriod(
      static_cast<int64_t>(1e6 / ViewerDisplay::kFramesPerSecond));
  Controls& controls = display_->controls();
  while (!controls.closed && !interrupted() && !display_->all_shown()) {
    if (!options_.frames.has_value()) std::this_thread::sleep_until(next_show);
    next_show = std::max(next_show + kFramePeriod, Clock::now());
    display_->handle_input(time_s_, 0);
    take_jumps();
    const Clock::time_point now = Clock::now();
    const double frame_s = options_.frames.has_value()
                               ? 1.0 / ViewerDisplay::kFramesPerSecond
                               : std::chrono::duration<double>(now - last).count();
    last = now;
    // As fast as it goes is here as fast as anybody can look.
    constexpr double kFullPace = 100.0;
    const double pace = controls.pace > 0.0 ? controls.pace : kFullPace;
    if (!controls.paused) go_to(time_s_ + pace * frame_s);
    display_->show();
    display_->save_when_due(time_s_, false);
  }
  display_->save_when_due(time_s_, true);
}

}  // namespace screed::viewer
