// `screed model check`: what Screed finds in a robot model, and what is doubtful about it.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "host_sim/core/constants.h"
#include "host_sim/core/data_folders.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/figures.h"
#include "host_sim/core/json.h"
#include "host_sim/core/name_list.h"
#include "host_sim/physics/vehicle/model_report.h"
#include "host_sim/run/experiment/board_table.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/experiment/robot_model.h"
#include "host_sim/run/world/world_setup.h"
#include "tools/screed/cli/command.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

constexpr double kMmPerMetre = 1e3;
constexpr const char* kCorners[2][2] = {{"front left", "rear left"}, {"front right", "rear right"}};

struct ModelArguments {
  std::string file;
  std::string board = kDefaultBoard;
  std::string chassis_link;
  std::string wheel_links;
  std::string imu_link;
  bool json = false;
};

struct CheckedModel {
  fs::path file;
  Experiment experiment;
  Assembly robot;
  ModelReport report;
};

void read_experiment_of(const fs::path& file, const std::string& board, CheckedModel& model) {
  model.experiment = read_experiment(file);
  model.file = find_model_file(model.experiment, board);
}

/// A robot that comes with Screed, or else an experiment that does.
void read_named(const std::string& name, const std::string& board, CheckedModel& model) {
  try {
    model.experiment.vehicle.model = name;
    model.file = find_model_file(model.experiment, board);
    return;
  } catch (const InputError&) {  // No robot has this name.
  }
  fs::path file;
  try {
    file = find_experiment(name);
  } catch (const InputError& error) {
    throw InputError(std::string(error.what()) + "; robots that come with it: " + shipped_robots());
  }
  read_experiment_of(file, board, model);
}

/// A URDF file, an experiment that names one, or a robot or experiment that comes with Screed.
CheckedModel read_model(const ModelArguments& arguments) {
  CheckedModel model;
  const fs::path given(arguments.file);
  if (given.extension() == ".ini") {
    read_experiment_of(given, arguments.board, model);
  } else if (given.has_extension() || given.has_parent_path()) {
    model.file = given;
  } else {
    read_named(arguments.file, arguments.board, model);
  }
  VehicleSection& vehicle = model.experiment.vehicle;
  if (!arguments.chassis_link.empty()) vehicle.chassis_link = arguments.chassis_link;
  if (!arguments.imu_link.empty()) vehicle.imu_link = arguments.imu_link;
  if (!arguments.wheel_links.empty()) {
    if (names_in(arguments.wheel_links).size() != 4) {
      throw InputError("--wheel-links = '" + arguments.wheel_links +
                       "' is not allowed; expected four links of the model: front left, front "
                       "right, rear left, rear right");
    }
    vehicle.wheel_links = arguments.wheel_links;
  }
  try {
    model.robot = make_robot_model(model.experiment, arguments.board, model.file);
  } catch (const InputError& error) {
    throw with_place(model.experiment, error);
  }
  const bool drive_is_given = given.extension() == ".ini";
  model.report = report_model(model.robot, vehicle_options(model.experiment, arguments.board),
                              !drive_is_given);
  return model;
}

bool is_driven(const Assembly& robot, const AssemblyWheel& wheel) {
  return robot.joint_to(wheel.body)->kind == AssemblyJoint::Kind::Motor;
}

/// What the board's firmware and motors do not fit.
void compare_with_board(const std::string& board, CheckedModel& model) {
  constexpr double kTolerance = 0.05;
  constexpr double kMinForceShare = 0.5;  // of the weight; steep slopes take that much
  const BoardConstants& constants = board_constants_of(board);
  const BoardMotor motor = board_motor(board);
  std::vector<std::string>& warnings = model.report.warnings;
  const double radius = model.robot.wheels[0][0].radius_m;
  const double radius_of_board =
      constants.count_um_q4 / 16.0 * 1e-6 * motor.counts_per_turn / (2.0 * std::numbers::pi);
  if (std::abs(radius / radius_of_board - 1.0) > kTolerance) {
    warnings.push_back(filled(
        "board {} counts distance for wheels of {*1000:.1f} mm: with {*1000:.1f} mm the robot "
        "drives {:.2f} times as far and as fast as its firmware reckons",
        board, radius_of_board, radius, radius / radius_of_board));
  }
  const double tread_of_board = constants.tread_mm / kMmPerMetre;
  if (std::abs(model.report.tread_m / tread_of_board - 1.0) > kTolerance) {
    warnings.push_back(
        filled("board {} steers for a tread of {*1000:.0f} mm; this one is {*1000:.0f} mm", board,
               tread_of_board, model.report.tread_m));
  }
  int motors = 0;
  for (const auto& side : model.robot.wheels) {
    for (const AssemblyWheel& wheel : side) motors += is_driven(model.robot, wheel) ? 1 : 0;
  }
  const double stall_a = constants.motor_nominal_mv / kMmPerMetre / motor.motor.resistance_ohm;
  const double force = motors * motor.motor.torque_per_ampere() * stall_a / radius;
  const double weight = model.report.mass_kg * kGravity_m_per_s2;
  if (force < kMinForceShare * weight) {
    warnings.push_back(
        filled("board {}'s motors push with {:.1f} N at most, {:.0f} % of the robot's "
               "weight: it stops on slopes",
               board, force, 100.0 * force / weight));
  }
}

Json list_of(const Eigen::Vector3d& v) {
  return Json::array({v.x(), v.y(), v.z()});
}

