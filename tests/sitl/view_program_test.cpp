// The viewer as a user meets it: beside a running simulation and on a recorded run. Windows are
// opened on SDL's dummy screen, one on a real X server.
#include <string>

#include "firmware/robot/supervisor.h"
#include "host_sim/run/session/session_reader.h"
#include "tests/sitl/program.h"
#include "tests/sitl/terminal.h"

namespace screed::testing {
namespace {

class View : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    write("e.ini",
          "[vehicle]\nh = 30\n[experiment]\nname = small\nduration = 3\nalgorithm = drive\n"
          "[map]\nsize = 1\nmodel = scm\n[soil]\ncell = 0.02\n[drive]\nspeed = 0.1\n");
  }

  /// On a screen that nobody sees.
  Result on_dummy(const std::string& arguments) const {
    return run(arguments, "SDL_VIDEODRIVER=dummy");
  }
  std::string hash(const std::string& folder) const {
    return SessionReader(root_ / folder / "session.h5").content_hash();
  }
  /// Of the IHDR chunk.
  std::pair<int, int> png_size(const std::filesystem::path& file) const {
    const std::string bytes = read(file);
    if (bytes.size() < 24 || bytes.compare(12, 4, "IHDR") != 0) return {0, 0};
    const auto number = [&](size_t at) {
      return static_cast<unsigned char>(bytes[at]) << 8 | static_cast<unsigned char>(bytes[at + 1]);
    };
    return {number(18), number(22)};
  }
  SimFrame last_frame(const std::string& folder) const {
    const SessionReader session(root_ / folder / "session.h5");
    SimFrame frame;
    session.read(session.frames() - 1, std::span(&frame, 1));
    return frame;
  }
};

TEST_F(View, ARunThatIsWatchedIsTheRunThatNobodyWatched) {
  ASSERT_EQ(run("sim e.ini --quiet --out alone").exit_code, 0);
  const Result watched = on_dummy(
      "sim e.ini --quiet --out watched --view --frames 1000 --follow --key-script m@1 --key-script "
      "h@2");
  ASSERT_EQ(watched.exit_code, 0) << watched.err;
  EXPECT_NE(watched.err.find(" frames, "), std::string::npos) << watched.err;
  EXPECT_EQ(hash("watched"), hash("alone"));
  for (const char* file : {"session.h5", "telemetry.log", "frames.csv", "summary.json",
                           "experiment.ini", "terrain_after.png"}) {
    EXPECT_EQ(read(root_ / "watched" / file), read(root_ / "alone" / file)) << file;
  }
}

TEST_F(View, PicturesNeedNoScreen) {
  const Result result =
      run("sim e.ini --quiet --no-pictures --out r --screenshot p.png --at 1.5 --shading slope "
          "--size 700x500",
          "SDL_VIDEODRIVER=none");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(png_size(root_ / "p.png"), (std::pair<int, int>(700, 500)));
  // The run goes on to its end, and the recording shows the same moment.
  EXPECT_EQ(SessionReader(root_ / "r" / "session.h5").frames(), 300U);
  ASSERT_EQ(run("sim e.ini --quiet --no-pictures --heights --out h").exit_code, 0);
  ASSERT_EQ(run("view h --screenshot q.png --at 1.5").exit_code, 0);
  ASSERT_EQ(run("view h --screenshot end.png").exit_code, 0);
  EXPECT_NE(read(root_ / "q.png"), read(root_ / "end.png"));
  ASSERT_EQ(run("view h --screenshot again.png --at 1.5").exit_code, 0);
  EXPECT_EQ(read(root_ / "again.png"), read(root_ / "q.png"));
}

TEST_F(View, TheKeyboardDrivesOverTheRadio) {
  write("hills.ini",
        "[experiment]\nname = hills\nduration = 12\nalgorithm = hill_sensing\n[map]\nsize = 3\n");
  ASSERT_EQ(run("sim hills.ini --quiet --no-pictures --out alone").exit_code, 0);
  const Result driven =
      run("sim hills.ini --quiet --no-pictures --out driven --key-script Up@6-30 --key-script "
          "Left@9-10");
  ASSERT_EQ(driven.exit_code, 0) << driven.err;
  EXPECT_NE(hash("driven"), hash("alone"));
  const SimFrame frame = last_frame("driven");
  EXPECT_EQ(frame.leveling_state, 5);  // drive
  EXPECT_NEAR(frame.linear, 0.18, 0.001);
  EXPECT_GT(frame.velocity_x, 0.1);
  const Result replayed = run("replay driven");
  EXPECT_EQ(replayed.exit_code, 0) << replayed.out << replayed.err;

  // And hands back.
  const Result returned =
      run("sim hills.ini --quiet --no-pictures --out returned --key-script Up@6-8 --key-script "
          "Backspace@8");
  ASSERT_EQ(returned.exit_code, 0) << returned.err;
  EXPECT_EQ(last_frame("returned").leveling_state, 1);  // walk
  EXPECT_EQ(last_frame("returned").state, 2);           // running
}

