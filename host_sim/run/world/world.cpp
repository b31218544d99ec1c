// Robots in one world.
#include "host_sim/run/world/world.h"

#include <utility>

#include "host_sim/run/world/robot_number.h"

namespace screed {
namespace {

WorldOptions options_of_robot(const WorldOptions& options, size_t number) {
  WorldOptions own = options;
  if (number == 0) return own;
  own.seed = seed_of_robot(options.seed, number);
  own.ground_key = key_of_robot(options.ground_key, number);
  if (number <= options.further_drives.size()) own.drive = options.further_drives[number - 1];
  own.lay_on_side_at_s.reset();
  own.ground_port = nullptr;
  return own;
}

std::ostream* log_of_robot(const WorldOptions& options, std::ostream* first, size_t number) {
  if (number == 0) return first;
  const auto& further = options.further_telemetry_logs;
  return number <= further.size() ? further[number - 1] : nullptr;
}

}  // namespace

World::World(HeightField terrain, const Assembly& model, const BoardConstants& board,
             const WorldOptions& options, std::ostream* telemetry_log,
             const ControllerFactory& first)
    : World(std::make_unique<Plant>(std::move(terrain), model, options), board, options,
            telemetry_log, first) {}

World::World(std::unique_ptr<Environment> plant, const BoardConstants& board,
             const WorldOptions& options, std::ostream* telemetry_log,
             const ControllerFactory& first)
    : plant_(std::move(plant)), duty_ratios_(plant_->robots()) {
  for (size_t i = 0; i < plant_->robots(); ++i) {
    const WorldOptions own = options_of_robot(options, i);
    std::ostream* const log = log_of_robot(options, telemetry_log, i);
    if (i == 0 && first) {
      robots_.push_back(first(own, plant_->robot(i), log));
      natives_.push_back(nullptr);
      continue;
    }
    auto native = std::make_unique<NativeRobot>(own, board, plant_->robot(i), log);
    natives_.push_back(native.get());
    robots_.push_back(std::move(native));
  }
}

bool World::at_end_of_tick() const {
  return plant_->steps() == ticks_ * static_cast<uint64_t>(plant_->steps_per_tick());
}

void World::step() {
  if (at_end_of_tick()) {
    ++ticks_;
    for (const auto& robot : robots_) robot->begin_tick(ticks_);
  }
  for (size_t i = 0; i < robots_.size(); ++i) duty_ratios_[i] = robots_[i]->duty_ratio();
  plant_->step_all(duty_ratios_);
  for (const auto& robot : robots_) robot->end_step();
}

void World::advance() {
  do {
    step();
  } while (!at_end_of_tick());
}

}  // namespace screed
