// What goes into a session: heights by the tiles that were written to, frames, maps.
#include "host_sim/run/simulation/recorders.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_sim/physics/terrain/footprint_contact.h"

namespace screed {

HeightWatch::HeightWatch(const HeightField& field) : revisions_(field.tile_revisions()) {
  known_.reserve(static_cast<size_t>(field.nx()) * static_cast<size_t>(field.ny()));
  for (int iy = 0; iy < field.ny(); ++iy) {
    for (int ix = 0; ix < field.nx(); ++ix) known_.push_back(field.node(ix, iy));
  }
}

std::span<const HeightChange> HeightWatch::changes(const HeightField& field) {
  changes_.clear();
  const std::vector<uint32_t>& revisions = field.tile_revisions();
  for (size_t tile = 0; tile < revisions.size(); ++tile) {
    if (revisions[tile] == revisions_[tile]) continue;
    revisions_[tile] = revisions[tile];
    look_at_tile(field, tile);
  }
  return changes_;
}

void HeightWatch::look_at_tile(const HeightField& field, size_t tile) {
  constexpr int kNodes = HeightField::kTileNodes;
  const int west = static_cast<int>(tile % static_cast<size_t>(field.tiles_x())) * kNodes;
  const int south = static_cast<int>(tile / static_cast<size_t>(field.tiles_x())) * kNodes;
  const int east = std::min(west + kNodes, field.nx());
  const int north = std::min(south + kNodes, field.ny());
  for (int iy = south; iy < north; ++iy) {
    for (int ix = west; ix < east; ++ix) {
      const size_t node =
          static_cast<size_t>(iy) * static_cast<size_t>(field.nx()) + static_cast<size_t>(ix);
      const Height height = field.node(ix, iy);
      if (height == known_[node]) continue;
      changes_.push_back({static_cast<uint32_t>(node), height - known_[node]});
      known_[node] = height;
    }
  }
}

// From a tick to the rows of the session file.

namespace {

HeightMap height_map_of(const HeightField& field) {
  HeightMap map;
  map.geometry = {static_cast<uint32_t>(field.nx()),
                  static_cast<uint32_t>(field.ny()),
                  kHeightUnit_m,
                  field.spacing_m(),
                  field.node_x(0),
                  field.node_y(0),
                  field.wrap(),
                  field.edge() == BedEdge::kWalled};
  map.heights.reserve(static_cast<size_t>(field.nx()) * static_cast<size_t>(field.ny()));
  for (int iy = 0; iy < field.ny(); ++iy) {
    for (int ix = 0; ix < field.nx(); ++ix) map.heights.push_back(field.node(ix, iy));
  }
  return map;
}

}  // namespace

PathPoint path_point(const SimFrame& frame) {
  return {frame.x, frame.y, static_cast<std::size_t>(frame.leveling_state)};
}

SessionRecorder::SessionRecorder(const std::filesystem::path& file, const SessionInfo& info,
                                 const HeightField& before,
                                 const std::optional<SoilParameters>& soil)
    : writer_(file, info) {
  writer_.write_terrain_before(height_map_of(before).view());
  if (soil.has_value()) writer_.write_soil(*soil);
}

void SessionRecorder::record_heights(const HeightField& terrain) {
  watch_.emplace(terrain);
  writer_.record_heights(height_map_of(terrain).view());
}

void SessionRecorder::record_particles_before(const SphereSet& particles) {
  if (!particles.centers_m.empty()) writer_.write_particles_before(particles);
}

void SessionRecorder::record_particles_after(const SphereSet& particles) {
  if (!particles.centers_m.empty()) writer_.write_particles_after(particles);
}

void SessionRecorder::observe_terrain(const HeightField& terrain) {
  if (watch_) changes_ = watch_->changes(terrain);
}

void SessionRecorder::append(const SimFrame& frame, const SensorSample& sample,
                             const RobotOutput& output) {
  writer_.append(frame, sample, output, changes_);
  height_changes_ += changes_.size();
  if (ticks_++ % kPathTicks == 0) path_.push_back(path_point(frame));
}

void SessionRecorder::record_leveling(const LevelingPoint& point) {
  if (last_point_.has_value() && last_point_->time < point.time)
    writer_.append_leveling(*last_point_);
  last_point_ = point;
}

std::string SessionRecorder::finish(const HeightField& after) {
  if (last_point_.has_value()) writer_.append_leveling(*last_point_);
  writer_.write_terrain_after(height_map_of(after).view());
  return writer_.finish();
}

// One frame of a session.

namespace {

constexpr double kRadPerAngle = std::numbers::pi / 32768.0;

double wrap_rad(double angle) {
  return std::remainder(angle, 2.0 * std::numbers::pi);
}

}  // namespace

SimFrame FrameRecorder::record(double time_s, const RobotView& plant, const Robot& robot) {
  const VehicleState& vehicle = plant.vehicle();
  const ChassisState chassis = vehicle.chassis();
  const Eigen::Matrix3d& rotation = chassis.pose.linear();
  const Eigen::Vector3d position = chassis.pose.translation();
  const Attitude attitude = attitude_of(rotation);
  const Eigen::Vector3d velocity = rotation.transpose() * chassis.velocity;

  SimFrame frame;
  frame.time = time_s;
  frame.x = position.x();
  frame.y = position.y();
  frame.z = position.z();
  // As travelled: a teleport is no motion.
  const Eigen::Vector3d travelled = plant.unwrapped_position();
  if (!first_) {
    frame.delta_x = travelled.x() - last_travelled_.x();
    frame.delta_y = travelled.y() - last_travelled_.y();
    frame.delta_theta = wrap_rad(attitude.heading - last_heading_);
    distance_m_ += (travelled - last_travelled_).norm();
  }
  first_ = false;
  last_travelled_ = travelled;
  last_heading_ = attitude.heading;

  const TrackSpeeds& targets = robot.drive().targets();
  frame.v_left = targets.left * 1e-3 / vehicle.wheel_radius_m(kLeft);
  frame.v_right = targets.right * 1e-3 / vehicle.wheel_radius_m(kRight);
  frame.pitch = attitude.pitch;
  frame.roll = attitude.roll;
  frame.yaw = attitude.heading;
  frame.linear = robot.motion().speed_mm_per_s * 1e-3;
  frame.angular = robot.motion().yaw_rate * kRadPerAngle;
  frame.velocity_x = velocity.x();
  frame.velocity_y = velocity.y();
  frame.velocity_z = velocity.z();
  frame.rate_x = chassis.omega_body.x();
  frame.rate_y = chassis.omega_body.y();
  frame.rate_z = chassis.omega_body.z();
  frame.track_left = vehicle.track_speed_m_per_s(kLeft);
  frame.track_right = vehicle.track_speed_m_per_s(kRight);
  frame.slip_left = signed_slip(frame.track_left, vehicle.ground_speed_m_per_s(kLeft));
  frame.slip_right = signed_slip(frame.track_right, vehicle.ground_speed_m_per_s(kRight));
  frame.sinkage_left = vehicle.sinkage_m(kLeft);
  frame.sinkage_right = vehicle.sinkage_m(kRight);
  frame.load_left = vehicle.load_n(kLeft);
  frame.load_right = vehicle.load_n(kRight);
  frame.current_left = vehicle.current_a(kLeft);
  frame.current_right = vehicle.current_a(kRight);
  frame.battery = plant.battery().terminal_v;
  frame.energy = plant.battery().energy_j;
  frame.est_pitch = robot.attitude().pitch() * kRadPerAngle;
  frame.est_roll = robot.attitude().roll() * kRadPerAngle;
  frame.est_heading = robot.attitude().heading() * kRadPerAngle;
  frame.odometry_x = robot.position().mm(kX) * 1e-3;
  frame.odometry_y = robot.position().mm(kY) * 1e-3;
  frame.state = static_cast<int32_t>(robot.supervisor().state());
  frame.leveling_state = static_cast<int32_t>(robot.leveling().state());
  frame.faults = robot.supervisor().faults();
  frame.beds_x = static_cast<int32_t>(plant.wrap_counts()[0]);
  frame.beds_y = static_cast<int32_t>(plant.wrap_counts()[1]);
  return frame;
}

}  // namespace screed
