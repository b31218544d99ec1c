// Experiment files: every key, every complaint, and text() as the way back.
#include "host_sim/run/experiment/experiment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "firmware/parameters/parameters.h"
#include "host_sim/core/errors.h"
#include "host_sim/run/simulation/simulation.h"
#include "tests/temp_folder.h"

namespace screed {
namespace {

class ExperimentFile : public ::testing::Test {
 protected:
  std::filesystem::path path() const { return folder_.path() / "test.ini"; }
  Experiment read(const std::string& text, const std::vector<std::string>& overrides = {}) {
    std::ofstream(path(), std::ios::binary) << text;
    return read_experiment(path(), overrides);
  }
  std::string error_message(const std::string& text,
                            const std::vector<std::string>& overrides = {}) {
    try {
      read(text, overrides);
    } catch (const InputError& error) {
      std::string what = error.what();
      EXPECT_EQ(what.find('\n'), std::string::npos) << what;
      const size_t at = what.find(path().string());
      if (at != std::string::npos) what.replace(at, path().string().size(), "FILE");
      return what;
    }
    return "";
  }
  static bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  }

 private:
  const TempFolder folder_;
};

/// A row of experiment_key_table().
struct Row {
  std::string section;
  std::string key;
  std::string unit;
  std::string value;
  std::string allowed;
};

std::vector<Row> rows() {
  std::vector<Row> all;
  std::istringstream table(experiment_key_table());
  for (std::string line; std::getline(table, line);) {
    std::vector<std::string> cells;
    std::istringstream cut(line.substr(2));
    for (size_t begin = 2; begin < line.size();) {
      const size_t end = line.find(" | ", begin - 1);
      if (end == std::string::npos) break;
      cells.push_back(end < begin ? "" : line.substr(begin, end - begin));
      begin = end + 3;
    }
    EXPECT_GE(cells.size(), 4U) << line;
    Row row;
    row.key = cells[0];
    if (row.key[0] == '[') {
      row.section = row.key.substr(1, row.key.find(']') - 1);
      row.key = row.key.substr(row.key.find(' ') + 1);
    }
    row.unit = cells[1];
    row.value = cells[2];
    row.allowed = cells[3];
    all.push_back(row);
  }
  return all;
}

/// The two ends of "a number A..B (unit)" or "an integer A..B".
std::vector<std::string> ends_of(const std::string& allowed) {
  const size_t dots = allowed.find("..");
  if (dots == std::string::npos) return {};
  const size_t begin = allowed.rfind(' ', dots) + 1;
  return {allowed.substr(begin, dots - begin), allowed.substr(dots + 2)};
}

std::string file_with(const Row& row, const std::string& value) {
  return (row.section.empty() ? "" : "[" + row.section + "]\n") + row.key + " = " + value + "\n";
}

/// The value of a key in a text.
std::string value_in(const std::string& text, const Row& row) {
  std::istringstream lines(text);
  std::string section;
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty() && line[0] == '[') section = line.substr(1, line.size() - 2);
    if (section == row.section && line.rfind(row.key + " = ", 0) == 0)
      return line.substr(row.key.size() + 3);
  }
  return "(none)";
}

/// Values that are allowed and differ from the default.
std::vector<std::string> good_values(const Row& row) {
  if (row.allowed == "true or false") return {row.value == "true" ? "false" : "true"};
  if (row.section == "robots" && row.key == "count") return {"2", "64"};  // 1 is not written
  if (row.section == "relief" && (row.key == "rms" || row.key == "trench_depth"))
    return {"0.1", "10"};  // 0 is not written
  if (row.key == "mounds") return {"1", "1000"};
  if (!ends_of(row.allowed).empty()) return ends_of(row.allowed);
  if (row.key == "algorithm")
    return {"drive", "spin_on_peak"};  // training_drive needs frames: below
  if (row.key == "model" && row.section == "map") return {"rigid", "scm"};
  if (row.key == "track_model") return {"chain"};
  if (row.key == "wheel_links") return {"a b c d", "a, b, c, d"};
  if (row.section == "radio" && row.key == "key") {
    return {"none", "0123456789abcdef0123456789ABCDEF 200"};
  }
  if (row.key == "preset") return {"clay", "ding_2011"};
  if (row.key == "placement") return {"ring", "random"};
  if (row.key == "places") return {"0 0 90, 1 0.5 -90"};
  if (row.key == "edges") return {"open", "walls", "wrap"};
  if (row.section == "trap") return {"wall", "ruts"};
  return {"Some-name_1"};
}

