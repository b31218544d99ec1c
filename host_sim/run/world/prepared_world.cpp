// Worlds of prepared ones, and their bytes.
#include "host_sim/run/world/prepared_world.h"

#include <cereal/archives/portable_binary.hpp>
#include <cereal/types/array.hpp>
#include <cereal/types/optional.hpp>
#include <cereal/types/string.hpp>
#include <cereal/types/variant.hpp>
#include <cereal/types/vector.hpp>
#include <span>
#include <sstream>
#include <utility>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/core/state_bytes.h"
#include "host_sim/physics/terrain/field_bytes.h"
#include "host_sim/standin/coarse_ground.h"
#include "host_sim/standin/standin_plant.h"

// How the parts of a prepared world stand in its bytes. Each lists all that worlds of the stand-in
// are made from.

namespace Eigen {

template <typename Archive, typename Number, int kRows, int kColumns>
void serialize(Archive& archive, Matrix<Number, kRows, kColumns>& matrix) {
  for (Number& number : std::span(matrix.data(), static_cast<size_t>(matrix.size())))
    archive(number);
}

template <typename Archive>
void serialize(Archive& archive, Isometry3d& pose) {
  archive(pose.matrix());
}

}  // namespace Eigen

namespace screed {

template <typename Archive>
void serialize(Archive& archive, Box& box) {
  archive(box.size);
}
template <typename Archive>
void serialize(Archive& archive, Cylinder& cylinder) {
  archive(cylinder.radius, cylinder.length);
}
template <typename Archive>
void serialize(Archive& archive, Sphere& sphere) {
  archive(sphere.radius);
}
template <typename Archive>
void serialize(Archive& archive, TriangleMesh& mesh) {
  archive(mesh.vertices, mesh.triangles);
}
template <typename Archive>
void serialize(Archive& archive, Shape& shape) {
  archive(shape.pose, shape.geometry);
}
template <typename Archive>
void serialize(Archive& archive, Inertia& inertia) {
  archive(inertia.mass, inertia.pose, inertia.tensor);
}
template <typename Archive>
void serialize(Archive& archive, AssemblyBody& body) {  // nobody looks at it
  archive(body.name, body.inertia, body.collision, body.pose);
}
template <typename Archive>
void serialize(Archive& archive, AssemblyJoint& joint) {
  archive(joint.name, joint.kind, joint.parent, joint.child, joint.pose, joint.axis, joint.limited,
          joint.lower_rad, joint.upper_rad, joint.effort_n_m);
}
template <typename Archive>
void serialize(Archive& archive, AssemblyWheel& wheel) {
  archive(wheel.body, wheel.centre, wheel.radius_m, wheel.width_m);
}
template <typename Archive>
void serialize(Archive& archive, Assembly& assembly) {
  archive(assembly.name, assembly.bodies, assembly.joints, assembly.chassis, assembly.imu,
          assembly.wheels);
}

template <typename Archive>
void serialize(Archive& archive, ReliefOptions& relief) {
  archive(relief.rms_m, relief.exponent, relief.longest_wave_m, relief.shortest_wave_m,
          relief.mounds, relief.mound_height_m, relief.mound_slope_deg, relief.trench_depth_m,
          relief.trench_width_m, relief.trench_slope_deg);
}
template <typename Archive>
void serialize(Archive& archive, SoilParameters& soil) {
  archive(soil.name);
  for (const SoilParameterInfo& it : kSoilParameters) archive(soil.*it.member);
}
template <typename Archive>
void serialize(Archive& archive, StartPose& start) {
  archive(start.x_m, start.y_m, start.z_m, start.attitude.roll, start.attitude.pitch,
          start.attitude.heading);
}
template <typename Archive>
void serialize(Archive& archive, GearMotor& motor) {
  archive(motor.resistance_ohm, motor.back_emf_v_s, motor.efficiency, motor.no_load_current_a,
          motor.inertia_kg_m2);
}
template <typename Archive>
void serialize(Archive& archive, VehicleOptions& vehicle) {
  archive(vehicle.tracks, vehicle.track_model, vehicle.chain.links, vehicle.chain.tension_n,
          vehicle.chain.mass_kg, vehicle.chain.stiffness_n, vehicle.track_friction,
          vehicle.lug_height_m, vehicle.chassis_friction, vehicle.wall_friction, vehicle.motor);
}
template <typename Archive>
void serialize(Archive& archive, Battery& battery) {
  archive(battery.cells, battery.capacity_c, battery.resistance_ohm, battery.electronics_a,
          battery.spares, battery.drawn_c, battery.used_c, battery.energy_j, battery.terminal_v);
}
template <typename Archive>
void serialize(Archive& archive, BoardConstants& board) {
  archive(board.count_um_q4, board.battery_uv_per_lsb, board.tread_mm, board.motor_nominal_mv,
          board.full_speed_mm_per_s, board.hull_reach_mm);
}
template <typename Archive>
void serialize(Archive& archive, Credentials& credentials) {
  archive(credentials.key, credentials.robot_id, credentials.key_set, credentials.boot_epoch);
}
template <typename Archive>
void serialize(Archive& archive, DriveCommand& drive) {
  archive(drive.speed_m_per_s, drive.yaw_rate_deg_per_s);
}
template <typename Archive>
void serialize(Archive& archive, ParameterChanges::Value& change) {
  archive(change.number, change.value);
}
template <typename Archive>
void serialize(Archive& archive, RobotOptions& robot) {
  archive(robot.settings.board, robot.settings.parameters.values, robot.settings.credentials,
          robot.drive, robot.changes.at_s, robot.changes.values, robot.ground_key.bytes,
          robot.ground_key.robot_id, robot.lay_on_side_at_s);
}
template <typename Archive>
void serialize(Archive& archive, ImuErrors& imu) {
  archive(imu.gyro_noise_dps, imu.gyro_bias_dps, imu.gyro_scale, imu.accel_noise_mg,
          imu.accel_bias_mg, imu.accel_scale, imu.mag_noise_mgauss, imu.mag_bias_mgauss,
          imu.mag_soft_iron, imu.pressure_noise_hpa, imu.pressure_bias_hpa);
}
template <typename Archive>
void serialize(Archive& archive, RadioOptions& radio) {
  archive(radio.delay_s, radio.loss, radio.bytes_per_s, radio.bit_errors, radio.duplication,
          radio.range_m, radio.pause_characters, radio.packet_bytes);
}
template <typename Archive>
void serialize(Archive& archive, PositionFixOptions& fixes) {
  archive(fixes.period_s, fixes.sigma_m, fixes.outage_every_s, fixes.outage_s);
}
template <typename Archive>
void serialize(Archive& archive, WorldOptions& options) {
  archive(options.soil, options.soil_options.bulldozing, options.soil_options.avalanches,
          options.soil_options.follow_slopes, options.physics_step_s, options.starts,
          options.robot_friction, options.vehicle, options.battery, options.robots, options.seed,
          options.imu, options.radio, options.ground_station_arms, options.fixes,
          options.calibration_motion, options.encoder_counts_per_turn);
}

namespace {

constexpr StateName kName = {"world", 2};

}  // namespace

HeightField PreparedWorld::dressed(HeightField field) const {
  if (relief.has_value()) {
    ReliefOptions its = *relief;
    its.seed = options.seed;
    add_relief(its, field);
  }
  if (walled) field.add_walls();
  return field;
}

void check_seed(uint64_t seed, const PreparedWorld& world) {
  if (seed != world.options.seed && !world.one_seed.empty()) {
    throw InputError("seed = " + std::to_string(seed) + "; allowed: " +
                     std::to_string(world.options.seed) + " alone, since " + world.one_seed);
  }
}

std::unique_ptr<World> make_standin_world(const PreparedWorld& prepared) {
  return std::make_unique<World>(
      std::make_unique<StandInPlant>(prepared.terrain(), prepared.model, prepared.options),
      prepared.options);
}

std::string to_bytes(const PreparedWorld& world) {
  std::ostringstream rest;
  cereal::PortableBinaryOutputArchive archive(rest);
  archive(bytes_of(world.ground), world.relief, world.walled, world.model, world.options,
          world.one_seed);
  return with_head(kName, rest.str());
}

PreparedWorld prepared_from(std::string_view bytes) {
  std::istringstream rest{std::string(without_head(kName, bytes))};
  cereal::PortableBinaryInputArchive archive(rest);
  FieldBytes ground;
  std::optional<ReliefOptions> relief;
  bool walled = false;
  archive(ground, relief, walled);
  PreparedWorld world{.ground = field_of(ground), .relief = relief, .walled = walled};
  archive(world.model, world.options, world.one_seed);
  return world;
}

}  // namespace screed
