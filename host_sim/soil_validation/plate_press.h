// Plates pressed into level soil, beside Bekker's law, and into a bed of particles, to find which
// soil it is like.
#pragma once

#include <vector>

#include "host_sim/core/task_progress.h"
#include "host_sim/physics/particles/particle_bed.h"
#include "host_sim/physics/soil/soil_bed.h"
#include "host_sim/physics/soil/soil_parameters.h"

namespace screed {

/// A plate pressed into level soil at a given speed: pressure against depth.
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

/// What soil a bed of particles is like: a plate pressed into it, again and again, and a block
/// dragged over it. Gives the figures that a deformable soil needs to stand for it.
struct ParticlePlateTest {
  ParticleMaterial particle;
  double depth_m = 0.10;        ///< of the bed, 0.02..1
  double length_m = 0.12;       ///< of the plate, 0.02..0.3
  double width_m = 0.04;        ///< 0.02..0.3
  double load_pa = 1338.0;      ///< below the block that is dragged, 100..1e5
  double speed_m_per_s = 0.05;  ///< of the block, 0.001..1
  uint64_t seed = 1;            ///< of the particles' layout
  int beds = 6;                 ///< laid with this seed and the next ones; 1..64
};

/// Means over the beds.
struct ParticlePlatePoint {
  double pressure_pa;
  double rut_m;               ///< that stays when the plate is lifted: mean height below the plate
  double raised_m3;           ///< around it
  double stiffness_pa_per_m;  ///< of unloading to half the pressure
  /// Depth that Bekker's law counts: the rut and what springs back.
  double depth_m() const { return rut_m + pressure_pa / stiffness_pa_per_m; }
};

struct ParticleDrag {
  double friction;              ///< greatest force along over load, of means over 1.5 mm
  double shear_displacement_m;  ///< after which it is 1 - 1/e of that
};

/// One point for each pressure, 1 to 20 kPa. Throws InputError for figures out of range. Reports
/// the task "pressing a plate".
std::vector<ParticlePlatePoint> press_particles(const ParticlePlateTest& test,
                                                const TaskProgress& progress = {});
/// A block with the outline of a belt, not driven, over the first 20 mm. Reports the task "dragging
/// a block".
ParticleDrag drag_over_particles(const ParticlePlateTest& test, const TaskProgress& progress = {});

}  // namespace screed
