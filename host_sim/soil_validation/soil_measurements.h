// Measurements on real soil, from CSV files: wheels in a single-wheel testbed, plates pressed in.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/soil_validation/wheel_limit.h"
#include "host_sim/soil_validation/wheel_schedule.h"

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

/// A wheel that rolled without slip until its rim went over to another speed, and how much deeper
/// it was then than it would have been without. A row a place; rows of one case follow each other.
/// Columns: case, wheel_radius_m, wheel_width_m, load_n, travel_m_s, rim_m_s, rim_time_constant_s
/// (0.001..10), slip_angle_deg (0 without), slip_path_m (of the rim, less the travel ahead),
/// extra_sinkage_m, extra_sinkage_error_m (a standard error; 0 without).
struct MeasuredTransient {
  struct Place {
    double slip_path_m;
    double extra_sinkage_m;
    double error_m;
  };
  std::string name;
  RollingWheel wheel;  ///< its slip does not count
  double travel_m_per_s;
  double rim_m_per_s;
  double time_constant_s;
  std::vector<Place> places;  ///< by rising slip path

  /// Until behind the last place.
  WheelSchedule schedule() const;
  /// What samples of that schedule give at the places, m.
  std::vector<double> extra_sinkage_m(const std::vector<WheelSample>& samples) const;
};

struct SoilMeasurements {
  std::vector<MeasuredWheel> wheels;
  std::vector<MeasuredTransient> transients;
  std::vector<MeasuredPlate> plates;
};

/// Rows whose case begins with `prefix`: transients when there is a column slip_path_m, wheels when
/// there is one wheel_radius_m, else plates.
/// Throws InputError with file and line when the file cannot be read, a column is missing, a number
/// is none or out of range, and when no row is left.
SoilMeasurements read_soil_measurements(const std::string& file, const std::string& prefix = "");

/// Rows of measurements that are trials of the same test of a wheel, by their places among the
/// measurements.
struct WheelTrials {
  double slip;  ///< mean
  double slip_angle_rad;
  std::vector<std::size_t> rows;
};

/// Slips of trials of one test differ by no more than this; loads by no more than a quarter. Both
/// are controlled, and measured in each trial.
inline constexpr double kSameSlip = 0.005;

/// All rows, by slip angle and slip from low to high. Trials of one test have the same wheel
/// (radius, width) and slip angle, and about the same slip and load.
std::vector<WheelTrials> wheel_trials(const std::vector<MeasuredWheel>& rows);

/// What was measured in the trials of one test.
struct TrialMean {
  double value;
  /// Of several trials the standard deviation (n - 1), at least the error that the rows state; of a
  /// single one what it states, or 0.
  double error;
  std::size_t trials;  ///< in which it was measured
};

/// A column of MeasuredWheel.
using WheelColumn = std::optional<double> MeasuredWheel::*;

/// Of the trials in which `value` was measured; nothing when it was in none. `error` may be null.
std::optional<TrialMean> mean_of_trials(const std::vector<MeasuredWheel>& rows,
                                        const WheelTrials& trials, WheelColumn value,
                                        WheelColumn error = nullptr);

}  // namespace screed
