// Ground that a tracked robot drives over in the surrogate world: how the robot stands on it, how
// deep its tracks press it, and where what they press away goes.
//
// The robot stands where Bekker's pressures below its tracks bear its weight; cells below them are
// pressed as deep as the tracks reach. What leaves them is set down beside and ahead, and slides,
// in whole units as in physics (host_sim/physics/soil/material_flow.h): the volume stays the same
// to the last bit, whatever a network says. Driven soil does not bear as Bekker's plates do; in
// which way, a network is asked (bearing_network.h).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "host_sim/physics/soil/material_flow.h"
#include "host_sim/physics/soil/power_table.h"
#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/physics/vehicle/assembly.h"
#include "nn/terrain/bearing_network.h"
#include "nn/terrain/drive_strides.h"

namespace screed::nn {

/// A robot's two tracks: belts round two wheels each.
struct TrackGeometry {
  double half_length_m = 0.0925;  ///< half the distance of the axles
  double radius_m = 0.03;         ///< of the wheels, belt included
  double width_m = 0.03;
  double half_tread_m = 0.0975;   ///< to the middle of a track
  double below_m = 0.0613;        ///< of the tracks' lower run under the robot's origin
  double mass_kg = 1.2;           ///< of the robot
  double mass_ahead_m = 0.0;      ///< its centre, ahead of the origin
  double mass_height_m = 0.0534;  ///< and over the lower run
};
/// Throws InputError when the model lacks one of rover5.urdf's wheels.
TrackGeometry track_geometry(const Assembly& robot);

/// The plane of the tracks' lower runs: its height where the robot's vertical axis meets it, and
/// its slopes forward and to the left (rise over run).
struct Stance {
  double height_m = 0.0;
  double forward = 0.0;
  double left = 0.0;
};
/// Of a recorded robot.
Stance stance_of(const TrackGeometry& tracks, const Stride& stride);

class TrackGround {
 public:
  TrackGround(const HeightField& ground, const SoilParameters& soil, const TrackGeometry& tracks);
  /// Ground on which tracks have been: `sunk` says by how much they pressed each node.
  TrackGround(const HeightField& ground, const HeightField& sunk, const SoilParameters& soil,
              const TrackGeometry& tracks);

  const HeightField& surface() const { return flow_.surface(); }
  /// Soil that found no place yet, in units: the sum of all heights and this one stays the same.
  std::int64_t in_hand() const { return flow_.in_hand(); }
  /// By how much tracks have pressed each node, on the same grid.
  HeightField sunk() const;

  /// A stride of the robot, by the network or, without one, in closed form.
  void step(const Stride& stride, const BearingNetwork* network);
  /// The same by a stance that is known.
  void step_at(const Stride& stride, const Stance& stance);

  /// The same without asking how the robot stands: all that is below its tracks is pressed to the
  /// depth at which an even pressure bears its weight.
  void step_evenly(const Stride& stride);

  /// Of the last step.
  const Stance& stance() const { return stance_; }

 private:
  struct Cell {  // of the ground below a track
    std::size_t node;
    int ix;
    int iy;
    double x;  // from where the stance's height counts, in the robot's axes, m
    double y;
    double share;     // of the cell that lies below
    double over;      // of the track's lower surface over its lower run, m
    double level;     // from which sinkage counts, m
    double sunk;      // of the whole cell so far, m
    double old;       // of the part below the track, m
    double beside;    // of the rest, times its share, m
    double bears;     // share of Bekker's pressure
    double gap;       // of the track over what it passed, that counts, m
    double depth;     // of the track below the level, m
    double pressure;  // Pa
  };
  struct Trace {  // what a node remembers of the track on it
    std::uint32_t step = 0;
    float covered = 0.0F;  // share of the cell
    float beside = 0.0F;
  };
  struct Way {  // of a track since it turned back
    double along_m = 0.0;
    double rise = 0.0;  // against its lower run, over its own length
    std::optional<double> height_m;
  };

  void find_cells(const Stride& stride, const Stance& about);
  void recall(Cell& cell) const;
  void go_on(const Stride& stride);
  std::array<float, BearingNetwork::kInputs> look(const Stride& stride) const;
  void bear(const Bearing& bearing);
  Stance stand(const Bearing& bearing);
  Eigen::Vector3d unbalance(const Stance& stance, double elastic, Eigen::Matrix3d& stiffness);
  void press(const Stride& stride, const Stance& stance, double elastic);
  void press_cells(const Stride& stride, double elastic);
  /// Unloading at so many times the soil's mean stiffness at 2 kPa, Pa/m.
  double elastic(double times) const;
  double along(const Stride& stride, std::size_t side) const;

  SoilParameters soil_;
  TrackGeometry tracks_;
  MaterialFlow flow_;
  PowerTable power_;
  double bekker_;
  double sinkage_m_;  // at 2 kPa
  std::array<float, 6> soil_inputs_{};
  std::vector<Trace> traces_;
  std::vector<Cell> cells_;
  std::array<std::size_t, 3> sides_{};  // where a side's cells begin
  std::array<Way, 2> ways_{};
  std::array<double, 2> sense_{};  // in which the tracks go, -1..1
  std::uint32_t step_ = 1;
  std::optional<Stance> last_;
  Stance stance_;
};

}  // namespace screed::nn
