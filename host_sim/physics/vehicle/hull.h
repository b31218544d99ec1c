// The parts of a body that are no running gear, in contact with the ground: points all over them
// on a hard surface, boxes round them as footprints.
//
// Everything is in the frame of the body's centre of mass.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "host_sim/physics/terrain/terrain.h"
#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/physics/vehicle/running_gear.h"

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
  /// The boxes that the hull is made of, and where they are in the body's frame.
  const std::vector<Footprint>& boxes() const { return boxes_; }
  const std::vector<Eigen::Isometry3d>& box_poses() const { return box_poses_; }

  /// Adds what a hard surface does to the body's points in this step.
  void stand_on(const HeightField& hard, const CarrierMotion& motion, double dt, Wrench& wrench);
  /// Adds the boxes that may touch the terrain; they stay valid until the hull is changed.
  void add_footprint_contacts(const Terrain& terrain, const CarrierMotion& motion,
                              std::vector<FootprintContact>& contacts);

 private:
  std::vector<Eigen::Vector3d> points_;
  std::vector<Eigen::Vector3d> bristles_;  ///< a point
  GroundTouches touches_;                  ///< of one step; kept for its room
  ContactLaw law_;
  std::vector<Footprint> boxes_;
  std::vector<Eigen::Isometry3d> box_poses_;
  std::vector<ContactMemory> box_memories_;
  double reach_ = 0.0;  ///< of points and boxes, for the broad phase
};

}  // namespace screed
