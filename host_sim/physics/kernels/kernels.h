// The inner loops of contact with soil, for eight sample points, cells or places at a time: lower
// surface of a belt or wheel, stress of cells, springs of a sinking body, reaction, shear. Each is
// written once (the .inc files) and compiled for each set of vector instructions; all give the same
// bits. Lengths in m, forces in N, pressures in Pa, world axes unless said otherwise.
//
// Files of kernels include nothing with templates of the standard library, so that no code for a
// newer processor can reach the rest of the program.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "host_sim/core/lanes/instruction_set.h"

namespace screed {

constexpr size_t kLanes = 8;
/// A body that covers a smaller share of a cell has pressed nothing there (soil_grid.h).
constexpr double kMinCoveredShare = 1e-3;
/// So many, rounded up to whole blocks.
constexpr size_t whole_blocks(size_t count) {
  return (count + kLanes - 1) / kLanes * kLanes;
}

/// A vector, plain.
struct Triple {
  double x;
  double y;
  double z;
};

/// Of a track or wheel and the way it came; footprint.cpp has the equations and fills it in.
struct TrackShape {
  bool belt;  ///< it has a run between two axles
  bool has_run;
  bool has_path;
  Triple centre;
  Triple axis_x;  ///< the body's axes x, y and z in the world
  Triple axis_y;
  Triple axis_z;
  Triple up;  ///< the world's vertical in the body's axes
  double square;
  double radius;
  double half;   ///< of the distance of the axles
  double width;  ///< half of it
  double edge;
  double run_z;
  double sense;
  double gradient;
  double reach;
  double per_climb;
  double deep[2];
  double touch[2];
};

/// Sample points, an array each, of whole blocks.
struct SurfacePoints {
  const double* x;
  const double* y;
  double* share;
  double* height;
  double* slope_x;
  double* slope_y;
  double* flat_within;
  double* passed;
};

/// Eight cells under a footprint.
struct alignas(64) CellBlock {
  // Asked for:
  double x[kLanes];  ///< centre
  double y[kLanes];
  double mirrored[kLanes];        ///< several points: -1: mirrored along x, else 1
  double active[kLanes];          ///< 1; 0: no cell. Out: 1 where it carries.
  double reference[kLanes];       ///< level of the undisturbed surface
  double sunk[kLanes];            ///< plastic sinkage
  double fresh[kLanes];           ///< 1: a new contact
  double covered_before[kLanes];  ///< as soil_grid.h has them; out: as of now
  double old_sinkage[kLanes];
  double beside[kLanes];
  // Answered by divide_cells:
  double covered[kLanes];
  // By sample_cells:
  double share[kLanes];      ///< of the cell that carries load
  double pressed[kLanes];    ///< plastic sinkage that this contact requires, earlier ones included
  double pressure[kLanes];   ///< mean, at that sinkage, before the body moves in this step
  double rate[kLanes];       ///< of that pressure with further sinking, Pa/m
  double unload[kLanes];     ///< of that pressure when the body rises, Pa/m
  double capacity[kLanes];   ///< what it bears without slip, Pa: the pressure, where nothing slips
  double hardening[kLanes];  ///< of that with further sinking, Pa/m
  double slope_x[kLanes];    ///< horizontal force of the normal stress, over its vertical force
  double slope_y[kLanes];
  double tilt_x[kLanes];  ///< the same of the surface alone, mean over the touching part
  double tilt_y[kLanes];
  double moment_x[kLanes];  ///< about the footprint's centre, per newton of vertical load, m
  double moment_y[kLanes];
  double moment_z[kLanes];
  double arm_x[kLanes];  ///< centre of pressure, from the footprint's centre
  double arm_y[kLanes];
  double arm_z[kLanes];
  double depth[kLanes];  ///< of the body below the undisturbed surface, mean over the touching part
  // By shear_cells:
  double shear_along[kLanes];  ///< mobilised share of the strength, 0 to 1, signed
  double shear_across[kLanes];
  double sliding[kLanes];  ///< of the surface over the soil, m/s
  // By react:
  double units[kLanes];   ///< sunk in this step, whole units of height
  double bears[kLanes];   ///< 1 where there is still pressure
  double shears[kLanes];  ///< how much this cell gives of what the surface drags away, relative
};

/// The force of a cell over the body's downward displacement there: max(0, min(elastic, virgin,
/// flowing)), each a straight line, and of what goes down its damper.
struct alignas(64) SpringBlock {
  double elastic[kLanes];        ///< N, now
  double elastic_slope[kLanes];  ///< N/m
  double virgin[kLanes];         ///< N, now
  double virgin_slope[kLanes];   ///< N/m
  double flowing[kLanes];        ///< N, now: what bears while it slips
  double flowing_slope[kLanes];  ///< N/m
  double damper[kLanes];         ///< N/m over this step
  double x[kLanes];              ///< position from the body's centre of mass, m
  double y[kLanes];
  double sinking[kLanes];  ///< the answer: downward displacement in this step, m
};

/// Wong and Reece's shape of the stress below a wheel (soil_laws.h).
struct StressShape {
  bool shaped = false;
  double entry = 0.0;   ///< theta_1, rad
  double middle = 0.0;  ///< theta_m
  double exit = 0.0;    ///< theta_2
  double slope = 0.0;   ///< (theta_1 - theta_m) / (theta_m - theta_2)
  double scale = 0.0;   ///< of the lift, m
};

/// z^n as a table of straight lines (soil_laws.h).
struct PowerLines {
  const double* lines;  ///< offset and slope of each
  double first;         ///< number of the leading bits of the first one's end
  double last;          ///< greatest index
  int dropped_bits;
};

/// The soil under one footprint in one step.
struct CellLaw {
  double bekker;   ///< k_c / b + k_phi
  double elastic;  ///< E, Pa/m
  double exponent;
  PowerLines power;
  StressShape stress;
  Triple sine;             ///< times a place from the wheel's centre: sine of its angle
  double per_upright = 1;  ///< 1 / cosine of the path's slope
  double rebound = 0.0;    ///< share of what a wheel presses down that comes up with it
  double half_square;      ///< half the side of the square that a sample point stands for
  double cell_area;
  double edge;     ///< of a cell
  double damper;   ///< R over the step, Pa/m
  bool radial;     ///< the normal stress acts along the surface's normal
  Triple centre;   ///< of the footprint
  Triple axis_x;   ///< its contour's direction
  Triple body_to;  ///< from the body's centre to it
};

/// Sums over a footprint's cells that carry.
struct CellSums {
  double area = 0.0;  ///< of shares, as the following are weighed
  double x = 0.0;
  double y = 0.0;
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  double own = 0.0;   ///< of squared shares
  double rear = 0.0;  ///< from where to where the cells lie along axis_x, m
  double front = 0.0;
};

/// Sums from which a wheel's entry angle is found.
struct EntrySums {
  double cosine = 0.0;
  double weight = 0.0;
};

/// Sums over springs: a force and its derivatives by the springs' displacement.
struct SpringSums {
  double f = 0.0;
  double fx = 0.0;
  double fy = 0.0;
  double k = 0.0;
  double kx = 0.0;
  double ky = 0.0;
  double kxx = 0.0;
  double kxy = 0.0;
  double kyy = 0.0;
};

/// How far a body moves in a step: up, and about the world's x and y.
struct Tilt {
  double up;
  double roll;
  double pitch;
};

/// The places of a shear field that touch (shear_field.h), an array a property; two lanes.
struct ShearPlaces {
  struct Side {
    double* along;
    double* across;
    double* yield;
    double* ahead_along;
    double* ahead_across;
    double* value_along;
    double* value_across;
    double* sliding;
    double* flowing;
  };
  Side side[2];
};

/// A step of a shear field.
struct ShearStep {
  double first_along;  ///< of the first place, m along the contour
  double spacing;
  size_t count;      ///< of places in contact
  double old_first;  ///< index of the first and last that were in contact before
  double old_last;
  bool touching;  ///< there was contact before
  double rear;
  double front;
  double rear_before;
  double front_before;
  double half;  ///< of the contour
  double radius;
  double below;
  double left;  ///< of the lanes
  Triple velocity;
  Triple omega;
  double surface_speed;
  double per_k;    ///< dt / K
  double damping;  ///< over elastic K, s/m
  double elastic;  ///< displacement of the elastic part, over K
  bool sideways_only;
  bool level;
};

/// What cells look up in a shear field.
struct ShearView {
  bool touching = false;
  ShearPlaces places{};
  double count = 0.0;
  double first_along = 0.0;
  double last_along = 0.0;
  double per_spacing = 0.0;
  double rear = 0.0;
  double front = 0.0;
  bool from_front = true;
  double per_offset = 0.0;  ///< half over the lanes' distance from the middle
};

/// A footprint's contact in one step.
struct ReactionLaw {
  double elastic;
  double stays;  ///< 1 - rebound
  double cell_area;
  double height_unit;
  double damping;
  double per_step;  ///< 1 / dt; 0: the motion is imposed, and no spring's sinking known
  double cohesion;
  double tan_friction;
  double adhesion;
  double surface_friction;
  Triple axis_x;  ///< ahead on the contour
  Triple axis_y;  ///< left
  Triple level_ahead;
  Triple level_left;
  double contour_half;
  double contour_radius;
  double sinking_speed;  ///< of the footprint's centre, upward, m/s
  double omega_x;        ///< of the body, rad/s
  double omega_y;
  double centre_z;
  bool radial;
  bool digs;    ///< slip is summed
  bool pushes;  ///< what is ahead and aside resists
  double sense;
  double travel;  ///< 1 or -1: the way it travels
  double passive_at_surface;
  double passive_per_depth;
  double per_width;
  ShearView shear;
  ShearView aside;
  double slip_bearing;  ///< soil_laws.h
  double slip_flow;     ///< its factor
  double slip_still;    ///< what slides by less does not flow, m/s
  double dt;
  Triple velocity;  ///< of the footprint's centre
  double turning;   ///< of the body about the vertical, rad/s
};

struct ReactionSums {
  Triple force{};
  Triple torque{};
  double along_surface = 0.0;
  double normal_load = 0.0;
  double area = 0.0;     ///< of shares
  double sinkage = 0.0;  ///< greatest depth
  // Slip, each times the cell's share:
  double sum_along = 0.0;
  double sum_across = 0.0;
  double sum_along_squared = 0.0;
  double sum_across_squared = 0.0;
  double slip = 0.0;        ///< speed times mobilised share
  double slip_along = 0.0;  ///< its parts ahead and to the left, signed
  double slip_across = 0.0;
  double depth = 0.0;  ///< of the surface below the undisturbed level, each cell by its share, m
  // Not times the share:
  double units = 0.0;   ///< by which cells yield, units of height
  double thrown = 0.0;  ///< those that go the way of the slip
};

/// From the first to behind the last of some heights that are above a line; none: end = 0.
struct AboveLine {
  size_t first;
  size_t end;
};

/// How a cell that may be touched is looked at.
struct ClassifyLimits {
  double unit;         ///< of the heights, m
  double rise;         ///< by which unloaded soil rises, m
  double rim;          ///< lowest surface of the body where it covers a cell's edge alone
  double half_cell;    ///< half the side of a cell
  double flat_within;  ///< a plane this far around covers the cell
};

/// One set of them. `points` of a block of cells lie one block of lanes after the other.
struct Kernels {
  InstructionSet set;
  /// Lower surface at `count` points, whole blocks.
  void (*track_surface)(const TrackShape& shape, const SurfacePoints& points, size_t count);
  /// Which of `count` heights are above the line z + i rise, in m as `unit` makes them.
  AboveLine (*above_line)(const int32_t* heights, size_t count, double unit, double z, double rise);
  /// Of cells whose centres are `points`: bit i of `flat` and `curved`, a byte a block, is set
  /// where the body may touch cell i, and its surface is plane there or not. Whole blocks of
  /// heights are read.
  void (*classify)(const SurfacePoints& points, const int32_t* heights, size_t count,
                   const ClassifyLimits& limits, uint8_t* flat, uint8_t* curved);
  /// Sample points of each block's cells, at these distances from their centres.
  void (*place_points)(const CellBlock* cells, size_t blocks, const double* dx, const double* dy,
                       size_t points, double* x, double* y);
  /// What lies below the body of each cell's sinkage; cells that it does not reach become inactive.
  void (*divide_cells)(CellBlock* cells, size_t blocks, const SurfacePoints& samples,
                       size_t points);
  void (*entry_angle)(const CellBlock* cells, size_t blocks, const SurfacePoints& samples,
                      size_t points, const CellLaw& law, double per_radius, EntrySums& sums);
  /// Stress of each cell, and its spring. Adds to the sums.
  void (*sample_cells)(CellBlock* cells, size_t blocks, const SurfacePoints& samples, size_t points,
                       const CellLaw& law, SpringBlock* springs, CellSums& sums);
  /// StressShape's lift at one sine of an angle, m.
  double (*stress_lift)(const StressShape& shape, double sine);
  /// Shear of cells, and what slip takes from their bearing.
  void (*shear_cells)(CellBlock* cells, SpringBlock* springs, size_t blocks,
                      const ReactionLaw& law);
  /// `damped`: springs have dampers.
  void (*spring_sums)(const SpringBlock* springs, size_t blocks, const Tilt& moved, bool damped,
                      SpringSums& sums);
  void (*spring_sinking)(SpringBlock* springs, size_t blocks, const Tilt& moved);
  void (*advance_shear)(const ShearStep& step, const ShearPlaces& places);
  /// One place of a shear field.
  void (*look_up_shear)(const ShearView& view, double along, double across, double& value_along,
                        double& value_across, double& sliding);
  void (*react)(CellBlock* cells, const SpringBlock* springs, size_t blocks, const ReactionLaw& law,
                ReactionSums& sums);
};

/// Those for a set of instructions that this processor has.
const Kernels& kernels_for(InstructionSet set);
/// Those for the best one.
const Kernels& best_kernels();

}  // namespace screed
