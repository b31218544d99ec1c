// Tests of a whole bed: a tower of loose material that collapses (how steep what remains is, and
// whether all of it is still there), and a plain robot that drives.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "host_sim/physics/soil/soil_bed.h"
#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/physics/vehicle/ode_world.h"

namespace screed {

struct ReposeTest {
  SoilParameters soil;
  double cell_m = 0.005;
  double size_m = 0.6;     ///< of the bed's side
  double radius_m = 0.06;  ///< of the tower
  double height_m = 0.15;
  double centre_x_m = 0.0;
  double centre_y_m = 0.0;
  bool wrap = false;
  double tap_m = 1e-4;  ///< a plate taps the tower's top by so much first; 0: untouched
};

struct ReposeResult {
  int64_t moves;
  int64_t volume_error;       ///< units of height times cells: 0
  double excess_units;        ///< of the steepest pair of neighbours above the angle of repose
  double slope_axis_deg;      ///< of the pile's flank along the grid's axes: chord between a
                              ///< quarter and three quarters of its height
  double slope_diagonal_deg;  ///< and along its diagonals
  HeightField surface;
};

/// Throws InputError for figures out of range.
ReposeResult collapse(const ReposeTest& test);

/// By how many units of height the steepest pair of neighbours (straight or diagonal, across a
/// wrapped edge too) exceeds a slope of `repose_deg`; negative when none does.
double repose_excess_units(const HeightField& surface, double repose_deg);

/// Masses and places as in docs/studies/soil.md.
struct SoilRobotShape {
  double wheel_radius_m = 0.03;
  double wheel_width_m = 0.025;
  double wheelbase_m = 0.17;
  double track_m = 0.20;
  double chassis_kg = 0.8;
  double wheel_kg = 0.1;
  Eigen::Vector3d chassis_m{0.25, 0.15, 0.06};
  double chassis_above_axles_m = 0.02;
};

/// The robot of the timing test: one rigid body in ODE on four driven wheels whose spin is imposed.
/// Not the Rover (host_sim/physics/vehicle): a plain body that any engine can rebuild.
class SoilRobot {
 public:
  /// Puts the robot down on the bed at (x, y), heading along x; the bed must outlive it.
  SoilRobot(SoilBed& bed, const SoilRobotShape& shape, double x, double y);

  /// One step of soil and bodies with these rim speeds, m/s.
  void step(double left_m_per_s, double right_m_per_s, double dt);

  Eigen::Vector3d position() const;  ///< of the centre of mass
  Eigen::Vector3d velocity() const;
  Eigen::Matrix3d rotation() const;
  double load_n() const { return load_; }  ///< that the soil supported in the last step

 private:
  struct Wheel {
    Eigen::Vector3d place;  // from the centre of mass
    Footprint footprint;
    ContactMemory memory;
  };

  SoilBed& bed_;
  OdeWorld world_;
  dBodyID body_;
  std::array<Wheel, 4> wheels_;
  double mass_ = 0.0;
  Eigen::Matrix3d inverse_inertia_;  // about the centre of mass, in the body's axes
  BodyMemory memory_;
  double load_ = 0.0;
};

/// A fingerprint of all heights of a surface.
std::string surface_hash(const HeightField& surface);

}  // namespace screed