TEST_F(View, TheEmergencyStopNeedsNoTakingOver) {
  write("hills.ini",
        "[experiment]\nname = hills\nduration = 12\nalgorithm = hill_sensing\n[map]\nsize = 3\n");
  ASSERT_EQ(run("sim hills.ini --quiet --no-pictures --out stopped --key-script Space@7").exit_code,
            0);
  EXPECT_EQ(last_frame("stopped").state, 4);  // fault
  EXPECT_EQ(last_frame("stopped").faults, Fault::kEmergencyStop);
  EXPECT_NEAR(last_frame("stopped").velocity_x, 0.0, 0.005);

  // Nothing but C starts the robot again.
  ASSERT_EQ(run("sim hills.ini --quiet --no-pictures --out held --key-script Space@7 --key-script "
                "Up@8-30 "
                "--key-script Backspace@9")
                .exit_code,
            0);
  EXPECT_EQ(last_frame("held").state, 4);
  ASSERT_EQ(
      run("sim hills.ini --quiet --no-pictures --out cleared --key-script Space@7 --key-script C@8")
          .exit_code,
      0);
  EXPECT_EQ(last_frame("cleared").state, 2);           // running
  EXPECT_EQ(last_frame("cleared").leveling_state, 1);  // walk
}

TEST_F(View, ClosingTheWindowEndsTheRunAndSavesIt) {
  const Result result = on_dummy(
      "sim e.ini --quiet --no-pictures --out r --view --frames 1000 --key-script q@1 --heights");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(SessionReader(root_ / "r" / "session.h5").frames(), 100U);
  EXPECT_TRUE(SessionReader(root_ / "r" / "session.h5").complete());
}

TEST_F(View, ARecordedRunIsPlayedAndFilmed) {
  ASSERT_EQ(run("sim e.ini --quiet --no-pictures --heights --out r").exit_code, 0);
  const Result played = on_dummy(
      "view r --frames 90 --key-script Right@0.5 --key-script 3@1 --key-script Space@2 "
      "--key-script Home@1.7");
  ASSERT_EQ(played.exit_code, 0) << played.err;
  EXPECT_NE(played.err.find("\n90 frames, "), std::string::npos) << played.err;
  ASSERT_EQ(run("view r --frames-dir film --speed 8").exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(root_ / "film" / "frame_000009.png"));
  EXPECT_LE(std::distance(std::filesystem::directory_iterator(root_ / "film"), {}), 12);
}

TEST_F(View, WhatIsWrongIsSaidInOneLine) {
  expect_refused(run("sim e.ini --view", "SDL_VIDEODRIVER=none"), 2,
                 {"the viewer has no screen", "SDL_VIDEODRIVER=none", "--screenshot"});
  expect_refused(run("sim e.ini --key-script Wide@3"), 2, {"--key-script", "Wide@3", "Up@3-5.5"});
  expect_refused(run("sim e.ini --view --size 3x4"), 2, {"--size", "480x360"});
  EXPECT_NE(run("view --help").out.find("8000x8000"), std::string::npos);
  for (const char* size : {"''", "nanxnan", "99999999999x500", "700x500x", "1e3x500", "479x800",
                           "800x359", "8001x800", "800x8001"}) {
    expect_refused(run(std::string("sim e.ini --view --size ") + size), 2, {"--size", "480x360"});
  }
  for (const char* time : {"", "nan", "inf", "nan-3", "1-inf", "1e999", "2000000", "-1", "1x"}) {
    expect_refused(run(std::string("sim e.ini --key-script Up@") + time), 2,
                   {"--key-script", "Up@3-5.5"});
  }
  expect_refused(run("sim e.ini --at 3"), 2, {"--at", "--screenshot"});
  expect_refused(run("sim e.ini e.ini --screenshot p.png"), 2, {"one experiment"});
  expect_refused(run("view nowhere --screenshot p.png"), 2, {"nowhere"});
}

