// What a robot of a model consists of before it is in a world: bodies that move as one, running
// gear on them, shafts that turn it, and the measures that follow from these. Knows no ODE: a
// vehicle (vehicle.h) is made of them, and worlds without dynamics take their measures.
//
// Bodies that a fixed joint holds together are one. Wheels ride with the body that carries them and
// turn on shafts (drive_train.h) under their running gear (running_gear.h).
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <vector>

#include "host_sim/physics/terrain/terrain.h"
#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/physics/vehicle/chain_track.h"
#include "host_sim/physics/vehicle/drive_train.h"
#include "host_sim/physics/vehicle/hull.h"
#include "host_sim/physics/vehicle/robot_contact.h"
#include "host_sim/physics/vehicle/running_gear.h"
#include "host_sim/physics/vehicle/vehicle_options.h"
#include "host_sim/physics/vehicle/vehicle_state.h"
#include "host_sim/physics/vehicle/wall_contact.h"

namespace screed {

class VehicleParts {
 public:
  /// Throws InputError when the model cannot be driven: no motor wheel on a side, motor joints on
  /// other bodies, a wheel that no body carries.
  VehicleParts(const Assembly& assembly, const VehicleOptions& options);

  /// Height of the chassis' origin at which the lowest contact point just touches the terrain, for
  /// this attitude at (x, y).
  double resting_height(const HeightField& terrain, double x, double y,
                        const Eigen::Matrix3d& rotation) const;
  /// From above: the rectangle round all contact points, in the frame of the chassis, joints at
  /// zero.
  Eigen::AlignedBox2d outline_at_rest() const;
  double mass_kg() const { return mass_; }
  /// Distance between the centre lines of left and right running gear.
  double tread_m() const { return tread_; }
  double wheel_radius_m(Side side) const { return of(side).radius; }

 protected:
  struct Carrier {                // bodies that move as one
    Eigen::Isometry3d rest_pose;  // its centre of mass in the frame of the chassis, joints at zero
    Hull hull;
    WallContact walls;
    // For other robots:
    std::vector<BodyPoint> points;
    std::vector<SolidPart> solids;
    double reach;  // of points and solids from the centre of mass
    BodyMemory memory;
    double mass;
    Eigen::Matrix3d inertia;  // in its own axes
    Eigen::Matrix3d inverse_inertia;
  };
  struct Shaft {
    Side side;
    DriveShaft shaft;
    double torque = 0.0;  // of all that it touches in this step, N m
  };
  struct Unit {
    size_t carrier;
    size_t shaft;
    RunningGear gear;
  };
  struct Chain {
    size_t carrier;
    std::array<size_t, 2> shafts;  // of front and rear wheel
    ChainTrack track;
  };
  struct SideGear {  // where a side's motion is measured
    size_t carrier;
    size_t shaft;            // with the encoder
    Eigen::Vector3d centre;  // from the carrier's centre of mass
    double radius;
  };

  const SideGear& of(Side side) const { return sides_[static_cast<size_t>(side)]; }

  std::vector<Carrier> carriers_;
  std::vector<size_t> carrier_of_body_;  // of each body of the assembly
  std::vector<Shaft> shafts_;
  std::vector<Unit> units_;
  std::vector<Chain> chains_;  // none, or one a side: left, right
  size_t chassis_carrier_ = 0;
  std::array<SideGear, 2> sides_{};
  double mass_ = 0.0;
  double tread_ = 0.0;

 private:
  void add_carriers(const Assembly& assembly, const std::vector<bool>& is_wheel,
                    const VehicleOptions& options);
  void add_running_gear(const Assembly& assembly, const VehicleOptions& options);
  /// Lists the points of hull and running gear that meet walls.
  void add_wall_points(const VehicleOptions& options);
  /// Lists what other robots meet of running gear, and then of all the rest.
  void add_gear_surface(size_t carrier, const RunningGearGeometry& gear, size_t drive);
  void add_hull_surface();
};

}  // namespace screed
