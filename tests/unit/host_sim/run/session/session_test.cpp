// Session files: what is written comes back, also through programs we did not write.
#include <sys/wait.h>
#include <unistd.h>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <sstream>

#include "firmware/parameters/parameters.h"
#include "host_sim/run/session/session_turns.h"
#include "tests/unit/host_sim/run/session/session_fixture.h"

namespace screed {
namespace {

TEST(Record, RowsAreLittleEndianWithoutPadding) {
  SensorSample sample{};
  sample.time_us = 0x04030201;
  sample.imu.gyro()[0] = -2;
  sample.pressure = -1;
  sample.encoder_errors = 0xAB;
  sample.chips_failing = 1;
  sample.bus_errors = 2;
  sample.radio_errors = 3;
  sample.reset_cause = 4;
  sample.radio_in_count = 2;
  std::fill(std::begin(sample.radio_in), std::end(sample.radio_in), std::uint8_t{0x55});
  const auto row = packed<kSampleBytes>(sample);
  ASSERT_EQ(kSampleBytes, 4U + 3 * 6 + 4 + 5 * 2 + 7 + 64);
  EXPECT_EQ(std::vector<std::uint8_t>(row.begin(), row.begin() + 6),
            (std::vector<std::uint8_t>{1, 2, 3, 4, 0xFE, 0xFF}));
  EXPECT_EQ(std::vector<std::uint8_t>(row.begin() + 22, row.begin() + 26),
            std::vector<std::uint8_t>(4, 0xFF));
  // encoder_errors, fresh, failing chips, bus errors, radio errors, reset cause, radio_in_count,
  // two valid bytes, nothing behind them
  EXPECT_EQ(std::vector<std::uint8_t>(row.begin() + 36, row.begin() + 46),
            (std::vector<std::uint8_t>{0xAB, 0, 1, 2, 3, 4, 2, 0x55, 0x55, 0}));

  SimFrame frame;
  frame.time = 1.0;
  frame.beds_y = 0x01020304;
  const auto frame_row = packed<kFrameBytes>(frame);
  EXPECT_EQ(std::vector<std::uint8_t>(frame_row.begin(), frame_row.begin() + 8),
            (std::vector<std::uint8_t>{0, 0, 0, 0, 0, 0, 0xF0, 0x3F}));
  EXPECT_EQ(std::vector<std::uint8_t>(frame_row.end() - 4, frame_row.end()),
            (std::vector<std::uint8_t>{4, 3, 2, 1}));
}

TEST(Record, DifferencesAreNamed) {
  RobotOutput a{};
  a.duty_left = -12;
  a.radio_out_count = 2;
  RobotOutput b = a;
  b.radio_out[2] = 99;  // not valid
  EXPECT_FALSE(first_difference(kOutputColumns, packed<kOutputBytes>(a), packed<kOutputBytes>(b)));
  b.radio_out[1] = 99;
  EXPECT_EQ(first_difference(kOutputColumns, packed<kOutputBytes>(a), packed<kOutputBytes>(b)),
            "radio_out[1]: expected 0, got 99");
  b.duty_left = 300;
  EXPECT_EQ(first_difference(kOutputColumns, packed<kOutputBytes>(a), packed<kOutputBytes>(b)),
            "duty_left: expected -12, got 300");
}

TEST_F(SessionTest, EverythingComesBack) {
  const Recording run = random_run(2 * SessionWriter::kBlockRows + 452);
  const std::string hash = write_run(file_, run);
  const SessionReader reader(file_);
  EXPECT_TRUE(reader.complete());
  EXPECT_EQ(reader.content_hash(), hash);
  EXPECT_EQ(reader.compute_content_hash(), hash);
  EXPECT_EQ(reader.frames(), run.frames.size());
  EXPECT_TRUE(reader.missing_columns().empty());
  EXPECT_TRUE(reader.missing_parameters().empty());
  expect_rows<kFrameBytes>(reader, run.frames);
  expect_rows<kSampleBytes>(reader, run.samples);
  expect_rows<kOutputBytes>(reader, run.outputs);

  const SessionInfo& info = reader.info();
  EXPECT_EQ(info.program_version, run.info.program_version);
  EXPECT_EQ(info.arithmetic, run.info.arithmetic);
  EXPECT_EQ(info.experiment_name, run.info.experiment_name);
  EXPECT_EQ(info.experiment_text, run.info.experiment_text);
  EXPECT_EQ(info.seed, run.info.seed);
  EXPECT_EQ(info.tick_rate_hz, 100U);
  EXPECT_EQ(info.board_name, run.info.board_name);
  EXPECT_EQ(info.board.count_um_q4, 9048);
  EXPECT_EQ(info.board.full_speed_mm_per_s, 250);
  for (const ParameterInfo& parameter : kParameterTable) {
    EXPECT_EQ(info.parameters.values[parameter.number],
              run.info.parameters.values[parameter.number])
        << parameter.name;
  }

  for (const bool after : {false, true}) {
    const auto map = after ? reader.terrain_after() : reader.terrain_before();
    const HeightMap& expected = after ? run.after : run.before;
    ASSERT_TRUE(map);
    EXPECT_EQ(map->heights, expected.heights);
    EXPECT_EQ(map->geometry.nx, 3U);
    EXPECT_EQ(map->geometry.ny, 2U);
    EXPECT_EQ(map->geometry.unit_m, 1e-6);
    EXPECT_EQ(map->geometry.spacing_m, 0.0125);
    EXPECT_EQ(map->geometry.origin_x_m, -1.5);
    EXPECT_EQ(map->geometry.origin_y_m, 2.5);
    EXPECT_TRUE(map->geometry.wrap);
    EXPECT_FALSE(map->geometry.walls);
  }
}

TEST_F(SessionTest, WallsOfTheBedAreKept) {
  Recording run = random_run(3);
  run.before.geometry.wrap = run.after.geometry.wrap = false;
  run.before.geometry.walls = true;
  write_run(file_, run);
  const SessionReader reader(file_);
  EXPECT_TRUE(reader.terrain_before()->geometry.walls);
  EXPECT_FALSE(reader.terrain_after()->geometry.walls) << "as before there were any";
  EXPECT_EQ(reader.compute_content_hash(), reader.content_hash());
}

TEST_F(SessionTest, AnyRangeOfRowsCanBeRead) {
  const Recording run = random_run(1500);
  write_run(file_, run);
  const SessionReader reader(file_);
  std::vector<SimFrame> rows(100);
  reader.read(1000, std::span(rows));  // across a block
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(packed<kFrameBytes>(rows[i]), packed<kFrameBytes>(run.frames[1000 + i]));
  }
  EXPECT_THROW(reader.read(1401, std::span(rows)), std::out_of_range);
  EXPECT_THROW(reader.read(std::numeric_limits<std::uint64_t>::max(), std::span(rows)),
               std::out_of_range);
  rows.clear();
  reader.read(1500, std::span(rows));
}

TEST_F(SessionTest, ARunMayBeEmptyAndWithoutTerrain) {
  const Recording run = random_run(0);
  const std::string hash = SessionWriter(file_, run.info).finish();
  const SessionReader reader(file_);
  EXPECT_TRUE(reader.complete());
  EXPECT_EQ(reader.frames(), 0U);
  EXPECT_FALSE(reader.terrain_before());
  EXPECT_FALSE(reader.terrain_after());
  EXPECT_EQ(reader.compute_content_hash(), hash);
}

// The writer changes the file all the while; whenever it is opened, whole blocks are in it.
TEST_F(SessionTest, ASessionCanBeReadWhileItIsWritten) {
  constexpr std::size_t kBlock = 1024;
  constexpr std::size_t kBlocks = 40;
  const Recording run = random_run(kBlock);
  const pid_t child = fork();
  if (child == 0) {
    try {
      SessionWriter writer(file_, run.info);
      writer.write_terrain_before(run.before.view());
      for (std::size_t i = 0; i < kBlocks * kBlock; ++i)
        writer.append(run.frames[i % kBlock], run.samples[i % kBlock], run.outputs[i % kBlock]);
      writer.write_terrain_after(run.after.view());
      writer.finish();
    } catch (...) {
      _exit(1);
    }
    _exit(0);
  }
  std::size_t reads = 0;
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    if (!is_being_written(file_)) continue;
    try {
      const SessionReader reader(file_);
      if (!reader.running()) continue;  // it has just ended
      EXPECT_FALSE(reader.complete());
      EXPECT_EQ(reader.frames() % kBlock, 0U);
      if (reader.frames() == 0) continue;
      std::vector<SimFrame> last(1);
      reader.read(reader.frames() - 1, std::span(last));
      EXPECT_EQ(packed<kFrameBytes>(last[0]), packed<kFrameBytes>(run.frames.back()));
      ++reads;
    } catch (const InputError& error) {
      expect_line(error.what(), file_, "only just begun");
    }
  }
  ASSERT_EQ(status, 0);
  EXPECT_GT(reads, 0U);
  const SessionReader reader(file_);
  EXPECT_FALSE(reader.running());
  EXPECT_TRUE(reader.complete());
  EXPECT_EQ(reader.frames(), kBlocks * kBlock);
}