TEST_F(View, WithoutAScreenThereIsNoWindowAndPicturesAreDrawn) {
  const std::string none = "env -u DISPLAY -u WAYLAND_DISPLAY -u SDL_VIDEODRIVER";
  ASSERT_EQ(run("sim e.ini --quiet --no-pictures --out ../r", none).exit_code, 0);
  expect_refused(run("view ../r", none), 2,
                 {"no screen", "DISPLAY is not set, WAYLAND_DISPLAY is not set", "--frames-dir"});
  expect_refused(run("view ../r", none + " DISPLAY=:7654"), 2, {"DISPLAY=:7654 leads to none"});
  // Before anything is set up: so many particles take many minutes to lay.
  write("big.ini", "[map]\nmodel = particles\nsize = 20\n[particles]\ndepth = 0.15\n");
  expect_refused(run("sim big.ini --view", none), 2, {"no screen"});
  EXPECT_EQ(run("view ../r --screenshot p.png", none).err, "");
  EXPECT_EQ(png_size(root_ / "p.png"), (std::pair<int, int>(1280, 800)));
  EXPECT_EQ(run("view ../r --frames-dir film --speed 8", none).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(root_ / "film" / "frame_000009.png"));
  EXPECT_EQ(run("sim e.ini --quiet --no-pictures --screenshot q.png --out s", none).exit_code, 0);
  EXPECT_EQ(png_size(root_ / "q.png"), (std::pair<int, int>(1280, 800)));
}

TEST_F(View, AnInvisibleWindowIsSaid) {
  ASSERT_EQ(run("sim e.ini --quiet --no-pictures --out r").exit_code, 0);
  const Result played = on_dummy("view r --frames 3");
  EXPECT_EQ(played.exit_code, 0);
  EXPECT_EQ(played.err.rfind("note: SDL_VIDEODRIVER=dummy: the window is invisible\n", 0), 0U)
      << played.err;
}

TEST_F(View, CtrlCEndsAFilmAndRemovesItsFrames) {
  write("long.ini", "[experiment]\nduration = 40\nalgorithm = drive\n[map]\nsize = 9\n");
  ASSERT_EQ(run("sim long.ini --quiet --no-pictures --out r").exit_code, 0);
  std::filesystem::create_directory(root_ / "mine");
  write("mine/notes.txt", "x");
  for (const std::string folder : {"deep/film", "mine"}) {
    Terminal terminal({program_, "view", "r", "--frames-dir", folder, "--size", "2000x1500"},
                      root_);
    ASSERT_TRUE(terminal.wait_for("drawing frames")) << terminal.screen();
    terminal.signal(SIGINT);
    EXPECT_EQ(terminal.exit_code(), 130);
    EXPECT_NE(terminal.screen().find("screed: stopped while drawing frames\r\n"), std::string::npos)
        << terminal.screen();
  }
  // So the same command may be given again.
  EXPECT_FALSE(std::filesystem::exists(root_ / "deep"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(root_ / "mine"), {}), 1);
  EXPECT_EQ(run("view r --frames-dir mine --speed 400 --size 480x360").exit_code, 0);
}