TEST_F(ExperimentFile, EveryKeyOfTheTableIsReadAndWrittenBack) {
  const std::vector<Row> all = rows();
  ASSERT_GT(all.size(), 40U);
  std::set<std::string> seen;
  for (const Row& row : all) {
    EXPECT_TRUE(seen.insert(row.section + "." + row.key).second)
        << row.key << " stands in the table twice";
    if (row.key == "units" || row.key == "chrono_data_path") continue;  // tests of their own
    for (const std::string& value : good_values(row)) {
      // Ordered pairs have a check of their own.
      std::vector<std::string> room;
      // Soil decides nothing on rigid ground, and is not written then.
      if (row.section == "soil") room = {"map.model=scm"};
      if (row.section == "particles" || row.section == "raygrid" || row.key == "particle_radius")
        room = {"map.model=particles"};
      if (row.key == "places") room = {"robots.count=2", "robots.placement=list"};
      if (row.key == "wall_friction") room = {"map.edges=walls"};
      if (row.section == "trap" && row.key != "kind") room = {"trap.kind=wall"};
      if (row.section == "relief") {
        // Each kind of relief is written only where there is any.
        const bool mound = row.key.rfind("mound_", 0) == 0 || row.key == "rms";
        const bool trench = row.key == "trench_width" || row.key == "trench_slope";
        room = {mound    ? "relief.mounds=2"
                : trench ? "relief.trench_depth=0.02"
                         : "relief.rms=0.02"};
        if (row.key == "longest_wave") room.push_back("relief.shortest_wave=0.01");
        if (row.key == "shortest_wave") room.push_back("relief.longest_wave=1000");
      }
      if (row.key == "walk_speed_min") room = {"parameters.walk_speed_max=250"};
      if (row.key == "walk_speed_max") room = {"parameters.walk_speed_min=0"};
      if (row.key == "walk_leg_min") room = {"parameters.walk_leg_max=20000"};
      if (row.key == "walk_leg_max") room = {"parameters.walk_leg_min=100"};
      if (row.section == "later")
        room.emplace_back(row.key == "at" ? "later.yaw_kp=1" : "later.at=1");
      Experiment experiment;
      ASSERT_NO_THROW(experiment = read(file_with(row, value), room))
          << row.section << " " << row.key << " = " << value;
      const std::string text = experiment.text();
      EXPECT_EQ(value_in(text, row), value) << row.section << " " << row.key;
      EXPECT_EQ(read(text).text(), text) << row.key;
    }
  }
}

TEST_F(ExperimentFile, ValuesBeyondTheirEndsAreRefused) {
  for (const Row& row : rows()) {
    const std::vector<std::string> ends = ends_of(row.allowed);
    std::vector<std::string> bad = {""};
    if (!ends.empty()) {
      bad.insert(bad.end(), {"x", "1x", "nan", "inf", "1e999", "--1", "1 2", "0x10"});
      const bool whole = row.allowed.rfind("an integer", 0) == 0 || row.key == "frames";
      const double step = whole ? 1.0 : 1e-3;
      const auto beyond = [&](double value) {
        std::ostringstream text;
        text.precision(12);
        text << value;
        return text.str();
      };
      const auto past = [&](const std::string& end) {
        return std::max(step, std::abs(std::stod(end)) * 1e-6);
      };
      if (row.key != "seed") bad.push_back(beyond(std::stod(ends[1]) + past(ends[1])));
      bad.push_back(beyond(std::stod(ends[0]) - past(ends[0])));
    }
    if (row.key == "seed") bad.insert(bad.end(), {"18446744073709551616", "-1", "1.5"});
    if (row.allowed == "true or false") bad.insert(bad.end(), {"1", "True", "yes"});
    if (row.key == "frames") bad.insert(bad.end(), {"12", "80.0"});
    if (row.allowed.rfind("an integer", 0) == 0) bad.insert(bad.end(), {"1.5", "99999"});
    if (row.key == "seed") bad.erase(std::find(bad.begin(), bad.end(), "99999"));
    if (row.key == "algorithm") bad.insert(bad.end(), {"1", "Random", "Drive"});
    if (row.key == "wheel_links") bad.insert(bad.end(), {"a b c", "a b c d e", ",,,"});
    if (row.key == "name") bad.insert(bad.end(), {"a/b", "..", "a b", std::string(65, 'a')});
    for (const std::string& value : bad) {
      const std::string message = error_message(file_with(row, value));
      const std::string line = row.section.empty() ? "1" : "2";
      EXPECT_EQ(message.rfind("FILE:" + line + ": ", 0), 0U)
          << row.key << " = '" << value << "': " << message;
      EXPECT_TRUE(contains(message, row.key)) << message;
      EXPECT_TRUE(contains(message, "'" + value + "'")) << message;
      EXPECT_TRUE(contains(message, row.allowed)) << message;
    }
  }
}

