// The portable core: the stand-in, soil, and robots with their firmware in the stand-in's world.
#include <array>
#include <memory>
#include <numbers>

#include "boards/a_star_32u4/board.h"
#include "hal/sample.h"
#include "host_sim/core/elementary.h"
#include "host_sim/core/rotation.h"
#include "host_sim/leveling/leveling_meter.h"
#include "host_sim/physics/soil/soil_bed.h"
#include "host_sim/run/world/world.h"
#include "host_sim/standin/standin_plant.h"
#include "tests/portable/portable.h"

namespace screed {
namespace {

SoilParameters gravel() {
  SoilParameters soil = soil_preset("gravel");
  soil.slip_layer_m = 0.0029;
  return soil;
}

/// Some 1.2 kg on two tracks of the size of a Rover 5's.
Assembly tracked_robot() {
  constexpr double kBelow_m = -0.0313;  // axles under the chassis' origin
  Assembly robot;
  robot.chassis = 0;
  AssemblyBody chassis;
  chassis.name = "Chassis";
  chassis.inertia.mass = 0.8;
  chassis.inertia.tensor = Eigen::Vector3d(0.002, 0.003, 0.004).asDiagonal();
  chassis.collision.push_back({Eigen::Isometry3d::Identity(), Box{{0.24, 0.16, 0.05}}});
  robot.bodies.push_back(chassis);
  for (const size_t side : {0U, 1U}) {
    for (const size_t end : {0U, 1U}) {
      const int number = static_cast<int>(robot.bodies.size());
      const Eigen::Vector3d centre(end == 0 ? 0.0925 : -0.0925, side == 0 ? 0.0975 : -0.0975,
                                   kBelow_m);
      AssemblyBody wheel;
      wheel.name = "Wheel";
      wheel.inertia.mass = 0.1;
      wheel.inertia.tensor = Eigen::Vector3d(3e-5, 5e-5, 3e-5).asDiagonal();
      wheel.pose.translation() = centre;
      robot.bodies.push_back(wheel);
      AssemblyJoint joint;
      joint.kind = AssemblyJoint::Kind::Motor;
      joint.parent = 0;
      joint.child = number;
      joint.pose.translation() = centre;
      joint.axis = Eigen::Vector3d::UnitY();
      robot.joints.push_back(joint);
      robot.wheels.at(side).at(end) = {number, centre, 0.03, 0.03, ""};
    }
  }
  return robot;
}

/// Three robots cross a bed of soil between walls, meet one another and them.
void drive_standin() {
  PlantOptions options;
  options.soil = gravel();
  options.starts = {
      {-0.4, 0.0, {}, {}}, {0.4, 0.1, {}, {0.0, 0.0, 3.0}}, {0.0, -0.4, {}, {0.0, 0.0, 1.5}}};
  HeightField ground = HeightField::from_function(
      61, 61, 0.03, false, [](double x, double y) { return 0.05 * x * y + 0.02 * x * x; });
  ground.add_walls();
  StandInPlant plant(ground, tracked_robot(), options);
  Hash hash;
  for (int step = 0; step < 20 * 500; ++step) {
    const bool turns = step / 1000 % 3 == 2;
    const std::array<DutyRatio, 3> duty = {
        {{0.9, turns ? -0.9 : 0.8}, {0.8, 0.9}, {turns ? -0.7 : 0.7, 0.9}}};
    plant.step(duty);
    if (step % 100 != 0) continue;
    for (size_t i = 0; i < plant.robots(); ++i) {
      hash.add(plant.robot(i).unwrapped_position());
      hash.add(plant.robot(i).motion().mean_specific_force);
    }
  }
  hash.add(plant.terrain());
  hash.print("three robots of the stand-in, 20 s");
}

/// A wheel on soil goes down, slips and turns.
void drive_on_soil() {
  SoilOptions options;
  SoilBed bed(hills(150, 0.01), gravel(), options);
  Footprint wheel = Footprint::wheel(0.03, 0.03);
  ContactMemory memory;
  Hash hash;
  for (int step = 0; step < 4000; ++step) {
    const double t = step * 1e-3;
    const double heading = 0.5 * t;
    const Eigen::Vector2d forward(portable::cos(heading), portable::sin(heading));
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = rotation_about(Eigen::Vector3d::UnitZ(), heading).toRotationMatrix();
    const Eigen::Vector2d at = 0.3 * Eigen::Vector2d(portable::sin(heading), -forward.x());
    pose.translation() << at, bed.surface().at(at.x(), at.y()).height + 0.0299;
    wheel.set_pose(pose);
    FootprintMotion motion;
    motion.velocity = {0.15 * forward.x(), 0.15 * forward.y(), -0.002};
    motion.omega = {0.0, 0.0, 0.5};
    motion.surface_speed = 0.2;
    motion.slip = 0.25;
    const TerrainReaction reaction = bed.press(wheel, motion, 1e-3, memory);
    bed.end_step();
    hash.add(reaction.force);
    hash.add(reaction.torque);
  }
  hash.add(bed.surface());
  hash.print("a wheel on soil, 4 s");
}

/// Two robots with their firmware, sensors and radio level a bed of the stand-in's soil.
void run_firmware() {
  WorldOptions options;
  options.soil = gravel();
  options.starts = {{-0.4, 0.0, {}, {}}, {0.4, 0.1, {}, {0.0, 0.0, 3.0}}};
  options.robots.resize(2);
  for (RobotOptions& robot : options.robots) {
    robot.settings.board = kBoard;
    robot.settings.parameters.algorithm() = static_cast<int16_t>(LevelingAlgorithm::kHillSensing);
  }
  options.robots[1].ground_key = key_of_robot(test_key(), 1);
  options.robots[1].settings.credentials = credentials_of(options.robots[1].ground_key);
  HeightField ground = HeightField::from_function(
      61, 61, 0.03, false, [](double x, double y) { return 0.05 * x * y + 0.02 * x * x; });
  ground.add_walls();
  World world(std::make_unique<StandInPlant>(ground, tracked_robot(), options), options);
  Hash hash;
  bool ran = false;
  for (int tick = 0; tick < 40 * kTickRate_hz; ++tick) {
    world.advance();
    for (size_t i = 0; i < world.robots(); ++i) {
      hash.add(static_cast<uint64_t>(static_cast<uint16_t>(world.output(i).duty_left)));
      for (uint8_t byte = 0; byte < world.output(i).radio_out_count; ++byte)
        hash.add(uint64_t{world.output(i).radio_out[byte]});
      ran = ran || world.firmware(i).supervisor().running();
    }
  }
  hash.add(world.terrain());
  hash.add(least_transport(ground_blocks(world.terrain())));
  hash.print(ran ? "two robots with their firmware, 40 s" : "the firmware never ran");
}

}  // namespace
}  // namespace screed

int main() {
  screed::drive_standin();
  screed::drive_on_soil();
  screed::run_firmware();
}
