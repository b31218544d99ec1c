// A world of the stand-in as the C interfaces have it: made of a prepared one, of any seed, with
// robots that are told what to do.
#pragma once

#include <screed/world.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "host_sim/core/record.h"
#include "host_sim/core/sim_frame.h"
#include "host_sim/run/world/frame_recorder.h"
#include "host_sim/run/world/prepared_world.h"
#include "host_sim/run/world/world.h"

namespace screed::interface {

class ToldWorld final : private RobotWatch {
 public:
  /// Throws InputError as check_seed() and make_standin_world() do.
  ToldWorld(std::shared_ptr<const PreparedWorld> prepared, uint64_t seed);
  ToldWorld(const ToldWorld&) = delete;
  ToldWorld& operator=(const ToldWorld&) = delete;

  /// As it was made, of another seed. Throws InputError as the constructor does.
  void reset(uint64_t seed);
  /// One action a robot, or none for nothing new. Throws InputError where one is not allowed.
  void check_actions(std::span<const screed_action> actions) const;
  /// They are allowed. Throws RunError as World::advance(), and when a robot has had all commands
  /// that it takes.
  void advance(int ticks, std::span<const screed_action> actions);
  /// A robot's newest row, of row_bytes(columns_of(table)) bytes; zeros before the first tick.
  void copy_row(size_t robot, int table, uint8_t* row) const;
  screed_level level(bool with_transport) const;

  const World& world() const { return *world_; }
  const PreparedWorld& prepared() const { return *prepared_; }

 private:
  void on_output(size_t robot, RobotOutput& output) override;
  void record();

  std::shared_ptr<const PreparedWorld> prepared_;
  std::unique_ptr<World> world_;
  std::vector<screed_action> actions_;  // of each robot
  std::vector<FrameRecorder> recorders_;
  std::vector<SimFrame> frames_;
};

/// Of a table, or none.
std::span<const Column> columns_of(int table);
/// Throw InputError.
void check_ticks(int ticks);
/// Of a world: not SCREED_LEVELING.
void check_table(int table);

}  // namespace screed::interface
