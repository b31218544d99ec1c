// Deformable soil on a grid of integer heights (soil contact model, SCM): bodies sink in, shear,
// push material aside.
//
// Each node keeps two integers: `height`, the surface as it lies there unloaded, and `reference`,
// the level from which Bekker's sinkage counts; their difference is the plastic sinkage. Material
// that moves changes both, in pairwise opposite amounts, so that the volume is exact; material that
// is compacted is booked. A node stands for a cell: its pressure is the mean over the cell, of
// Bekker's law at a lattice of sample points below the body (footprint.h), so a body may cover a
// cell in part and the result does not depend on where the grid lies. Sample points that the lowest
// point of a rolling wheel has passed are known to be unloading, from the geometry alone, which
// spares a memory finer than the grid.
//
// Forces of a footprint are summed in a fixed order: the same bits on every compiler and any number
// of worlds side by side.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "host_sim/physics/soil/cell_history.h"
#include "host_sim/physics/soil/material_flow.h"
#include "host_sim/physics/soil/passive_pressure.h"
#include "host_sim/physics/soil/power_table.h"
#include "host_sim/physics/soil/sinking.h"
#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/physics/soil/wheel_stress.h"
#include "host_sim/physics/terrain/footprint_contact.h"
#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/physics/terrain/terrain.h"

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
  /// Where a body passed, it is taken to have come along its path, uphill or downhill. false:
  /// level, as if it had come at its present height, by which long belts sink too deep downhill
  /// (the simpler model, for comparisons).
  bool follow_slopes = true;
  double sample_spacing_m = 0.00125;  ///< of the sample points inside a cell, at most
};

class SoilBed final : public Terrain {
 public:
  SoilBed(HeightField surface, const SoilParameters& soil, const SoilOptions& options = {});

  /// How the body sinks and tilts on all its footprints is solved together. Each contact needs a
  /// memory.
  void press(const PressingBody& body, std::span<FootprintContact> contacts, double dt,
             BodyMemory& memory) override;
  /// A footprint by itself: it sinks and does not tilt.
  TerrainReaction press(const Footprint& footprint, const FootprintMotion& motion, double dt,
                        ContactMemory& memory);
  /// Ends a step: what was sunk is deposited beside the footprints, slopes slide.
  void end_step();
  void end_step(double /*dt*/) override { end_step(); }
  /// Lets slopes slide until none is too steep, or `max_moves` moves were made; returns the moves.
  int64_t relax_slopes(int64_t max_moves = INT64_MAX);

  const HeightField& surface() const override { return flow_.surface(); }
  bool is_deformable() const override { return true; }
  BedBounds bounds() const override { return bounds_of(surface()); }
  FootprintShape footprint_shape() const override { return FootprintShape::kLowerSurface; }
  double max_height_within(double x, double y, double radius) const override {
    return surface().max_height_within(x, y, radius);
  }
  /// Whether the slopes round a node are still to be looked at: a body stood on it in the last step
  /// and held it, or more slid than a step has time for; then slopes_left() was not 0.
  bool is_slope_queued(int ix, int iy) const { return flow_.is_queued(flow_.index(ix, iy)); }
  /// Nodes that the last step had no time for.
  size_t slopes_left() const { return slopes_left_; }
  const SoilParameters& soil() const { return soil_; }
  VolumeBalance balance() const override;

