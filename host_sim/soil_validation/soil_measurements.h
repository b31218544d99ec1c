// Measurements on real soil, from CSV files: wheels in a single-wheel testbed, plates pressed in.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host_sim/soil_validation/wheel_limit.h"

namespace screed {

/// A row of a test with a wheel. Columns, in any order: case, wheel_radius_m, wheel_width_m,
/// load_n, slip (as RollingWheel::slip), and of slip_angle_deg (0 without), drawbar_pull_n,
/// side_force_n, torque_nm, sinkage_m what was measured; an empty field was not. The columns
/// drawbar_pull_error_n, side_force_error_n and sinkage_error_m may say how uncertain that is: a
/// standard or a reading error, 0 or more.
struct MeasuredWheel {
  std::string name;
  RollingWheel wheel;
  std::optional<double> drawbar_pull_n;
  std::optional<double> side_force_n;
  std::optional<double> torque_nm;
  std::optional<double> sinkage_m;
  std::optional<double> drawbar_pull_error_n;
  std::optional<double> side_force_error_n;
  std::optional<double> sinkage_error_m;
};

/// A row of a test with a plate. Columns: case, plate_width_m, plate_length_m (a disc: both are its
/// diameter, and the column round is 1), depth_m, pressure_pa.
struct MeasuredPlate {
  std::string name;
  double width_m;  ///< the shorter side
  double length_m;
  bool round;
  double depth_m;
  double pressure_pa;
};

struct SoilMeasurements {
  std::vector<MeasuredWheel> wheels;
  std::vector<MeasuredPlate> plates;
};

/// Rows whose case begins with `prefix`; wheels when there is a column wheel_radius_m, else plates.
/// Throws InputError with file and line when the file cannot be read, a column is missing, a number
/// is none or out of range, and when no row is left.
SoilMeasurements read_soil_measurements(const std::string& file, const std::string& prefix = "");

}  // namespace screed
