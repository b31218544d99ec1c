// Every board's robot, as the simulation finds it in the board's folder.
#include "host_sim/run/experiment/board_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/physics/vehicle/ode_world.h"
#include "host_sim/physics/vehicle/urdf/urdf_importer.h"
#include "host_sim/physics/vehicle/vehicle.h"
#include "paths.h"

namespace screed {
namespace {

// Geometry, motor and encoder of the model against what the firmware is told in board.h.
TEST(BoardTable, ModelAndMotorAgreeWithTheFirmwaresConstants) {
  for (const std::string& name : board_names()) {
    SCOPED_TRACE(name);
    const BoardConstants& board = board_constants_of(name);
    const BoardMotor motor = board_motor(name);
    OdeWorld world;
    const Vehicle vehicle(world, import_urdf(board_model(name)), VehicleOptions{});
    EXPECT_NEAR(vehicle.tread_m() * 1e3, board.tread_mm, 0.5);
    const double circumference_um = 2.0 * std::numbers::pi * vehicle.wheel_radius_m(kLeft) * 1e6;
    EXPECT_NEAR(circumference_um / motor.counts_per_turn, board.count_um_q4 / 16.0, 0.1);
    const double nominal_v = board.motor_nominal_mv * 1e-3;
    const double no_load_rad_per_s =
        (nominal_v - motor.motor.no_load_current_a * motor.motor.resistance_ohm) /
        motor.motor.back_emf_v_s;
    EXPECT_NEAR(no_load_rad_per_s * vehicle.wheel_radius_m(kLeft) * 1e3, board.full_speed_mm_per_s,
                0.01 * board.full_speed_mm_per_s);
    EXPECT_GT(motor.motor.efficiency, 0.2);
    EXPECT_LT(motor.motor.efficiency, 0.9);
  }
}

TEST(BoardTable, HasAFolderOfEachNameAndTheDefaultAmongThem) {
  const std::vector<std::string> names = board_names();
  EXPECT_NE(std::find(names.begin(), names.end(), kDefaultBoard), names.end());
  std::vector<std::string> folders;
  for (const auto& folder : std::filesystem::directory_iterator(kBoardsFolder)) {
    if (std::filesystem::exists(folder.path() / "board.mk"))
      folders.push_back(folder.path().filename().string());
  }
  std::sort(folders.begin(), folders.end());
  EXPECT_EQ(names, folders);
}

TEST(BoardTable, FindsAFileOfABoard) {
  const auto rover = file_of_a_board("rover5.urdf");
  ASSERT_TRUE(rover.has_value());
  EXPECT_TRUE(std::filesystem::exists(*rover));
  EXPECT_FALSE(file_of_a_board("toaster.urdf").has_value());
}

TEST(BoardTable, BatteriesAreFullOnesOfTheirCells) {
  const auto cells_and_voltage = [](const char* board) {
    const Battery battery = board_battery(board).value();
    EXPECT_EQ(board_battery_cells(board), battery.cells);
    EXPECT_EQ(battery.charge(), 1.0);
    return std::pair(battery.cells, battery.terminal_v);
  };
  EXPECT_EQ(cells_and_voltage("a_star_32u4"), std::pair(6, 6 * 1.4));
  EXPECT_EQ(cells_and_voltage("zumo_32u4"), std::pair(4, 4 * 1.4));
  EXPECT_FALSE(board_battery("toaster").has_value());
}

TEST(BoardTable, RefusesAnUnknownBoard) {
  EXPECT_THROW(board_model("toaster"), InputError);
  EXPECT_THROW(board_motor("toaster"), InputError);
}

}  // namespace
}  // namespace screed
