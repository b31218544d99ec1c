// Pages and pictures of a run: `screed report`, `screed render`.
#include <sys/stat.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <string>

#include "host_sim/core/data_folders.h"
#include "host_sim/physics/terrain/grey_image.h"
#include "tests/sitl/program.h"
#include "tests/sitl/terminal.h"

namespace screed::testing {
namespace {

// `screed report` as a user meets it; what a browser makes of the page is tests/report's.

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

// `screed render` as a user meets it. POV-Ray itself is used where it is installed, and a stand-in
// where a test needs it to be missing or to fail.

class Render : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    write("e.ini",
          "[experiment]\nduration = 2\nalgorithm = drive\n[map]\nsize = 1\nmodel = scm\n[soil]\n"
          "cell = 0.02\n");
    ASSERT_EQ(run("sim e.ini --quiet --no-pictures --out run").exit_code, 0);
    std::filesystem::create_directories(root_ / "bin");
  }

  /// A program of that text under the name povray.
  void put_povray(const std::string& script) const {
    const std::filesystem::path file = root_ / "bin" / "povray";
    std::ofstream(file) << "#!/bin/sh\n" << script;
    ASSERT_EQ(chmod(file.c_str(), 0755), 0);
  }
  /// With nothing but bin/ on the path.
  Result render(const std::string& arguments) const {
    return run("render " + arguments, "PATH='" + (root_ / "bin").string() + "'");
  }
  /// Whether such a process still computes; one that has been killed may wait for its parent.
  static bool runs(int pid) {
    const std::string status = read("/proc/" + std::to_string(pid) + "/status");
    return !status.empty() && status.find("State:\tZ") == std::string::npos;
  }
  /// One that has been killed still needs the processor once.
  static bool ends(int pid) {
    constexpr int kLooks = 100'000;
    for (int i = 0; i < kLooks; ++i) {
      if (!runs(pid)) return true;
    }
    return false;
  }
  /// Files and folders in the folder of the test, beside those of SetUp().
  std::vector<std::string> files(const std::string& folder = ".") const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(root_ / folder)) {
      const std::string name = entry.path().filename();
      if (name != "e.ini" && name != "run" && name != "bin") names.push_back(name);
    }
    std::sort(names.begin(), names.end());
    return names;
  }
};

using Names = std::vector<std::string>;

TEST_F(Render, WithoutPovrayLeavesTheScene) {
  const Result result = render("run --frame 150 --out p.png");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, "frame 150: p.pov (no picture: povray is not installed)\n");
  EXPECT_EQ(files(), (Names{"p.pov", "p_ground.png", "p_turned.png"}));
  const GreyImage ground = read_grey_image(root_ / "p_ground.png");
  EXPECT_EQ(ground.width, 51);
  EXPECT_EQ(ground.bit_depth, 16);
}

TEST_F(Render, RunsPovrayBesideTheScene) {
  put_povray(
      "for word; do case $word in +I*) cp \"${word#+I}\" copy; esac; done\n"
      "for word; do case $word in +O*) echo \"$*\" > \"${word#+O}\"; esac; done\nrm copy\n");
  // The scene's own images are found from where povray runs.
  const Result result =
      run("render run --out pictures.d/p.png --width 320 --height 200 --frame -200",
          "mkdir pictures.d; PATH='" + (root_ / "bin").string() + ":/usr/bin:/bin'");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, "frame 0: pictures.d/p.png\n");
  EXPECT_EQ(files("pictures.d"), (Names{"p.png", "p.pov", "p_ground.png"}));
  const std::string arguments = read(root_ / "pictures.d" / "p.png");
  for (const char* part : {"+Ip.pov", "+Op.png", "+W320", "+H200"}) {
    EXPECT_NE(arguments.find(part), std::string::npos) << part << " in: " << arguments;
  }
}

TEST_F(Render, PovrayThatFailsLeavesNothing) {
  put_povray("echo 'p.pov line 7: Parse Error: no such thing' >&2\nexit 1\n");
  const Result result = render("run --out p.png");
  expect_refused(result, 1, {"povray", "p.pov", "Parse Error: no such thing"});
  EXPECT_EQ(files(), Names{});
}

TEST_F(Render, ShowsTheProgressOfPovrayUnlessQuiet) {
  // Ends when the test has seen the progress.
  put_povray(
      "printf 'Rendered 1 of 4 pixels (25%%)\\rRendered 2 of 4 pixels (50%%)\\r' >&2\n"
      "until [ -e seen ]; do sleep 0.01; done\n"
      "for word; do case $word in +O*) echo > \"${word#+O}\"; esac; done\n");
  const std::string path = (root_ / "bin").string() + ":/usr/bin:/bin";
  Terminal terminal({program_, "render", "run", "--out", "p.png"}, root_, path);
  ASSERT_TRUE(terminal.wait_for(" 50 %")) << terminal.screen();
  ASSERT_TRUE(terminal.wait_for("rendering p.png")) << terminal.screen();
  for (const std::string& folder : files()) write(folder + "/seen", "");
  EXPECT_EQ(terminal.exit_code(), 0) << terminal.screen();
  EXPECT_NE(terminal.screen().find("frame 199: p.png\r\n"), std::string::npos) << terminal.screen();

  put_povray("sleep 0.3\nfor word; do case $word in +O*) echo > \"${word#+O}\"; esac; done\n");
  Terminal quiet({program_, "render", "run", "--out", "q.png", "--quiet"}, root_, path);
  EXPECT_EQ(quiet.exit_code(), 0);
  EXPECT_EQ(quiet.screen(), "frame 199: q.png\r\n");
}

