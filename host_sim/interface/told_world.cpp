// Actions, ticks and rows of a world.
#include "host_sim/interface/told_world.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "hal/sample.h"
#include "host_sim/interface/checks.h"
#include "host_sim/leveling/leveling_meter.h"
#include "schema/class_values.h"

namespace screed::interface {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

void check_action(const screed_action& action) {
  if (action.control == SCREED_COMMAND) {
    require(std::abs(action.values[0]) <= 1.0, "speed", action.values[0], "-1 to 1 m/s");
    require(std::abs(action.values[1]) <= 2.0 * std::numbers::pi, "yaw rate", action.values[1],
            "-6.28 to 6.28 rad/s");
  } else if (action.control == SCREED_DUTY) {
    for (const double share : action.values)
      require(std::abs(share) <= 1.0, "duty", share, "-1 to 1");
  } else if (action.control != SCREED_FIRMWARE) {
    throw InputError("control = " + std::to_string(action.control) +
                     "; allowed: 0 to 2 (screed_control)");
  }
}

}  // namespace

std::span<const Column> columns_of(int table) {
  switch (table) {
    case SCREED_FRAMES:
      return kFrameColumns;
    case SCREED_SAMPLES:
      return kSampleColumns;
    case SCREED_OUTPUTS:
      return kOutputColumns;
    case SCREED_LEVELING:
      return kLevelingColumns;
    default:
      return {};
  }
}

void check_ticks(int ticks) {
  require(ticks >= 1 && ticks <= 1000000, "ticks", ticks, "1 to 1000000");
}

void check_table(int table) {
  if (table < SCREED_FRAMES || table > SCREED_OUTPUTS) {
    throw InputError("table = " + std::to_string(table) +
                     "; allowed: 0 to 2 (screed_table, without SCREED_LEVELING)");
  }
}

ToldWorld::ToldWorld(std::shared_ptr<const PreparedWorld> prepared, uint64_t seed)
    : prepared_(std::move(prepared)) {
  reset(seed);
}

void ToldWorld::check_actions(std::span<const screed_action> actions) const {
  for (size_t i = 0; i < actions.size(); ++i) {
    check_action(actions[i]);
    const int16_t algorithm = world_->robot(i).settings().parameters.algorithm();
    if (actions[i].control == SCREED_COMMAND &&
        algorithm != static_cast<int16_t>(LevelingAlgorithm::kDrive))
      throw InputError("control = 1, a command: needs [experiment] algorithm = drive");
  }
}

void ToldWorld::reset(uint64_t seed) {
  check_seed(seed, *prepared_);
  PreparedWorld its = *prepared_;
  its.options.seed = seed;
  world_ = make_standin_world(its);
  actions_.assign(world_->robots(), {});
  recorders_.assign(world_->robots(), {});
  frames_.assign(world_->robots(), {});
}

void ToldWorld::on_output(size_t robot, RobotOutput& output) {
  const screed_action& action = actions_[robot];
  if (action.control != SCREED_DUTY) return;
  const auto duty = [](double share) {
    return static_cast<int16_t>(std::lround(share * kDutyMax));
  };
  output.duty_left = duty(action.values[0]);
  output.duty_right = duty(action.values[1]);
}

void ToldWorld::record() {
  for (size_t i = 0; i < frames_.size(); ++i)
    frames_[i] =
        recorders_[i].record(world_->time_s(), world_->plant().robot(i), world_->firmware(i));
}

void ToldWorld::advance(int ticks, std::span<const screed_action> actions) {
  for (size_t i = 0; i < actions.size(); ++i) {
    GroundStation& station = world_->ground_station(i);
    if (actions[i].control == SCREED_COMMAND) {
      station.drive(DriveCommand{actions[i].values[0], actions[i].values[1] * kDegPerRad});
    } else if (actions_[i].control == SCREED_COMMAND) {
      station.drive(prepared_->options.robots[i].drive);
    }
    actions_[i] = actions[i];
  }
  for (int left = ticks; left > 0; --left) {
    world_->advance(this);
    if (left <= 2) record();  // a frame has the changes since the one before
  }
}

void ToldWorld::copy_row(size_t robot, int table, uint8_t* row) const {
  if (table == SCREED_FRAMES) {
    pack(frames_[robot], FrameRow(row, kFrameBytes));
  } else if (table == SCREED_SAMPLES) {
    pack(world_->sample(robot), SampleRow(row, kSampleBytes));
  } else {
    pack(world_->output(robot), OutputRow(row, kOutputBytes));
  }
}

screed_level ToldWorld::level(bool with_transport) const {
  const HeightField& ground = world_->terrain();
  const RobotScaleFigures figures = robot_scale_figures(ground, 0.0);
  screed_level level = {figures.level_deviation_m, figures.relief_m, figures.roughness_m,
                        std::nan(""), std::nan("")};
  if (with_transport) {
    const GroundBlocks blocks = ground_blocks(ground);
    level.transport = least_transport(blocks);
    level.transport_squared = least_squared_transport(blocks);
  }
  return level;
}

}  // namespace screed::interface
