// Deformable soil on a grid of integer heights (soil contact model, SCM): bodies sink in, shear,
// push material aside.
//
// Each node keeps two integers: `height`, the surface as it lies there unloaded, and `reference`,
// the level from which Bekker's sinkage counts; their difference is the plastic sinkage. Material
// that moves changes both, in pairwise opposite amounts, so that the volume is exact; material that
// is compacted is booked. A node stands for a cell: its pressure is the mean over the cell, of
// Bekker's law at a lattice of places below the body (footprint.h), so a body may cover a cell in
// part and the result does not depend on where the grid lies. Places that the lowest point of a
// rolling wheel has passed are known to be unloading, from the geometry alone, which spares a
// memory finer than the grid.
//
// Forces of a footprint are summed in a fixed order: the same bits on every compiler and any number
// of worlds side by side.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "host_sim/soil/footprint.h"
#include "host_sim/soil/material_flow.h"
#include "host_sim/soil/pressure_table.h"
#include "host_sim/soil/soil_parameters.h"
#include "host_sim/terrain/height_field.h"

namespace screed {

/// How normal stress acts on a body.
enum class NormalStress {
  kRadial,    ///< along the body's surface normal: what is measured on wheels; the default
  kVertical,  ///< straight up, as Project Chrono's SCM; for comparisons
};

struct SoilOptions {
  NormalStress normal_stress = NormalStress::kRadial;
  bool bulldozing = true;  ///< sunk and dragged material moves; false: it is compacted where it was
  bool avalanches = true;  ///< slopes above the angle of repose slide
  double sample_spacing_m = 0.00125;  ///< of the places inside a cell, at most
};

/// Motion of the pressing surface: that of the body plus the speed of its belt or rim.
struct FootprintMotion {
  Eigen::Vector3d velocity =
      Eigen::Vector3d::Zero();                      ///< of the footprint's centre, world frame, m/s
  Eigen::Vector3d omega = Eigen::Vector3d::Zero();  ///< of the body without the wheel's spin, rad/s
  double surface_speed =
      0.0;  ///< of the belt over its wheels, forward drive positive: below it goes backward, m/s
  double slip = 0.0;      ///< for slip-sinkage, 0..1
  double friction = 0.8;  ///< Coulomb's, against particles; soil has its own
  double mass_kg =
      1.0;  ///< that the footprint carries; infinite: the motion is imposed, whatever the force
};

/// Force and torque on the footprint, world frame, torque about its centre; what drives it; what it
/// rests on.
struct SoilReaction {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();
  double along_surface = 0.0;  ///< force of the ground along the belt's direction of motion, N
  double normal_load = 0.0;    ///< vertical part of the normal forces, N
  double sinkage = 0.0;        ///< greatest depth below the reference level, m
  double area = 0.0;           ///< touched, projected to the horizontal, m^2
};

/// What a footprint remembers from step to step.
struct ContactMemory {
  double patch_b_m = 0.0;  ///< b of Bekker's formula, from the touched area
  double patch_area_m2 = 0.0;
  bool touching = false;
  double sinkage = 0.0;     ///< greatest depth in the last step, m
  double travel_m = 0.0;    ///< way along local x since touching or turning back, signed
  double velocity_z = 0.0;  ///< of the last step, m/s
  double force_z = 0.0;     ///< of the soil in the last step, N
};

/// Volumes in units of height times cells. Always: heights_now = heights_before - compacted -
/// in_hand.
struct VolumeBalance {
  int64_t before = 0;
  int64_t now = 0;
  int64_t compacted = 0;
  int64_t in_hand = 0;  ///< sunk in the last steps and not yet set down
  int64_t error() const { return before - compacted - in_hand - now; }
};

class SoilBed {
 public:
  SoilBed(HeightField surface, const SoilParameters& soil, const SoilOptions& options = {});

  /// One footprint in this step. Every footprint of a step before end_step().
  SoilReaction press(const Footprint& footprint, const FootprintMotion& motion, double dt,
                     ContactMemory& memory);
  /// Ends a step: what was sunk is set down beside the footprints, slopes slide.
  void end_step();
  /// Lets slopes slide until none is too steep, or `most` moves were made; returns the moves.
  int64_t settle(int64_t most = INT64_MAX);

  const HeightField& surface() const { return flow_.surface(); }
  const SoilParameters& soil() const { return soil_; }
  VolumeBalance balance() const;

 private:
  enum class Lattice {  // the places of a cell where the body's surface is looked at
    kMiddle,            // one: below a plane
    kRook,  // one in each row and column: sees what varies along or across as finely as all
    kFull,  // all: at the rim of a body with corners
  };
  struct Law {       // of the soil under one footprint in one step
    double bekker;   // k_c / b + k_phi
    double elastic;  // E, Pa/m
  };
  struct Cell {  // one cell under the footprint, sampled
    size_t node;
    int ix;
    int iy;
    double share;          // of the cell that bears
    double pressed;        // plastic sinkage of the cell when it was virgin before this contact, m
    double pressure;       // mean pressure of virgin soil, Pa
    double rate;           // of that pressure with further sinking, Pa/m
    Eigen::Vector3d lift;  // mean of pressure times normal / normal.z
    Eigen::Vector3d moment;  // mean of arm x the same
    Eigen::Vector3d arm;     // mean place of the pressure, from the footprint's centre
    Eigen::Vector3d normal;  // mean, unit length
    double lead;  // mean place of the pressure ahead of the mean place of the touching part, along
                  // local x, m
    double sunk;  // plastic sinkage, m
  };

  bool sample(const Footprint& footprint, int ix, int iy, const PressureTable& table,
              const Law& law, double travel, Lattice lattice, Cell& cell) const;
  void drag(const Cell& cell, double way_x, double way_y);
  void measure_patch(const Footprint& footprint, double edge, ContactMemory& memory) const;
  static double pressure_after(const Cell& cell, const Law& law, double sinking);
  double solve_sinking(const FootprintMotion& motion, const ContactMemory& memory, const Law& law,
                       double dt) const;

  SoilParameters soil_;
  SoilOptions options_;
  MaterialFlow flow_;
  PressureTable table_;
  PressureTable slipping_;  // of the exponent that slip-sinkage made of it
  double tan_friction_;
  double cell_area_;
  int samples_;  // along one side of a cell
  int64_t volume_before_;
  int64_t compacted_ = 0;
  double compaction_rest_ = 0.0;
  uint32_t step_ = 1;
  std::vector<uint32_t> touched_;  // step of the last contact
  std::vector<float>
      shear_along_;  // mean shear displacement of the touching part along the belt, m
  std::vector<float> shear_across_;  // and across it
  std::vector<float> share_;         // of the cell that touched in the last contact
  std::vector<Cell> cells_;          // of the footprint being pressed
};

}  // namespace screed