TEST_F(ExperimentFile, ASectionForAnotherGroundIsNotedOnce) {
  const Experiment rigid = read("[soil]\nE = 1e6\nn = 1\n[map]\nparticle_radius = 0.02\n");
  ASSERT_EQ(rigid.notes.size(), 2U);
  EXPECT_TRUE(contains(rigid.notes[0],
                       ":5: [map] particle_radius decides nothing with [map] model = rigid"))
      << rigid.notes[0];
  EXPECT_TRUE(contains(rigid.notes[1], ": [soil] decides nothing with [map] model = rigid"))
      << rigid.notes[1];
  EXPECT_TRUE(read("[map]\nmodel = scm\n[soil]\nE = 1e6\n").notes.empty());
}

TEST_F(ExperimentFile, ErrorsOfTheWorldGetThePlaceOfTheKeyThatTheyName) {
  const Experiment experiment = read("[map]\nsize = 2\n\n[vehicle]\nx = 1\n");
  const auto placed = [&](const char* what) {
    std::string text = with_place(experiment, InputError(what)).what();
    const size_t at = text.find(path().string());
    if (at != std::string::npos) text.replace(at, path().string().size(), "FILE");
    return text;
  };
  EXPECT_EQ(placed("[vehicle] x = 1 is in a wall"), "FILE:5: [vehicle] x = 1 is in a wall");
  EXPECT_EQ(placed("a wall ([vehicle] y, [map] size)"), "FILE:2: a wall ([vehicle] y, [map] size)");
  EXPECT_EQ(placed("[vehicle] y = 1 is in a wall"), "FILE: [vehicle] y = 1 is in a wall");
  EXPECT_EQ(placed("out: the folder is not empty"), "out: the folder is not empty");
  // Said once, however often it passes by.
  EXPECT_STREQ(with_place(experiment, with_place(experiment, InputError("[vehicle] x"))).what(),
               with_place(experiment, InputError("[vehicle] x")).what());
}

TEST_F(ExperimentFile, UnknownNamesSayWhatIsKnown) {
  EXPECT_EQ(error_message("[drive]\nsped = 1\n"),
            "FILE:2: unknown key 'sped' in [drive]; known are speed, yaw_rate");
  EXPECT_EQ(
      error_message("tracks = true\n"),
      "FILE:1: unknown key 'tracks' before the first section; did you mean [vehicle] tracks; known "
      "are output_directory_prefix, units, chrono_data_path");
  EXPECT_TRUE(contains(error_message("", {"algorithm=drive"}),
                       "--set: unknown key 'algorithm' before the first section; did you mean "
                       "experiment.algorithm;"))
      << error_message("", {"algorithm=drive"});
  const std::string section = error_message("\n\n[vehicel]\nx = 1\n");
  EXPECT_EQ(
      section.rfind("FILE:4: unknown section [vehicel]; known are [vehicle], [robots], [map], ", 0),
      0U)
      << section;
  EXPECT_TRUE(contains(section, "[parameters]")) << section;
  EXPECT_TRUE(contains(error_message("[Map]\nsize = 1\n"), "unknown section [Map]"));
  EXPECT_TRUE(contains(error_message("[map]\nSize = 1\n"), "unknown key 'Size'"));
  EXPECT_TRUE(contains(error_message("[parameters]\nalgorithm = 1\n"), "unknown key 'algorithm'"));
}