TEST_F(SessionTest, AnExperimentTextMayBeLong) {
  Recording run = random_run(1);
  run.info.experiment_text.assign(300000, 'x');
  write_run(file_, run);
  EXPECT_EQ(SessionReader(file_).info().experiment_text, run.info.experiment_text);
}

TEST_F(SessionTest, AnExperimentTextWithNulIsRefused) {
  Recording run = random_run(1);
  run.info.experiment_text += '\0';
  EXPECT_THROW(write_run(file_, run), InputError);
  EXPECT_FALSE(fs::exists(file_));
}

TEST_F(SessionTest, AHeightMapMustFitItsSize) {
  SessionWriter writer(file_, random_run(0).info);
  HeightMap map = random_run(0).before;
  map.heights.pop_back();
  EXPECT_THROW(writer.write_terrain_before(map.view()), std::invalid_argument);
}

TEST_F(SessionTest, EqualRunsGiveEqualFiles) {
  const Recording run = random_run(1100);
  write_run(file_, run);
  write_run(base_ / "again.h5", run);
  EXPECT_TRUE(read_text(file_) == read_text(base_ / "again.h5"));
}

TEST_F(SessionTest, NoTimeOfDayIsStored) {
  write_run(file_, random_run(1));
  edit([](hid_t file) {
    for (const char* name : {"/", "/frames", "/samples", "/outputs", "/parameters", "/board",
                             "/terrain", "/terrain/before", "/terrain/after"}) {
      H5O_info_t info{};
      ASSERT_GE(H5Oget_info_by_name2(file, name, &info, H5O_INFO_TIME, H5P_DEFAULT), 0) << name;
      EXPECT_EQ(info.mtime, 0) << name;
      EXPECT_EQ(info.btime, 0) << name;
    }
  });
}

