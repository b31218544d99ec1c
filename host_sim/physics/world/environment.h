// What robots are driven in, and what their sensors measure there, without the errors.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/sample.h"
#include "host_sim/physics/terrain/terrain.h"
#include "host_sim/physics/vehicle/drive_train.h"
#include "host_sim/physics/vehicle/vehicle_state.h"

namespace screed {

// The motion that a robot's sensors measure, without their errors.

/// True motion: means over one control tick's time, ending when it is asked for.
struct ImuTruth {
  Eigen::Vector3d mean_rate_rad_per_s;  ///< body frame
  Eigen::Vector3d mean_specific_force;  ///< body frame, m/s^2: acceleration minus gravity
  Eigen::Matrix3d body_to_world;
  double altitude_m;
};

// What robots are driven in, as the rest of the program sees it: the terrain, each robot's true
// state and battery, advanced a step at a time. Behind it stands physics (plant.h), or a network
// that has learned from physics (surrogate_plant.h).

/// Mean output of a robot's drivers over the battery voltage, -1..1, left and right; positive
/// drives forward.
using DutyRatio = std::array<double, 2>;

/// One robot's body in its world.
class RobotView {
 public:
  virtual ~RobotView() = default;

  /// True motion: means over the last kTickPeriod_us, ending now, not at the last tick (the
  /// simulated microcontroller asks between ticks).
  virtual ImuTruth motion() const = 0;

  /// Picks the robot up and lays it on its left side where it is.
  virtual void lay_on_side() = 0;

  virtual const VehicleState& vehicle() const = 0;
  /// With wrap-around: how many beds east and north of its first copy the robot has come. Whenever
  /// its origin passes an edge it is teleported to the opposite one (thesis 5.1.4), motion and all,
  /// so that unwrapped position = position + wrap_counts x size of the bed.
  virtual const std::array<int64_t, 2>& wrap_counts() const = 0;
  /// The chassis' place as if there had been no teleport, m.
  virtual Eigen::Vector3d unwrapped_position() const = 0;
  virtual const Battery& battery() const = 0;

 protected:
  RobotView() = default;
  RobotView(const RobotView&) = default;
  RobotView& operator=(const RobotView&) = default;
};

/// The ground, and the robots on it, numbered from 0.
class Environment {
 public:
  virtual ~Environment() = default;

  /// One physics step, with a duty for each robot in their order. Throws RunError when a robot has
  /// come to where nothing can have brought it.
  virtual void step(std::span<const DutyRatio> duty_ratios) = 0;

  virtual size_t robots() const = 0;
  virtual RobotView& robot(size_t number) = 0;
  virtual const RobotView& robot(size_t number) const = 0;

  virtual int steps_per_tick() const = 0;
  virtual uint64_t steps() const = 0;
  double time_s() const {
    return static_cast<double>(steps()) / (static_cast<double>(steps_per_tick()) * kTickRate_hz);
  }
  /// The terrain's surface as it is now.
  virtual const HeightField& terrain() const = 0;
  /// As Terrain::is_deformable().
  virtual bool is_deformable() const = 0;
  /// As Terrain::balance() and Terrain::work(); all zero where nothing of the kind is booked.
  virtual VolumeBalance volume_balance() const { return {}; }
  virtual TerrainWork terrain_work() const { return {}; }
  /// As Terrain::spheres().
  virtual SphereSet spheres() const { return {}; }

 protected:
  Environment() = default;
  Environment(const Environment&) = default;
  Environment& operator=(const Environment&) = default;
};

}  // namespace screed
