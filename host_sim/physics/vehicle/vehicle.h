// A skid-steered robot in the world: rigid bodies integrated by ODE, running gear and chassis in
// contact with the terrain.
//
// Its parts (vehicle_parts.h) as ODE bodies, their revolute joints, but for the wheels', as ODE
// hinges. All forces of the terrain are our own (terrain.h, running_gear.h), those of the walls
// round it (wall_contact.h) and those of other robots (robot_contact.h).
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <vector>

#include "host_sim/physics/terrain/terrain.h"
#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/physics/vehicle/ode_world.h"
#include "host_sim/physics/vehicle/robot_contact.h"
#include "host_sim/physics/vehicle/vehicle_parts.h"
#include "host_sim/physics/vehicle/vehicle_state.h"

namespace screed {

class Vehicle : public VehicleState, private VehicleParts {
 public:
  /// Throws InputError as VehicleParts does.
  Vehicle(OdeWorld& world, const Assembly& assembly, const VehicleOptions& options);

  /// Puts the robot somewhere, at rest. Passive joints go back to zero.
  void place(const Eigen::Isometry3d& pose);
  /// Moves the whole robot sideways as it is: motion, joints and grip stay.
  void shift(double dx_m, double dy_m);
  using VehicleParts::mass_kg;
  using VehicleParts::resting_height;
  using VehicleParts::tread_m;

  /// From above: the rectangle round all contact points where they are now.
  Eigen::AlignedBox2d outline() const;

  /// Adds what two robots do to each other in this step. `to_other`: where the other one is to be
  /// looked for, from where it is; on a bed that wraps around one of its copies may be nearer.
  /// Before apply_forces() of either. Between chains and another robot there is friction, but their
  /// drive does not feel it.
  void collide(Vehicle& other, const Eigen::Vector3d& to_other, double dt, RobotContact& contact);
  /// How deep two robots stand in one another, m; 0 when they do not.
  double depth_in(Vehicle& other, const Eigen::Vector3d& to_other, RobotContact& contact);

  /// Adds the forces of this step to the bodies and advances the motors. The terrain's end_step()
  /// and the world's step() are the caller's, afterwards.
  void apply_forces(Terrain& terrain, const std::array<double, 2>& motor_voltage, double dt);

  ChassisState chassis() const override;
  /// Of motion and height over z = 0, shafts included, J.
  double energy_j() const;
  /// What its motors have done since the start while they drove, J.
  double motor_work_j() const;

  double track_speed_m_per_s(Side side) const override;
  double shaft_angle_rad(Side side) const override;
  double current_a(Side side) const override;
  double wheel_radius_m(Side side) const override;
  /// The side's links; null without tracks, or with a belt.
  const ChainTrack* chain(Side side) const;
  double load_n(Side side) const override;
  double sinkage_m(Side side) const override;
  double ground_speed_m_per_s(Side side) const override;

 private:
  void add_bodies(OdeWorld& world);
  void add_hinges(OdeWorld& world, const Assembly& assembly);
  struct ContactRanges {  // where they begin among contacts_
    size_t chains;
    size_t hull;
  };
  void terrain_contact(Terrain& terrain, size_t carrier, const CarrierMotion& motion, double dt,
                       Wrench& wrench);
  /// Fills contacts_ with the footprints of a carrier: running gear, chains, hull.
  ContactRanges collect_contacts(const Terrain& terrain, size_t carrier,
                                 const CarrierMotion& motion, double dt);
  void meet_walls(const BedBounds& bed, size_t carrier, const CarrierMotion& motion, double dt,
                  Wrench& wrench);
  /// Whether bodies of two robots may be so near each other.
  bool within_reach(double gap_m, size_t mine, const Vehicle& other, size_t theirs,
                    const Eigen::Vector3d& to_other) const;
  /// Calls visit(mine, theirs) for the bodies that may be so near each other.
  template <class Visit>
  void visit_near(double gap_m, Vehicle& other, const Eigen::Vector3d& to_other, Visit visit);
  PressingBody pressing_body(size_t carrier, const CarrierMotion& motion) const;
  CarrierMotion motion_of(size_t carrier) const;
  /// The carrier as it moves by itself, whatever hangs on it.
  PressingBody moving_body(size_t carrier, const CarrierMotion& motion) const;
  /// Fills drives_ with the shafts.
  void list_shaft_drives();
  RobotBody robot_body(size_t carrier, const Eigen::Vector3d& offset, Wrench& wrench);
  void add_wrench(size_t carrier, const Wrench& wrench);
  /// Ends the step of a carrier's chains; theirs begin at `first` among contacts_.
  void end_chains(const Terrain& terrain, size_t carrier, size_t first, const CarrierMotion& motion,
                  double dt, Wrench& wrench);
  ChainTrack::WheelRates wheel_rates(const Chain& chain) const;
  double surface_speed(const Unit& unit) const {
    return shafts_[unit.shaft].shaft.omega_rad_per_s() * unit.gear.radius_m();
  }
  const DriveShaft& shaft_of(Side side) const { return shafts_[of(side).shaft].shaft; }

  std::vector<dBodyID> bodies_;             // of the carriers
  std::vector<FootprintContact> contacts_;  // of one carrier in one step; kept for its room
  std::vector<SurfaceDrive> drives_;        // of the shafts, then of the chains; the same
};

}  // namespace screed