TEST_F(Render, ASignalEndsPovrayAndWhatItStartedAndLeavesNothing) {
  // The child and its own child would go on for minutes.
  put_povray("sleep 300 &\necho $$ $! > \"$PIDS\"\necho 'Rendered 1 of 4 pixels' >&2\nwait\n");
  const std::filesystem::path pids = root_ / "bin" / "pids";
  setenv("PIDS", pids.c_str(), 1);
  struct Case {
    int signal;
    int exit_code;
  };
  for (const Case& it : {Case{SIGHUP, 129}, Case{SIGINT, 130}, Case{SIGTERM, 143}}) {
    Terminal terminal({program_, "render", "run", "--out", "p.png"}, root_,
                      (root_ / "bin").string() + ":/usr/bin:/bin");
    ASSERT_TRUE(terminal.wait_for(" 25 %")) << terminal.screen();
    terminal.signal(it.signal);
    EXPECT_EQ(terminal.exit_code(), it.exit_code) << terminal.screen();
    EXPECT_NE(terminal.screen().find("screed: stopped while rendering p.png\r\n"),
              std::string::npos)
        << terminal.screen();
    EXPECT_EQ(files(), Names{});
    std::ifstream file(pids);
    for (int pid = 0; file >> pid;) EXPECT_TRUE(ends(pid)) << pid;
  }
  unsetenv("PIDS");
}

TEST_F(Render, SceneOnly) {
  put_povray("exit 1\n");
  const Result result = render("run --pov-only");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(std::filesystem::exists(root_ / "run" / "frame_last.pov"));
  EXPECT_FALSE(std::filesystem::exists(root_ / "run" / "frame_last.png"));
}

TEST_F(Render, HeightsAreTintedUnlessAskedOtherwise) {
  const auto scene = [this](const std::string& options) {
    EXPECT_EQ(render("run --out p.png --pov-only " + options).exit_code, 0);
    return read(root_ / "p.pov");
  };
  for (const char* camera : {"front", "bed"}) {
    const std::string camera_option = std::string("--camera ") + camera;
    EXPECT_NE(scene(camera_option).find("\"height [mm]\""), std::string::npos);
    EXPECT_EQ(scene(camera_option + " --no-tint").find("HeightColors"), std::string::npos);
  }
}

TEST_F(Render, ParticlesAreRoundAndWhereTheRunLeftThem) {
  write("g.ini",
        "[experiment]\nduration = 6.5\nalgorithm = drive\n[map]\nsize = 0.4\nmodel = "
        "particles\nparticle_radius = 0.02\n[particles]\ndepth = 0.06\n");
  ASSERT_EQ(run("sim g.ini --quiet --no-pictures --out gravel").exit_code, 0);
  const auto spheres = [this](const std::string& options) {
    const Result result = render("gravel --out g.png --no-path --pov-only " + options);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const std::string scene = read(root_ / "g.pov");
    EXPECT_EQ(scene.find("height_field"), std::string::npos);
    return scene.substr(scene.find("  sphere { <"), 4000);
  };
  const std::string after = spheres("");
  EXPECT_NE(after.find(", 0.020000 texture { Stone"), std::string::npos);
  EXPECT_NE(spheres("--frame 0"), after) << "the robot has moved none";
}

TEST_F(Render, RefusesInOneLineAndLeavesNothing) {
  write("half.h5", read(root_ / "run" / "session.h5").substr(0, 20000));
  std::filesystem::create_directories(root_ / "run" / "empty");
  expect_refused(render("run --frame 200 --out p.png"), 2, {"frame = 200", "0 to 199"});
  expect_refused(render("run --frame -201 --out p.png"), 2, {"frame = -201", "0 to 199"});
  expect_refused(render("run --frame one --out p.png"), 2, {"--frame", "one"});
  expect_refused(render("nowhere --out p.png"), 2, {"nowhere", "no such"});
  expect_refused(render("run/empty --out p.png"), 2, {"run/empty", "not the folder of a run"});
  expect_refused(render("e.ini --out p.png"), 2, {"e.ini"});
  expect_refused(render("half.h5 --out p.png"), 2, {"half.h5"});
  expect_refused(render("run --out p.bmp"), 2, {"p.bmp", ".png"});
  expect_refused(render("run --out p.png --camera behind"), 2, {"behind", "front", "AZIMUTH"});
  expect_refused(render("run --out p.png --width 7"), 2, {"7", "16 to 8000"});
  expect_refused(render("run --out p.png --model gone.urdf"), 2, {"gone.urdf"});
  expect_refused(render("run --out no_folder/p.png"), 1, {"no_folder/p.png"});
  EXPECT_EQ(files(), Names{"half.h5"});
}

TEST_F(Render, RealPovrayDrawsIt) {
  if (std::system("povray --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "povray is missing";
  const Result result = run("render run --out p.png --width 96 --height 60");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string png = read(root_ / "p.png");
  ASSERT_GT(png.size(), 2000u);  // more than a sky
  EXPECT_EQ(png.substr(1, 3), "PNG");
  // Width and height stand behind the first chunk's name.
  EXPECT_EQ(png.substr(16, 8), std::string("\0\0\0\x60\0\0\0\x3c", 8));
}

}  // namespace
}  // namespace screed::testing
