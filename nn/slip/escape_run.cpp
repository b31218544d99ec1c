// Trials from the same stuck state.
#include "nn/slip/escape_run.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>

#include "firmware/robot/robot.h"
#include "host_sim/core/errors.h"
#include "host_sim/run/simulation/outcome.h"
#include "host_sim/run/world/world.h"
#include "host_sim/run/world/world_setup.h"
#include "nn/slip/slip_drive.h"
#include "nn/slip/stuck_rules.h"

namespace screed::nn {
namespace {

constexpr double kDrive_s = 14.0;  ///< until the alarm, at most
constexpr std::size_t kHalfSecond = kTickRate_hz / 2;
constexpr std::uint64_t kEscapeReportTicks = kTickRate_hz / 5;
constexpr double kAngleUnitsPerDegree = 65536.0 / 360.0;

/// The oracle's hands on the motors: the robot's drive control with other commands.
class Driver : public RobotWatch {
 public:
  /// Of the world's robot, from now on.
  Driver(const Manoeuvre& manoeuvre, const World& world)
      : manoeuvre_(manoeuvre),
        world_(world),
        control_(board_constants_of(kDefaultBoard), world.robot().settings().parameters),
        left_(world.sample().encoder_left),
        right_(world.sample().encoder_right) {}

  void on_output(std::size_t /*robot*/, RobotOutput& output) override {
    const SensorSample& sample = world_.sample();
    const DriveMeasurement measured = {
        static_cast<std::int16_t>(static_cast<std::uint16_t>(sample.encoder_left - left_)),
        static_cast<std::int16_t>(static_cast<std::uint16_t>(sample.encoder_right - right_)),
        world_.firmware().attitude().yaw_rate(), kBattery_mv};
    left_ = sample.encoder_left;
    right_ = sample.encoder_right;
    const DriveOutput duty = control_.tick(command(), measured);
    output.duty_left = duty.duty_left;
    output.duty_right = duty.duty_right;
  }

 private:
  static constexpr std::uint16_t kBattery_mv = 7200;

  MotionCommand command() {
    const ManoeuvreStep* step = &manoeuvre_.steps[step_];
    if (ticks_ >= std::lround(step->duration_s * kTickRate_hz)) {
      step_ = (step_ + 1) % manoeuvre_.steps.size();
      step = &manoeuvre_.steps[step_];
      ticks_ = 0;
    }
    ++ticks_;
    return {static_cast<std::int16_t>(std::lround(step->speed_m_per_s * 1000.0)),
            static_cast<YawRate>(std::lround(step->turn_deg_per_s * kAngleUnitsPerDegree))};
  }

