// The firmware drives in a world where a network stands in for the physics, and notices nothing.
// Long: ruts need minutes to show.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "host_sim/core/data_folders.h"
#include "host_sim/core/errors.h"
#include "host_sim/run/session/session_reader.h"
#include "nn/surrogate/surrogate_plant.h"
#include "nn/terrain/terrain_network.h"
#include "tests/sitl/program.h"
#include "tests/sitl/test_drive.h"
#include "tests/step_one.h"

namespace screed {
namespace {

using testing::rover5;

WorldOptions on_soil() {
  WorldOptions options;
  options.soil = soil_preset("viper");
  return options;
}

/// Tracks that do not slip.
std::unique_ptr<nn::SurrogatePlant> plant_of(HeightField ground, const WorldOptions& options) {
  return std::make_unique<nn::SurrogatePlant>(
      std::move(ground), rover5(), options,
      nn::Surrogate(nn::skid_kinematics(1.0, 0.127), nn::SupportGeometry{}, 1));
}

struct SurrogateDrive : testing::TestDrive {
  SurrogateDrive(HeightField ground, const WorldOptions& options)
      : TestDrive(plant_of(std::move(ground), options), options) {}

  Eigen::Vector3d place() const { return world.plant().robot(0).unwrapped_position(); }
};

TEST(SurrogateDrive, FirmwareDrivesStraightAtTheCommandedSpeed) {
  WorldOptions options = on_soil();
  options.robots[0].drive = DriveCommand{0.1, 0.0};
  SurrogateDrive drive(HeightField::flat(20.0, 0.1), options);
  drive.run(8.0);
  ASSERT_TRUE(drive.robot.supervisor().running());
  const Eigen::Vector3d begin = drive.place();
  drive.run(10.0);
  EXPECT_NEAR((drive.place() - begin).norm(), 1.0, 0.02);
  EXPECT_NEAR(drive.robot.position().mm(kX) * 1e-3, drive.place().x(), 0.1);
  EXPECT_EQ(drive.robot.supervisor().faults(), 0);
}

TEST(SurrogateDrive, FirmwareTurnsAtTheCommandedRateAndSensorsFeelTheSlope) {
  WorldOptions options = on_soil();
  options.robots[0].drive = DriveCommand{0.0, 30.0};
  SurrogateDrive drive(HeightField::ramp(20.0, 0.1, 6.0), options);
  drive.run(8.0);
  const double before = attitude_of(drive.world.vehicle().chassis().pose.linear()).heading;
  drive.run(2.0);
  const double after = attitude_of(drive.world.vehicle().chassis().pose.linear()).heading;
  constexpr double kRadPerDeg = 3.141592653589793 / 180.0;
  EXPECT_NEAR(std::remainder(after - before, 360.0 * kRadPerDeg), 60.0 * kRadPerDeg,
              4.0 * kRadPerDeg);
  const Attitude truth = attitude_of(drive.world.vehicle().chassis().pose.linear());
  EXPECT_NEAR(drive.robot.attitude().pitch() * 3.141592653589793 / 32768.0, truth.pitch,
              2.0 * kRadPerDeg);
  EXPECT_NEAR(drive.robot.attitude().roll() * 3.141592653589793 / 32768.0, truth.roll,
              2.0 * kRadPerDeg);
}

TEST(SurrogateDrive, WrapsAroundAndKeepsTheWayMade) {
  WorldOptions options = on_soil();
  options.robots[0].drive = DriveCommand{0.2, 0.0};
  SurrogateDrive drive(
      HeightField::from_function(32, 32, 0.05, true, [](double, double) { return 0.0; }), options);
  drive.run(20.0);
  EXPECT_GT(drive.place().x(), 1.6);
  EXPECT_GT(drive.world.plant().robot(0).wrap_counts()[0], 0);
  EXPECT_LT(std::abs(drive.world.vehicle().chassis().pose.translation().x()), 0.81);
}

// A wall stops what leads into it and nothing else: at 30 degrees the robot goes on along it.
TEST(SurrogateDrive, StopsAtWalls) {
  for (const double heading_deg : {0.0, 30.0}) {
    WorldOptions options = on_soil();
    options.robots[0].drive = DriveCommand{0.2, 0.0};
    options.starts[0].attitude.heading = heading_deg * std::numbers::pi / 180.0;
    HeightField field = HeightField::flat(1.6, 0.05);
    field.add_walls();
    SurrogateDrive drive(std::move(field), options);
    drive.run(20.0);
    // The Rover's middle stays half a length and more from the wall.
    const double along = heading_deg == 0.0 ? 0.0 : 0.04;
    EXPECT_NEAR(drive.place().x(), 0.8 - 0.1225 - along, 0.03) << heading_deg;
    const ChassisState chassis = drive.world.vehicle().chassis();
    EXPECT_LT(std::abs(chassis.velocity.x()), 1e-3);
    EXPECT_EQ(drive.place().y() > 0.3, heading_deg > 0.0);
    EXPECT_LT(std::abs(drive.place().y()), 0.8 - 0.1);
  }
  WorldOptions beyond = on_soil();
  beyond.starts[0].x_m = 0.75;
  HeightField field = HeightField::flat(1.6, 0.05);
  field.add_walls();
  EXPECT_THROW(plant_of(std::move(field), beyond), InputError);
}

TEST(SurrogateDrive, LaidOnItsSideItFaultsAndStays) {
  WorldOptions options = on_soil();
  options.robots[0].drive = DriveCommand{0.1, 0.0};
  SurrogateDrive drive(HeightField::flat(20.0, 0.1), options);
  drive.run(8.0);
  drive.world.plant().robot(0).lay_on_side();
  const Eigen::Vector3d begin = drive.place();
  drive.run(3.0);
  EXPECT_NE(drive.robot.supervisor().faults(), 0);
  EXPECT_EQ((drive.place() - begin).norm(), 0.0);
}

/// The network of the thesis' second version that drives best, and the one of the terrain.
const std::string kModels = data_folders().models.string();

/// A minute, one and a half circles, so that it crosses its own ruts, on a bed without end, whose
/// ground the wheels change.
HeightField driven_ground(const HeightField& bed) {
  WorldOptions options;
  options.vehicle.tracks = false;
  options.robots[0].drive = DriveCommand{0.12, 9.0};
  auto plant = plant_of(bed, options);
  plant->change_ground_by(
      nn::read_terrain_network(kModels + "/terrain_flux.json").change(rover5()));
  const nn::SurrogatePlant& world_plant = *plant;
  testing::TestDrive drive(std::move(plant), options);
  drive.run(60.0);
  EXPECT_EQ(drive.robot.supervisor().faults(), 0);
  EXPECT_EQ(world_plant.terrain().height_sum(), bed.height_sum());
  return world_plant.terrain();
}

TEST(SurrogateDrive, AMinuteOfRutsKeepsTheVolumeAndTheBits) {
  const HeightField bed = HeightField::from_function(256, 256, 0.01, true, [](double x, double y) {
    return 0.01 * std::sin(4.9 * x) * std::cos(4.9 * y);
  });
  const HeightField once = driven_ground(bed);
  const HeightField again = driven_ground(bed);
  size_t changed = 0;
  for (size_t node = 0; node < 256U * 256U; ++node) {
    ASSERT_EQ(once.node(node), again.node(node));
    changed += once.node(node) != bed.node(node) ? 1 : 0;
  }
  EXPECT_GT(changed, 2000U);
}

// The change gets the strides of the drive, and the robot stands on what it leaves.
TEST(SurrogateDrive, TheGroundChangesStrideByStrideAndBearsTheRobot) {
  WorldOptions options;
  options.vehicle.tracks = false;
  auto plant = plant_of(HeightField::flat(4.0, 0.01), options);
  constexpr auto kMillimetre = static_cast<Height>(0.001 / kHeightUnit_m);
  std::vector<nn::Stride> strides;
  plant->change_ground_by([&](HeightField& ground, const nn::Stride& stride) {
    strides.push_back(stride);
    for (int iy = 0; iy < ground.ny(); ++iy) {
      for (int ix = 0; ix < ground.nx(); ++ix)
        ground.set_node(ix, iy, ground.node(ix, iy) - kMillimetre);
    }
  });
  const double before = plant->vehicle().chassis().pose.translation().z();
  for (int i = 0; i < 1000; ++i) testing::step_one(*plant, {0.0, 0.0});
  EXPECT_TRUE(strides.empty()) << "what stands changes nothing";
  const double speed = [&] {
    for (int i = 0; i < 1000; ++i) testing::step_one(*plant, {0.4, 0.5});
    return plant->vehicle().track_speed_m_per_s(kLeft);
  }();
  ASSERT_EQ(strides.size(), 20U);
  const nn::Stride& last = strides.back();
  EXPECT_NEAR(last.track_m[kLeft], 0.05 * speed, 0.05 * 0.05 * speed);
  EXPECT_NEAR(last.forward_m, 0.5 * (last.track_m[kLeft] + last.track_m[kRight]), 1e-5);
  EXPECT_NEAR(last.turn_rad, (last.track_m[kRight] - last.track_m[kLeft]) / 0.127, 1e-6);
  EXPECT_NEAR(last.v_left * 0.03, speed, 1e-9);
  EXPECT_EQ(last.x_m, plant->pose().x_m);
  EXPECT_EQ(last.yaw_rad, plant->pose().heading_rad);
  EXPECT_NEAR(plant->vehicle().chassis().pose.translation().z(), before - 0.020, 0.002);
}

class Surrogate : public testing::Program {
 protected:
  /// A network in place of the closed form.
  const std::string network_ = " --hal surrogate --model '" + kModels + "/v2_products.json' ";
  const std::string fluxes_ = " --terrain-net '" + kModels + "/terrain_flux.json' ";
};

TEST_F(Surrogate, RunsRecordsAndReplaysAndTheSameSeedGivesTheSameHash) {
  write("e.ini",
        "[map]\nmodel = scm\nsize = 4\n[experiment]\nname = e\nalgorithm = drive\nduration = 12\n");
  for (const std::string& world : {std::string(" --hal surrogate "), network_}) {
    const testing::Result a = run("sim e.ini" + world + "--quiet --no-pictures --out a");
    const testing::Result b = run("sim e.ini" + world + "--quiet --no-pictures --out b");
    ASSERT_EQ(a.exit_code, 0) << a.err;
    EXPECT_EQ(a.out.substr(a.out.find(' ')), b.out.substr(b.out.find(' ')));
    const testing::Result replay = run("replay a");
    EXPECT_EQ(replay.exit_code, 0) << replay.out << replay.err;
    for (const char* folder : {"a", "b"}) std::filesystem::remove_all(root_ / folder);
  }
}

TEST_F(Surrogate, RutsAppearAreRecordedAndCanBeLeftOut) {
  write("e.ini",
        "[vehicle]\ntracks = false\n[map]\nmodel = scm\nsize = 4\n[soil]\ncell = 0.01\n"
        "[experiment]\nname = e\nalgorithm = drive\nduration = 14\n");
  ASSERT_EQ(run("sim e.ini" + network_ + fluxes_ + "--heights --quiet --no-pictures --out ruts")
                .exit_code,
            0);
  ASSERT_EQ(run("sim e.ini" + network_ + "--heights --quiet --no-pictures --out none").exit_code,
            0);
  const SessionReader ruts(root_ / "ruts" / "session.h5");
  const SessionReader none(root_ / "none" / "session.h5");
  EXPECT_GT(ruts.height_changes(), 1000U);
  EXPECT_EQ(none.height_changes(), 0U);
  const auto volume = [](const HeightMap& map) {
    return std::accumulate(map.heights.begin(), map.heights.end(), int64_t{0});
  };
  const int64_t before = volume(ruts.heights_after(0));  // the map is good until the next call
  const HeightMap& last = ruts.heights_after(ruts.frames());
  EXPECT_EQ(last.heights, ruts.terrain_after()->heights);
  EXPECT_EQ(before, volume(last));
  EXPECT_EQ(run("replay ruts").exit_code, 0);
}

// Networks without their weights would go on at one speed, whatever the wheels do, and turn.
TEST_F(Surrogate, TheNetworksOfTheThesisDriveAsTheirWheelsTurn) {
  write("e.ini",
        "[vehicle]\ntracks = false\n[map]\nsize = 8\n[experiment]\nname = e\n"
        "algorithm = drive\nduration = 16\n");
  for (const char* model : {"v1", "v2", "v2_products"}) {
    for (const char* speed : {"0.06", "0.15"}) {
      const std::string folder = std::string(model) + speed;
      std::string command =
          "sim e.ini --quiet --no-pictures --hal surrogate --model '" + kModels + "/";
      command += std::string(model) + ".json' --set drive.speed=" + speed + " --out " + folder;
      const testing::Result result = run(command);
      ASSERT_EQ(result.exit_code, 0) << folder << result.err;
      const SessionReader session(root_ / folder / "session.h5");
      std::vector<SimFrame> frames(session.frames());
      session.read(0, std::span(frames));
      double distance = 0.0;
      double wheels = 0.0;
      double turn = 0.0;
      for (const SimFrame& frame : frames) {
        distance += std::hypot(frame.delta_x, frame.delta_y);
        wheels += 0.5 * 0.01 * (frame.track_left + frame.track_right);
        turn += frame.delta_theta;
      }
      EXPECT_GT(wheels, 0.5) << folder;
      EXPECT_LT(distance, 1.2 * wheels) << folder;
      EXPECT_GT(distance, 0.5 * wheels) << folder << ": wheels slip, and networks settle";
      EXPECT_NEAR(turn, 0.0, 0.2) << folder << ": the firmware keeps its heading";
    }
  }
}

TEST_F(Surrogate, RefusesWhatItCannotRun) {
  write("e.ini", "[experiment]\nname = e\nduration = 1\n");
  expect_refused(run("sim e.ini --hal surrogate"), 2, {"soil", "scm"});
  expect_refused(run("sim e.ini --model x.json"), 2, {"--model", "--hal surrogate"});
  expect_refused(run("sim e.ini" + fluxes_), 2, {"--terrain-net", "--hal surrogate"});
  expect_refused(run("sim e.ini --hal surrogate" + fluxes_), 2, {"--terrain-net", "--model"});
  expect_refused(run("sim e.ini" + network_ + fluxes_), 2, {"wheels", "tracks = false"});
  expect_refused(run("sim e.ini" + network_ + "--terrain-net e.ini"), 2, {"e.ini"});
}

}  // namespace
}  // namespace screed
