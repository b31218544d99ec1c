// A skid-steered robot in the world: rigid bodies integrated by ODE, running gear and chassis in
// contact with the terrain.
//
// Bodies that a fixed joint holds together are one ODE body. Wheels ride with the body that carries
// them and turn on shafts (drive_shaft.h) under their running gear (running_gear.h). Other revolute
// joints are ODE hinges. All forces of the terrain are our own
// (terrain.h, terrain_contact.h), those of the walls round it (wall_contact.h) and those of other
// robots (robot_contact.h).
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <vector>

#include "host_sim/physics/terrain/terrain.h"
#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/physics/vehicle/chain_track.h"
#include "host_sim/physics/vehicle/drive_shaft.h"
#include "host_sim/physics/vehicle/gear_motor.h"
#include "host_sim/physics/vehicle/hull.h"
#include "host_sim/physics/vehicle/ode_world.h"
#include "host_sim/physics/vehicle/robot_contact.h"
#include "host_sim/physics/vehicle/running_gear.h"
#include "host_sim/physics/vehicle/vehicle_state.h"
#include "host_sim/physics/vehicle/wall_contact.h"

namespace screed {

enum class TrackModel {
  kBelt,   ///< a contour of fixed shape whose surface moves (running_gear.h)
  kChain,  ///< links round the wheels (chain_track.h)
};

struct VehicleOptions {
  /// A track round the wheels of each side. false: the wheels alone, all four driven; a wheel
  /// without a motor of its own is geared to the other one of its side.
  bool tracks = true;
  TrackModel track_model = TrackModel::kBelt;
  ChainOptions chain;
  double track_friction = 0.8;  ///< Coulomb coefficient, rubber on the ground
  double chassis_friction = 0.4;
  double wall_friction = 0.3;  ///< of anything on the walls of a bed
  GearMotor motor;
};

class Vehicle : public VehicleState {
 public:
  /// Throws InputError when the model cannot be driven: no motor wheel on a side, motor joints on
  /// other bodies, a wheel that no body carries.
  Vehicle(OdeWorld& world, const Assembly& assembly, const VehicleOptions& options);

  /// Puts the robot somewhere, at rest. Passive joints go back to zero.
  void place(const Eigen::Isometry3d& pose);
  /// Moves the whole robot sideways as it is: motion, joints and grip stay.
  void shift(double dx_m, double dy_m);
  /// Height of the chassis' origin at which the lowest contact point just touches the terrain, for
  /// this attitude at (x, y).
  double resting_height(const HeightField& terrain, double x, double y,
                        const Eigen::Matrix3d& rotation) const;

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
  double mass_kg() const { return mass_; }

  double track_speed_m_per_s(Side side) const override;
  double shaft_angle_rad(Side side) const override;
  double current_a(Side side) const override;
  double wheel_radius_m(Side side) const override;
  /// The side's links; null without tracks, or with a belt.
  const ChainTrack* chain(Side side) const;
  double load_n(Side side) const override;
  double sinkage_m(Side side) const override;
  /// Distance between the centre lines of left and right running gear.
  double tread_m() const { return tread_; }
  double ground_speed_m_per_s(Side side) const override;

 private:
  struct Carrier {  // one ODE body
    dBodyID body;
    Eigen::Isometry3d rest_pose;  // its centre of mass in the frame of the chassis, joints at zero
    Hull hull;
    WallContact walls;
    // For other robots:
    std::vector<BodyPoint> points;
    std::vector<SolidPart> solids;
    double reach;  // of points and solids from the centre of mass
    BodyMemory memory;
    double mass;
    Eigen::Matrix3d inverse_inertia;  // in its own axes
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
  struct ContactRanges {  // where they begin among contacts_
    size_t chains;
    size_t hull;
  };
  struct SideGear {  // where a side's motion is measured
    size_t carrier;
    size_t shaft;            // with the encoder
    Eigen::Vector3d centre;  // from the carrier's centre of mass
    double radius;
  };

  void add_carriers(const Assembly& assembly, const std::vector<bool>& is_wheel,
                    const VehicleOptions& options);
  void add_hinges(const Assembly& assembly);
  void add_running_gear(const Assembly& assembly, const VehicleOptions& options);
  void terrain_contact(Terrain& terrain, size_t carrier, const CarrierMotion& motion, double dt,
                       Wrench& wrench);
  /// Fills contacts_ with the footprints of a carrier: running gear, chains, hull.
  ContactRanges collect_contacts(const Terrain& terrain, size_t carrier,
                                 const CarrierMotion& motion, double dt);
  /// Lists the points of hull and running gear that meet walls.
  void add_wall_points(const VehicleOptions& options);
  void meet_walls(const BedBounds& bed, size_t carrier, const CarrierMotion& motion, double dt,
                  Wrench& wrench);
  /// Lists what other robots meet of running gear, and then of all the rest.
  void add_gear_surface(size_t carrier, const RunningGearGeometry& gear, size_t drive);
  void add_hull_surface();
  /// Whether bodies of two robots may be so near each other.
  static bool within_reach(double gap_m, const Carrier& one, const Carrier& other,
                           const Eigen::Vector3d& to_other);
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
  const SideGear& of(Side side) const { return sides_[static_cast<size_t>(side)]; }
  const DriveShaft& shaft_of(Side side) const { return shafts_[of(side).shaft].shaft; }

  OdeWorld& world_;
  std::vector<Carrier> carriers_;
  std::vector<size_t> carrier_of_body_;  // of each body of the assembly
  std::vector<Shaft> shafts_;
  std::vector<Unit> units_;
  std::vector<Chain> chains_;               // none, or one a side: left, right
  std::vector<FootprintContact> contacts_;  // of one carrier in one step; kept for its room
  std::vector<SurfaceDrive> drives_;        // of the shafts, then of the chains; the same
  size_t chassis_carrier_ = 0;
  std::array<SideGear, 2> sides_{};
  double mass_ = 0.0;
  double tread_ = 0.0;
};

}  // namespace screed
