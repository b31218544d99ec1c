// What the summary of a run says of a robot that could not be armed.

#include "host_sim/core/json.h"
#include "tests/sitl/program.h"

namespace screed::testing {
namespace {

using Sentences = std::vector<std::string>;

class Arming : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    write("e.ini", "[experiment]\nname = e\nduration = 7\n");
  }
};

TEST_F(Arming, TheSummarySaysWhatPreventedIt) {
  struct Case {
    const char* arguments;
    const char* state;
    Sentences obstacles;
  };
  const Case cases[] = {
      {"--duration 2", "disarmed", {"start-up needs 4.5 s at rest, 2.5 s left"}},
      {"--set parameters.battery_low=9000",
       "disarmed",
       {"battery 8.38 V below battery_low 9.00 V"}},
      {"--set parameters.tilt_limit=1000 --set map.ramp=20",
       "disarmed",
       {"tilted 20 degrees, tilt_limit 10 degrees"}},
      {"--set radio.loss=1", "disarmed", {"the robot hears no ground station"}},
      {"--set radio.key=none",
       "disarmed",
       {"commands are refused: the robot has no command key; one is set over USB"}},
      {"--set radio.ground_station=false", "disarmed", {}},
      {"", "running", {}},
  };
  for (const Case& it : cases) {
    const Result result = run(std::string("sim e.ini --no-pictures --json ") + it.arguments);
    ASSERT_EQ(result.exit_code, 0) << it.arguments << ": " << result.err;
    const auto summary = Json::parse(result.out);
    EXPECT_EQ(summary["state"].get<std::string>(), it.state) << it.arguments;
    EXPECT_EQ(summary["cannot_be_armed"].get<Sentences>(), it.obstacles) << it.arguments;
  }
}

TEST_F(Arming, TheTableHasALineForEachReason) {
  const Result low = run("sim e.ini --no-pictures --duration 4 --set parameters.battery_low=9000");
  EXPECT_EQ(low.exit_code, 0) << low.err;
  EXPECT_NE(low.out.find("  cannot be armed:           battery 8.38 V below battery_low 9.00 V\n"
                         "                             start-up needs 4.5 s at rest, 0.5 s left\n"),
            std::string::npos)
      << low.out;
  const Result well = run("sim e.ini --no-pictures");
  EXPECT_EQ(well.out.find("be armed"), std::string::npos) << well.out;
  const Result idle = run("sim e.ini --no-pictures --set radio.ground_station=false");
  EXPECT_NE(idle.out.find("  can be armed                        yes\n"), std::string::npos)
      << idle.out;
}

}  // namespace
}  // namespace screed::testing
