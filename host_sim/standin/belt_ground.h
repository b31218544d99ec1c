// Deformable soil below robots on belts, in strides of five frames (50 ms): how a robot stands on
// it, how deep its belts sink, what their slip digs away, and where all that goes.
//
// The laws are those of the physics (host_sim/physics/soil), for a belt as a whole where the
// physics has them for each of its cells, and without dynamics:
//   a robot stands where Bekker's pressures below its belts support its weight;
//   cells below them are compacted to the belts' depth, what leaves them is laid down beside
//   (MaterialFlow::deposit);
//   slip digs: volume = layer slip width, carried down the slope and with the belt
//   (soil_reaction.cpp, Digging);
//   slopes above the angle of repose slide.
// Heights are integers and soil moves in whole units: the volume stays the same to the last bit. A
// robot at rest has sunk as far as it will: nothing changes any more.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "host_sim/physics/soil/material_flow.h"
#include "host_sim/physics/soil/soil_grid.h"
#include "host_sim/physics/soil/soil_laws.h"
#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/physics/terrain/terrain.h"
#include "host_sim/standin/belt_motion.h"
#include "host_sim/standin/planar_pose.h"

namespace screed {

/// Frames of a stride: 50 ms, in which the robot comes about half as far as a cell.
inline constexpr int kBeltStrideFrames = 5;

/// What a robot did in a stride.
struct BeltStride {
  PlanarPose pose;     ///< of its origin, at the end
  FrameMotion motion;  ///< during it, in its axes at its end
  std::array<BeltShear, 2> shear{};
  double acceleration_m_per_s2 = 0.0;  ///< forward, its mean
};

/// Puts a stride together frame by frame.
class BeltStrideRecorder {
 public:
  explicit BeltStrideRecorder(const PlanarPose& start) : begin_(start) {}
  void add_frame(const FrameMotion& motion, const std::array<BeltShear, 2>& shear);
  /// The stride that ends at this pose; the next one begins there.
  BeltStride take(const PlanarPose& end);

 private:
  PlanarPose begin_;
  std::array<BeltShear, 2> shear_{};
  double forward_begin_m_ = 0.0;  // in a frame
  double forward_m_ = 0.0;
};

class BeltGround {
 public:
  BeltGround(const HeightField& surface, const SoilParameters& soil, const TrackGeometry& tracks,
             std::size_t robots, const BeltFit& fit = {});

  const HeightField& surface() const { return flow_.grid().surface(); }
  VolumeBalance balance() const { return flow_.balance(); }

  /// A robot that has not been here before sinks in where it stands.
  void place(std::size_t robot, const PlanarPose& pose);
  /// One robot's stride: it sinks and digs.
  void press(std::size_t robot, const BeltStride& stride);
  /// After all robots' strides: soil is laid down and slides.
  void end_stride();

  /// How a robot stands since its last stride.
  const TrackPlane& plane(std::size_t robot) const { return stances_[robot].plane; }
  const BeltSupport& support(std::size_t robot) const { return stances_[robot].support; }
  /// Depth of a belt below the undisturbed ground, mean over what touches, m.
  double sinkage_m(std::size_t robot, std::size_t side) const {
    return stances_[robot].sinkage_m[side];
  }

 private:
  struct Stance {
    bool placed = false;
    TrackPlane plane;
    BeltSupport support;
    std::array<double, 2> sinkage_m{};
  };
  struct Cell {  // of the ground below a belt
    GridNode at;
    double x;  // in the robot's axes, from where the plane's height counts, m
    double y;
    std::size_t patch;  // of the belt, above it
    double share;       // of the cell that lies below
    double over;        // of the belt's lower surface over its lower run, m
    double level;       // from which sinkage counts, m
    double prior;       // sinkage of the part below the belt, m
    SinkageDivision division;
    double flow;      // below the belt in this stride, m (slip_flow())
    double depth;     // of the belt below the level, m
    double pressure;  // Pa
  };
  struct Reaction {  // of the soil: its force and moments, and their growth as the plane goes down
    double force = 0.0;
    double moment_x = 0.0;
    double moment_y = 0.0;
    std::array<double, 6> stiffness{};  // 1, x, y, xx, xy, yy
  };

  double middle(std::size_t side) const {
    return side == 0 ? tracks_.half_tread_m : -tracks_.half_tread_m;
  }
  std::size_t patch_of(double x) const;
  void find_cells(const BeltStride& stride, const TrackPlane& about);
  Reaction react(const TrackPlane& plane);
  TrackPlane find_equilibrium(const TrackPlane& from, double acceleration_m_per_s2, int iterations);
  void compact(const BeltStride& stride, std::size_t side);
  void dig(const BeltStride& stride, const TrackPlane& plane, std::size_t side);
  void keep_support(const TrackPlane& plane, Stance& stance) const;

  SoilParameters soil_;
  TrackGeometry tracks_;
  BeltFit fit_;
  MaterialFlow flow_;
  PowerTable power_;
  double cell_area_;
  double bekker_;
  double unloading_pa_per_m_;
  double tan_repose_;
  double dig_remainder_ = 0.0;  // parts of a unit, for what is dug next
  double pressed_ = 0.0;        // by the belt in this stride, units
  double thrown_ = 0.0;         // of it, what goes along with the belt
  std::vector<Stance> stances_;
  std::vector<Cell> cells_;
  std::array<std::size_t, 3> sides_{};  // where a side's cells begin
  std::uint32_t stride_ = 1;
};

}  // namespace screed
