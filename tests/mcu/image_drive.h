// The image that is flashed, driving in a world of physics, for tests: everything in reach.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "firmware/leveling/leveling.h"
#include "host_sim/physics/vehicle/urdf/urdf_importer.h"
#include "host_sim/physics/world/plant.h"
#include "host_sim/run/experiment/board_table.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/world/mcu_robot.h"
#include "host_sim/run/world/world.h"
#include "tests/mcu/images.h"

namespace screed::mcu {

class ImageDrive {
 public:
  static constexpr double kSpeed_m_per_s = 0.15;

  /// handled: the IMU feels a person turning the robot over.
  explicit ImageDrive(std::uint64_t seed = 1, double speed_m_per_s = kSpeed_m_per_s,
                      bool handled = false)
      : ImageDrive(options(seed, speed_m_per_s, handled)) {}

  /// The image of another node, with that robot's key.
  ImageDrive(const std::string& image, const CommandKey& key) : ImageDrive(options(image, key)) {}

  /// One control tick of the program.
  void tick() {
    world.advance();
    sample = world.sample();
    output = world.output();
  }
  McuRobot& image() { return dynamic_cast<McuRobot&>(world.robot()); }
  Board& board() { return image().board(); }
  CycleReport cycles() const { return world.robot().cycles().value(); }
  double time_ms() { return board().mcu.time_ms(); }
  void run(double seconds) {
    const double end = time_ms() + seconds * 1000.0;
    while (time_ms() < end) tick();
  }
  /// Time until the condition holds after a tick, ms.
  std::optional<double> ms_until(const std::function<bool()>& condition, double most_s) {
    const double begin = time_ms();
    while (time_ms() < begin + most_s * 1000.0) {
      tick();
      if (condition()) return time_ms() - begin;
    }
    return std::nullopt;
  }
  bool powered() {
    return board().motor_duty_ratio(kLeft) != 0.0 || board().motor_duty_ratio(kRight) != 0.0;
  }
  /// Armed, running and at speed.
  void set_off() {
    ASSERT_TRUE(ms_until([this] { return report().state == RobotState::kRunning; }, 12.0));
    run(3.0);
    ASSERT_TRUE(powered());
  }
  std::optional<double> ms_until_stop(double most_s = 3.0) {
    return ms_until([this] { return !powered(); }, most_s);
  }

  const RobotView& body() const { return world.plant().robot(0); }
  const RobotReport& report() const { return world.ground_station().report(); }
  /// Payload of the newest frame of an id that came down the radio, as the log has it.
  std::vector<std::uint8_t> last_frame(std::uint16_t id) const {
    char name[8];
    std::snprintf(name, sizeof name, " %03X#", static_cast<unsigned>(id));
    const std::string text = log.str();
    const std::size_t at = text.rfind(name);
    std::vector<std::uint8_t> bytes;
    if (at == std::string::npos) return bytes;
    for (std::size_t i = at + 5; i + 1 < text.size() && text[i] != '\n'; i += 2) {
      bytes.push_back(static_cast<std::uint8_t>(std::stoul(text.substr(i, 2), nullptr, 16)));
    }
    return bytes;
  }
  /// What the health message says of the chips.
  int failing_chips() const {
    const std::vector<std::uint8_t> health = last_frame(kIdHealth);
    // The other flag of this byte: the robot starts up.
    constexpr int kChips = ChipBit::kAccelMagChip | ChipBit::kGyroChip | ChipBit::kBaroChip;
    return health.size() == 7 ? health[2] & kChips : -1;
  }
  /// The tick never missed its deadline, and kept to its budget.
  void expect_punctual() const {
    const CycleReport spent = cycles();
    EXPECT_EQ(spent.missed_ticks, 0U);
    EXPECT_LE(spent.longest_tick_cycles, CycleReport::kTickCycles / 2);
    EXPECT_EQ(spent.resets, 0);
  }

  std::ostringstream log;
  World world;
  SensorSample sample{};
  RobotOutput output{};

 private:
  explicit ImageDrive(WorldOptions options)
      : world(std::make_unique<Plant>(HeightField::flat(20.0, 0.1), rover5(), options),
              with_log(options, log)) {}
  static const WorldOptions& with_log(WorldOptions& options, std::ostream& log) {
    options.robots[0].telemetry_log = &log;
    return options;
  }
  static const Assembly& rover5() {
    static const Assembly model = import_urdf(find_model_file(Experiment{}));
    return model;
  }
  static WorldOptions options(std::uint64_t seed, double speed_m_per_s, bool handled) {
    WorldOptions options;
    options.seed = seed;
    options.calibration_motion = handled;
    RobotOptions& robot = options.robots[0];
    robot.settings.board = board_constants_of(kDefaultBoard);
    robot.settings.parameters.algorithm() = static_cast<int16_t>(LevelingAlgorithm::kDrive);
    robot.image = RobotImage{kScreedImage, kDefaultBoard};
    robot.drive = DriveCommand{speed_m_per_s, 0.0};
    return options;
  }
  static WorldOptions options(const std::string& image, const CommandKey& key) {
    WorldOptions own = options(1, kSpeed_m_per_s, false);
    RobotOptions& robot = own.robots[0];
    robot.image->elf = image;
    robot.settings.credentials = credentials_of(key);
    robot.ground_key = key;
    return own;
  }
};

}  // namespace screed::mcu
