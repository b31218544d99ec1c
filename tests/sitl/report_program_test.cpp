// `screed report` as a user meets it; what a browser makes of the page is tests/report's.
#include <string>

#include "host_sim/core/data_folders.h"
#include "tests/sitl/program.h"

namespace screed::testing {
namespace {

class Report : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    write("e.ini",
          "[experiment]\nduration = 1\n[map]\nsize = 1\nmodel = scm\n[soil]\ncell = 0.02\n");
    const Result result = run("sim e.ini --quiet --no-pictures --out one");
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }
};

TEST_F(Report, RefusesInOneLineAndLeavesNothing) {
  write("half.h5", read(root_ / "one" / "session.h5").substr(0, 20000));
  expect_refused(run("report nowhere"), 2, {"nowhere", "no such file"});
  expect_refused(run("report half.h5"), 2, {"half.h5"});
  expect_refused(run("report one --out page.txt"), 2, {"page.txt", ".html"});
  expect_refused(run("report"), 2, {"RUN is required"});
  EXPECT_FALSE(std::filesystem::exists(root_ / "page.txt"));
  EXPECT_FALSE(std::filesystem::exists(root_ / "half.html"));
}

TEST_F(Report, WithoutABuiltPageSaysHowToBuildIt) {
  // An installation that lacks it.
  std::filesystem::create_directories(root_ / "data" / "experiments");
  std::filesystem::create_directory_symlink(data_folders().boards, root_ / "data" / "boards");
  const Result result = run("report one", "SCREED_DATA=data");
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_NE(result.err.find("data/report/page.html: no such file; make report-page builds"),
            std::string::npos)
      << result.err;
  EXPECT_FALSE(std::filesystem::exists(root_ / "one" / "report.html"));
}

}  // namespace
}  // namespace screed::testing
