// The C interface of worlds.
#include <screed/world.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "hal/sample.h"
#include "host_sim/core/record.h"
#include "host_sim/interface/checks.h"
#include "host_sim/leveling/leveling_meter.h"
#include "host_sim/run/world/frame_recorder.h"
#include "host_sim/run/world/prepared_world.h"
#include "host_sim/run/world/world.h"

namespace {

using namespace screed;  // of a file whose own names are C's
using namespace screed::interface;

constexpr int kMaxTicks = 1000000;

/// What robots are told, and the frames of the tick in which they answered.
class Robots final : public RobotWatch {
 public:
  explicit Robots(size_t count) : actions_(count), recorders_(count), frames_(count) {}

  void set_actions(const screed_action* actions) {
    std::copy_n(actions, actions_.size(), actions_.begin());
  }
  const SimFrame& frame(size_t robot) const { return frames_[robot]; }

  void on_output(size_t robot, RobotOutput& output) override {
    const screed_action& action = actions_[robot];
    if (action.control != SCREED_DUTY) return;
    const auto duty = [&](double share) {
      return static_cast<int16_t>(std::lround(share * kDutyMax));
    };
    output.duty_left = duty(action.values[0]);
    output.duty_right = duty(action.values[1]);
  }
  void record(const World& world) {
    for (size_t i = 0; i < frames_.size(); ++i)
      frames_[i] = recorders_[i].record(world.time_s(), world.plant().robot(i), world.firmware(i));
  }

 private:
  std::vector<screed_action> actions_;
  std::vector<FrameRecorder> recorders_;
  std::vector<SimFrame> frames_;
};

std::span<const Column> columns_of(int table) {
  switch (table) {
    case SCREED_FRAMES:
      return kFrameColumns;
    case SCREED_SAMPLES:
      return kSampleColumns;
    case SCREED_OUTPUTS:
      return kOutputColumns;
    default:
      return {};
  }
}

void check(const screed_action& action) {
  if (action.control == SCREED_FIRMWARE) return;
  if (action.control == SCREED_COMMAND) {
    constexpr double kMaxYawRate = 2.0 * std::numbers::pi;
    require(std::abs(action.values[0]) <= 1.0, "speed", action.values[0], "-1 to 1 m/s");
    require(std::abs(action.values[1]) <= kMaxYawRate, "yaw rate", action.values[1],
            "-6.28 to 6.28 rad/s");
  } else if (action.control == SCREED_DUTY) {
    for (const double share : action.values)
      require(std::abs(share) <= 1.0, "duty", share, "-1 to 1");
  } else {
    throw InputError("control = " + std::to_string(action.control) +
                     "; allowed: 0 to 2 (screed_control)");
  }
}

}  // namespace

struct screed_world : Handle {
  explicit screed_world(PreparedWorld of) : prepared(std::move(of)) { begin(); }
  void begin() {
    world = make_standin_world(prepared);
    robots.emplace(world->robots());
  }

  PreparedWorld prepared;
  std::unique_ptr<World> world;
  std::optional<Robots> robots;
};

screed_world* screed_world_create(const void* prepared, size_t size, uint64_t seed,
                                  screed_error* error) {
  screed_world* world = nullptr;
  attempt(error, [&] {
    require_pointer(prepared, "prepared");
    PreparedWorld its = prepared_from({static_cast<const char*>(prepared), size});
    set_seed(seed, its);
    world = new screed_world(std::move(its));
  });
  return world;
}

screed_status screed_world_reset(screed_world* world, uint64_t seed, screed_error* error) {
  return attempt(error, [&] {
    const Use use(world, "world");
    set_seed(seed, world->prepared);
    world->begin();
  });
}

void screed_world_destroy(screed_world* world) {
  delete world;
}

int screed_world_robots(const screed_world* world) {
  return world == nullptr ? 0 : static_cast<int>(world->world->robots());
}

uint64_t screed_world_ticks(const screed_world* world) {
  return world == nullptr ? 0 : world->world->ticks();
}

