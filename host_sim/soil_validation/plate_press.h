// A plate pressed into level soil at a given speed: pressure against depth, beside Bekker's law.
#pragma once

#include <vector>

#include "host_sim/physics/soil/soil_bed.h"
#include "host_sim/physics/soil/soil_parameters.h"

namespace screed {

struct PlateTest {
  SoilParameters soil;
  SoilOptions options{.bulldozing = false, .avalanches = false};
  bool round = false;      ///< a disc of diameter `length_m`
  double length_m = 0.05;  ///< of a rectangle's side; 0.005..1
  double width_m = 0.05;   ///< of its other side; 0.005..1
  double cell_m = 0.005;   ///< 0.0005..0.1
  double offset_x_m = 0.0;
  double offset_y_m = 0.0;
  double yaw_rad = 0.0;
  double speed_m_per_s = 0.01;  ///< > 0
  double step_s = 1e-3;         ///< 1e-5..0.1
  /// Depths that the plate moves to, one after the other, up or down, m.
  std::vector<double> depths_m = {0.02};
};

struct PlatePoint {
  double depth_m;
  double pressure_pa;  ///< vertical force over the plate's area
  double bekker_pa;    ///< closed form at this depth, as if never pressed deeper
  double b_m;          ///< as the soil measured it from the touched area; 0 before it touched
};

/// Bekker's law with the plate's own b (shorter side, or radius), never stiffer than E.
double bekker_pressure(const PlateTest& test, double depth_m);

/// One point a step. Throws InputError for figures out of range.
std::vector<PlatePoint> press_plate(const PlateTest& test);

/// The point of a run nearest to a depth, on the first way down.
const PlatePoint& at_depth(const std::vector<PlatePoint>& run, double depth_m);

}  // namespace screed
