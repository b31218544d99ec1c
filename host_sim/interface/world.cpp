// The C interface of a world.
#include <screed/world.h>

#include <memory>
#include <span>
#include <string_view>
#include <utility>

#include "host_sim/interface/checks.h"
#include "host_sim/interface/told_world.h"

using namespace screed;  // of a file whose own names are C's
using namespace screed::interface;

struct screed_world : Handle {
  screed_world(std::shared_ptr<const PreparedWorld> prepared, uint64_t seed)
      : its(std::move(prepared), seed) {}
  ToldWorld its;
};

screed_world* screed_world_create(const void* prepared, size_t size, uint64_t seed,
                                  screed_error* error) {
  screed_world* world = nullptr;
  attempt(error, [&] {
    require_pointer(prepared, "prepared");
    world = new screed_world(std::make_shared<const PreparedWorld>(prepared_from(
                                 std::string_view(static_cast<const char*>(prepared), size))),
                             seed);
  });
  return world;
}

screed_status screed_world_reset(screed_world* world, uint64_t seed, screed_error* error) {
  return attempt(error, [&] {
    const Use use(world, "world");
    world->its.reset(seed);
  });
}

void screed_world_destroy(screed_world* world) {
  destroy(world);
}

int screed_world_robots(const screed_world* world) {
  return world == nullptr ? 0 : static_cast<int>(world->its.world().robots());
}

screed_status screed_world_ticks(const screed_world* world, uint64_t* ticks, screed_error* error) {
  return attempt(error, [&] {
    const Use use(world, "world");
    require_pointer(ticks, "ticks");
    *ticks = world->its.world().ticks();
  });
}

screed_status screed_world_advance(screed_world* world, int ticks, const screed_action* actions,
                                   screed_error* error) {
  return attempt(error, [&] {
    const Use use(world, "world");
    check_ticks(ticks);
    std::span<const screed_action> of_robots;
    if (actions != nullptr) of_robots = {actions, world->its.world().robots()};
    world->its.check_actions(of_robots);
    world->its.advance(ticks, of_robots);
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
    check_table(table);
    const World& its = world->its.world();
    require(robot >= 0 && static_cast<size_t>(robot) < its.robots(), "robot", robot,
            "numbers of robots");
    if (its.ticks() == 0) throw InputError("row: the world has not lived a tick");
    world->its.copy_row(static_cast<size_t>(robot), table, static_cast<uint8_t*>(row));
  });
}

screed_status screed_world_level(const screed_world* world, int with_transport, screed_level* level,
                                 screed_error* error) {
  return attempt(error, [&] {
    const Use use(world, "world");
    require_pointer(level, "level");
    *level = world->its.level(with_transport != 0);
  });
}

screed_status screed_world_bed(const screed_world* world, screed_rectangle* nodes, double* spacing,
                               screed_error* error) {
  return attempt(error, [&] {
    const Use use(world, "world");
    require_pointer(nodes, "nodes");
    require_pointer(spacing, "spacing");
    const HeightField& ground = world->its.world().terrain();
    *nodes = {0, 0, ground.nx(), ground.ny()};
    *spacing = ground.spacing_m();
  });
}

screed_status screed_world_heights(const screed_world* world, const screed_rectangle* part,
                                   double* heights, screed_error* error) {
  return attempt(error, [&] {
    const Use use(world, "world");
    copy_heights(world->its.world().terrain(), part, heights);
  });
}