screed_status screed_world_advance(screed_world* world, int ticks, const screed_action* actions,
                                   screed_error* error) {
  return attempt(error, [&] {
    const Use use(world, "world");
    require(ticks >= 1 && ticks <= kMaxTicks, "ticks", ticks, "1 to 1000000");
    World& its = *world->world;
    if (actions != nullptr) {
      for (size_t i = 0; i < its.robots(); ++i) check(actions[i]);
      world->robots->set_actions(actions);
      for (size_t i = 0; i < its.robots(); ++i) {
        if (actions[i].control != SCREED_COMMAND) continue;
        its.ground_station(i).drive(
            {actions[i].values[0], actions[i].values[1] * 180.0 / std::numbers::pi});
      }
    }
    for (int tick = 0; tick < ticks; ++tick) {
      its.advance(&*world->robots);
      world->robots->record(its);
    }
  });
}

size_t screed_table_row(int table) {
  const std::span<const Column> columns = columns_of(table);
  return columns.empty() ? 0 : row_bytes(columns);
}

int screed_table_column(int table, int number, screed_column* column) {
  const std::span<const Column> columns = columns_of(table);
  if (number < 0 || static_cast<size_t>(number) >= columns.size() || column == nullptr) return 0;
  const Column& its = columns[static_cast<size_t>(number)];
  *column = {
      its.name,  its.unit, its.meaning, static_cast<int>(its.type), its.array ? its.count : 0,
      its.offset};
  return 1;
}

screed_status screed_world_row(const screed_world* world, int robot, int table, void* row,
                               screed_error* error) {
  return attempt(error, [&] {
    const Use use(world, "world");
    require_pointer(row, "row");
    const World& its = *world->world;
    require(robot >= 0 && static_cast<size_t>(robot) < its.robots(), "robot", robot,
            "numbers of robots");
    if (its.ticks() == 0) throw InputError("row: the world has not lived a tick");
    const auto number = static_cast<size_t>(robot);
    auto* bytes = static_cast<uint8_t*>(row);
    if (table == SCREED_FRAMES) {
      pack(world->robots->frame(number), FrameRow(bytes, kFrameBytes));
    } else if (table == SCREED_SAMPLES) {
      pack(its.sample(number), SampleRow(bytes, kSampleBytes));
    } else if (table == SCREED_OUTPUTS) {
      pack(its.output(number), OutputRow(bytes, kOutputBytes));
    } else {
      throw InputError("table = " + std::to_string(table) + "; allowed: 0 to 2 (screed_table)");
    }
  });
}

screed_status screed_world_level(const screed_world* world, int with_transport, screed_level* level,
                                 screed_error* error) {
  return attempt(error, [&] {
    const Use use(world, "world");
    require_pointer(level, "level");
    const HeightField& ground = world->world->terrain();
    const RobotScaleFigures figures = robot_scale_figures(ground, 0.0);
    *level = {figures.level_deviation_m, figures.relief_m, figures.roughness_m, std::nan(""),
              std::nan("")};
    if (with_transport == 0) return;
    const GroundBlocks blocks = ground_blocks(ground);
    level->transport = least_transport(blocks);
    level->transport_squared = least_squared_transport(blocks);
  });
}

screed_status screed_world_bed(const screed_world* world, screed_rectangle* nodes, double* spacing,
                               screed_error* error) {
  return attempt(error, [&] {
    const Use use(world, "world");
    require_pointer(nodes, "nodes");
    require_pointer(spacing, "spacing");
    const HeightField& ground = world->world->terrain();
    *nodes = {0, 0, ground.nx(), ground.ny()};
    *spacing = ground.spacing_m();
  });
}

screed_status screed_world_heights(const screed_world* world, const screed_rectangle* part,
                                   double* heights, screed_error* error) {
  return attempt(error, [&] {
    const Use use(world, "world");
    copy_heights(world->world->terrain(), part, heights);
  });
}
