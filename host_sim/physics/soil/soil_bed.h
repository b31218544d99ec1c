// Deformable soil on a grid of integer heights (soil contact model, SCM): bodies sink in, shear,
// push material aside.
//
// A cell (soil_grid.h) has a pressure that is the mean over it, of Bekker's law at a lattice of
// sample points below the body (footprint.h), so a body may cover a cell in part and the result
// does not depend on where the grid lies. Sample points that the lowest point of a rolling wheel
// has passed are known to be unloading, from the geometry alone, which spares a memory finer than
// the grid.
//
// Forces of a footprint are summed in a fixed order: the same bits on every compiler and any number
// of worlds side by side.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "host_sim/physics/kernels/kernels.h"
#include "host_sim/physics/soil/material_flow.h"
#include "host_sim/physics/soil/sinking.h"
#include "host_sim/physics/soil/soil_grid.h"
#include "host_sim/physics/soil/soil_laws.h"
#include "host_sim/physics/soil/soil_parameters.h"
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
  /// For tests: all sets of instructions give the same bits.
  InstructionSet instructions = best_kernels().set;
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

  const HeightField& surface() const override { return flow_.grid().surface(); }
  bool is_deformable() const override { return true; }
  BedBounds bounds() const override { return bounds_of(surface()); }
  FootprintShape footprint_shape() const override { return FootprintShape::kLowerSurface; }
  double max_height_within(double x, double y, double radius) const override {
    return surface().max_height_within(x, y, radius);
  }
  /// Whether the slopes round a node are still to be looked at: a body stood on it in the last step
  /// and held it, or more slid than a step has time for; then slopes_left() was not 0.
  bool is_slope_queued(int ix, int iy) const { return flow_.is_queued(flow_.grid().node(ix, iy)); }
  /// Nodes that the last step had no time for.
  size_t slopes_left() const { return slopes_left_; }
  const SoilParameters& soil() const { return soil_; }
  const SoilOptions& options() const { return options_; }
  VolumeBalance balance() const override { return flow_.balance(); }
  /// What is kept from step to step, but the surface: for an archive as those of cereal. A bed made
  /// with the same surface, soil and options goes on from it with the same bits.
  template <typename Archive>
  void serialize(Archive& archive) {
    archive(flow_, dig_remainder_, slopes_left_, step_);
  }

 private:
  struct GridPlace {
    GridNode at;
    uint32_t candidate;  // its number
  };
  /// The sample points of a cell.
  enum Lattice : uint8_t {
    kCentre,              // one: below a plane
    kOnePerRowAndColumn,  // sees what varies along or across as finely as all
    kFull,                // all: at the rim of a body with corners
    kLattices,
    kNone,  // not touched
  };
  struct LatticePoints {  // from the cell's centre, m
    std::vector<double> x;
    std::vector<double> y;
  };
  struct CellRun {  // candidates that follow each other in a row of the grid, west to east
    GridNode first;
    size_t count;
  };
  struct Group {  // blocks of cells with the same lattice
    Lattice lattice;
    size_t begin;  // among cells_
    size_t blocks;
    size_t first_point;
  };
  struct Law {  // of the soil under one footprint in one step
    CellLaw cell{};
    WheelStress stress;
  };
  struct Range {  // of one footprint among the blocks of cells_
    size_t begin = 0;
    size_t end = 0;
    Law law;
    RunFrame frame{};
    double rear = 0.0;  // of the contact along the contour, m
    double front = 0.0;
    bool touching = false;
    ReactionLaw reaction{};
  };

  Range find_cells(const FootprintContact& contact, double elastic, double dt);
  Law law_below(const FootprintContact& contact, const RunFrame& frame, double elastic,
                double dt) const;
  void find_candidates(const Footprint& footprint, const PathHistory& path, double rebound_m);
  bool find_runs(const Footprint& footprint, double highest);
  void drop_cells_below(const Footprint& footprint, double rebound_m);
  void classify(const Footprint& footprint, double rebound_m);
  Lattice lattice_of_corner(size_t candidate, double highest_surface, double rim) const;
  void lay_out_cells();
  void sample_surface(const Footprint& footprint, const PathHistory& path);
  void copy_plane_points(const Footprint& footprint, const Group& group);
  WheelStress wheel_stress(const FootprintContact& contact, Law& law);
  void find_extent(const Footprint& footprint, const CellSums& sums, Range& range) const;
  void measure_patch(const Footprint& footprint, const CellSums& sums, ContactMemory& memory) const;
  void advance_shear(const Range& range, const PressingBody& body, FootprintContact& contact,
                     double dt) const;
  ReactionLaw reaction_law(const Range& range, const PressingBody& body,
                           const FootprintContact& contact, double dt) const;
  void react(const Range& range, const PressingBody& body, FootprintContact& contact, double dt);
  void settle(const Range& range, bool slips);
  void dig_below(const ReactionSums& sums, const ReactionLaw& law, const FootprintContact& contact,
                 double dt);

  SoilParameters soil_;
  SoilOptions options_;
  const Kernels& kernels_;
  MaterialFlow flow_;
  PowerTable power_;
  double tan_friction_;
  double tan_repose_;
  double cell_area_;
  int samples_per_side_;  // along one side of a cell
  std::array<LatticePoints, kLattices> lattices_;
  double dig_remainder_ = 0.0;
  size_t slopes_left_ = 0;
  uint32_t step_ = 1;
  PassivePressure passive_;

  // Of the footprint being pressed; kept for their room.
  std::vector<CellRun> runs_;
  FootprintSamples candidate_points_;  // one a cell, its centre
  std::vector<Height> candidate_heights_;
  std::vector<uint8_t> flat_bits_;  // of candidates, a byte a block of lanes
  std::vector<uint8_t> curved_bits_;
  std::array<std::vector<GridPlace>, kLattices> candidates_;  // by their lattice
  std::vector<Group> groups_;
  FootprintSamples sample_points_;  // inside the cells, a block of lanes after the other
  // Of the body being pressed.
  std::vector<CellBlock> cells_;
  std::vector<GridPlace> places_;  // of the cells' lanes
  std::vector<SpringBlock> springs_;
  size_t blocks_ = 0;  // of these in use
  std::vector<Range> ranges_;
};

}  // namespace screed