TEST_F(SessionTest, ALargeTerrainComesBack) {
  Recording run = random_run(1);
  run.before.geometry.nx = 300;
  run.before.geometry.ny = 131;
  run.before.heights.resize(std::size_t{300} * 131);
  Noise noise(5);
  for (std::int32_t& height : run.before.heights) height = static_cast<std::int32_t>(noise.next());
  write_run(file_, run);
  const auto map = SessionReader(file_).terrain_before();
  ASSERT_TRUE(map);
  EXPECT_EQ(map->geometry.nx, 300U);
  EXPECT_TRUE(map->heights == run.before.heights);
}

/// The numbers between "DATA {" and the attributes of what h5dump printed.
std::vector<double> dumped_numbers(const std::string& dump) {
  const std::size_t start = dump.find("DATA {") + 6;
  std::string data = dump.substr(start, dump.find("ATTRIBUTE", start) - start);
  std::replace_if(
      data.begin(), data.end(),
      [](char c) { return std::string(",{}[]\"").find(c) != std::string::npos; }, ' ');
  std::istringstream in(data);
  std::vector<double> numbers;
  for (std::string word; in >> word;) numbers.push_back(std::strtod(word.c_str(), nullptr));
  return numbers;
}

TEST_F(SessionTest, H5dumpReadsTheSameNumbers) {
  Recording run = random_run(3);
  for (SimFrame& frame : run.frames) {
    double value = 1.0 / 3 + static_cast<double>(&frame - run.frames.data());
#define SCREED_SET(type, name, unit, meaning) frame.name = static_cast<type>(value *= -1.5);
    SCREED_FRAME_COLUMNS(SCREED_SET)
#undef SCREED_SET
  }
  const std::string hash = write_run(file_, run);

  std::vector<double> expected;
  for (const SimFrame& frame : run.frames) {
#define SCREED_GET(type, name, unit, meaning) expected.push_back(frame.name);
    SCREED_FRAME_COLUMNS(SCREED_GET)
#undef SCREED_GET
  }
  const std::string dump = "h5dump -y -w 0 -m %.17g -d ";
  EXPECT_EQ(dumped_numbers(output_of(dump + "/frames " + file_.string())), expected);

  expected.clear();
  for (const SensorSample& s : run.samples) {
    expected.insert(expected.end(), {static_cast<double>(s.time_us)});
    for (const auto* axes : {s.imu.gyro(), s.imu.accel(), s.imu.mag()})
      expected.insert(expected.end(), axes, axes + 3);
    expected.insert(expected.end(),
                    {static_cast<double>(s.pressure), static_cast<double>(s.temperature),
                     static_cast<double>(s.encoder_left), static_cast<double>(s.encoder_right),
                     static_cast<double>(s.battery), static_cast<double>(s.last_tick_us),
                     static_cast<double>(s.encoder_errors), static_cast<double>(s.fresh),
                     static_cast<double>(s.chips_failing), static_cast<double>(s.bus_errors),
                     static_cast<double>(s.radio_errors), static_cast<double>(s.reset_cause),
                     static_cast<double>(s.radio_in_count)});
    for (int i = 0; i < kRadioInCapacity; ++i) {
      expected.push_back(i < s.radio_in_count ? s.radio_in[i] : 0);
    }
  }
  EXPECT_EQ(dumped_numbers(output_of(dump + "/samples " + file_.string())), expected);

  expected.clear();
  for (const RobotOutput& o : run.outputs) {
    expected.insert(expected.end(),
                    {static_cast<double>(o.duty_left), static_cast<double>(o.duty_right),
                     static_cast<double>(o.leds), static_cast<double>(o.store_parameter),
                     static_cast<double>(o.store_value), static_cast<double>(o.radio_out_count)});
    for (int i = 0; i < kRadioOutCapacity; ++i) {
      expected.push_back(i < o.radio_out_count ? o.radio_out[i] : 0);
    }
  }
  EXPECT_EQ(dumped_numbers(output_of(dump + "/outputs " + file_.string())), expected);

  const std::string terrain = output_of("h5dump -y -w 0 -d /terrain/after " + file_.string());
  EXPECT_NE(terrain.find("( 2, 3 )"), std::string::npos) << terrain;
  EXPECT_NE(terrain.find("1, 77, 3,"), std::string::npos) << terrain;

  for (const auto& [attribute, text] : std::vector<std::pair<std::string, std::string>>{
           {"/format", "\"screed-session\""},
           {"/format_version", " 1\n"},
           {"/seed", " 18364758544493064720\n"},
           {"/frames", " 3\n"},
           {"/content_hash", '"' + hash + '"'},
           {"/board_name", "\"a_star_32u4\""},
           {"/parameters/climb_speed", " 123\n"},
           {"/parameters/climb_speed.unit", "\"mm/s\""},
           {"/board/tread_mm", " 195\n"},
           {"/terrain/before/spacing_m", " 0.0125\n"},
           {"/frames/units", "\"s\", \"m\", \"m\""}}) {
    const std::string printed = output_of("h5dump -y -a " + attribute + " " + file_.string());
    EXPECT_NE(printed.find(text), std::string::npos) << attribute << "\n" << printed;
  }
  const std::string listing = output_of("h5ls -r " + file_.string());
  EXPECT_NE(listing.find("/outputs                 Dataset {3/Inf}"), std::string::npos) << listing;
}

