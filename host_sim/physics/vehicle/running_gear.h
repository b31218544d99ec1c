// Contact with rigid terrain: of a point, and of a belt or wheel made of points.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <vector>

#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/physics/terrain/terrain.h"

namespace screed {

// The force between one point of a surface that may move (a belt, a wheel's rim, the chassis) and
// rigid terrain.
//
// Normal: a spring and damper that never pull. Tangential: elastic bristles with Coulomb's limit:
// the bristle is the distance that the surface has moved over the terrain while it stuck, so a
// robot stands still on a slope instead of creeping. Along a moving belt the bristles travel with
// its material (brush model; Pacejka, Tire and Vehicle Dynamics, ch. 3): the owner of the points
// does that.

struct ContactLaw {
  double stiffness = 0.0;  ///< N/m per point, normal and tangential alike
  double damping = 0.0;    ///< N s/m per point
  double friction = 0.8;   ///< Coulomb coefficient
};

/// How the terrain lies under a point that is in it.
struct TerrainContact {
  Eigen::Vector3d normal;  ///< of the terrain, unit length
  double depth;            ///< m, along the normal, positive
};

/// Whether `position` is below the terrain's surface.
inline bool find_contact(const HeightField& terrain, const Eigen::Vector3d& position,
                         TerrainContact& contact) {
  const SurfacePoint surface = terrain.at(position.x(), position.y());
  const double gap = position.z() - surface.height;
  if (gap >= 0.0) return false;
  const double scale = 1.0 / std::sqrt(1.0 + surface.gradient_x * surface.gradient_x +
                                       surface.gradient_y * surface.gradient_y);
  contact.normal = {-surface.gradient_x * scale, -surface.gradient_y * scale, scale};
  contact.depth = -gap * scale;
  return true;
}

/// Force on a surface point that touches the terrain. The surface moves at `velocity` over it, belt
/// motion included; the contact point sinks in at `body_velocity`, without it: a wheel that
/// rolls does not press deeper where its rim goes down. `bristle` is the state of the point, world
/// frame, m; it becomes zero when the point is being pulled out and carries no load.
inline Eigen::Vector3d contact_force(const ContactLaw& law, const TerrainContact& contact,
                                     const Eigen::Vector3d& body_velocity,
                                     const Eigen::Vector3d& velocity, double dt,
                                     Eigen::Vector3d& bristle) {
  const double normal_force =
      law.stiffness * contact.depth - law.damping * body_velocity.dot(contact.normal);
  if (normal_force <= 0.0) {
    bristle.setZero();
    return Eigen::Vector3d::Zero();
  }
  const Eigen::Vector3d sliding = velocity - velocity.dot(contact.normal) * contact.normal;
  bristle += sliding * dt;
  bristle -= bristle.dot(contact.normal) * contact.normal;
  Eigen::Vector3d tangential = -law.stiffness * bristle - law.damping * sliding;
  const double limit = law.friction * normal_force;
  const double size2 = tangential.squaredNorm();
  if (size2 > limit * limit) {
    tangential *= limit / std::sqrt(size2);
    bristle = tangential / -law.stiffness;
  }
  return normal_force * contact.normal + tangential;
}

// The surface of one unit of running gear: a belt around two wheels, or a single wheel.
//
// A unit is a closed contour in a plane of the chassis, covered with contact points, whose surface
// moves along it at one speed, which the shaft gives (drive_train.h): a belt does not slip on its
// wheels.

/// Vertical part of the outward normal from which a point of a contour is on its upper side; above
/// 0, so that a robot on its side counts.
inline constexpr double kUpperSide = 0.2;
/// Below this speed slip means nothing, m/s.
inline constexpr double kSlipSpeed = 1e-3;
/// Sine of the axles' inclination from which running gear lies on its side.
inline constexpr double kOnItsSide = 0.8;

/// The carrying body at this step, its motion in the world frame.
struct CarrierMotion {
  Eigen::Vector3d origin;    ///< centre of mass
  Eigen::Matrix3d rotation;  ///< body to world
  Eigen::Vector3d velocity;  ///< of the centre of mass
  Eigen::Vector3d omega;
  double mass_kg;
  Eigen::Matrix3d inverse_inertia;  ///< in its own axes
};

// The points of a body that are in hard ground in one step, and how stiff the ground may be to
// them.
//
// Springs and dampers are explicit: with k and c per point, and the body's velocities answering
// forces at these points by at most lambda, a step of dt is stable while dt (c + dt k / 2) lambda
// < 2. For a body that is too light for it, the ground is as much softer as it takes. lambda is
// bounded by the points' number over the mass and the row sums of the inverse inertia times
// sum(r^2 1 - r r^T), r from the centre of mass.

class GroundTouches {
 public:
  struct Touch {
    size_t point;
    Eigen::Vector3d arm;  ///< world axes
    TerrainContact contact;
  };

