// hal.h for hosts: forwards to the current target of this thread.
#include "hal/hal.h"

#include "hal/host/target.h"

namespace screed {
namespace hal {
namespace {

thread_local Target* current = nullptr;

}  // namespace

void init() {
  current->init();
}
const BoardConstants& board_constants() {
  return current->board_constants();
}
const Parameters& parameters() {
  return current->parameters();
}
const Credentials& credentials() {
  return current->credentials();
}
bool parameters_intact() {
  return true;  // those of an experiment are checked when it is read
}
bool wait_for_tick() {
  return current->wait_for_tick();
}
void read_sensors(SensorSample& sample) {
  current->read_sensors(sample);
}
void write_outputs(const RobotOutput& output) {
  current->write_outputs(output);
}

TargetScope::TargetScope(Target& target) : before_(current) {
  current = &target;
}
TargetScope::~TargetScope() {
  current = before_;
}

}  // namespace hal
}  // namespace screed
