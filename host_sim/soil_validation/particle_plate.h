// What soil a bed of particles is like: a plate pressed into it, again and again, and a block
// dragged over it. Gives the figures that a deformable soil needs to stand for it.
#pragma once

#include <vector>

#include "host_sim/core/task_progress.h"
#include "host_sim/physics/particles/particle_bed.h"

namespace screed {

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
