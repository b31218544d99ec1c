// Keeping pace with the clock, or counting frames.
#include "tools/screed/viewer/live_viewer.h"

#include <algorithm>
#include <thread>

#include "hal/sample.h"
#include "host_sim/run/experiment/robot_model.h"
#include "host_sim/run/simulation/simulation.h"
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

}  // namespace screed::viewer
