// `screed record`, `session` and `terrain` as a user meets them; what they write, read by programs
// that are not ours.
// Long: sessions are recorded and exported whole, and twice where bytes are compared.
#include <png.h>

#include <cmath>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "host_sim/core/child_process.h"
#include "host_sim/core/json.h"
#include "host_sim/run/session/session_reader.h"
#include "host_sim/run/session/session_writer.h"
#include "tests/sitl/program.h"
#include "tests/sitl/terminal.h"

namespace screed::testing {
namespace {

class RecordProgram : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    ASSERT_EQ(run("terrain generate hills.png --size 64 --waves 1 --octaves 2 --seed 3").exit_code,
              0);
    write("soft.ini", experiment("soft", "scm", 80));
    write("hard.ini", experiment("hard", "rigid", 40));
  }

  static std::string experiment(const std::string& name, const std::string& model, int frames) {
    return "[vehicle]\nh = 30\nx = 0.3\n[map]\nfilename = hills.png\nsize = 1.28\nscale = 0.03\n"
           "edges = wrap\nmodel = " +
           model + (model == "scm" ? "\n[soil]\ncell = 0.01" : "") +
           "\n[experiment]\nname = " + name + "\nframes = " + std::to_string(frames) + "\n";
  }

  /// What a program prints; the test fails when it does not end well.
  std::string shell(const std::string& command) const {
    const ShellOutput output = shell_output("cd '" + root_.string() + "' && " + command + " 2>&1");
    EXPECT_EQ(output.exit_code, 0) << command << "\n" << output.text;
    return output.text;
  }
};

TEST_F(RecordProgram, ADriveMayEndBeforeItsBlocksDo) {
  const Result recorded =
      run("record soft.ini --no-pictures --set experiment.stop_after=0.3 --out run --json");
  ASSERT_EQ(recorded.exit_code, 0) << recorded.err;
  EXPECT_EQ(Json::parse(recorded.out)["training_frames"], 30);
}

