// Runs and their figures.
#include "nn/slip/stuck_run.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <thread>

#include "firmware/robot/robot.h"
#include "host_sim/core/errors.h"
#include "host_sim/run/world/world.h"
#include "host_sim/run/world/world_setup.h"

namespace screed::nn {
namespace {

constexpr std::size_t kSecond = kTickRate_hz;
constexpr std::size_t kReportTicks = kSecond / 5;
constexpr double kSmoothing = 1.0 / 8.0;
constexpr float kMinDrivenSpeed = 0.03F;  ///< of tracks that count as driven, m/s
constexpr double kHalfTread_m = 0.0975;
constexpr const char* kTask = "driving";

/// What all threads have driven.
class SharedProgress {
 public:
  SharedProgress(const TaskProgress& progress, double all_s) : progress_(progress), all_s_(all_s) {}

  /// Of one drive of that duration, by the thread that drives it.
  TaskProgress of_drive(double duration_s) {
    return [this, duration_s, counted_s = 0.0](std::string_view task, double share) mutable {
      const std::scoped_lock lock(mutex_);
      done_s_ += share * duration_s - counted_s;
      counted_s = share * duration_s;
      report_progress(progress_, task, std::min(1.0, done_s_ / all_s_));
    };
  }

 private:
  const TaskProgress& progress_;
  double all_s_;
  std::mutex mutex_;
  double done_s_ = 0.0;
};

}  // namespace

SlipTick slip_tick_of(const World& world, const Robot& robot) {
  const VehicleState& vehicle = world.vehicle();
  const ChassisState chassis = vehicle.chassis();
  const Eigen::Vector3d velocity = chassis.pose.linear().transpose() * chassis.velocity;
  const double left = vehicle.track_speed_m_per_s(kLeft);
  const double right = vehicle.track_speed_m_per_s(kRight);
  const SlipWatch& watch = robot.slip_watch();
  SlipTick tick{};
  std::copy_n(watch.network_inputs(), kSlipInputs, tick.inputs.begin());
  tick.running = robot.supervisor().running();
  const DriveControl& drive = robot.drive();
  tick.evaluated =
      std::max(std::abs(drive.speed_left_dmm_per_s()), std::abs(drive.speed_right_dmm_per_s())) >=
      SlipWatch::kMinTrackSpeed_dmm_per_s;
  tick.speed = static_cast<float>(velocity.x());
  tick.turn = static_cast<float>(chassis.omega_body.z() * kHalfTread_m);
  tick.faster_track = static_cast<float>(std::max(std::abs(left), std::abs(right)));
  tick.backwards = left + right < 0.0;
  tick.slips = watch.slips();
  tick.stuck = watch.stuck();
  tick.stalled = (robot.supervisor().faults() & (Fault::kStallLeft | Fault::kStallRight)) != 0;
  return tick;
}

SlipRun drive(const StuckScenario& scenario, const TaskProgress& progress) {
  SlipRun run{scenario, {}, {}};
  const Experiment& e = scenario.experiment;
  try {
    const std::unique_ptr<World> world = make_world(e, nullptr);
    Robot robot(board_constants_of(kDefaultBoard), e.parameters, credentials_of(e));
    RobotOutput output{};
    const auto ticks =
        static_cast<std::size_t>(std::lround(e.experiment.duration_s * kTickRate_hz));
    run.ticks.reserve(ticks);
    for (std::size_t i = 0; i < ticks; ++i) {
      if (i % kReportTicks == 0) report_progress(progress, kTask, i, ticks);
      world->advance();
      robot.tick(world->sample(), output);
      run.ticks.push_back(slip_tick_of(*world, robot));
      world->apply(output);
      if (robot.supervisor().faults() != 0) break;
    }
  } catch (const RunError& error) {
    run.failure = error.what();
  }
  return run;
}

double travel_share(const SlipRun& run, std::size_t begin, std::size_t end) {
  double distance = 0.0;
  double turn = 0.0;
  double of_track = 0.0;
  for (std::size_t i = begin; i < end; ++i) {
    distance += static_cast<double>(run.ticks[i].speed);
    turn += static_cast<double>(run.ticks[i].turn);
    of_track += static_cast<double>(run.ticks[i].faster_track);
  }
  return of_track <= 0.0 ? 1.0 : (std::abs(distance) + std::abs(turn)) / of_track;
}

std::optional<std::size_t> dug_in_at(const SlipRun& run) {
  double speed = 0.0;
  double turn = 0.0;
  double faster_track = 0.0;
  for (std::size_t i = 0; i + kSecond <= run.ticks.size(); ++i) {
    const SlipTick& tick = run.ticks[i];
    speed += (static_cast<double>(tick.speed) - speed) * kSmoothing;
    turn += (static_cast<double>(tick.turn) - turn) * kSmoothing;
    faster_track += (static_cast<double>(tick.faster_track) - faster_track) * kSmoothing;
    if (!tick.running || tick.faster_track < kMinDrivenSpeed) continue;
    if (std::abs(speed) + std::abs(turn) > (kDugInShare + 0.05) * faster_track) continue;
    if (travel_share(run, i, i + kSecond) < kDugInShare) return i;
  }
  return std::nullopt;
}

DetectionResult detection_of(const SlipRun& run, std::size_t dug_in) {
  const std::size_t begin = dug_in > kSecond ? dug_in - kSecond : 0;
  const std::size_t end = std::min(dug_in + kSecond + 1, run.ticks.size());
  for (std::size_t i = begin; i < end; ++i) {
    if (!run.ticks[i].stuck && !run.ticks[i].stalled) continue;
    return {true, i > dug_in ? static_cast<double>(i - dug_in) / kTickRate_hz : 0.0};
  }
  return {};
}

FreeResult alarms_of(const SlipRun& run) {
  FreeResult result;
  for (std::size_t i = 0; i < run.ticks.size(); ++i) {
    if (run.ticks[i].evaluated && run.ticks[i].running) result.driven_s += 1.0 / kTickRate_hz;
    if (i == 0 || !run.ticks[i].stuck || run.ticks[i - 1].stuck) continue;
    const std::size_t begin = i > kSecond / 2 ? i - kSecond / 2 : 0;
    const std::size_t end = std::min(i + kSecond / 2, run.ticks.size());
    if (travel_share(run, begin, i + 1) > kFreeShare) {
      ++result.false_alarms;
    } else if (travel_share(run, begin, end) > kFreeShare) {
      ++result.recovered_alarms;
    } else {
      ++result.other_alarms;
    }
  }
  return result;
}

std::vector<SlipRun> drive_all(const std::vector<StuckScenario>& scenarios, unsigned threads,
                               const TaskProgress& progress) {
  std::vector<SlipRun> runs(scenarios.size());
  double all_s = 0.0;
  for (const StuckScenario& scenario : scenarios)
    all_s += scenario.experiment.experiment.duration_s;
  SharedProgress shared(progress, all_s);
  std::atomic<std::size_t> next = 0;
  std::mutex mutex;
  std::exception_ptr failure;
  const auto work = [&] {
    try {
      for (std::size_t i = next++; i < scenarios.size(); i = next++) {
        const TaskProgress of_drive =
            shared.of_drive(scenarios[i].experiment.experiment.duration_s);
        runs[i] = drive(scenarios[i], of_drive);
        of_drive(kTask, 1.0);  // of one that ended early
      }
    } catch (...) {
      const std::scoped_lock lock(mutex);
      failure = std::current_exception();
      next = scenarios.size();
    }
  };
  std::vector<std::jthread> others;
  for (unsigned i = 1; i < threads; ++i) others.emplace_back(work);
  work();
  others.clear();  // joins
  if (failure) std::rethrow_exception(failure);
  return runs;
}

}  // namespace screed::nn
