// `screed parity` and `screed sim --hal mcu` as a user meets them.
// Long: simavr executes every instruction of the image, some 16 million a second of driving.
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "host_sim/core/json.h"
#include "host_sim/run/experiment/board_table.h"
#include "paths.h"
#include "tests/mcu/images.h"
#include "tests/sitl/program.h"
#include "tests/sitl/terminal.h"

namespace screed::mcu {
namespace {

using testing::Result;

class McuProgram : public testing::Program {
 protected:
  static std::string first_drive() {
    return std::string("'") + kDataFolder + "/experiments/first_drive.ini'";
  }
  static std::string image() { return std::string(" --elf '") + kScreedImage + "'"; }
};

TEST_F(McuProgram, ParityOfAShortHillSensing) {
  const Result result = run("parity " + first_drive() + image() + " --minutes 0.5 --json");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = Json::parse(result.out);
  EXPECT_EQ(json["differing_bytes"], 0);
  EXPECT_TRUE(json["first_difference"].is_null());
  EXPECT_GE(json["ticks"], 2995);
  EXPECT_GE(json["driving_ticks"], 2000);
  EXPECT_GT(json["real_time_factor"], 0.0);
}

// With the algorithm that levels best, on the bed that `make sim` drives.
TEST_F(McuProgram, TheImageLevelsAsTheFirmwareHere) {
  const std::string bed = std::string("'") + kDataFolder + "/experiments/level_bed.ini' --json";
  const Result parity = run("parity " + bed + image() + " --minutes 2");
  ASSERT_EQ(parity.exit_code, 0) << parity.err;
  const auto compared = Json::parse(parity.out);
  EXPECT_EQ(compared["differing_bytes"], 0) << compared["first_difference"];
  EXPECT_GE(compared["driving_ticks"], 11000);

  // On its own the image reads the sensors at times of its own, and drives another course.
  // It learns the site first: ten minutes.
  const std::string ten_minutes = "sim " + bed + " --no-pictures --duration 600";
  const std::string here = ten_minutes + " --hal native --out native";
  const std::string on_image = ten_minutes + " --hal mcu --out mcu" + image();
  for (const std::string& command : {here, on_image}) {
    const Result run_of = run(command);
    ASSERT_EQ(run_of.exit_code, 0) << run_of.err;
    const auto json = Json::parse(run_of.out);
    const auto before = json["terrain_before"]["relief_m"].get<double>();
    const auto after = json["terrain_after"]["relief_m"].get<double>();
    EXPECT_LT(after, 0.97 * before) << command;
  }
}

TEST_F(McuProgram, ARunOfTheImageIsASessionThatReplays) {
  const Result sim =
      run("sim " + first_drive() + image() + " --hal mcu --duration 12 --seed 3 --out run --json");
  ASSERT_EQ(sim.exit_code, 0) << sim.err;
  const auto json = Json::parse(sim.out);
  const auto& mcu = json["microcontroller"];
  EXPECT_EQ(json["stopped_early"], false);
  EXPECT_EQ(mcu["missed_ticks"], 0);
  EXPECT_LE(mcu["longest_tick_cycles"], 80'000);
  EXPECT_EQ(mcu["encoder_edges_missed"], 0);
  EXPECT_GT(mcu["interrupts"]["TWI"]["count"], 10'000);
  for (const char* file : {"session.h5", "telemetry.log", "frames.csv", "terrain_after.png"}) {
    EXPECT_TRUE(std::filesystem::exists(root_ / "run" / file)) << file;
  }
  EXPECT_EQ(run("replay run").exit_code, 0);
  // Again: the same bytes.
  const Result again = run("sim " + first_drive() + image() +
                           " --hal mcu --duration 12 --seed 3 --no-pictures --out again --json");
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(Json::parse(again.out)["content_hash"], json["content_hash"]);
}

/// The image is robot 0; the others stand far enough away to meet it never, and one another late.
class ImageAmongRobots : public McuProgram {
 protected:
  void write_bed(const std::string& map) const {
    std::ofstream(root_ / "bed.ini")
        << "[experiment]\nname = bed\nseed = 5\nalgorithm = drive\nduration = 8\n[drive]\nspeed = "
           "0.15\nyaw_rate = 20\n[map]\nsize = 3\nedges = walls\n"
        << map;
  }
  std::string read(const std::string& file) const {
    std::ifstream stream(root_ / file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  void run_bed(const std::string& options) const {
    const Result result = run("sim bed.ini --quiet --no-pictures " + options);
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }
  static std::string three() {
    return " --set robots.count=3 --set robots.placement=list "
           "--set 'robots.places=-1 -1 0, 1 -1 0, 0 1 90'";
  }
};

TEST_F(ImageAmongRobots, TheSameRunTwiceIsTheSameInEveryFileAndReplays) {
  write_bed("model = scm\n[soil]\npreset = lete_sand\n[robots]\nspacing = 0.35\ncount = 3\n");
  run_bed("--hal mcu --out one" + image());
  run_bed("--hal mcu --out two" + image());
  for (const std::string robot : {"", "robot_1/", "robot_2/"}) {
    for (const std::string file : {"session.h5", "frames.csv", "telemetry.log"}) {
      const std::string path = std::string(robot).append(file);
      EXPECT_FALSE(read("one/" + path).empty()) << path;
      EXPECT_EQ(read("one/" + path), read("two/" + path)) << path;
    }
  }
  const auto json = Json::parse(read("one/summary.json"));
  EXPECT_EQ(json["world"]["hal"], "mcu");
  EXPECT_EQ(json["microcontroller"]["missed_ticks"], 0);
  ASSERT_EQ(json["robots"].size(), 3U);
  for (const auto& robot : json["robots"]) EXPECT_GT(robot["distance_m"], 0.1);

  const Result replay = run("replay one");
  EXPECT_EQ(replay.exit_code, 0) << replay.out << replay.err;
  EXPECT_NE(replay.out.find("robot 2: 800 ticks replayed, outputs identical"), std::string::npos)
      << replay.out;
  // The image has made a tick less than the others.
  EXPECT_EQ(run("render one --pov-only --out all.png").exit_code, 0);
  EXPECT_EQ(run("view one --screenshot all_view.png").exit_code, 0);
  EXPECT_EQ(run("session export one --pictures").exit_code, 0);
}

TEST_F(ImageAmongRobots, DriveAsTheyDoWithoutEachOther) {
  write_bed("model = rigid\n");
  run_bed("--hal mcu --out among" + image() + three());
  run_bed("--hal mcu --out alone --set vehicle.x=-1 --set vehicle.y=-1" + image());
  run_bed("--out native" + three());
  EXPECT_EQ(read("among/frames.csv"), read("alone/frames.csv"));
  EXPECT_EQ(read("among/telemetry.log"), read("alone/telemetry.log"));
  EXPECT_EQ(read("among/robot_1/frames.csv"), read("native/robot_1/frames.csv"));
  EXPECT_EQ(read("among/robot_2/telemetry.log"), read("native/robot_2/telemetry.log"));
  EXPECT_NE(read("among/frames.csv"), read("native/frames.csv")) << "it is the image";
}

TEST_F(ImageAmongRobots, ParityHoldsOnRigidGroundAndOnSoil) {
  for (const char* const map : {"model = rigid\n", "model = scm\n[soil]\npreset = lete_sand\n"}) {
    write_bed(map);
    const Result result =
        run("parity bed.ini --json --minutes 0.2 --set robots.count=4 "
            "--set robots.spacing=0.35" +
            image());
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const auto json = Json::parse(result.out);
    EXPECT_EQ(json["differing_bytes"], 0) << map << json["first_difference"];
    EXPECT_GE(json["ticks"], 1195);
    EXPECT_GE(json["driving_ticks"], 500);
  }
}

TEST_F(McuProgram, SaysWhatIsMissing) {
  const auto refused = [&](const std::string& arguments, const std::string& says) {
    const Result result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments;
    EXPECT_NE(result.err.find(says), std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(std::filesystem::exists(root_ / "out"));
  };
  refused("sim " + first_drive() + " --hal mcu --elf none.elf", "make firmware");
  write("text.elf", "no image\n");
  refused("sim " + first_drive() + " --hal mcu --elf text.elf", "not an ELF image");
  refused("sim " + first_drive() + " --hal mcu --board unheard_of", "unheard_of");
  refused("sim " + first_drive() + " --elf none.elf", "--hal mcu");
  refused("sim " + first_drive() + " --hal cloud", "--hal");
  refused("parity " + first_drive() + " --board unheard_of", kDefaultBoard);
  // Of the image, before anything runs: what it lacks, what it has, and the cure.
  const std::string lacks =
      "the image has no algorithm peak_memory, only drive, hill_sensing, "
      "spin_on_peak, random_walk, coverage, strokes; make firmware LEVELING=peak_memory";
  const std::string missing = first_drive() + image() + " --set experiment.algorithm=peak_memory";
  refused("sim --hal mcu " + missing, lacks);
  refused("parity " + missing, lacks);
}

TEST_F(McuProgram, StopsWhileParticlesAreLaid) {
  std::ofstream(root_ / "big.ini") << "[experiment]\nname = big\n[map]\nmodel = particles\n"
                                      "size = 12\n[particles]\ndepth = 0.15\n";
  struct Case {
    std::vector<std::string> words;
    int signal;
    int exit_code;
    std::string last_words;
  };
  const Case cases[] = {
      {{"sim", "--hal", "mcu"},
       SIGTERM,
       143,
       "note: big was stopped while laying particles; there is no run of it\r\n"},
      {{"parity"}, SIGINT, 130, "screed: stopped while laying particles\r\n"},
  };
  for (const Case& it : cases) {
    std::vector<std::string> words = it.words;
    words.insert(words.begin(), program_);
    words.insert(words.end(), {"big.ini", "--elf", kScreedImage});
    screed::testing::Terminal terminal(words, root_);
    ASSERT_TRUE(terminal.wait_for("laying particles")) << terminal.screen();
    terminal.signal(it.signal);
    EXPECT_EQ(terminal.exit_code(), it.exit_code) << terminal.screen();
    EXPECT_NE(terminal.screen().find(it.last_words), std::string::npos) << terminal.screen();
    EXPECT_FALSE(std::filesystem::exists(root_ / "out"));
  }
}

}  // namespace
}  // namespace screed::mcu
