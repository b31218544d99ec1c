// The parts of a body that are no running gear, in contact with the ground: points all over them
// on what is rigid, boxes round them on soil and particles.
//
// Everything is in the frame of the body's centre of mass.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "host_sim/physics/particles/particle_bed.h"
#include "host_sim/physics/soil/soil_bed.h"
#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/physics/vehicle/running_gear.h"
#include "host_sim/physics/vehicle/terrain_contact.h"

namespace screed {

class Hull {
 public:
  /// A shape of the hull, in a frame that stands at `pose`.
  void add(const Shape& shape, const Eigen::Isometry3d& pose);
  /// After the last shape. The ground is as stiff as lets a robot of that mass, on four points,
  /// sink in by a millimetre.
  void close(double friction, double robot_kg);

  /// Clears the state of all contacts.
  void reset_contacts();

  const std::vector<Eigen::Vector3d>& points() const { return points_; }

  /// Adds what the ground does to the body in this step.
  void contact(const HeightField& ground, const CarrierMotion& motion, double dt, Wrench& wrench);
  void contact(ParticleBed& particles, const CarrierMotion& motion, double dt, Wrench& wrench);
  /// Adds the boxes that may touch the soil; they stay valid until the hull is changed.
  void add_soil_contacts(const SoilBed& soil, const CarrierMotion& motion,
                         std::vector<SoilContact>& contacts);

 private:
  std::vector<Eigen::Vector3d> points_;
  std::vector<Eigen::Vector3d> bristles_;  ///< a point
  ContactLaw law_;
  std::vector<Footprint> boxes_;
  std::vector<Eigen::Isometry3d> box_poses_;
  std::vector<ContactMemory> box_memories_;
  double reach_ = 0.0;  ///< of points and boxes, for the broad phase
};

}  // namespace screed
