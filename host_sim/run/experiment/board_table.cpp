// The boards, from their folders.
#include "host_sim/run/experiment/board_table.h"

#include <charconv>
#include <cmath>
#include <map>
#include <numbers>
#include <system_error>

#include "boards.h"
#include "host_sim/core/constants.h"
#include "host_sim/core/data_folders.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/ini_file.h"
#include "host_sim/core/name_list.h"

namespace screed {
namespace {

std::filesystem::path folder_of(const std::string& board) {
  return data_folders().boards / board;
}

const std::map<std::string, const BoardConstants*>& boards() {
  static const std::map<std::string, const BoardConstants*> table = {
#define SCREED_BOARD(board) {#board, &kBoard_##board},
      SCREED_BOARDS(SCREED_BOARD)
#undef SCREED_BOARD
  };
  return table;
}

/// Positive numbers, one for each of the keys in `values`.
void read_numbers(const std::filesystem::path& path, const char* of,
                  std::map<std::string, double>& values) {
  for (const IniEntry& entry : read_ini_file(path)) {
    const auto known = values.find(entry.key);
    const char* const end = entry.value.data() + entry.value.size();
    if (!entry.section.empty() || known == values.end() ||
        std::from_chars(entry.value.data(), end, known->second).ptr != end ||
        !(known->second > 0.0)) {
      throw InputError(path.string() + ":" + std::to_string(entry.line) + ": " + entry.key +
                       " = '" + entry.value +
                       "'; allowed are positive numbers for the keys of the " + of);
    }
  }
  for (const auto& [key, value] : values) {
    if (value == 0.0) throw InputError(path.string() + ": " + key + " is missing");
  }
}

}  // namespace

const char* const kDefaultBoard = SCREED_DEFAULT_BOARD;

std::vector<std::string> board_names() {
  std::vector<std::string> names;
  for (const auto& [name, constants] : boards()) names.push_back(name);
  return names;
}

const BoardConstants& board_constants_of(const std::string& name) {
  const auto found = boards().find(name);
  if (found != boards().end()) return *found->second;
  throw InputError("board '" + name + "' is not known; there are: " + name_list(board_names()));
}

std::optional<std::filesystem::path> file_of_a_board(const std::string& name) {
  for (const std::string& board : board_names()) {
    std::error_code error;
    if (std::filesystem::exists(folder_of(board) / name, error)) return folder_of(board) / name;
  }
  return std::nullopt;
}

std::filesystem::path board_model(const std::string& name) {
  board_constants_of(name);
  std::filesystem::path model;
  for (const auto& entry : std::filesystem::directory_iterator(folder_of(name))) {
    if (entry.path().extension() != ".urdf") continue;
    if (!model.empty()) {
      throw InputError(folder_of(name).string() + ": there are several .urdf files; name one in " +
                       "[vehicle] model");
    }
    model = entry.path();
  }
  if (model.empty()) {
    throw InputError(folder_of(name).string() + ": no .urdf file; name one in [vehicle] model");
  }
  return model;
}

BoardMotor board_motor(const std::string& name) {
  board_constants_of(name);
  const std::filesystem::path path = folder_of(name) / "motor.ini";
  if (!std::filesystem::exists(path)) return {};
  std::map<std::string, double> values = {
      {"nominal_v", 0.0},       {"stall_current_a", 0.0},   {"stall_torque_n_m", 0.0},
      {"no_load_rpm", 0.0},     {"no_load_current_a", 0.0}, {"inertia_kg_m2", 0.0},
      {"counts_per_turn", 0.0},
  };
  read_numbers(path, "motor", values);
  BoardMotor board;
  GearMotor& motor = board.motor;
  motor.resistance_ohm = values["nominal_v"] / values["stall_current_a"];
  motor.no_load_current_a = values["no_load_current_a"];
  const double no_load_rad_per_s = values["no_load_rpm"] * 2.0 * std::numbers::pi / 60.0;
  motor.back_emf_v_s =
      (values["nominal_v"] - motor.no_load_current_a * motor.resistance_ohm) / no_load_rad_per_s;
  motor.efficiency = values["stall_torque_n_m"] / (motor.back_emf_v_s * values["stall_current_a"]);
  motor.inertia_kg_m2 = values["inertia_kg_m2"];
  board.counts_per_turn = values["counts_per_turn"];
  return board;
}

std::optional<Battery> board_battery(const std::string& name) {
  const std::filesystem::path path = folder_of(name) / "battery.ini";
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return std::nullopt;
  std::map<std::string, double> values = {
      {"cells", 0.0}, {"capacity_ah", 0.0}, {"resistance_ohm", 0.0}};
  read_numbers(path, "battery", values);
  constexpr double kMaxCells = 20.0;
  if (values["cells"] > kMaxCells || values["cells"] != std::floor(values["cells"]))
    throw InputError(path.string() + ": cells: allowed are 1..20");
  Battery battery;
  battery.cells = static_cast<int>(values["cells"]);
  battery.capacity_c = values["capacity_ah"] * kSecondsPerHour;
  battery.resistance_ohm = values["resistance_ohm"];
  battery.begin_with(1.0);
  return battery;
}

int board_battery_cells(const std::string& name) {
  const std::optional<Battery> battery = board_battery(name);
  return battery.has_value() ? battery->cells : 0;
}

}  // namespace screed