TEST_F(ExperimentFile, MistakesOfTheFileItselfComeThrough) {
  EXPECT_EQ(error_message("[map]\nsize = 1\nsize = 2\n"),
            "FILE:3: key 'size' is given twice in [map], first in line 2");
  EXPECT_EQ(error_message("[map]\nsize\n").rfind("FILE:2: ", 0), 0U);
}

TEST_F(ExperimentFile, OverridesWinAndTheLastOfThemMost) {
  const Experiment experiment =
      read("[map]\nsize = 4\n", {"map.size=5", "map.size=6", "experiment.seed=7"});
  EXPECT_EQ(experiment.map.size_m, 6.0);
  EXPECT_EQ(experiment.experiment.seed, 7U);
  EXPECT_EQ(error_message("", {"map.size=0"}),
            "--set: [map] size = '0' is not allowed; expected a number 0.1..1000 (m)");
  EXPECT_TRUE(contains(error_message("", {"map.sise=0"}), "--set: unknown key 'sise' in [map]"));
  EXPECT_TRUE(contains(error_message("", {"size=3"}), "before the first section"));
  EXPECT_TRUE(contains(error_message("", {"map.size"}), "section.key=value"));
}

TEST_F(ExperimentFile, KeysThatDoNotFitTogether) {
  EXPECT_TRUE(contains(error_message("[parameters]\nwalk_speed_min = 200\nwalk_speed_max = 100\n"),
                       "walk_speed_min = 200"));
  EXPECT_TRUE(
      contains(error_message("[parameters]\nwalk_leg_min = 5000\n"), "walk_leg_min = 5000"));
  EXPECT_TRUE(contains(error_message("[map]\nfilename = a.png\nramp = 5\n"),
                       "FILE:2: [map] filename = 'a.png' and ramp are both given"));
}

TEST_F(ExperimentFile, LaterSetsLiveParametersAtATime) {
  const Experiment experiment = read("[later]\nat = 12.5\nstall_time = 400\nclimb_speed = 90\n");
  const ParameterChanges changes = experiment.later.changes();
  EXPECT_EQ(changes.at_s, 12.5);
  ASSERT_EQ(changes.values.size(), 2U);
  EXPECT_EQ(changes.values[0].number, Parameters::k_climb_speed);
  EXPECT_EQ(changes.values[0].value, 90);
  EXPECT_EQ(changes.values[1].number, Parameters::k_stall_time);
  EXPECT_EQ(changes.values[1].value, 400);
  EXPECT_EQ(experiment.parameters.climb_speed(), Parameters().climb_speed());
  EXPECT_TRUE(contains(error_message("[later]\nat = 1\n"), "FILE:2: [later] at: no parameter"));
  EXPECT_TRUE(contains(error_message("[later]\nyaw_kp = 1\n"), "FILE:2: [later] yaw_kp: when"));
  EXPECT_TRUE(contains(error_message("[later]\nat = 1\nstroke_time = 500\n"),
                       "FILE:3: unknown key 'stroke_time' in [later]; did you mean [parameters]"));
  EXPECT_TRUE(contains(error_message("[later]\nat = 1\nwalk_speed_max = 50\n"),
                       "[later] walk_speed_min = 60 is above [later] walk_speed_max = 50"));
  EXPECT_TRUE(contains(error_message("[robots]\ncount = 2\n[robot_1]\nwalk_speed_min = 120\n"
                                     "[later]\nat = 1\nwalk_speed_max = 100\n"),
                       "[later] walk_speed_min = 120 is above [later] walk_speed_max = 100"));
}