TEST_F(SessionTest, TheLevelingCurveComesBackAndIsNotHashed) {
  const Recording run = random_run(200);
  const std::string without = write_run(base_ / "without.h5", run);
  EXPECT_TRUE(SessionReader(base_ / "without.h5").leveling().empty());

  SessionWriter writer(file_, run.info);
  writer.write_terrain_before(run.before.view());
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    writer.append(run.frames[i], run.samples[i], run.outputs[i]);
    LevelingPoint point;
    point.time = static_cast<double>(i);
    point.progress = 0.5 * static_cast<double>(i);
    writer.append_leveling(point);
  }
  writer.write_terrain_after(run.after.view());
  EXPECT_EQ(writer.finish(), without);

  const SessionReader reader(file_);
  const std::vector<LevelingPoint> points = reader.leveling();
  ASSERT_EQ(points.size(), 200U);
  EXPECT_EQ(points[7].time, 7.0);
  EXPECT_EQ(points[199].progress, 99.5);
  EXPECT_TRUE(std::isnan(points[7].relief));
  EXPECT_EQ(reader.compute_content_hash(), without);
}

TEST_F(SessionTest, MorePointsThanTicksAreNoCurve) {
  SessionWriter writer(file_, random_run(1).info);
  for (int i = 0; i < 3; ++i) writer.append_leveling({});
  writer.finish();
  const SessionReader reader(file_);
  EXPECT_THROW(reader.leveling(), InputError);
}

