// Deformable soil below a tracked robot in the surrogate world: the robot's equilibrium on it, the
// tracks' sinkage, and where the displaced soil goes.
//
// The robot stands where Bekker's pressures below its tracks support its weight; cells below them
// are compacted to the tracks' depth. What leaves them is deposited beside and ahead, and slides,
// in whole units as in physics (host_sim/physics/soil/material_flow.h): the volume stays the same
// to the last bit, whatever a network says. Driven soil does not bear as Bekker's plates do; in
// which way, a network is asked (bearing_capacity_network.h).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "host_sim/physics/soil/cell_history.h"
#include "host_sim/physics/soil/material_flow.h"
#include "host_sim/physics/soil/power_table.h"
#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/standin/track_geometry.h"
#include "nn/terrain/bearing_capacity_network.h"
#include "nn/terrain/drive_strides.h"

namespace screed::nn {

/// That of a recorded robot.
TrackPlane track_plane_of(const TrackGeometry& tracks, const Stride& stride);

class TrackSoilModel {
 public:
  TrackSoilModel(const HeightField& ground, const SoilParameters& soil,
                 const TrackGeometry& tracks);
  /// Terrain that tracks have passed: `sinkage` is how much they pressed each node.
  TrackSoilModel(const HeightField& ground, const HeightField& sinkage, const SoilParameters& soil,
                 const TrackGeometry& tracks);

  const HeightField& surface() const { return flow_.surface(); }
  /// Soil in transit, not yet deposited, in units: the sum of all heights and this one stays the
  /// same.
  std::int64_t in_transit() const { return flow_.in_transit(); }
  /// By how much tracks have pressed each node, on the same grid.
  HeightField sinkage() const;

  /// A stride of the robot, by the network or, without one, in closed form.
  void step(const Stride& stride, const BearingCapacityNetwork* network);
  /// The same at a known plane of the tracks.
  void step_at(const Stride& stride, const TrackPlane& track_plane);

  /// The same without the robot's equilibrium: all that is below its tracks is pressed to the
  /// depth at which an even pressure supports its weight.
  void step_evenly(const Stride& stride);

  /// Of the last step.
  const TrackPlane& track_plane() const { return track_plane_; }

 private:
  struct TrackCell {  // of the ground below a track
    std::size_t node;
    int ix;
    int iy;
    double x;  // from where the plane's height counts, in the robot's axes, m
    double y;
    double share;    // of the cell that lies below
    double over;     // of the track's lower surface over its lower run, m
    double level;    // from which sinkage counts, m
    double sinkage;  // of the whole cell so far, m
    SinkageDivision division;
    double prior;           // of the part below the track, m
    double capacity_share;  // share of Bekker's pressure
    double gap;             // of the track over what it passed, that counts, m
    double depth;           // of the track below the level, m
    double pressure;        // Pa
  };
  struct TrackPath {  // of a track since it last reversed
    double distance_m = 0.0;
    double rise = 0.0;  // against its lower run, over its own length
    std::optional<double> height_m;
  };

  void find_cells(const Stride& stride, const TrackPlane& about);
  void update_paths(const Stride& stride);
  std::array<float, BearingCapacityNetwork::kInputs> network_inputs(const Stride& stride) const;
  void apply_capacity(const BearingCapacity& bearing);
  TrackPlane find_equilibrium(const BearingCapacity& bearing);
  Eigen::Vector3d soil_reaction(const TrackPlane& track_plane, double unloading_pa_per_m,
                                Eigen::Matrix3d& stiffness);
  void compact_soil(const Stride& stride, const TrackPlane& track_plane, double unloading_pa_per_m);
  void compact_cells(const Stride& stride, double unloading_pa_per_m);
  /// Stiffness of unloading, as a multiple of the soil's mean stiffness at 2 kPa, Pa/m.
  double unloading_stiffness(double times) const;
  double track_advance(const Stride& stride, std::size_t side) const;

  SoilParameters soil_;
  TrackGeometry tracks_;
  MaterialFlow flow_;
  PowerTable power_;
  double bekker_;
  double sinkage_m_;  // at 2 kPa
  std::array<float, 6> soil_inputs_{};
  std::vector<CellHistory> histories_;  // of the track on a node
  std::vector<TrackCell> cells_;
  std::array<std::size_t, 3> sides_{};  // where a side's cells begin
  std::array<TrackPath, 2> paths_{};
  std::array<double, 2> directions_{};  // of the tracks' travel, -1..1
  std::uint32_t step_ = 1;
  std::optional<TrackPlane> last_;
  TrackPlane track_plane_;
};

}  // namespace screed::nn