Json describe(const CheckedModel& model) {
  const ModelReport& r = model.report;
  const auto name = [&](int body) { return model.robot.bodies[static_cast<size_t>(body)].name; };
  Json json = {{"file", model.file.string()},
               {"robot", model.robot.name},
               {"links", model.robot.bodies.size()},
               {"joints", model.robot.joints.size()},
               {"chassis", name(model.robot.chassis)},
               {"mass_kg", r.mass_kg},
               {"centre_of_mass_m", list_of(r.centre)},
               {"inertia_kg_m2",
                {{"ixx", r.inertia(0, 0)},
                 {"iyy", r.inertia(1, 1)},
                 {"izz", r.inertia(2, 2)},
                 {"ixy", r.inertia(0, 1)},
                 {"ixz", r.inertia(0, 2)},
                 {"iyz", r.inertia(1, 2)}}},
               {"imu",
                {{"link", model.robot.imu < 0 ? Json() : Json(name(model.robot.imu))},
                 {"place_m", list_of(r.imu)}}}};
  json["wheels"] = Json::array();
  for (const size_t end : {0U, 1U}) {
    for (const size_t side : {0U, 1U}) {
      const AssemblyWheel& wheel = model.robot.wheels[side][end];
      json["wheels"].push_back({{"corner", kCorners[side][end]},
                                {"link", name(wheel.body)},
                                {"joint", model.robot.joint_to(wheel.body)->name},
                                {"radius_m", wheel.radius_m},
                                {"width_m", wheel.width_m},
                                {"centre_m", list_of(wheel.centre)},
                                {"source", wheel.source},
                                {"driven", is_driven(model.robot, wheel)}});
    }
  }
  json["wheelbase_m"] = r.wheelbase_m;
  json["tread_m"] = r.tread_m;
  json["clearance_m"] = std::isfinite(r.clearance_m) ? Json(r.clearance_m) : Json(nullptr);
  json["warnings"] = r.warnings;
  return json;
}

std::string place(const Json& at) {
  // Rounded before it is printed, and + 0.0: no "-0.0".
  const auto tenths = [](const Json& m) {
    return std::round(kMmPerMetre * 10.0 * m.get<double>()) / 10.0 + 0.0;
  };
  return filled("x {:.1f}, y {:.1f}, z {:.1f} mm", tenths(at[0]), tenths(at[1]), tenths(at[2]));
}

void print_model(const Json& json) {
  const auto row = [&](const char* what, const std::string& text) {
    print("{:-16s}{}\n", what, filled(text, json));
  };
  print("{file}: robot '{robot}', {links} links, {joints} joints\n\n", json);
  row("chassis", "{chassis}");
  row("mass", "{mass_kg:.3f} kg, centre " + place(json["centre_of_mass_m"]));
  row("inertia",
      "Ixx {inertia_kg_m2.ixx:.3g}, Iyy {inertia_kg_m2.iyy:.3g}, Izz {inertia_kg_m2.izz:.3g} kg "
      "m^2");
  row("IMU", json["imu"]["link"].is_null() ? "at the origin of the chassis"
                                           : "{imu.link}, " + place(json["imu"]["place_m"]));
  row("wheelbase", "{wheelbase_m*1000:.1f} mm");
  row("tread", "{tread_m*1000:.1f} mm");
  row("clearance", json["clearance_m"].is_null() ? "none" : "{clearance_m*1000:.1f} mm");
  print("\n{:-16s}{:10s}{:10s}   {:-34s}{:-8s}{:-20s}{}\n", "wheel", "radius", "width", "centre",
        "motor", "from", "link");
  for (const Json& wheel : json["wheels"]) {
    print("{corner:-16s}{radius_m*1000:7.1f} mm{width_m*1000:7.1f} mm   ", wheel);
    print("{:-34s}{:-8s}", place(wheel["centre_m"]), wheel["driven"].get<bool>() ? "yes" : "no");
    print("{source:-20s}{link}\n", wheel);
  }
  print("\n");
  const Json& warnings = json["warnings"];
  for (const Json& warning : warnings) print("warning: {}\n", warning);
  if (warnings.empty()) {
    print("no warnings\n");
  } else {
    print("{}\n", counted(warnings.size(), "warning"));
  }
}

int check_model(const ModelArguments& arguments) {
  CheckedModel model = read_model(arguments);
  compare_with_board(arguments.board, model);
  const Json json = describe(model);
  arguments.json ? print_json(json) : print_model(json);
  return 0;
}

}  // namespace

void register_model_command(Command& root, Program& program) {
  Command* model = root.add_subcommand("model", "Check a robot model (URDF)");
  auto [command, arguments] = add_subcommand<ModelArguments>(
      *model, program, "check",
      "Print what is found in a robot model: chassis, mass, wheels, what is doubtful", check_model);
  command
      .add_option("FILE", arguments.file,
                  "URDF file, experiment that names one, or robot or experiment that comes with "
                  "Screed")
      ->required();
  command.add_option("--board", arguments.board, "Board that drives the robot")->show_default();
  command.add_option("--chassis-link", arguments.chassis_link,
                     "Link of the chassis (default: Body, base_link or the root)");
  command.add_option("--wheel-links", arguments.wheel_links,
                     "Links of the wheels: \"FRONT_LEFT FRONT_RIGHT REAR_LEFT REAR_RIGHT\" "
                     "(default: by their names and places)");
  command.add_option("--imu-link", arguments.imu_link,
                     "Link of the IMU (default: Imu, imu_link or the origin of the chassis)");
  command.add_flag("--json", arguments.json, "Print JSON");
}

}  // namespace screed
