// `screed terrain-net` as a user meets it, on a drive of a few seconds.
// Long: trains a network and drives with it.
#include <sstream>
#include <string>

#include "host_sim/core/data_folders.h"
#include "host_sim/run/session/session_reader.h"
#include "tests/sitl/program.h"

namespace screed::testing {
namespace {

class TerrainNet : public Program {
 protected:
  /// A drive on wheels over soft soil into `run`; `e.ini` stays.
  void record_run(int duration_s) {
    write("e.ini",
          "[vehicle]\ntracks = false\n"
          "[map]\nsize = 1\nmodel = scm\n[soil]\npreset = soft\ncell = 0.01\n"
          "[drive]\nspeed = 0.1\n"
          "[experiment]\nname = small\nalgorithm = drive\nduration = " +
              std::to_string(duration_s) + "\n");
    ASSERT_EQ(run("sim e.ini --quiet --no-pictures --heights --out run").exit_code, 0);
  }
};

TEST_F(TerrainNet, LearnsFromARunAndIsComparedWithIt) {
  ASSERT_NO_FATAL_FAILURE(record_run(9));
  const Result learned = run("terrain-net train run --out n.json --every 4 --epochs 2 --hidden 4");
  ASSERT_EQ(learned.exit_code, 0) << learned.err;
  EXPECT_NE(learned.err.find("epoch 2: "), std::string::npos) << learned.err;
  const Result compared = run("terrain-net compare n.json run --pictures p");
  ASSERT_EQ(compared.exit_code, 0) << compared.err;
  EXPECT_TRUE(std::filesystem::exists(root_ / "p" / "run.png"));
  // The volume, in units, is the fifth figure: kept by the fluxes to the last one.
  const size_t row = compared.out.find("fluxes");
  ASSERT_NE(row, std::string::npos) << compared.out;
  std::istringstream figures(compared.out.substr(row + 6));
  double error = 0.0;
  double outside = 0.0;
  double moved = 0.0;
  double volume = 0.0;
  long long units = 1;
  figures >> error >> outside >> moved >> volume >> units;
  EXPECT_GT(moved, 0.0) << compared.out;
  EXPECT_EQ(units, 0) << compared.out;
}

// The thesis' network is trained, kept, compared beside the other, and changes a running world.
TEST_F(TerrainNet, TheWindowNetworkIsKeptComparedAndDriven) {
  ASSERT_NO_FATAL_FAILURE(record_run(9));
  ASSERT_EQ(run("terrain-net train run --out f.json --epochs 1 --hidden 4").exit_code, 0);
  const Result learned = run("terrain-net train run --kind window --out w.json --epochs 2");
  ASSERT_EQ(learned.exit_code, 0) << learned.err;
  EXPECT_NE(learned.err.find("epoch 2: "), std::string::npos) << learned.err;
  const Result compared = run("terrain-net compare f.json run --beside w.json");
  ASSERT_EQ(compared.exit_code, 0) << compared.err;
  EXPECT_LT(compared.out.find("fluxes"), compared.out.find("window")) << compared.out;
  EXPECT_NE(compared.out.find("window"), std::string::npos) << compared.out;
  const std::string model = (data_folders().models / "v2.json").string();
  const std::string world =
      "sim e.ini --quiet --no-pictures --heights --hal surrogate --model '" + model + "'";
  ASSERT_EQ(run(world + " --terrain-net w.json --out changed").exit_code, 0);
  EXPECT_GT(SessionReader(root_ / "changed" / "session.h5").height_changes(), 0U);
  write("broken.json", R"({"format": "screed-window-1", "matrix": [1], "constant": []})");
  expect_refused(run(world + " --terrain-net broken.json --out none"), 2, {"broken.json"});
}

TEST_F(TerrainNet, AComparisonIsStoppedAtOnce) {
  ASSERT_NO_FATAL_FAILURE(record_run(7));
  ASSERT_EQ(run("terrain-net train run --out n.json --epochs 1 --hidden 4").exit_code, 0);
  std::string runs;
  for (int i = 0; i < 1000; ++i) runs += " run";
  const Result result = interrupted("terrain-net compare n.json" + runs);
  EXPECT_EQ(result.exit_code, 130);
  EXPECT_EQ(result.err, "screed: stopped while predicting\n");
}

TEST_F(TerrainNet, WhatIsWrongIsSaidInOneLine) {
  write("e.ini", "[experiment]\nduration = 0.1\n[map]\nsize = 1\n");
  ASSERT_EQ(run("sim e.ini --quiet --no-pictures --out run").exit_code, 0);
  const Result no_heights = run("terrain-net train run");
  EXPECT_EQ(no_heights.exit_code, 2);
  EXPECT_NE(no_heights.err.find("heights were not recorded"), std::string::npos) << no_heights.err;
  const Result no_network = run("terrain-net compare e.ini run");
  EXPECT_EQ(no_network.exit_code, 2);
  EXPECT_NE(no_network.err.find("e.ini"), std::string::npos) << no_network.err;
}

}  // namespace
}  // namespace screed::testing