  const Manoeuvre& manoeuvre_;
  const World& world_;
  DriveControl control_;
  std::uint16_t left_;
  std::uint16_t right_;
  std::size_t step_ = 0;
  long ticks_ = 0;
};

struct Trial {
  bool stuck = false;
  double alarm_s = 0.0;
  bool out = false;
  double out_s = 0.0;
  std::uint16_t faults = 0;
  bool failed = false;  ///< the physics
};

/// One drive: to the alarm, and from there as parameters and manoeuvre (may be null) say.
Trial run_trial(const StuckScenario& scenario, const Parameters& parameters,
                const Manoeuvre* manoeuvre, const TaskProgress& progress) {
  Experiment e = scenario.experiment;
  e.parameters = parameters;
  const std::unique_ptr<World> world = make_world(e);
  const Robot& robot = world->firmware();
  SlipDrive run = drive_of(scenario);
  std::optional<Driver> driver;
  Trial trial;
  Eigen::Vector2d alarm_position = Eigen::Vector2d::Zero();
  const double after_s = manoeuvre == nullptr ? kEscapeTime_s : kManoeuvreTime_s;
  while (world->time_s() < (trial.stuck ? trial.alarm_s + after_s : kDrive_s)) {
    if (world->ticks() % kEscapeReportTicks == 0) report_progress(progress, "driving", 0.0);
    world->advance(driver ? &*driver : nullptr);
    const Eigen::Vector2d position = world->plant().robot(0).unwrapped_position().head<2>();
    if (trial.stuck) {
      trial.faults = robot.supervisor().faults();
      if (trial.faults != 0 && !driver) break;
      if ((position - alarm_position).norm() >= kEscapeDistance_m) {
        trial.out = true;
        trial.out_s = world->time_s() - trial.alarm_s;
        break;
      }
    } else {
      trial.faults = robot.supervisor().faults();
      if (trial.faults != 0) break;
      run.ticks.push_back(slip_tick_of(*world));
      const std::size_t end = run.ticks.size();
      if (run.ticks.back().running && robot.slip_watch().stuck()) {
        if (TrueMotion(run).travel_share(end - std::min(end, kHalfSecond), end) > kFreeShare) break;
        trial.stuck = true;
        trial.alarm_s = world->time_s();
        alarm_position = position;
        if (manoeuvre != nullptr) driver.emplace(*manoeuvre, *world);
      }
    }
  }
  return trial;
}

/// The same, where physics that fails is a drive that leads nowhere.
Trial trial_of(const StuckScenario& scenario, const Parameters& parameters,
               const Manoeuvre* manoeuvre, const TaskProgress& progress) {
  try {
    return run_trial(scenario, parameters, manoeuvre, progress);
  } catch (const RunError&) {
    return {.failed = true};
  }
}

/// Those that get most robots out first.
std::vector<Manoeuvre> make_manoeuvres() {
  Manoeuvre rock_and_back = {"rock, then back", {}};
  for (int i = 0; i < 8; ++i) {
    rock_and_back.steps.push_back({0.5, -0.25, 0.0});
    rock_and_back.steps.push_back({0.5, 0.25, 0.0});
  }
  rock_and_back.steps.push_back({2.0, -0.25, 0.0});
  return {
      {"rock 0.5 s", {{0.5, -0.25, 0.0}, {0.5, 0.25, 0.0}}},
      {"back", {{10.0, -0.2, 0.0}}},
      {"turn right, then ahead", {{2.0, 0.0, -60.0}, {3.0, 0.15, 0.0}}},
      rock_and_back,
      {"rock 0.8 s", {{0.8, -0.25, 0.0}, {0.8, 0.25, 0.0}}},
      {"rock 0.3 s", {{0.3, -0.25, 0.0}, {0.3, 0.25, 0.0}}},
      {"rock, more back", {{0.7, -0.25, 0.0}, {0.4, 0.25, 0.0}}},
      {"rock, turning", {{0.5, -0.2, 30.0}, {0.5, 0.2, -30.0}}},
      {"alternate tracks", {{0.5, -0.1, 60.0}, {0.5, -0.1, -60.0}}},
      {"back wagging", {{0.7, -0.15, 40.0}, {0.7, -0.15, -40.0}}},
      {"turn left, then ahead", {{2.0, 0.0, 60.0}, {3.0, 0.15, 0.0}}},
      {"back in an arc to the left", {{10.0, -0.12, 30.0}}},
      {"ahead in an arc to the right", {{10.0, 0.12, -30.0}}},
      {"ahead", {{10.0, 0.2, 0.0}}},
  };
}

}  // namespace

const std::vector<Manoeuvre>& oracle_manoeuvres() {
  static const std::vector<Manoeuvre> kAll = make_manoeuvres();
  return kAll;
}

StuckScenario escape_scenario(std::uint64_t seed) {
  StuckScenario scenario = stuck_scenario(seed, ScenarioKind::kTrapped, kDrive_s + kEscapeTime_s);
  Experiment& e = scenario.experiment;
  e.parameters.escape_attempts() = Parameters{}.escape_attempts();
  if (e.experiment.algorithm != "drive") return scenario;
  e.experiment.algorithm = "random_walk";
  e.parameters.algorithm() = algorithm_number(e.experiment.algorithm);
  const auto speed = static_cast<std::int16_t>(std::lround(e.drive.speed_m_per_s * 1000.0));
  e.parameters.walk_speed_min() = speed;
  e.parameters.walk_speed_max() = speed;
  e.parameters.walk_yaw_rate_max() =
      static_cast<std::int16_t>(std::lround(std::abs(e.drive.yaw_rate_deg_per_s)));
  e.drive = {};
  return scenario;
}

EscapeResult escape_trials(std::uint64_t seed, const EscapeOptions& options,
                           const TaskProgress& progress) {
  EscapeResult result;
  result.scenario = escape_scenario(seed);
  const Parameters escaping = result.scenario.experiment.parameters;
  Parameters plain = escaping;
  plain.escape_attempts() = 0;
  const Trial alone = trial_of(result.scenario, plain, nullptr, progress);
  result.alarm_s = alone.alarm_s;
  if (!alone.stuck) {
    if (alone.faults != 0) result.fault = fault_names(alone.faults);
    return result;
  }
  const Trial escape = trial_of(result.scenario, escaping, nullptr, progress);
  // The drives are the same to the bit, or they are not.
  const bool same = escape.stuck && escape.alarm_s == alone.alarm_s;
  result.backed_off = !same && escape.faults == 0 && !escape.failed;
  if (result.backed_off) return result;
  result.stuck = true;
  result.out_alone = alone.out;
  result.out_escape = escape.out;
  result.escape_s = escape.out_s;
  result.held = (escape.faults & Fault::kStuck) != 0;
  const auto other = static_cast<std::uint16_t>(escape.faults & ~Fault::kStuck);
  if (other != 0) result.fault = fault_names(other);
  result.recoverable = result.out_alone || result.out_escape;
  if (!options.oracle) return result;
  for (const Manoeuvre& manoeuvre : oracle_manoeuvres()) {
    if (result.recoverable && !options.all_manoeuvres) break;
    result.out_by.push_back(trial_of(result.scenario, plain, &manoeuvre, progress).out);
    result.recoverable = result.recoverable || result.out_by.back();
  }
  return result;
}

}  // namespace screed::nn