 private:
  enum class Lattice : uint8_t {  // the sample points of a cell
    kCentre,                      // one: below a plane
    kOnePerRowAndColumn,          // sees what varies along or across as finely as all
    kFull,                        // all: at the rim of a body with corners
  };
  struct Law {       // of the soil under one footprint in one step
    double bekker;   // k_c / b + k_phi
    double elastic;  // E, Pa/m
    const PowerTable* table;
    WheelStress stress;
    Eigen::Vector3d sine;    // times a place from the wheel's centre: sine of its angle
    double per_upright = 1;  // 1 / cosine of the path's slope
    double rebound = 0.0;    // share of what a wheel presses down that comes up behind it
  };
  struct Candidate {
    size_t node;
    int ix;
    int iy;
    Lattice lattice;
    size_t first = 0;  // of its sample points
    size_t count = 0;
    double reference = 0.0;  // level of the undisturbed surface, m
    double sunk = 0.0;       // plastic sinkage, m
    double covered = 0.0;    // share of it below the body
    SinkageDivision division{};
  };
  struct SoilCell {  // one cell under a footprint, sampled
    size_t node;
    int ix;
    int iy;
    double share;     // of the cell that carries load
    double pressed;   // plastic sinkage that this contact requires, earlier contacts included, m
    double pressure;  // mean pressure at that sinkage, before the body moves in this step, Pa
    double rate;      // of that pressure with further sinking, Pa/m
    double slope_x;   // horizontal force of the normal stress, over its vertical force
    double slope_y;
    double tilt_x;  // the same of the surface alone, mean over the touching part
    double tilt_y;
    Eigen::Vector3d moment;  // about the footprint's centre, per newton of vertical load, m
    Eigen::Vector3d arm;     // centre of pressure, from the footprint's centre
    double sunk;             // plastic sinkage, m
    double depth;            // of the body below the undisturbed surface, mean over the touching
                             // part, m
  };
  struct Range {  // of one footprint among cells_
    size_t begin;
    size_t end;
    Law law;
    size_t footprint;  // as flow_ numbers them
    RunFrame frame;
    double rear;  // of the contact along the contour, m
    double front;
  };

  /// How a footprint slips over what it touches: sums over its cells, each times its share.
  struct SlipSums {
    SlipSums(const Eigen::Vector3d& along, const Eigen::Vector3d& across)
        : forward(along), side(across) {}
    void add(const SoilCell& cell, double sliding, double mobilised);
    Eigen::Vector3d forward;  // level, unit length
    Eigen::Vector3d side;
    double share = 0.0;
    double sum_along = 0.0;  // of the cells' positions from the footprint's centre, m
    double sum_across = 0.0;
    double sum_along_squared = 0.0;  // m^2
    double sum_across_squared = 0.0;
    double slip_sum = 0.0;  // of their slip times the mobilised share, m/s
  };

  Range find_cells(const FootprintContact& contact, double elastic);
  void find_candidates(const Footprint& footprint, double rebound_m);
  void add_sample_points(const Candidate& candidate);
  void divide_sinkage();
  WheelStress wheel_stress(const FootprintContact& contact, Law& law) const;
  bool sample(const Footprint& footprint, const Candidate& candidate, const Law& law,
              SoilCell& cell);
  template <size_t static_count>
  bool sample_points(const Footprint& footprint, const Candidate& candidate, const Law& law,
                     SoilCell& cell);
  void find_extent(const Footprint& footprint, Range& range) const;
  void measure_patch(const Footprint& footprint, size_t begin, ContactMemory& memory) const;
  void advance_shear(const Range& range, const PressingBody& body, FootprintContact& contact,
                     double dt) const;
  double yield(const SoilCell& cell, double sinking, const Law& law, size_t footprint);
  void react(const Range& range, const PressingBody& body, FootprintContact& contact, double dt);
  void dig_below(const SlipSums& slip, const Eigen::Isometry3d& pose, double dt);
  size_t sample_count(Lattice lattice) const;

  SoilParameters soil_;
  SoilOptions options_;
  MaterialFlow flow_;
  /// Of Bekker's exponent, finer than anybody knows it.
  static constexpr double kExponentStep = 0.005;
  std::vector<PowerTable> tables_;  // of n, and of what slip-sinkage makes of it
  double tan_friction_;
  double cell_area_;
  int samples_per_side_;          // along one side of a cell
  std::vector<double> lattice_;   // rows, and columns, of sample points, from a cell's centre, m
  std::vector<double> permuted_;  // the column of one sample point in each row
  int64_t volume_before_;
  int64_t compacted_ = 0;
  double compaction_remainder_ = 0.0;  // parts of a unit, for the next step
  double dig_remainder_ = 0.0;
  size_t slopes_left_ = 0;
  uint32_t step_ = 1;
  PassivePressure passive_;
  std::vector<CellHistory> histories_;

  // Of the body being pressed; kept for their room.
  FootprintSamples candidate_points_;  // one a cell, its centre
  FootprintSamples sample_points_;     // of all candidates, inside the cells
  std::vector<Candidate> candidates_;
  std::vector<SoilCell> cells_;  // the first cell_count_ of them
  size_t cell_count_ = 0;
  std::vector<SoilSpring> springs_;
  std::vector<Range> ranges_;
};

}  // namespace screed
