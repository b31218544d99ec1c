// Numbers on the command line that once ended in a crash, in a run without end, or were taken as
// they came. Every numeric option is tested in tests/unit/tools/screed/cli.
#include <set>

#include "tests/sitl/program.h"

namespace screed::testing {
namespace {

class Numbers : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    write("e.ini", "[experiment]\nname = e\nduration = 0.1\n");
  }
  std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(root_)) {
      names.insert(entry.path().filename());
    }
    return names;
  }
};

TEST_F(Numbers, WhatOnceCrashedOrHungIsOneLine) {
  ASSERT_EQ(run("sim e.ini --quiet --no-pictures --out r").exit_code, 0);
  ASSERT_EQ(run("view r --screenshot whole.png").exit_code, 0);
  const std::set<std::string> before = files();
  struct Case {
    const char* arguments;
    const char* message;
  };
  const std::vector<Case> cases = {
      // Segmentation faults.
      {"view r --span nan --screenshot z.png", "--span nan: allowed are 0.05 to 1000"},
      {"sim e.ini --span nan --screenshot z.png --out s", "--span nan: allowed are 0.05 to 1000"},
      // Never ended, or filled the memory.
      {"parity e.ini --minutes nan", "--minutes nan: allowed are 0.01 to 10000"},
      {"parity e.ini --minutes inf", "--minutes inf: allowed are 0.01 to 10000"},
      {"nn stuck --duration nan --trapped 1", "--duration nan: allowed are 5 to 36000"},
      // Were taken.
      {"view r --speed nan --frames-dir f", "--speed nan: allowed are 0.01 to 1000, and 0"},
      {"view r --at nan --screenshot z.png", "--at nan: allowed are 0 to 1000000"},
      {"plot none.log attitude.pitch --from nan --out p.svg", "--from nan: allowed are 0 to "},
      {"plot none.log attitude.pitch --to nan --out p.svg", "--to nan: allowed are 0 to "},
      {"soil plate --offset-x nan", "--offset-x nan: allowed are -1 to 1"},
      {"soil plate --yaw inf", "--yaw inf: allowed are -360 to 360"},
      {"soil repose --x nan", "--x nan: allowed are -10 to 10"},
      {"soil dig --fit-raised nan", "--fit-raised nan: allowed are 0 to "},
      // Blamed something else, or said it in hundreds of digits.
      {"sim e.ini --duration nan --out s", "--duration nan: allowed are 0.01 to 1000000"},
      {"sim e.ini --seed 1.5 --out s", "--seed 1.5: allowed are whole numbers 0 to "},
      {"record e.ini --frames '' --out s", "--frames '': allowed are whole numbers 8 to 262136"},
      {"session export r --csv --count -3", "--count -3: allowed are whole numbers 1 to "},
  };
  for (const Case& bad : cases) {
    SCOPED_TRACE(bad.arguments);
    const Result result = run(bad.arguments, "timeout 20");
    expect_refused(result, 2, {std::string("screed: ") + bad.message});
    EXPECT_EQ(result.out, "");
    EXPECT_LT(result.err.size(), 160U);
    EXPECT_EQ(files(), before);
  }
}

TEST_F(Numbers, OfAnOverrideAreCheckedToo) {
  for (const char* value : {"nan", "inf", "-inf", "1e999", "", "1s", "0", "-1", "1e7"}) {
    expect_refused(run(std::string("sim e.ini --set experiment.duration=") + value), 2,
                   {"--set: [experiment] duration = '" + std::string(value) + "' is not allowed"});
  }
}

TEST_F(Numbers, OfTheMessageNameTheSubcommandWhoseHelpSaysMore) {
  expect_refused(run("session export r --count 0"), 2, {"(see screed session export --help)"});
  expect_refused(run("sim e.ini --frobnicate"), 2,
                 {"'--frobnicate' is no option (see screed sim --help)"});
}

TEST_F(Numbers, ADurationIsThatOfTheRun) {
  ASSERT_EQ(
      run("sim e.ini --quiet --no-pictures --duration 0.25 --seed 18446744073709551615 --out r")
          .exit_code,
      0);
  const Result info = run("session info r --json");
  EXPECT_NE(info.out.find("\"frames\": 25"), std::string::npos) << info.out;
  EXPECT_NE(info.out.find("18446744073709551615"), std::string::npos) << info.out;
}

}  // namespace
}  // namespace screed::testing
