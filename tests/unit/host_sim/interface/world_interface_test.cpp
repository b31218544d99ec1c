// The C interface of worlds: the bits of the program's, seeds, what robots are told, what is
// refused.
#include <gtest/gtest.h>
#include <screed/world.h>

#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "host_sim/core/record.h"
#include "host_sim/leveling/leveling_meter.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/world/frame_recorder.h"
#include "host_sim/run/world/world_setup.h"
#include "host_sim/standin/standin_plant.h"

namespace screed {
namespace {

// Programs that are there were compiled with these sizes: whoever changes one makes a new ABI.
static_assert(sizeof(screed_action) == 24);
static_assert(sizeof(screed_column) == 40);
static_assert(sizeof(screed_level) == 40);

struct Destroy {
  void operator()(screed_world* world) const { screed_world_destroy(world); }
};
using Handle = std::unique_ptr<screed_world, Destroy>;

Experiment level_bed(const std::vector<std::string>& more = {}) {
  std::vector<std::string> sets = {"soil.cell=0.03", "robots.count=2"};
  sets.insert(sets.end(), more.begin(), more.end());
  return read_experiment("level_bed", sets);
}

Handle make(const std::string& bytes, uint64_t seed = 1) {
  screed_error error;
  Handle world(screed_world_create(bytes.data(), bytes.size(), seed, &error));
  EXPECT_NE(world, nullptr) << error.text;
  return world;
}

const std::string& prepared() {
  static const std::string bytes = to_bytes(prepare_standin(level_bed()));
  return bytes;
}

uint64_t ticks_of(const Handle& world) {
  uint64_t ticks = 0;
  EXPECT_EQ(screed_world_ticks(world.get(), &ticks, nullptr), SCREED_OK);
  return ticks;
}

void advance(const Handle& world, int ticks, const std::vector<screed_action>& actions = {}) {
  screed_error error;
  EXPECT_EQ(
      screed_world_advance(world.get(), ticks, actions.empty() ? nullptr : actions.data(), &error),
      SCREED_OK)
      << error.text;
}

std::vector<uint8_t> row_of(const Handle& world, int robot, int table) {
  std::vector<uint8_t> row(screed_table_row(table));
  screed_error error;
  EXPECT_EQ(screed_world_row(world.get(), robot, table, row.data(), &error), SCREED_OK)
      << error.text;
  return row;
}

SimFrame frame_of(const Handle& world, int robot = 0) {
  SimFrame frame;
  const std::vector<uint8_t> row = row_of(world, robot, SCREED_FRAMES);
  unpack(std::span<const uint8_t, kFrameBytes>(row.data(), kFrameBytes), frame);
  return frame;
}

std::vector<double> heights_of(const Handle& world) {
  screed_rectangle bed{};
  double spacing = 0.0;
  EXPECT_EQ(screed_world_bed(world.get(), &bed, &spacing, nullptr), SCREED_OK);
  std::vector<double> heights(static_cast<size_t>(bed.nodes_x) * static_cast<size_t>(bed.nodes_y));
  EXPECT_EQ(screed_world_heights(world.get(), &bed, heights.data(), nullptr), SCREED_OK);
  return heights;
}

template <typename Call>
std::string refusal(const Call& call) {
  screed_error error = {SCREED_OK, "not called"};
  EXPECT_NE(call(&error), SCREED_OK);
  return error.text;
}

/// After 20 s of the world that the program makes of the experiment, against the library's.
void expect_the_same(const Experiment& experiment, const Handle& world) {
  const std::unique_ptr<World> its = make_world(
      experiment,
      {.environment = [](HeightField terrain, const Assembly& robot, const PlantOptions& options) {
        return std::make_unique<StandInPlant>(terrain, robot, options);
      }});
  std::array<FrameRecorder, 2> recorders;
  std::array<SimFrame, 2> frames;
  for (int tick = 0; tick < 2000; ++tick) {
    its->advance();
    for (size_t i = 0; i < 2; ++i)
      frames[i] = recorders[i].record(its->time_s(), its->plant().robot(i), its->firmware(i));
  }
  advance(world, 1);
  advance(world, 1999);
  for (int i = 0; i < 2; ++i) {
    std::vector<uint8_t> row(kFrameBytes);
    pack(frames[static_cast<size_t>(i)], FrameRow(row.data(), kFrameBytes));
    EXPECT_EQ(row_of(world, i, SCREED_FRAMES), row);
  }
  const std::vector<double> heights = heights_of(world);
  for (size_t i = 0; i < heights.size(); ++i)
    ASSERT_EQ(heights[i], its->terrain().node(i) * kHeightUnit_m);
  EXPECT_EQ(ticks_of(world), 2000U);
}

TEST(WorldInterface, HasTheBitsOfTheProgram) {
  const Handle world = make(prepared());
  EXPECT_EQ(screed_world_robots(world.get()), 2);
  expect_the_same(level_bed(), world);
}

TEST(WorldInterface, HasThemOfAnySeed) {
  const Handle world = make(prepared());
  advance(world, 100);
  ASSERT_EQ(screed_world_reset(world.get(), 7, nullptr), SCREED_OK);
  EXPECT_EQ(ticks_of(world), 0U);
  expect_the_same(level_bed({"experiment.seed=7"}), world);
}

TEST(WorldInterface, AWorldOfOneSeedSaysWhy) {
  const Experiment random = level_bed({"robots.placement=random"});
  const Handle world = make(to_bytes(prepare_standin(random)));
  EXPECT_EQ(refusal([&](screed_error* error) { return screed_world_reset(world.get(), 2, error); }),
            "seed = 2; allowed: 1 alone, since robots stand at random places");
  expect_the_same(random, world);
}

TEST(WorldInterface, DutyDrivesWhateverTheFirmwareSays) {
  const Handle world = make(prepared());
  advance(world, 100, {{SCREED_DUTY, {0.8, 0.8}}, {SCREED_DUTY, {0.0, 0.0}}});
  EXPECT_GT(frame_of(world, 0).track_left, 0.1);
  EXPECT_EQ(frame_of(world, 1).track_left, 0.0);
  advance(world, 100, {{SCREED_DUTY, {-0.8, 0.8}}, {SCREED_DUTY, {0.0, 0.0}}});
  EXPECT_GT(frame_of(world, 0).rate_z, 0.2);
  EXPECT_LT(frame_of(world, 0).track_left, -0.1);
}

TEST(WorldInterface, ACommandGoesOverTheRadioToTheFirmware) {
  const Handle world =
      make(to_bytes(prepare_standin(level_bed({"experiment.algorithm=drive", "robots.count=1"}))));
  advance(world, 600);  // it stands still for five seconds
  advance(world, 10, {{SCREED_COMMAND, {0.0, 0.5}}});
  EXPECT_NEAR(frame_of(world).angular, 0.5, 0.01);
  EXPECT_NEAR(frame_of(world).linear, 0.0, 1e-9);
  advance(world, 10, {{SCREED_COMMAND, {0.1, 0.0}}});
  EXPECT_NEAR(frame_of(world).linear, 0.1, 1e-9);
  // Told nothing any more, it does what the experiment says.
  advance(world, 10, {{SCREED_FIRMWARE, {0.0, 0.0}}});
  EXPECT_NEAR(frame_of(world).linear, level_bed().drive.speed_m_per_s, 1e-9);
}

TEST(WorldInterface, ACommandNeedsAFirmwareThatExecutesIt) {
  const Handle world = make(prepared());
  const std::vector<screed_action> told(2, {SCREED_COMMAND, {0.1, 0.0}});
  EXPECT_EQ(refusal([&](screed_error* error) {
              return screed_world_advance(world.get(), 1, told.data(), error);
            }),
            "control = 1, a command: needs [experiment] algorithm = drive");
}

TEST(WorldInterface, ColumnsDescribeARow) {
  int end = 0;
  screed_column column{};
  int number = 0;
  for (; screed_table_column(SCREED_SAMPLES, number, &column) == 1; ++number) {
    EXPECT_EQ(column.offset, end);
    constexpr std::array<int, 6> kBytes = {1, 2, 2, 4, 4, 8};
    end += kBytes[static_cast<size_t>(column.type)] * std::max(1, column.count);
    EXPECT_NE(std::string(column.meaning), "");
  }
  EXPECT_EQ(static_cast<size_t>(end), screed_table_row(SCREED_SAMPLES));
  EXPECT_EQ(number, static_cast<int>(kSampleColumns.size()));
  EXPECT_EQ(screed_table_row(4), 0U);
}

TEST(WorldInterface, LevelIsThatOfTheMetrics) {
  const Handle world = make(prepared());
  screed_level level{};
  ASSERT_EQ(screed_world_level(world.get(), 1, &level, nullptr), SCREED_OK);
  const std::unique_ptr<World> its = make_standin_world(prepare_standin(level_bed()));
  const HeightField& ground = its->terrain();
  EXPECT_EQ(level.level_deviation, robot_scale_figures(ground, 0.0).level_deviation_m);
  EXPECT_EQ(level.transport, least_transport(ground_blocks(ground)));
  ASSERT_EQ(screed_world_level(world.get(), 0, &level, nullptr), SCREED_OK);
  EXPECT_TRUE(std::isnan(level.transport));
}

TEST(WorldInterface, WorldsOnEightThreadsDoNotKnowOfEachOther) {
  const auto drive = [] {
    const Handle world = make(prepared());
    advance(world, 500);
    return row_of(world, 0, SCREED_FRAMES);
  };
  const std::vector<uint8_t> alone = drive();
  std::array<std::vector<uint8_t>, 8> rows;
  std::vector<std::thread> threads;
  threads.reserve(rows.size());
  for (std::vector<uint8_t>& row : rows) threads.emplace_back([&] { row = drive(); });
  for (std::thread& thread : threads) thread.join();
  for (const std::vector<uint8_t>& row : rows) EXPECT_EQ(row, alone);
}

TEST(WorldInterface, WhatIsNotAllowedIsRefused) {
  const Handle world = make(prepared());
  const auto advance_by = [&](int ticks, const std::vector<screed_action>& actions) {
    return refusal([&](screed_error* error) {
      return screed_world_advance(world.get(), ticks, actions.empty() ? nullptr : actions.data(),
                                  error);
    });
  };
  const screed_action none = {SCREED_FIRMWARE, {0.0, 0.0}};
  EXPECT_EQ(advance_by(0, {}), "ticks = 0; allowed: 1 to 1000000");
  EXPECT_EQ(advance_by(1, {{SCREED_DUTY, {1.5, 0.0}}, none}), "duty = 1.5; allowed: -1 to 1");
  EXPECT_EQ(advance_by(1, {none, {SCREED_DUTY, {std::nan(""), 0.0}}}),
            "duty = nan; allowed: -1 to 1");
  EXPECT_EQ(advance_by(1, {none, {SCREED_COMMAND, {9.0, 0.0}}}), "speed = 9; allowed: -1 to 1 m/s");
  EXPECT_EQ(advance_by(1, {{7, {0.0, 0.0}}, none}),
            "control = 7; allowed: 0 to 2 (screed_control)");
  EXPECT_EQ(ticks_of(world), 0U);
  std::vector<uint8_t> row(kFrameBytes);
  const auto read = [&](int robot, int table) {
    return refusal([&](screed_error* error) {
      return screed_world_row(world.get(), robot, table, row.data(), error);
    });
  };
  EXPECT_EQ(read(0, 0), "row: the world has not lived a tick");
  advance(world, 1);
  EXPECT_EQ(read(2, 0), "robot = 2; allowed: numbers of robots");
  EXPECT_EQ(read(0, 3), "table = 3; allowed: 0 to 2 (screed_table, without SCREED_LEVELING)");
  EXPECT_EQ(
      refusal([](screed_error* error) { return screed_world_advance(nullptr, 1, nullptr, error); }),
      "world: a null pointer");
  screed_error error;
  EXPECT_EQ(screed_world_create("screed", 6, 1, &error), nullptr);
  EXPECT_STREQ(error.text, "state of a world: damaged, or of something else");
}

}  // namespace
}  // namespace screed