TEST_F(ExperimentFile, TheAlgorithmReachesTheParameters) {
  EXPECT_EQ(read("[experiment]\nalgorithm = drive\n").parameters.algorithm(), 0);
  EXPECT_EQ(read("").parameters.algorithm(), 1);
  EXPECT_EQ(read("[experiment]\nalgorithm = spin_on_peak\n").parameters.algorithm(), 2);
  EXPECT_EQ(algorithm_number("hill_sensing"), 1);
  EXPECT_EQ(algorithm_number(kTrainingDriveName), 3);
  EXPECT_THROW(algorithm_number("Random"), InputError);
}

TEST_F(ExperimentFile, TheTrainingDriveTakesItsLengthFromFramesOrDuration) {
  const Experiment frames = read("[experiment]\nalgorithm = training_drive\nframes = 64000\n");
  EXPECT_EQ(frames.parameters.algorithm(), 3);
  EXPECT_EQ(frames.parameters.training_block(), 8000);
  EXPECT_EQ(frames.experiment.duration_s, 640.0);
  const Experiment duration = read("[experiment]\nalgorithm = training_drive\nduration = 20.05\n");
  EXPECT_EQ(duration.experiment.frames, 2000U);
  EXPECT_EQ(duration.parameters.training_block(), 250);
  EXPECT_EQ(read("[experiment]\nframes = 800\n").experiment.duration_s, 8.0);
  EXPECT_TRUE(contains(error_message("[experiment]\nalgorithm = training_drive\nduration = 1e5\n"),
                       "duration = 1e+05 s: algorithm training_drive needs 0.08 s to"));
}

TEST_F(ExperimentFile, OfTwoKeysForTheSameTheLaterOneHolds) {
  EXPECT_FALSE(read("[experiment]\nframes = 800\nduration = 3\n").experiment.frames.has_value());
  EXPECT_EQ(read("[experiment]\nduration = 3\n", {"experiment.frames=80"}).experiment.duration_s,
            0.8);
  EXPECT_FALSE(read("[map]\nxy_scale = 0.01\nsize = 3\n").map.xy_scale.has_value());
  const std::string text = read("[map]\nsize = 3\nxy_scale = 0.01\n").text();
  EXPECT_TRUE(contains(text, "\nxy_scale = 0.01\n")) << text;
  EXPECT_FALSE(contains(text, "\nsize = ")) << text;
}

TEST_F(ExperimentFile, AFileOfSandboxIsReadInItsUnitsAndAxes) {
  // Units of 1/12 m, x east, y up, z south; terrain without edges.
  const char* text =
      "[vehicle]\nx = -20\ny = 8\nz = -18\n[map]\nscale = 5\nxy_scale = 0.12\n[drive]\nspeed = "
      "0.2\n";
  for (const char* first : {"chrono_data_path = ../data/\n", "units = sandbox\n",
                            "units = sandbox\nchrono_data_path = ../data/\n"}) {
    const Experiment e = read(std::string(first) + text);
    EXPECT_NEAR(e.vehicle.x_m, -20.0 / 12.0, 1e-12);
    EXPECT_NEAR(e.vehicle.y_m, 1.5, 1e-12);
    EXPECT_NEAR(e.vehicle.z_m.value(), 8.0 / 12.0, 1e-12);
    EXPECT_NEAR(e.map.scale_m, 5.0 / 12.0, 1e-12);
    EXPECT_NEAR(e.map.xy_scale.value(), 0.01, 1e-12);
    EXPECT_TRUE(e.map.wrap());
    EXPECT_EQ(e.drive.speed_m_per_s, 0.2);  // a section that Sandbox does not have
    // What is written back is in SI units, and says the same.
    const Experiment again = read(e.text());
    EXPECT_EQ(again.text(), e.text());
    EXPECT_EQ(again.vehicle.x_m, e.vehicle.x_m);
    EXPECT_TRUE(again.map.wrap());
  }
  const Experiment si = read("units = si\nchrono_data_path = ../data/\n[vehicle]\nx = -20\n");
  EXPECT_EQ(si.vehicle.x_m, -20.0);
  EXPECT_FALSE(si.map.wrap());
  EXPECT_EQ(si.notes.size(), 1U);
  EXPECT_EQ(read("units = sandbox\n[vehicle]\nx = -20\n", {"vehicle.x=1"}).vehicle.x_m, 1.0);
  const std::string wrong = error_message("chrono_data_path = ../data/\n[vehicle]\nx = east\n");
  EXPECT_TRUE(contains(wrong, "FILE:3: [vehicle] x = 'east'")) << wrong;
}