TEST_F(SessionTest, TheSoilIsAnAttributeAParameter) {
  SoilParameters soil;
  double value = 0.5;
  for (const SoilParameterInfo& parameter : kSoilParameters) soil.*parameter.member = value += 1.25;
  {
    SessionWriter writer(file_, random_run(1).info);
    writer.write_soil(soil);
    writer.finish();
  }
  const std::string printed = output_of("h5dump -y -g /soil " + file_.string());
  const auto attribute = [&](const std::string& name) {
    const size_t begin = printed.find("ATTRIBUTE \"" + name + "\"");
    EXPECT_NE(begin, std::string::npos) << name;
    return printed.substr(begin, printed.find("ATTRIBUTE", begin + 1) - begin);
  };
  for (const SoilParameterInfo& parameter : kSoilParameters) {
    std::ostringstream number;
    number << soil.*parameter.member;
    const std::string unit = std::string(parameter.key) + ".unit";
    EXPECT_NE(attribute(parameter.key).find(" " + number.str() + "\n"), std::string::npos)
        << attribute(parameter.key);
    if (*parameter.unit == '\0') {
      EXPECT_EQ(printed.find('"' + unit + '"'), std::string::npos) << unit;
    } else {
      EXPECT_NE(attribute(unit).find('"' + std::string(parameter.unit) + '"'), std::string::npos)
          << attribute(unit);
    }
  }
}

}  // namespace
}  // namespace screed