TEST_F(RecordProgram, ASessionIsRecordedShownAndExported) {
  const Result recorded = run("record soft.ini --no-pictures --out run --json");
  ASSERT_EQ(recorded.exit_code, 0) << recorded.err;
  const Json summary = Json::parse(recorded.out);
  EXPECT_EQ(summary["training_frames"], 80);
  EXPECT_GT(summary["height_changes"], 1000);

  const Json info = Json::parse(run("session info run --json").out);
  EXPECT_EQ(info["training_frames"], 80);
  EXPECT_EQ(info["heights"]["nx"], 128);
  EXPECT_EQ(info["content_hash"], summary["content_hash"]);
  EXPECT_EQ(info["frames"], info["training_first"].get<int>() + 80);
  EXPECT_NE(run("session info run").out.find("training frames    80 from frame "),
            std::string::npos);
  EXPECT_NE(run("replay run").out.find("outputs identical"), std::string::npos);

  const Result exported = run("session export run --csv --heights --pictures --every 40");
  ASSERT_EQ(exported.exit_code, 0) << exported.err;
  // The table, by awk: units in the header, 80 rows of 12 columns, each block of its kind.
  EXPECT_EQ(shell("head -1 run/export/table_5_1.csv"),
            "frame,x [m],y [m],delta_x [m],delta_y [m],delta_theta [rad],v_left [rad/s],"
            "v_right [rad/s],pitch [rad],roll [rad],linear [m/s],angular [rad/s]\n");
  EXPECT_EQ(shell("awk -F, 'NR > 1 && NF == 12' run/export/table_5_1.csv | wc -l"), "80\n");
  EXPECT_EQ(shell("awk -F, 'NR > 1 { print ($11 > 0) - ($11 < 0), ($12 > 0) - ($12 < 0) }' "
                  "run/export/table_5_1.csv | uniq -c | tr -s ' ' | tr '\\n' ';'"),
            " 11 1 0; 9 -1 0; 10 0 1; 10 0 -1; 10 1 1; 10 -1 -1; 10 -1 1; 10 1 -1;");
  // The images, by pngcheck and libpng, against the heights that h5dump prints.
  EXPECT_NE(shell("pngcheck run/export/heights/*.png").find("128x128, 16-bit grayscale"),
            std::string::npos);
  shell("pngcheck run/export/pictures/*.png");
  const Json scale = Json::parse(read(root_ / "run/export/heights/scale.json"));
  ASSERT_EQ(scale["frames"].size(), 2U);
  EXPECT_EQ(scale["frames"][0]["frame"], info["training_first"]);
  EXPECT_NEAR(scale["m_per_pixel"].get<double>(), 0.01, 1e-12);
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  const std::string last = scale["frames"][1]["file"].get<std::string>();
  ASSERT_NE(png_image_begin_read_from_file(&image, (root_ / "run/export/heights" / last).c_str()),
            0);
  image.format = PNG_FORMAT_LINEAR_Y;  // 16 bit, taken as they are
  std::vector<uint16_t> samples(PNG_IMAGE_SIZE(image) / 2);
  ASSERT_NE(png_image_finish_read(&image, nullptr, samples.data(), 0, nullptr), 0);
  const SessionReader session(root_ / "run" / "session.h5");
  const HeightMap& map = session.heights_after(scale["frames"][1]["frame"].get<uint64_t>() + 1);
  const double black = scale["black_m"].get<double>();
  const double step = scale["m_per_sample_step"].get<double>();
  for (size_t row = 0; row < 128; ++row) {
    for (size_t x = 0; x < 128; ++x) {
      const double height = map.heights[(127 - row) * 128 + x] * map.geometry.unit_m;
      ASSERT_NEAR(black + samples[row * 128 + x] * step, height, 0.5001 * step);
    }
  }
  // What the file holds at the end is the terrain as it was left.
  EXPECT_EQ(session.heights_after(session.frames()).heights, session.terrain_after()->heights);
  EXPECT_NE(session.heights_after(0).heights, session.terrain_after()->heights);
  EXPECT_NE(shell("h5dump -a /soil/k_phi run/session.h5").find("2e+06"), std::string::npos);

  ASSERT_EQ(run("session export run --csv --all --first 5 --count 7 --out e").exit_code, 0);
  EXPECT_EQ(shell("awk -F, 'NR > 1 { print $1 }' e/frames.csv | tr '\\n' ' '"), "5 6 7 8 9 10 11 ");
}

TEST_F(RecordProgram, ARunsPicturesAreMadeAgainFromItsSession) {
  write("bed.ini",
        "[experiment]\nname = bed\nduration = 0.5\n[map]\nmodel = particles\nsize = 0.8\n"
        "[particles]\ndepth = 0.05\n");
  const auto expect_same = [this](const std::string& name) {
    ASSERT_EQ(run("sim " + name + ".ini --duration 0.5 --quiet --out " + name).exit_code, 0);
    const Result exported = run("session export " + name + " --pictures");
    ASSERT_EQ(exported.exit_code, 0) << exported.err;
    EXPECT_NE(exported.err.find("start and end alone"), std::string::npos) << exported.err;
    EXPECT_NE(exported.err.find("sim --heights"), std::string::npos) << exported.err;
    for (const char* file :
         {"terrain_before.png", "terrain_after.png", "terrain_change.png", "leveling.png"}) {
      const std::string drawn = read(root_ / name / file);
      EXPECT_EQ(drawn.substr(1, 3), "PNG");
      EXPECT_TRUE(read(root_ / name / "export" / "pictures" / file) == drawn) << name << file;
    }
  };
  expect_same("soft");
  expect_same("bed");
  expect_refused(run("session export soft --heights"), 2, {"sim --heights", "record"});
}

