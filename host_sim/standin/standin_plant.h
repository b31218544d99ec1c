// The world of robots on belts in closed form, where the physics is too slow: the same motors and
// batteries, a ground of the same soil, robots that stand on it without dynamics. The firmware, its
// sensors and its radio notice nothing. docs/standin.md says how far it can be trusted.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/physics/world/environment.h"
#include "host_sim/physics/world/plant_options.h"
#include "host_sim/standin/belt_fit.h"
#include "host_sim/standin/belt_ground.h"
#include "host_sim/standin/standin_robot.h"

namespace screed {

/// Coarsest cells of the ground on which belts 30 mm wide find their way, m: what a run in the
/// stand-in takes where an experiment has finer ones.
inline constexpr double kStandInCell_m = 0.02;

class StandInPlant final : public Environment {
 public:
  /// Of the options the step, frictions, start heights and attitudes do not count. Throws
  /// InputError when the ground is not soil, the robot has no belts, stands in a wall or in another
  /// robot.
  StandInPlant(const HeightField& terrain, const Assembly& model, const PlantOptions& options,
               const BeltFit& fit = {});

  /// The first robot, which stands there, goes on from there.
  void set_state(const DrivingState& state) { robots_[0]->set_state(state); }
  PlanarPose pose() const { return robots_[0]->pose(); }
  /// A frame in which the first robot's belts run at these speeds, m/s, left and right, whatever
  /// drives them.
  void step_frame(const std::array<double, 2>& belts_m_per_s);
  /// The same where something else moves the robot: to this pose, by this motion.
  void follow_frame(const std::array<double, 2>& belts_m_per_s, const PlanarPose& pose,
                    const FrameMotion& motion);

  void step(std::span<const DutyRatio> duty_ratios) override;
  std::size_t robots() const override { return robots_.size(); }
  StandInRobot& robot(std::size_t number) override { return *robots_[number]; }
  const StandInRobot& robot(std::size_t number) const override { return *robots_[number]; }

  int steps_per_tick() const override { return kStepsPerTick; }
  uint64_t steps() const override { return steps_; }
  const HeightField& terrain() const override { return ground_.surface(); }
  bool is_deformable() const override { return true; }
  VolumeBalance volume_balance() const override { return ground_.balance(); }

 private:
  static constexpr int kStepsPerTick = 5;  // of motors and battery

  void check_apart(const StartPose& start) const;
  void push_from_walls(StandInRobot& robot) const;
  void push_apart(StandInRobot& robot, StandInRobot& other) const;
  void end_frame();
  void end_stride();

  BeltGround ground_;
  std::vector<std::unique_ptr<StandInRobot>> robots_;
  uint64_t steps_ = 0;
  int stride_frames_ = 0;
};

}  // namespace screed
