// Their turn in a tick.
#include "host_sim/run/simulation/further_robots.h"

#include <utility>

namespace screed {

FurtherRobots::FurtherRobots(World& world, std::span<const RobotSettings> settings,
                             RobotWatch watch)
    : world_(world), watch_(std::move(watch)) {
  for (const RobotSettings& own : settings.subspan(1))
    robots_.emplace_back(own.board, own.parameters, own.credentials);
  outputs_.resize(robots_.size());
}

void FurtherRobots::answer() {
  for (size_t i = 0; i < robots_.size(); ++i) {
    const size_t number = i + 1;
    const SensorSample& sample = world_.sample(number);
    if (watch_.sample) watch_.sample(number, sample);
    robots_[i].tick(sample, outputs_[i]);
    if (watch_.output) watch_.output(number, outputs_[i]);
    world_.apply(outputs_[i], number);
  }
}

}  // namespace screed