  void clear() {
    touches_.clear();
    spread_.setZero();
  }
  /// `at`: in the body's frame.
  void add(size_t point, const Eigen::Vector3d& at, const Eigen::Vector3d& arm,
           const TerrainContact& contact) {
    touches_.push_back({point, arm, contact});
    spread_ -= at * at.transpose();
    spread_.diagonal().array() += at.squaredNorm();
  }
  const std::vector<Touch>& touches() const { return touches_; }
  /// The law that a step of dt carries.
  ContactLaw softened(ContactLaw law, const CarrierMotion& carrier, double dt) const {
    constexpr double kMaxAsked = 1.5;  // of the 2 that would swing for ever
    const double lambda = static_cast<double>(touches_.size()) / carrier.mass_kg +
                          (carrier.inverse_inertia * spread_).cwiseAbs().rowwise().sum().maxCoeff();
    const double asked = dt * (law.damping + 0.5 * dt * law.stiffness) * lambda;
    if (asked > kMaxAsked) {
      law.stiffness *= kMaxAsked / asked;
      law.damping *= kMaxAsked / asked;
    }
    return law;
  }

 private:
  std::vector<Touch> touches_;
  Eigen::Matrix3d spread_ = Eigen::Matrix3d::Zero();
};

/// Sum of forces on the carrying body, about its centre of mass, world frame.
struct Wrench {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();

  void add(const Eigen::Vector3d& f, const Eigen::Vector3d& arm) {
    force += f;
    torque += arm.cross(f);
  }
  /// What terrain does to a footprint of the body.
  void add(const FootprintContact& contact) {
    add(contact.reaction.force, contact.arm);
    torque += contact.reaction.torque;
  }
};

struct RunningGearGeometry {
  /// Centre of the front wheel, in the frame of the carrier's centre of mass.
  Eigen::Vector3d front;
  Eigen::Vector3d rear;       ///< of the rear wheel; equal to `front` for a single wheel
  double radius = 0.03;       ///< m, belt included
  double width = 0.03;        ///< m
  double lug_height_m = 0.0;  ///< of the tread, which takes soil along
};

/// What a unit carries.
struct GearLoad {
  double weight_n = 1.0;  ///< on level ground; sets the stiffness, so that it sinks in 0.4 mm
  double mass_kg = 0.1;   ///< share of the robot's mass, for the damping
};

class RunningGear {
 public:
  RunningGear(const RunningGearGeometry& geometry, double friction, const GearLoad& load);

  /// The unit as a footprint of the carrier, while its surface moves at `speed` over the wheels
  /// (m/s, driving forward positive); valid until the next call.
  FootprintContact make_footprint_contact(FootprintShape shape, const CarrierMotion& carrier,
                                          double speed);
  /// What this step does to the unit, added to `wrench`: the forces of its points on a hard surface
  /// and the terrain's reaction to its footprint, either null where there is none. Returns the
  /// terrain's force along the surface's motion, N.
  double apply_contact(const HeightField* hard, const FootprintContact* pressed,
                       const CarrierMotion& carrier, double speed, double dt, Wrench& wrench);

  /// Clears the state of all contacts.
  void reset_contacts();

  double radius_m() const { return geometry_.radius; }
  double normal_load_n() const { return normal_load_; }
  /// Greatest depth below the undisturbed terrain, 0 on terrain that remembers none.
  double sinkage_m() const { return sinkage_; }
  const Eigen::Vector3d& centre() const { return centre_; }
  /// The contour's points in the frame of the carrier's centre of mass.
  const std::vector<Eigen::Vector3d>& points() const { return points_; }
  /// Of each of them the direction of the material when driving forward, unit length.
  const std::vector<Eigen::Vector3d>& directions() const { return along_; }

 private:
  double stand_on(const HeightField& hard, const CarrierMotion& carrier, double speed, double dt,
                  Wrench& wrench);
  void add_point(const Eigen::Vector3d& at, const Eigen::Vector3d& out,
                 const Eigen::Vector3d& along);
  void carry_bristles(double speed, double dt);
  void reset_contacts(size_t point);

  RunningGearGeometry geometry_;
  ContactLaw law_;
  double spacing_;  ///< between neighbours along the contour, m
  int rows_ = 2;    ///< contours side by side, at both edges of the belt
  Eigen::Vector3d centre_;

  // Point i of row r stands at index r * (count / rows) + i, in the order in which the material
  // passes when driving forward.
  std::vector<Eigen::Vector3d> points_;
  std::vector<Eigen::Vector3d> outwards_;  ///< normal of the contour, unit length
  std::vector<Eigen::Vector3d> along_;     ///< direction of the material, unit length
  std::vector<Eigen::Vector3d> bristles_;  ///< world frame, m
  std::vector<Eigen::Vector3d> carried_;   ///< bristles before carry_bristles
  std::vector<uint8_t> bent_;              ///< whether a bristle may differ from zero

  Footprint footprint_;
  Footprint side_footprint_;  ///< its lower surface when it lies on its side
  Eigen::Matrix3d axes_;      ///< forward, left, up of the contour in the carrier's frame
  ContactMemory memory_;
  GroundTouches touches_;  ///< of one step; kept for its room
  double normal_load_ = 0.0;
  double sinkage_ = 0.0;
};

}  // namespace screed
