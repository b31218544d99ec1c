// Drives and their threads.
#include "nn/slip/slip_drive.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <thread>

#include "firmware/robot/robot.h"
#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/run/world/world.h"
#include "host_sim/run/world/world_setup.h"
#include "nn/slip/slip_archive.h"

namespace screed::nn {
namespace {

constexpr std::size_t kReportTicks = kTickRate_hz / 5;
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

SlipDrive recorded_drive(const StuckScenario& scenario, const TaskProgress& progress,
                         const std::filesystem::path& folder) {
  if (folder.empty()) return drive(scenario, progress);
  const std::filesystem::path file = folder / archive_name(scenario);
  if (std::optional<SlipDrive> found = read_drive(file, scenario)) return *std::move(found);
  SlipDrive driven = drive(scenario, progress);
  write_drive(file, driven);
  return driven;
}

}  // namespace

SlipTick slip_tick_of(const World& world) {
  const SensorSample& sample = world.sample();
  const Robot& robot = world.firmware();
  const VehicleState& vehicle = world.vehicle();
  const ChassisState chassis = vehicle.chassis();
  const Eigen::Vector3d velocity = chassis.pose.linear().transpose() * chassis.velocity;
  const DriveControl& drive = robot.drive();
  SlipTick tick{};
  tick.speed_left = drive.left().speed_dmm_per_s;
  tick.effort_left = drive.left().effort;
  tick.speed_right = drive.right().speed_dmm_per_s;
  tick.effort_right = drive.right().effort;
  std::copy_n(sample.imu.gyro(), tick.gyro.size(), tick.gyro.begin());
  std::copy_n(sample.imu.accel(), tick.accel.size(), tick.accel.begin());
  tick.sin_pitch_q14 = robot.attitude().angles().sin_pitch_q14;
  tick.yaw_rate = robot.attitude().yaw_rate();
  tick.running = robot.supervisor().running();
  tick.speed = static_cast<float>(velocity.x());
  tick.turn = static_cast<float>(chassis.omega_body.z() * kHalfTread_m);
  tick.track_left = static_cast<float>(vehicle.track_speed_m_per_s(kLeft));
  tick.track_right = static_cast<float>(vehicle.track_speed_m_per_s(kRight));
  return tick;
}

SlipDrive drive_of(const StuckScenario& scenario) {
  const Experiment& e = scenario.experiment;
  return {e.experiment.seed, scenario.kind, scenario.ground, e.trap.kind, {}, {}};
}

SlipDrive drive(const StuckScenario& scenario, const TaskProgress& progress) {
  SlipDrive driven = drive_of(scenario);
  const Experiment& e = scenario.experiment;
  try {
    const std::unique_ptr<World> world = make_world(e);
    const auto ticks =
        static_cast<std::size_t>(std::lround(e.experiment.duration_s * kTickRate_hz));
    driven.ticks.reserve(ticks);
    for (std::size_t i = 0; i < ticks; ++i) {
      if (i % kReportTicks == 0) report_progress(progress, kTask, i, ticks);
      world->advance();
      driven.ticks.push_back(slip_tick_of(*world));
      if (world->firmware().supervisor().faults() != 0) break;
    }
  } catch (const RunError& error) {
    driven.failure = error.what();
  }
  return driven;
}

std::vector<SlipDrive> drive_all(const std::vector<StuckScenario>& scenarios, unsigned threads,
                                 const TaskProgress& progress,
                                 const std::filesystem::path& folder) {
  MadeFolders folders;
  if (!folder.empty()) folders.make(folder);
  std::vector<SlipDrive> runs(scenarios.size());
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
        runs[i] = recorded_drive(scenarios[i], of_drive, folder);
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