TEST_F(ExperimentFile, EdgesAreOpenWalledOrWrappedOnEveryTerrain) {
  const std::string small = "[map]\nsize = 1\n[soil]\ncell = 0.05\n";
  for (const char* model : {"rigid", "scm", "particles"}) {
    const std::string of = std::string("map.model=") + model;
    for (const auto& [text, edge] : {std::pair{"walls", BedEdge::kWalled},
                                     {"wrap", BedEdge::kWrapped},
                                     {"open", BedEdge::kOpen}}) {
      const std::string edges = std::string("map.edges=") + text;
      if (model == std::string("particles") && edge == BedEdge::kOpen) continue;
      const Experiment e = read(small, {of, edges});
      const HeightField bed = make_terrain(e);
      EXPECT_EQ(bed.edge(), edge) << model << " " << text;
      EXPECT_NEAR(bed.x_max() - bed.x_min(), 1.0, 1e-9) << model << " " << text;
      EXPECT_EQ(read(e.text()).map.edge(), edge);
    }
    const bool particles = model == std::string("particles");
    const Experiment unsaid = read(small, {of});
    EXPECT_EQ(make_terrain(unsaid).edge(), particles ? BedEdge::kWalled : BedEdge::kOpen);
    EXPECT_EQ(contains(unsaid.text(), "wall_friction"), particles) << "it decides nothing";
  }
}

TEST_F(ExperimentFile, EdgesThatCannotBeAreRefused) {
  const std::string particles = error_message("[map]\nmodel = particles\nedges = open\n");
  EXPECT_TRUE(contains(particles, "[map] edges = open: particles would roll off")) << particles;
  EXPECT_TRUE(contains(particles, "walls or wrap")) << particles;
  const std::string ramp = error_message("[map]\nramp = 5\nedges = wrap\n");
  EXPECT_TRUE(contains(ramp, "FILE:3: [map] edges = wrap and ramp are both given")) << ramp;
  const std::string other = error_message("[map]\nedges = fence\n");
  EXPECT_TRUE(contains(other, "FILE:2: [map] edges = 'fence' is not allowed")) << other;
  EXPECT_TRUE(contains(other, "open, walls or wrap")) << other;
}

TEST_F(ExperimentFile, TheKeyWrapSaysWhatStandsInItsPlace) {
  const std::string old = error_message("[map]\nwrap = true\n");
  EXPECT_TRUE(contains(old, "FILE:2: [map] wrap is now edges: for wrap = true write edges = wrap"))
      << old;
}

// The file as it is printed, spaces at the ends of its lines and all. Its bed is the large one of
// Table 5.2: 72 x 72 units of 1/12 m.
TEST_F(ExperimentFile, Figure53IsAcceptedAsPrinted) {
  const Experiment e = read_experiment("host_sim/data/experiments/figure_5_3.ini");
  EXPECT_EQ(e.output_directory_prefix, "./tracked_noplow_static/");
  EXPECT_TRUE(e.vehicle.tracks);
  EXPECT_EQ(find_model_file(e).filename(), "rover5.urdf");
  EXPECT_NEAR(e.vehicle.x_m, -20.0 / 12.0, 1e-12);
  EXPECT_NEAR(e.vehicle.y_m, 20.0 / 12.0, 1e-12);
  EXPECT_NEAR(e.vehicle.z_m.value(), 8.0 / 12.0, 1e-12);
  EXPECT_EQ(e.vehicle.heading_deg, 0.0);
  EXPECT_EQ(e.map.filename, "terrain_large.bmp");
  EXPECT_NEAR(e.map.scale_m, 5.0 / 12.0, 1e-12);
  EXPECT_NEAR(e.map.particle_radius_m, 0.0125, 1e-12);
  EXPECT_EQ(e.map.xy_scale, 0.4);
  EXPECT_EQ(e.map.model, "particles");
  EXPECT_EQ(e.particles.depth_m, 0.0);
  EXPECT_TRUE(e.map.wrap());
  EXPECT_NEAR(e.raygrid.resolution_per_m, 24.0, 1e-12);
  EXPECT_EQ(e.experiment.name, "sparse_random");
  EXPECT_EQ(e.parameters.algorithm(), 3);
  const HeightField bed = make_terrain(e);
  EXPECT_NEAR(bed.x_max() - bed.x_min(), 6.0, 1e-9);
  EXPECT_TRUE(bed.inside(e.vehicle.x_m, e.vehicle.y_m));
}