TEST_F(RecordProgram, ASeriesOfPicturesShowsTheSurfaceThatCounts) {
  write("bed.ini",
        "[experiment]\nname = bed\nduration = 0.05\n[map]\nmodel = particles\nsize = 0.8\n"
        "[particles]\ndepth = 0.05\n");
  ASSERT_EQ(run("sim bed.ini --heights --quiet --no-pictures --out bed").exit_code, 0);
  ASSERT_EQ(run("session export bed --pictures --every 5").exit_code, 0);
  const std::string filtered = read(root_ / "bed/export/pictures/picture_000000.png");
  // The same heights as terrain that is no bed of particles: stone by stone.
  const SessionReader bed(root_ / "bed" / "session.h5");
  SessionInfo info = bed.info();
  info.experiment_text = "[experiment]\nname = bed\n[map]\nmodel = rigid\n";
  SessionWriter writer(root_ / "stones.h5", info);
  writer.write_terrain_before(bed.terrain_before()->view());
  writer.record_heights(bed.heights_after(0).view());
  std::vector<SimFrame> frame(1);
  bed.read(0, std::span(frame));
  writer.append(frame[0], SensorSample{}, RobotOutput{}, {});
  writer.write_terrain_after(bed.terrain_after()->view());
  writer.finish();
  ASSERT_EQ(run("session export stones.h5 --pictures --every 5 --out e").exit_code, 0);
  EXPECT_FALSE(filtered == read(root_ / "e/pictures/picture_000000.png"));
}

TEST_F(RecordProgram, AnExportThatIsStoppedLeavesNothing) {
  ASSERT_EQ(run("record soft.ini --frames 600 --out run --quiet --no-pictures").exit_code, 0);
  ASSERT_EQ(run("session export run --heights --every 300").exit_code, 0);
  const auto files = [this] {
    std::set<std::filesystem::path> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root_ / "run"))
      names.insert(entry.path());
    return names;
  };
  const auto before = files();
  const std::string scale = read(root_ / "run/export/heights/scale.json");
  for (const std::string what : {"heights", "pictures"}) {
    Terminal terminal({program_, "session", "export", "run", "--" + what, "--every", "1"}, root_);
    ASSERT_TRUE(terminal.wait_for("exporting " + what)) << terminal.screen();
    terminal.signal(SIGINT);
    EXPECT_EQ(terminal.exit_code(), 130) << terminal.screen();
  }
  const auto after = files();
  for (const auto& file : after) {
    const std::string name = file.filename().string();
    const bool of_the_run = name.starts_with("terrain_") || name == "leveling.png";
    EXPECT_TRUE(before.contains(file) || of_the_run || file.filename() == "pictures") << file;
  }
  EXPECT_EQ(read(root_ / "run/export/heights/scale.json"), scale);
}

TEST_F(RecordProgram, EqualSeedsGiveEqualSessionsAndOthersOthers) {
  const auto hash = [&](const std::string& arguments) {
    const Result result = run("record " + arguments + " --no-pictures --json");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(result.out)["content_hash"].get<std::string>();
  };
  const std::string first = hash("soft.ini --seed 5 --out a");
  EXPECT_EQ(hash("soft.ini --seed 5 --out b"), first);
  EXPECT_NE(hash("soft.ini --seed 6 --out c"), first);
  // The file of the run gives it again.
  EXPECT_EQ(hash("a/experiment.ini --set map.filename=../hills.png --out d").size(), first.size());
}

TEST_F(RecordProgram, SeveralExperimentsRunInSuccession) {
  const Result result =
      run("record hard.ini soft.ini hard.ini --out sets --frames 8 --quiet --no-pictures");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  for (const char* name : {"hard-0001", "soft-0001", "hard-0002"}) {
    EXPECT_EQ(
        Json::parse(run(std::string("session info --json sets/") + name).out)["training_frames"], 8)
        << name;
  }
  // Each has a world of its own: the same as alone.
  const auto hash = [&](const char* folder) {
    return Json::parse(run(std::string("session info --json ") + folder).out)["content_hash"];
  };
  EXPECT_EQ(hash("sets/hard-0001"), hash("sets/hard-0002"));
  ASSERT_EQ(run("record soft.ini --no-pictures --frames 8 --out alone").exit_code, 0);
  EXPECT_EQ(hash("sets/soft-0001"), hash("alone"));
  EXPECT_NE(run("sim hard.ini soft.ini --duration 0.1 --out pair --quiet --no-pictures")
                .out.find("pair/soft"),
            std::string::npos);
  const Json both =
      Json::parse(run("sim hard.ini hard.ini --no-pictures --duration 0.1 --json").out);
  EXPECT_EQ(both.size(), 2U);
}

