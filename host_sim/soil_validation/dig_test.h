// A tracked robot that digs, and how much a height map rose and sank, told from several runs whose
// single heights are noisy.
//
// Noise adds to both volumes: what truly stays level counts as raised in one place and sunk in the
// next. So the volume of the mean of N maps falls as N grows, to the true one: it is too great,
// on average. In turn, asking the other N - 1 maps where the ground rose and counting there what
// the one map says is too small, on average: a place whose direction the others take wrongly
// counts against it. Between the two lies the volume without noise.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "host_sim/core/task_progress.h"
#include "host_sim/physics/particles/particle_bed.h"
#include "host_sim/physics/soil/soil_bed.h"
#include "host_sim/physics/terrain/height_field.h"

namespace screed {

struct MovedVolume {
  double raised_m3 = 0.0;
  double sunk_m3 = 0.0;
};

/// Rise of each node in one run, m; all of one size, of nodes that stand for this area each.
using RiseMap = std::vector<double>;

/// Of the mean of so many maps, averaged over all groups of neighbours in the row that are full.
/// 0 when no group is.
MovedVolume volume_of_means(std::span<const RiseMap> maps, double area_m2, size_t group);

/// Counted where the other maps say so, averaged over the maps. 0 for fewer than two maps.
MovedVolume volume_without_noise(std::span<const RiseMap> maps, double area_m2);

/// Standard error of the volume of the mean of all maps, by the jackknife (B. Efron, C. Stein, The
/// jackknife estimate of variance, Annals of Statistics 9(3), 1981). 0 for fewer than two maps.
MovedVolume standard_error(std::span<const RiseMap> maps, double area_m2);

// On deformable soil or on particles, by the same motions, measured the same way: how much material
// the robot moved, how deep its hole is and where the material went.

enum class Manoeuvre {
  kSpin,     ///< 10 s on the spot, the tracks against each other
  kCharge,   ///< against a mound whose flanks rise at 20 degrees
  kSlip,     ///< straight ahead while something holds it to a slip; on a slope uphill
  kStrokes,  ///< to and fro: gently into the way ahead, hard into the way back; on a slope, which
             ///< it faces uphill, the other way round
};

struct DigTest {
  Manoeuvre manoeuvre = Manoeuvre::kSpin;
  SoilParameters soil;  ///< of deformable ground
  SoilOptions options;
  double cell_m = 0.005;               ///< of its grid, and of the rays over particles
  double step_s = 1e-3;                ///< of deformable ground; particles have their own
  ParticleMaterial particle;           ///< of ground of particles
  double depth_m = 0.10;               ///< of the bed of particles, 0.02..1
  double size_m = 0.9;                 ///< of the bed's side, 0.5..5
  double track_m_per_s = 0.2;          ///< belt speed over the wheels, 0.01..1
  double duration_s = 10.0;            ///< 0.1..600; slip: as far as the bed goes, at most
  double stroke_s = 0.1;               ///< strokes: of full speed ahead, 0..5
  double stroke_back_s = 0.22;         ///< strokes: of full speed back, 0..5
  double stroke_accel_m_per_s2 = 1.5;  ///< strokes: of the belts into the way ahead, 0.1..100
  double slip = 0.6;                   ///< slip: 0.05..0.99
  double lug_height_m = 0.002;         ///< of the tread, 0..0.1; nothing to particles
  double slope_deg = 0.0;  ///< not for charge: of the ground, rising to the east, 0..25; above
                           ///< 0 the spinning robot is tethered to its place
  uint64_t seed = 1;       ///< of the particles' layout
  int beds = 16;           ///< of particles, laid with this seed and the next ones; 1..256
};

/// Volumes of the mean of so many beds' height maps.
struct DigOfBeds {
  int beds;
  MovedVolume moved;
};

/// Of the height maps before the robot was put down and after its drive, both averaged over
/// squares of 35 mm, of particles also over the beds: otherwise single particles that have rolled
/// over count for more than all that was dug. The robot starts at the origin (spin), or west of it,
/// heading east.
struct DigResult {
  HeightField before;
  HeightField after;
  double raised_m3 = 0.0;     ///< volume above the ground of before
  double sunk_m3 = 0.0;       ///< and below it
  MovedVolume error = {};     ///< of particles: standard error of these two
  MovedVolume at_least = {};  ///< of particles: the two without noise are greater than this
  std::vector<DigOfBeds> of_beds = {};  ///< of particles: of fewer beds; 1, 4, 16, ...
  double downhill_m4 = 0.0;  ///< volume times the way west that it was moved, from the robot's end
  double downhill_error_m4 = 0.0;  ///< of particles: its standard error
  double carried_m4 = 0.0;  ///< volume times the way east that it was moved, from what has sunk
  double carried_error_m4 = 0.0;  ///< of particles: its standard error
  double sunk_x_m = 0.0;          ///< middle of the sunk volume
  double deepest_m = 0.0;         ///< of the hole or rut
  double highest_m = 0.0;         ///< of what was thrown up
  double sunk_radius_m = 0.0;     ///< mean distance of the sunk volume from there
  double raised_radius_m = 0.0;   ///< and of the raised
  double behind_share = 0.0;      ///< of the raised volume, west of there
  double end_x_m = 0.0;           ///< where the robot ended
  double end_y_m = 0.0;
  double time_s = 0.0;         ///< that the drive took
  double pull_n = 0.0;         ///< slip: what held it back, mean; negative: pushed it on
  double distance_m = 0.0;     ///< of the body from start to end, straight
  double turned_rad = 0.0;     ///< about the vertical, all turns counted
  double lower_by_m = 0.0;     ///< the body at the end against the start
  double pitch_rad = 0.0;      ///< greatest nose-up pitch
  VolumeBalance balance = {};  ///< of deformable ground
};

/// Throws InputError for figures out of range. Both report the task "digging".
DigResult dig_soil(const DigTest& test, const TaskProgress& progress = {});
DigResult dig_particles(const DigTest& test, const TaskProgress& progress = {});

}  // namespace screed