TEST_F(View, PicturesThatCannotBeAreRefusedBeforeTheRun) {
  expect_refused(run("sim e.ini --screenshot x.jpg"), 2, {"--screenshot", "x.jpg", ".png"});
  expect_refused(run("sim e.ini --screenshot no/p.png"), 2, {"--screenshot", "no"});
  expect_refused(run("sim e.ini --screenshot p.png --at 3.5"), 2, {"--at = 3.5", "3.00 s", "0 to"});
  ASSERT_EQ(run("sim e.ini --quiet --no-pictures --out r").exit_code, 0);
  expect_refused(run("view r --screenshot x.jpg"), 2, {"--screenshot", "x.jpg", ".png"});
  expect_refused(run("view r --screenshot p.png --at 3.5"), 2, {"--at = 3.5", "r lasts 3.00 s"});
  EXPECT_FALSE(std::filesystem::exists(root_ / "p.png"));
  std::filesystem::create_directory(root_ / "d.png");
  write("file", "x");
  for (const std::string command : {"sim e.ini", "view r"}) {
    expect_refused(run(command + " --screenshot d.png"), 2,
                   {"--screenshot: d.png", "regular file"});
    expect_refused(run(command + " --screenshot /proc/x.png"), 2, {"--screenshot: /proc/x.png"});
    expect_refused(run(command + " --frames-dir /proc/frames"), 2, {"--frames-dir: /proc/frames"});
    expect_refused(run(command + " --frames-dir file/frames"), 2, {"--frames-dir: file/frames"});
  }
  // Trying leaves nothing, also where something else is refused afterwards.
  expect_refused(run("sim nowhere.ini --screenshot new.png --frames-dir a/b"), 2, {"nowhere.ini"});
  EXPECT_FALSE(std::filesystem::exists(root_ / "new.png"));
  EXPECT_FALSE(std::filesystem::exists(root_ / "a"));
  EXPECT_EQ(run("view r --screenshot p.PNG --at 3").exit_code, 0);
  EXPECT_EQ(png_size(root_ / "p.PNG"), (std::pair<int, int>(1280, 800)));
}

TEST_F(View, ARunIsSavedThoughItsPicturesCannotBeWritten) {
  // Their folder goes away while the run goes on.
  write("long.ini",
        "[experiment]\nname = long\nduration = 30\nalgorithm = drive\n[map]\nsize = 9\n");
  std::filesystem::create_directory(root_ / "gone");
  Terminal terminal({program_, "sim", "long.ini", "--out", "r", "--screenshot", "gone/p.png",
                     "--frames-dir", "gone/film", "--size", "480x360"},
                    root_);
  ASSERT_TRUE(terminal.wait_for("frame_000001.png ...")) << terminal.screen();
  std::filesystem::rename(root_ / "gone", root_ / "elsewhere");
  EXPECT_EQ(terminal.exit_code(), 1);
  EXPECT_NE(terminal.screen().find("; the run is saved, in r"), std::string::npos)
      << terminal.screen();
  EXPECT_TRUE(SessionReader(root_ / "r" / "session.h5").complete());
  EXPECT_EQ(SessionReader(root_ / "r" / "session.h5").frames(), 3000U);
}

TEST_F(View, TheRunIsReadBeforeAScreenIsLookedFor) {
  expect_refused(run("view nowhere", "SDL_VIDEODRIVER=none"), 2, {"nowhere", "no such file"});
}

TEST_F(View, FramesOfTwoFilmsDoNotMix) {
  ASSERT_EQ(run("sim e.ini --quiet --no-pictures --out r").exit_code, 0);
  ASSERT_EQ(run("view r --frames-dir film --speed 8 --size 480x360").exit_code, 0);
  const std::string first = read(root_ / "film" / "frame_000001.png");
  expect_refused(run("view r --frames-dir film --speed 32 --size 480x360 --shading slope"), 2,
                 {"--frames-dir", "film", "another"});
  EXPECT_EQ(read(root_ / "film" / "frame_000001.png"), first);
  // An empty folder, or one with other files, is welcome.
  std::filesystem::create_directory(root_ / "other");
  write("other/notes.txt", "x");
  EXPECT_EQ(run("view r --frames-dir other --speed 32 --size 480x360").exit_code, 0);
  // The R key names no folder: every film gets a new one.
  const std::string film =
      "view r --frames 20 --size 480x360 --key-script R@0.1 --key-script R@0.2";
  ASSERT_EQ(on_dummy(film).exit_code, 0);
  ASSERT_EQ(on_dummy(film).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(root_ / "frames" / "frame_000001.png"));
  EXPECT_TRUE(std::filesystem::exists(root_ / "frames-2" / "frame_000001.png"));
}

TEST_F(View, OnARealScreenTheWindowClosesAtAKey) {
  const Result result = run("", "export SCREED='" + program_ +
                                    "'; xvfb-run -a bash -c '"
                                    "\"$SCREED\" sim e.ini --set experiment.duration=600 --view "
                                    "--quiet --out r & xdotool search --sync --name Screed:.small "
                                    "key q; wait $!'; true");
  EXPECT_TRUE(SessionReader(root_ / "r" / "session.h5").complete()) << result.out << result.err;
  EXPECT_LT(SessionReader(root_ / "r" / "session.h5").frames(), 60000U);
}

}  // namespace
}  // namespace screed::testing