TEST_F(ExperimentFile, ThePathOfChronosDataIsNotedAndNotUsed) {
  const Experiment experiment = read("; a comment\nchrono_data_path = ../data/\n");
  ASSERT_EQ(experiment.notes.size(), 1U);
  EXPECT_TRUE(contains(experiment.notes[0], ":2: chrono_data_path is not used"));
  EXPECT_TRUE(contains(experiment.notes[0], "1/12 m"));
  EXPECT_EQ(experiment.notes[0].find('\n'), std::string::npos);
}

TEST_F(ExperimentFile, EveryParameterOfTheFirmwareHasAKeyOfItsOwn) {
  for (const ParameterInfo& info : kParameterTable) {
    // Said in [experiment].
    if (std::string(info.name) == "algorithm") continue;
    const std::string name = info.name;
    const int16_t value = name == "walk_speed_min" || name == "walk_leg_min" ? info.min : info.max;
    const Experiment experiment =
        read("[parameters]\n" + name + " = " + std::to_string(value) + "\n");
    for (const ParameterInfo& other : kParameterTable) {
      const int16_t expected = other.number == info.number ? value : other.default_value;
      EXPECT_EQ(experiment.parameters.values[other.number], expected) << name << ": " << other.name;
    }
  }
}

TEST_F(ExperimentFile, TextOfTheDefaultsGivesTheDefaults) {
  const std::string text = Experiment{}.text();
  EXPECT_EQ(read(text).text(), text);
  EXPECT_EQ(read("").text(), text);
  EXPECT_FALSE(contains(text, "max_slope"));  // optional and not set
  // What decides nothing is not written with its default, which the table has all the same.
  EXPECT_FALSE(contains(text, "[metrics]"));
  EXPECT_TRUE(contains(experiment_key_table(), "| [metrics] interval | s | 30 |"));
}

TEST_F(ExperimentFile, NumbersComeBackToTheBit) {
  const Experiment experiment =
      read("[vehicle]\nx = 0.1\ny = -1.2345678901234567e-7\nz = 1e-300\n");
  const Experiment again = read(experiment.text());
  EXPECT_EQ(again.vehicle.x_m, 0.1);
  EXPECT_EQ(again.vehicle.y_m, -1.2345678901234567e-7);
  EXPECT_EQ(again.vehicle.z_m, 1e-300);
}

TEST_F(ExperimentFile, DataFilesAreLookedForBesideTheExperimentFirst) {
  const Experiment experiment = read("");
  const std::filesystem::path own = path();
  EXPECT_EQ(find_data_file(experiment, own.filename().string(), "key"), own);
  EXPECT_EQ(find_data_file(experiment, own.string(), "key"), own);
  EXPECT_TRUE(
      std::filesystem::exists(find_data_file(experiment, "jacksboro_fault_dem_16bit.png", "key")));
  EXPECT_TRUE(std::filesystem::exists(find_model_file(experiment)));
  try {
    find_data_file(experiment, "no_such.png", "[map] filename");
    FAIL();
  } catch (const InputError& error) {
    const std::string what = error.what();
    EXPECT_TRUE(
        contains(what, "test.ini: [map] filename = 'no_such.png': no such file; looked for "))
        << what;
    EXPECT_TRUE(contains(what, "terrain/no_such.png")) << what;
  }
}

TEST_F(ExperimentFile, TheExperimentsThatComeWithTheProjectAreRight) {
  int count = 0;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator("host_sim/data/experiments")) {
    if (entry.path().extension() != ".ini") continue;
    EXPECT_NO_THROW(read_experiment(entry.path())) << entry.path();
    ++count;
  }
  EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace screed
