#include "host_sim/run/world/world.h"

#include <algorithm>
#include <string>
#include <utility>

#include "host_sim/core/errors.h"
#include "host_sim/run/world/image_robot.h"
#include "host_sim/run/world/native_robot.h"

namespace screed {

World::World(std::unique_ptr<Environment> plant, const WorldOptions& options)
    : plant_(std::move(plant)), duty_ratios_(plant_->robots()) {
  if (options.robots.size() != plant_->robots()) {
    throw InputError("a world of " + std::to_string(plant_->robots()) + " robots with options of " +
                     std::to_string(options.robots.size()) + "; as many are needed");
  }
  for (size_t i = 0; i < plant_->robots(); ++i) {
    robots_.push_back(options.robots[i].image.has_value()
                          ? make_image_robot(options, *plant_, i)
                          : std::make_unique<NativeRobot>(options, *plant_, i));
  }
}

void World::step() {
  if (plant_->steps() == ticks_ * static_cast<uint64_t>(plant_->steps_per_tick())) {
    ++ticks_;
    for (const auto& robot : robots_) robot->begin_tick(ticks_);
  }
  for (size_t i = 0; i < robots_.size(); ++i) duty_ratios_[i] = robots_[i]->duty_ratio();
  plant_->step(duty_ratios_);
  for (const auto& robot : robots_) robot->end_step();
}

bool World::advance(RobotWatch* watch) {
  std::vector<bool> answered(robots_.size(), false);
  do {
    step();
    for (size_t i = 0; i < robots_.size(); ++i) {
      const RobotController::Progress progress = robots_[i]->live(watch);
      if (progress == RobotController::Progress::kOver) return false;
      if (progress == RobotController::Progress::kAnswered) answered[i] = true;
    }
  } while (std::find(answered.begin(), answered.end(), false) != answered.end());
  return true;
}

}  // namespace screed
