// `screed parity` and `screed sim --hal mcu` as a user meets them.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host_sim/run/experiment/board_table.h"
#include "paths.h"
#include "tests/mcu/images.h"
#include "tests/sitl/terminal.h"

namespace screed::mcu {
namespace {

struct Result {
  int exit_code;
  std::string out;
  std::string err;
};

class McuProgram : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* program = std::getenv("SCREED_PROGRAM");
    ASSERT_NE(program, nullptr)
        << "SCREED_PROGRAM names the program under test; `make test` sets it";
    program_ = program;
    root_ = std::filesystem::temp_directory_path() /
            ("screed-mcu-" + std::to_string(getpid()) + "-" +
             ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(root_);
    std::filesystem::create_directories(root_);
  }
  void TearDown() override { std::filesystem::remove_all(root_); }

  Result run(const std::string& arguments) const {
    const std::string out = (root_ / "stdout").string();
    const std::string err = (root_ / "stderr").string();
    const std::string command = "cd '" + root_.string() + "' && '" + program_ + "' " + arguments +
                                " > '" + out + "' 2> '" + err + "' < /dev/null";
    const int status = std::system(command.c_str());
    const auto text = [](const std::string& path) {
      std::ifstream file(path);
      return std::string(std::istreambuf_iterator<char>(file), {});
    };
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text(out), text(err)};
  }
  static std::string first_drive() {
    return std::string("'") + kDataFolder + "/experiments/first_drive.ini'";
  }
  static std::string image() { return std::string(" --elf '") + kScreedImage + "'"; }

  std::string program_;
  std::filesystem::path root_;
};

TEST_F(McuProgram, ParityOfAShortHillSensing) {
  const Result result = run("parity " + first_drive() + image() + " --minutes 0.5 --json");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["differing_bytes"], 0);
  EXPECT_TRUE(json["first_difference"].is_null());
  EXPECT_GE(json["ticks"], 2995);
  EXPECT_GE(json["driving_ticks"], 2000);
  EXPECT_GT(json["real_time_factor"], 0.0);
}

TEST_F(McuProgram, ARunOfTheImageIsASessionThatReplays) {
  const Result sim =
      run("sim " + first_drive() + image() + " --hal mcu --duration 12 --seed 3 --out run --json");
  ASSERT_EQ(sim.exit_code, 0) << sim.err;
  const auto json = nlohmann::json::parse(sim.out);
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
                           " --hal mcu --duration 12 --seed 3 --out again --json");
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(nlohmann::json::parse(again.out)["content_hash"], json["content_hash"]);
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
  refused("sim " + first_drive() + " --hal mcu --elf stdout", "not an ELF image");
  refused("sim " + first_drive() + " --hal mcu --board unheard_of", "unheard_of");
  refused("sim " + first_drive() + " --elf none.elf", "--hal mcu");
  refused("sim " + first_drive() + " --hal cloud", "--hal");
  refused("parity " + first_drive() + " --board unheard_of", kDefaultBoard);
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
