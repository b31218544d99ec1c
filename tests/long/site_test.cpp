// A robot on its site: it recognises walls, takes its place from them and from position fixes, and
// the shipped beds are run without leaving them.
// Long: whether a robot stays on its site shows after minutes of driving.
#include <gtest/gtest.h>

#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include "host_sim/core/json.h"
#include "host_sim/physics/terrain/terrain.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/world/world_setup.h"
#include "tests/sitl/program.h"
#include "tests/sitl/test_drive.h"

namespace screed::testing {
namespace {

/// Stuck at a wall of a bed of 3 m, having driven there from the middle.
std::unique_ptr<TestDrive> at_wall(double heading_deg) {
  Parameters parameters = drive_parameters();
  parameters.site_x() = 1500;
  parameters.site_y() = 1500;
  WorldOptions options = drive_options(0.15, 0.0);
  options.starts[0].attitude.heading = heading_deg * std::numbers::pi / 180.0;
  HeightField field = HeightField::flat(3.0, 0.1);
  field.add_walls();
  auto drive = std::make_unique<TestDrive>(std::move(field), options, parameters);
  EXPECT_TRUE(drive->start());
  EXPECT_TRUE(drive->run_until(30.0, [&] { return drive->robot.slip_watch().stuck(); }))
      << heading_deg;
  drive->run(0.1);
  return drive;
}

TEST(Site, AWallTellsTheRobotWhereItIs) {
  for (const double heading_deg : {0.0, 90.0, 200.0}) {
    const std::unique_ptr<TestDrive> drive = at_wall(heading_deg);
    const Axis axis = heading_deg == 90.0 ? kY : kX;
    EXPECT_NEAR(drive->robot.position().mm(axis) * 1e-3, drive->position()[axis], 0.04)
        << heading_deg;
    Place place;
    drive->robot.position().get(place);
    EXPECT_LE(4 * place.sigma[axis], 44) << heading_deg << ": that of a wall";
    EXPECT_GT(place.sigma[1 - axis], place.sigma[axis]) << heading_deg;
  }
}

// A robot that believes its walls elsewhere is moved there by the first it touches.
TEST(Site, TheWallsOfShippedBedsStandWhereTheRobotIsTold) {
  for (const char* name : {"soft_bed", "gravel_bed", "level_bed"}) {
    const Experiment experiment = read_experiment(find_experiment(name), {});
    const BedBounds bed = bounds_of(make_terrain(experiment));
    ASSERT_EQ(bed.edge, BedEdge::kWalled) << name;
    EXPECT_NEAR(experiment.parameters.site_x(), 500.0 * bed.width_m, 5.0) << name;
    EXPECT_NEAR(experiment.parameters.site_y(), 500.0 * bed.depth_m, 5.0) << name;
  }
}

class Beds : public Program {};

// Shipped experiments, shorter than they are, and other algorithms on their slopes of 25 degrees:
// nobody leaves the bed, nothing fails.
TEST_F(Beds, AreRunWithoutLeavingThem) {
  // At 30 degrees, as its file has it, that drive digs itself in: nobody steers.
  const char* straight_on =
      "soft_bed --duration 12 --set experiment.algorithm=drive --set vehicle.h=60";
  int number = 0;
  for (const std::string name :
       {"soft_bed --duration 90", "open_bed --duration 90",
        "soft_bed --duration 40 --set experiment.algorithm=hill_sensing",
        "soft_bed --duration 40 --set experiment.algorithm=coverage", straight_on,
        "gravel_bed --duration 8", "level_bed --duration 120"}) {
    const std::string folder = std::to_string(++number);
    std::string command = "sim " + name;
    command += " --quiet --no-pictures --json --out ";
    command += folder;
    const Result result = run(command);
    ASSERT_EQ(result.exit_code, 0) << name << ": " << result.err;
    const auto summary = Json::parse(result.out);
    EXPECT_EQ(summary["left_bed"], false) << name;
    EXPECT_EQ(summary["stopped_early"], false) << name;
    EXPECT_EQ(summary["state"], "running") << name;
    EXPECT_EQ(summary["faults"], "none") << name;
    const double driven_s = summary["time_s"].get<double>() - 6.0;  // it stands at first
    EXPECT_GT(summary["distance_m"].get<double>(), 0.03 * driven_s) << name;
  }
}

// Nor does it help to stay: the robot goes everywhere, comes to peaks, and does not spend its time
// at the fence.
TEST_F(Beds, AreWorkedAllOver) {
  int number = 0;
  for (const std::string name :
       {"first_drive --duration 400",
        "first_drive --duration 400 --set experiment.algorithm=spin_on_peak",
        "open_bed --duration 120"}) {
    const Result result =
        run("sim " + name + " --quiet --no-pictures --json --out w" + std::to_string(++number));
    ASSERT_EQ(result.exit_code, 0) << name << ": " << result.err;
    const auto summary = Json::parse(result.out);
    EXPECT_GT(summary["leveling"]["visited"].get<double>(), 0.8) << name;
    EXPECT_LT(summary["leveling"]["returning"].get<double>(), 0.1) << name;
    EXPECT_GT(summary["peaks"].get<int>(), 3) << name;
  }
}

}  // namespace
}  // namespace screed::testing