TEST_F(RecordProgram, NothingIsRunWhenOneFileOfSeveralIsWrong) {
  write("wrong.ini", "[map]\nfilename = nothing.png\n");
  expect_refused(run("record hard.ini wrong.ini"), 2, {"nothing.png", "no such file"});
}

TEST_F(RecordProgram, WrongInputIsOneLine) {
  expect_refused(run("record"), 2, {"FILE"});
  expect_refused(run("record hard.ini --frames 12"), 2, {"--frames 12", "a multiple of 8"});
  expect_refused(run("record hard.ini --seed x"), 2, {"--seed x", "whole numbers"});
  expect_refused(run("session info nowhere"), 2, {"nowhere", "no such file"});
  expect_refused(run("session info soft.ini"), 2, {"not a session"});
  expect_refused(run("session export hills.png --csv"), 2, {"not a session"});
  expect_refused(run("terrain generate hills.jpg"), 2, {"hills.jpg", ".png", ".bmp"});
  expect_refused(run("terrain generate a.png --size 5"), 2, {"--size 5", "16 to 4096"});
  ASSERT_EQ(run("record hard.ini --no-pictures --out run").exit_code, 0);
  expect_refused(run("session export run"), 2,
                 {"--csv, --heights, --leveling, --mcap, --pictures"});
  expect_refused(run("session export run --csv --first 100000"), 2, {"--first = 100000"});
  expect_refused(run("session export run --csv --count 100000"), 2, {"--count = 100000"});
  ASSERT_EQ(run("sim hard.ini --no-pictures --duration 0.1 --out plain").exit_code, 0);
  expect_refused(run("session export plain --heights"), 2, {"no recorded heights"});
  // A file that was cut off, at many places: one line each, whatever is missing.
  const std::string whole = read(root_ / "run/session.h5");
  for (const size_t permille : {0U, 10U, 300U, 700U, 999U}) {
    write("cut.h5", whole.substr(0, whole.size() * permille / 1000));
    expect_refused(run("session info cut.h5"), 2, {"cut.h5: "});
    expect_refused(run("session export cut.h5 --heights --csv"), 2, {"cut.h5: "});
  }
}

TEST_F(RecordProgram, TheImageHasNoTrainingDrive) {
  expect_refused(
      run("sim hard.ini --set experiment.algorithm=training_drive --hal mcu --elf /dev/null"), 2,
      {"algorithm = training_drive", "--hal mcu"});
}

TEST_F(RecordProgram, AnExportedMapIsTheSameTerrainAgain) {
  ASSERT_EQ(run("record soft.ini --no-pictures --frames 8 --out run").exit_code, 0);
  ASSERT_EQ(run("session export run --heights --count 1").exit_code, 0);
  const Json scale = Json::parse(read(root_ / "run/export/heights/scale.json"));
  const double height = scale["white_m"].get<double>() - scale["black_m"].get<double>();
  write("again.ini", "[map]\nfilename = run/export/heights/" +
                         scale["frames"][0]["file"].get<std::string>() +
                         "\nxy_scale = 0.01\nscale = " + std::to_string(height) +
                         "\nedges = wrap\n[experiment]\nframes = 8\n");
  const Result result = run("record again.ini --no-pictures --out again --json");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json again = Json::parse(result.out);
  const Json first = Json::parse(read(root_ / "run/summary.json"));
  EXPECT_NEAR(again["terrain_before"]["height_deviation_m"].get<double>(),
              first["terrain_before"]["height_deviation_m"].get<double>(), 1e-4);
}

}  // namespace
}  // namespace screed::testing
