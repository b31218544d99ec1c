// One run of the grid world, cycle by cycle: the swarm carries out what the agents (grid_agents.h)
// answer and books what they did.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "host_sim/core/random.h"
#include "host_sim/grid/grid_agents.h"
#include "host_sim/grid/grid_config.h"
#include "host_sim/grid/grid_world.h"

namespace screed {

/// What a swarm has done so far.
struct SwarmCounts {
  uint64_t cycles = 0;
  uint64_t units = 0;     ///< successful pick-ups
  uint64_t carried = 0;   ///< units in the air now
  uint64_t straight = 0;  ///< steps along a side
  uint64_t diagonal = 0;

  /// Of all agents together, in cells.
  [[nodiscard]] double distance() const {
    return static_cast<double>(straight) + static_cast<double>(diagonal) * std::sqrt(2.0);
  }
};

/// What can be seen of an agent from outside.
struct AgentView {
  GridPlace place;
  GridOperation last_operation;  ///< of the last cycle, on the cell where the agent then stood
  bool carries;
};

class GridSwarm {
 public:
  virtual ~GridSwarm() = default;
  /// One sense and one act of every agent, in turn.
  virtual void cycle(GridWorld& world) = 0;
  [[nodiscard]] virtual size_t size() const = 0;
  [[nodiscard]] virtual AgentView view(size_t agent) const = 0;
  [[nodiscard]] const SwarmCounts& counts() const { return counts_; }

 protected:
  SwarmCounts counts_;
};

/// Free cells for so many agents, each free cell equally likely. agents <= cells.
std::vector<GridPlace> random_places(const GridWorld& world, int agents, WorldRandom& random);

/// Agents of one kind. The oracle is called after every cycle with the agents, for selection from
/// outside.
template <class Agent>
class SwarmOf : public GridSwarm {
 public:
  /// Puts an agent with a generator of its own on each place.
  template <class Parameters>
  SwarmOf(GridWorld& world, const std::vector<GridPlace>& places, const Parameters& parameters,
          uint64_t seed) {
    members_.reserve(places.size());
    uint32_t stream = 0;
    for (const GridPlace place : places) {
      world.occupy(place);
      // A seed of 64 bits: its upper half moves the streams of the lower one apart.
      const auto upper = static_cast<uint32_t>(seed >> 32) * 0x9E3779B9U;
      members_.push_back(Member{Agent(parameters, static_cast<uint32_t>(seed), stream++ ^ upper),
                                place, true, GridOperation::kNone});
    }
  }

  void cycle(GridWorld& world) override {
    for (Member& member : members_) act(world, member);
    ++counts_.cycles;
  }

  [[nodiscard]] size_t size() const override { return members_.size(); }
  [[nodiscard]] AgentView view(size_t agent) const override {
    const Member& member = members_[agent];
    return {member.place, member.last_operation, member.agent.carries()};
  }
  [[nodiscard]] Agent& agent(size_t index) { return members_[index].agent; }

 private:
  struct Member {
    Agent agent;
    GridPlace place;
    bool arrived;
    GridOperation last_operation;
  };

  void act(GridWorld& world, Member& member) {
    const GridAction action = member.agent.tick({world.stack(member.place), member.arrived});
    member.last_operation = action.operation;
    if (action.operation == GridOperation::kPickUp) {
      world.pick_up(member.place);
      ++counts_.units;
      ++counts_.carried;
    } else if (action.operation == GridOperation::kDeposit) {
      world.deposit(member.place);
      --counts_.carried;
    }
    member.arrived = false;
    if (action.direction == kGridStay) return;
    const GridPlace there = world.step(member.place, action.direction);
    if (there == member.place) return;
    world.leave(member.place);
    world.occupy(there);
    member.place = there;
    member.arrived = true;
    const uint64_t is_diagonal = action.direction & 1U;  // a branch would be guessed wrong often
    counts_.diagonal += is_diagonal;
    counts_.straight += 1U - is_diagonal;
  }

  std::vector<Member> members_;
};

/// The swarm of a configuration, placed at random.
std::unique_ptr<GridSwarm> make_swarm(const GridConfig& config, GridWorld& world);

struct GridResult {
  bool level = false;  ///< the stop rule was met within the cap
  uint64_t cycles = 0;
  uint64_t units = 0;      ///< successful pick-ups
  uint64_t min_units = 0;  ///< no agents could have done with fewer (GridWorld::work_left)
  uint64_t straight = 0;   ///< steps of all agents
  uint64_t diagonal = 0;

  /// Of all agents together, in cells.
  [[nodiscard]] double distance() const;
  bool operator==(const GridResult&) const = default;
};

/// A point of the progress curve. progress = 1 - work_left / work_left at the start: 0 untouched, 1
/// level. It is an L1 distance to the nearest level terrain.
struct GridProgress {
  uint64_t cycle;
  uint64_t units;
  double distance;
  double progress;
};

class GridRun {
 public:
  /// Throws InputError for a configuration out of range, an unreadable image, more agents than
  /// cells.
  explicit GridRun(const GridConfig& config);

  /// Level, or at the cap.
  [[nodiscard]] bool finished() const { return level_ || cycles() >= config_.max_cycles; }
  void cycle();

  [[nodiscard]] const GridConfig& config() const { return config_; }
  [[nodiscard]] const GridWorld& world() const { return *world_; }
  [[nodiscard]] const GridSwarm& swarm() const { return *swarm_; }
  [[nodiscard]] uint64_t cycles() const { return swarm_->counts().cycles; }
  [[nodiscard]] GridResult result() const;
  [[nodiscard]] GridProgress progress() const;

 private:
  GridConfig config_;
  std::unique_ptr<GridWorld> world_;
  std::unique_ptr<GridSwarm> swarm_;
  uint64_t min_units_ = 0;
  bool level_ = false;
};

/// A whole run.
GridResult run_grid(const GridConfig& config);

}  // namespace screed
