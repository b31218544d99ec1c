// The plant a step ahead, the microcontroller after it.
#include "host_sim/run/world/mcu_world.h"

#include <filesystem>

#include "host_sim/core/data_folders.h"
#include "host_sim/core/errors.h"
#include "host_sim/devices/mcu/mcu.h"
#include "host_sim/run/experiment/sections/experiment_section.h"

namespace screed::mcu {
namespace {

// No healthy program is silent for so long, not even through a reset by the watchdog.
constexpr std::uint64_t kAnswerTimeout_us = 2'000'000;

Wiring wiring_of(const std::string& board) {
  const std::filesystem::path folder = data_folders().boards / board;
  std::error_code error;
  if (board.empty() || !std::filesystem::is_directory(folder, error)) {
    throw InputError("board '" + board + "': no folder " + folder.string());
  }
  return read_wiring(folder / "wiring.ini");
}

}  // namespace

McuWorld::McuWorld(HeightField terrain, const Assembly& model, const CoSimulationOptions& options,
                   std::ostream* telemetry_log)
    : board_(options.elf, wiring_of(options.board)),
      world_(std::move(terrain), model, board_constants_of(options.board), options.world,
             telemetry_log, [&](const WorldOptions& own, RobotView& robot, std::ostream* log) {
               auto made = std::make_unique<McuRobot>(board_, options, own, robot, log);
               image_robot_ = made.get();
               return made;
             }) {}

void McuWorld::run_to(Board::Mark mark) {
  const std::uint64_t limit_us = image_robot_->now_us() + kAnswerTimeout_us;
  while (!image_robot_->run_to(mark)) {
    if (image_robot_->now_us() > limit_us) {
      throw RunError("the image has made no control tick for 2 s, at " +
                     std::to_string(world_.plant().time_s()) + " s");
    }
    world_.step();
    if (world_.at_end_of_tick()) let_native_robots_answer();
  }
}

const SensorSample& McuWorld::run_to_sample() {
  run_to(Board::Mark::kSample);
  return board_.sample();
}

const RobotOutput& McuWorld::run_to_output() {
  run_to(Board::Mark::kOutput);
  return board_.output();
}

}  // namespace screed::mcu

namespace screed {
namespace {

/// The robot would refuse to be armed, and its shadow on this machine would not.
void check_algorithm(const CoSimulationOptions& options) {
  const std::optional<std::uint16_t> in_image = mcu::image_algorithms(options.elf);
  const std::int16_t wanted = options.parameters.algorithm();
  if (!in_image.has_value() || (*in_image >> wanted & 1) != 0) return;
  const std::vector<std::string> names = algorithm_names();
  std::string has;
  for (size_t i = 0; i < names.size(); ++i)
    if ((*in_image >> i & 1) != 0) has += (has.empty() ? "" : ", ") + names[i];
  const std::string& name = names.at(static_cast<size_t>(wanted));
  throw InputError(options.elf + ": the image has no algorithm " + name + ", only " + has +
                   "; make firmware LEVELING=" + name + " builds one that has it, for --elf");
}

}  // namespace

std::unique_ptr<CoSimulation> make_co_simulation(HeightField terrain, const Assembly& model,
                                                 const CoSimulationOptions& options,
                                                 std::ostream* telemetry_log) {
  std::error_code error;
  if (!std::filesystem::exists(options.elf, error)) {
    throw InputError(options.elf + ": no such image; run make firmware BOARD=" + options.board);
  }
  check_algorithm(options);
  return std::make_unique<mcu::McuWorld>(std::move(terrain), model, options, telemetry_log);
}

}  // namespace screed
