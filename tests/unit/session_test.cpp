// Session files: what is written comes back, also through programs we did not write; what is wrong
// is refused in one line; and a recorded run replays to the byte.
#include <gtest/gtest.h>
#include <hdf5.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>

#include "firmware/robot/parameter_table.h"
#include "firmware/robot/robot.h"
#include "host_sim/core/content_hash.h"
#include "host_sim/core/errors.h"
#include "host_sim/session/csv_export.h"
#include "host_sim/session/hdf5_handle.h"
#include "host_sim/session/record.h"
#include "host_sim/session/replay.h"
#include "host_sim/session/session_reader.h"
#include "host_sim/session/session_writer.h"
#include "tools/replay_command.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

/// SplitMix64 (Steele, Lea, Flood 2014): test data that is the same everywhere.
class Noise {
 public:
  explicit Noise(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next() {
    std::uint64_t z = state_ += 0x9E3779B97F4A7C15U;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31);
  }
  template <std::size_t N>
  std::array<std::uint8_t, N> bytes() {
    std::array<std::uint8_t, N> bytes{};
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(next());
    return bytes;
  }

 private:
  std::uint64_t state_;
};

struct Recording {
  SessionInfo info;
  std::vector<Frame> frames;
  std::vector<SensorSample> samples;
  std::vector<RobotOutput> outputs;
  HeightMap before;
  HeightMap after;
};

/// Every bit of every field takes part, NaNs, infinities and all.
Recording random_run(std::size_t ticks, std::uint64_t seed = 1) {
  Recording run;
  run.info.program_version = "1.2.3";
  run.info.experiment_name = "hill";
  run.info.experiment_text = "[experiment]\nseed = 7\n# gr\xC3\xBC\xC3\x9F dich\n";
  run.info.seed = 0xFEDCBA9876543210U;
  run.info.board_name = "a_star_32u4";
  run.info.board = {9048, 1831, 195, 7200, 250};
  run.info.parameters.climb_speed = 123;
  Noise noise(seed);
  for (std::size_t i = 0; i < ticks; ++i) {
    Frame frame;
    SensorSample sample{};
    RobotOutput output{};
    unpack(noise.bytes<kFrameBytes>(), frame);
    unpack(noise.bytes<kSampleBytes>(), sample);
    unpack(noise.bytes<kOutputBytes>(), output);
    sample.radio_in_count =
        static_cast<std::uint8_t>(sample.radio_in_count % (kRadioInCapacity + 1));
    output.radio_out_count =
        static_cast<std::uint8_t>(output.radio_out_count % (kRadioOutCapacity + 1));
    run.frames.push_back(frame);
    run.samples.push_back(sample);
    run.outputs.push_back(output);
  }
  run.before.geometry = {3, 2, 1e-6, 0.0125, -1.5, 2.5, true};
  run.before.heights = {1, -2, 3, 2147483647, -2147483647 - 1, 6};
  run.after = run.before;
  run.after.heights[1] = 77;
  return run;
}

std::string write_run(const fs::path& file, const Recording& run) {
  SessionWriter writer(file, run.info);
  writer.write_terrain_before(run.before.view());
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    writer.append(run.frames[i], run.samples[i], run.outputs[i]);
  }
  writer.write_terrain_after(run.after.view());
  return writer.finish();
}

template <std::size_t N, class Row>
std::array<std::uint8_t, N> packed(const Row& row) {
  std::array<std::uint8_t, N> bytes{};
  pack(row, std::span<std::uint8_t, N>(bytes));
  return bytes;
}

template <std::size_t N, class Row>
void expect_rows(const SessionReader& reader, const std::vector<Row>& expected) {
  std::vector<Row> rows(expected.size());
  reader.read(0, std::span(rows));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ASSERT_EQ(packed<N>(rows[i]), packed<N>(expected[i])) << "row " << i;
  }
}

std::string get(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void put(const fs::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

/// Standard output of a program; fails the test when it does not succeed.
std::string output_of(const std::string& command) {
  std::string text;
  std::FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return {};
  std::array<char, 4096> block{};
  for (std::size_t n = 0; (n = std::fread(block.data(), 1, block.size(), pipe)) > 0;) {
    text.append(block.data(), n);
  }
  EXPECT_EQ(pclose(pipe), 0) << command << " (package hdf5-tools)\n" << text;
  return text;
}

template <class Error>
std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing was thrown";
}

void expect_line(const std::string& message, const fs::path& file, const std::string& part) {
  EXPECT_EQ(message.find(file.string()), 0U) << message;
  EXPECT_NE(message.find(part), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

constexpr char kNotPossibleHere[] = "not possible here";

/// Runs in a child process, which may limit and drop what it wants. The action returns what is
/// wrong, "" for nothing. False when it returned kNotPossibleHere.
bool succeeds_in_child(const std::function<std::string()>& action) {
  constexpr int kSkip = 77;
  const pid_t child = fork();
  if (child == 0) {
    const std::string wrong = action();
    if (wrong == kNotPossibleHere) _exit(kSkip);
    if (!wrong.empty()) std::fprintf(stderr, "%s\n", wrong.c_str());
    _exit(wrong.empty() ? 0 : 1);
  }
  int status = -1;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  if (WIFEXITED(status) && WEXITSTATUS(status) == kSkip) return false;
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << "status " << status;
  return true;
}

class SessionTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "screed-session-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    base_ = name;
    file_ = base_ / "session.h5";
  }
  void TearDown() override { fs::remove_all(base_); }

  void expect_refused(const std::string& part) const {
    expect_line(message_of<InputError>([&] { const SessionReader reader(file_); }), file_, part);
  }

  /// Changes the finished file by the library itself.
  void edit(const std::function<void(hid_t)>& change) const {
    const h5::Handle file(H5Fopen(file_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose, "open");
    change(file.get());
  }

  fs::path base_;
  fs::path file_;
};

// --- rows ---

TEST(Record, RowsAreLittleEndianWithoutPadding) {
  SensorSample sample{};
  sample.time_us = 0x04030201;
  sample.gyro[0] = -2;
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

  Frame frame;
  frame.time = 1.0;
  frame.faults = 0x01020304;
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

// --- writing and reading ---

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
  EXPECT_EQ(info.experiment_name, run.info.experiment_name);
  EXPECT_EQ(info.experiment_text, run.info.experiment_text);
  EXPECT_EQ(info.seed, run.info.seed);
  EXPECT_EQ(info.tick_rate_hz, 100U);
  EXPECT_EQ(info.board_name, run.info.board_name);
  EXPECT_EQ(info.board.count_um_q4, 9048);
  EXPECT_EQ(info.board.full_speed_mm_per_s, 250);
  for (const ParameterInfo& parameter : kParameterTable) {
    EXPECT_EQ(info.parameters.*parameter.field, run.info.parameters.*parameter.field)
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
  }
}

TEST_F(SessionTest, AnyRangeOfRowsCanBeRead) {
  const Recording run = random_run(1500);
  write_run(file_, run);
  const SessionReader reader(file_);
  std::vector<Frame> rows(100);
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
  EXPECT_TRUE(get(file_) == get(base_ / "again.h5"));
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

// --- other programs ---

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
  for (Frame& frame : run.frames) {
    double value = 1.0 / 3 + static_cast<double>(&frame - run.frames.data());
#define SCREED_SET(type, name, unit, meaning) frame.name = static_cast<type>(value *= -1.5);
    SCREED_FRAME_COLUMNS(SCREED_SET)
#undef SCREED_SET
  }
  const std::string hash = write_run(file_, run);

  std::vector<double> expected;
  for (const Frame& frame : run.frames) {
#define SCREED_GET(type, name, unit, meaning) expected.push_back(frame.name);
    SCREED_FRAME_COLUMNS(SCREED_GET)
#undef SCREED_GET
  }
  const std::string dump = "h5dump -y -w 0 -m %.17g -d ";
  EXPECT_EQ(dumped_numbers(output_of(dump + "/frames " + file_.string())), expected);

  expected.clear();
  for (const SensorSample& s : run.samples) {
    expected.insert(expected.end(), {static_cast<double>(s.time_us)});
    for (const auto* axes : {s.gyro, s.accel, s.mag})
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

// --- the content hash ---

TEST_F(SessionTest, TheHashCoversEveryByteOfEveryRow) {
  Recording run = random_run(1);
  run.samples[0].radio_in_count = kRadioInCapacity - 1;
  run.outputs[0].radio_out_count = kRadioOutCapacity - 1;
  int number = 0;
  const auto hash = [&](const Recording& changed) {
    return write_run(base_ / (std::to_string(number++) + ".h5"), changed);
  };
  const std::string original = hash(run);
  EXPECT_EQ(hash(run), original);
  const auto check = [&]<std::size_t N, class Row>(const std::array<std::uint8_t, N>& bytes,
                                                   Row& row, std::span<const Column> columns) {
    const Row unchanged = row;
    for (std::size_t i = 0; i < N; ++i) {
      auto other = bytes;
      other[i] ^= 1;
      unpack(other, row);
      const bool valid = columns.back().array ? i + 1 < N : true;  // the last radio byte is not
      EXPECT_EQ(hash(run) != original, valid) << columns.front().name << "..., byte " << i;
    }
    row = unchanged;
  };
  check(packed<kFrameBytes>(run.frames[0]), run.frames[0], kFrameColumns);
  check(packed<kSampleBytes>(run.samples[0]), run.samples[0], kSampleColumns);
  check(packed<kOutputBytes>(run.outputs[0]), run.outputs[0], kOutputColumns);
  EXPECT_EQ(hash(run), original);
}

TEST_F(SessionTest, TheHashCoversTheConditionsButNotTheNames) {
  const Recording run = random_run(2);
  int number = 0;
  const auto hash = [&](const std::function<void(Recording&)>& change) {
    Recording changed = run;
    change(changed);
    return write_run(base_ / (std::to_string(number++) + ".h5"), changed);
  };
  const std::string original = hash([](Recording&) {});
  EXPECT_EQ(original, hash([](Recording& r) { r.info.program_version = "9"; }));
  EXPECT_EQ(original, hash([](Recording& r) { r.info.experiment_name = "pit"; }));
  EXPECT_EQ(original, hash([](Recording& r) { r.info.board_name = "other"; }));

  EXPECT_NE(original, hash([](Recording& r) { ++r.info.seed; }));
  EXPECT_NE(original, hash([](Recording& r) { r.info.experiment_text += ' '; }));
  EXPECT_NE(original, hash([](Recording& r) { r.info.tick_rate_hz = 50; }));
  EXPECT_NE(original, hash([](Recording& r) { ++r.info.board.tread_mm; }));
  for (const ParameterInfo& parameter : kParameterTable) {
    EXPECT_NE(original, hash([&](Recording& r) { ++(r.info.parameters.*parameter.field); }))
        << parameter.name;
  }
  EXPECT_NE(original, hash([](Recording& r) { ++r.before.heights[5]; }));
  EXPECT_NE(original, hash([](Recording& r) { ++r.after.heights[5]; }));
  EXPECT_NE(original, hash([](Recording& r) { std::swap(r.before, r.after); }));
  EXPECT_NE(original, hash([](Recording& r) { r.before.geometry.unit_m = 2e-6; }));
  EXPECT_NE(original, hash([](Recording& r) { r.before.geometry.spacing_m = 0.025; }));
  EXPECT_NE(original, hash([](Recording& r) { r.before.geometry.origin_x_m = 0; }));
  EXPECT_NE(original, hash([](Recording& r) { r.before.geometry.origin_y_m = 0; }));
  EXPECT_NE(original, hash([](Recording& r) { r.before.geometry.wrap = false; }));
  EXPECT_NE(original,
            hash([](Recording& r) { std::swap(r.before.geometry.nx, r.before.geometry.ny); }));
  EXPECT_NE(original, hash([](Recording& r) { std::swap(r.frames[0], r.frames[1]); }));
}

TEST_F(SessionTest, TheHashShowsAnEditedFile) {
  const std::string hash = write_run(file_, random_run(3));
  edit([](hid_t file) {
    const h5::Handle group(H5Gopen2(file, "parameters", H5P_DEFAULT), H5Gclose, "parameters");
    h5::write_attribute(group.get(), "climb_speed", std::int64_t{124});
  });
  const SessionReader reader(file_);
  EXPECT_EQ(reader.content_hash(), hash);
  EXPECT_NE(reader.compute_content_hash(), hash);
}

// --- what is wrong with a file ---

TEST_F(SessionTest, FilesThatAreNoSessionAreRefused) {
  expect_refused("no such file");
  fs::create_directory(file_);
  expect_refused("is a folder");
  fs::remove(file_);
  put(file_, "");
  expect_refused("not an HDF5 file");
  put(file_, "time [s],x [m]\n0,0\n");
  expect_refused("not an HDF5 file");
  fs::remove(file_);
  {
    const h5::Handle foreign(H5Fcreate(file_.c_str(), H5F_ACC_EXCL, H5P_DEFAULT, H5P_DEFAULT),
                             H5Fclose, "create");
  }
  expect_refused("another program");
}

TEST_F(SessionTest, ATruncatedFileIsRefused) {
  write_run(file_, random_run(1200));
  const std::string whole = get(file_);
  testing::internal::CaptureStderr();
  for (std::size_t size = whole.size() - 1; size > 2000; size -= size / 9) {
    put(file_, whole.substr(0, size));
    expect_refused("truncated");
  }
  put(file_, whole.substr(0, 4));
  expect_refused("not an HDF5 file");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");  // the library has no say
}

TEST_F(SessionTest, DamagedRowsAreReported) {
  write_run(file_, random_run(1200));
  std::string bytes = get(file_);
  // The frames of a block are most of the file; somewhere in the middle is one of theirs.
  for (std::size_t i = 0; i < 64; ++i) bytes[bytes.size() / 2 + i] = static_cast<char>(0x5A);
  put(file_, bytes);
  const std::string message =
      message_of<InputError>([&] { SessionReader(file_).compute_content_hash(); });
  expect_line(message, file_, "damaged");
}

TEST_F(SessionTest, ANewerFormatIsRefused) {
  write_run(file_, random_run(1));
  edit([](hid_t file) { h5::write_attribute(file, "format_version", std::uint64_t{2}); });
  expect_refused("format 2 is not known; this program reads up to format 1");
}

TEST_F(SessionTest, AMissingOrWrongPartIsNamed) {
  const auto broken = [&](const std::function<void(hid_t)>& change, const std::string& part) {
    fs::remove(file_);
    write_run(file_, random_run(5));
    edit(change);
    expect_refused(part);
  };
  broken([](hid_t f) { H5Adelete(f, "seed"); }, "'seed' is missing");
  broken(
      [](hid_t f) {
        H5Adelete(f, "seed");
        h5::write_attribute(f, "seed", std::string("7"));
      },
      "'seed' is not an integer");
  broken([](hid_t f) { H5Ldelete(f, "samples", H5P_DEFAULT); }, "'samples' is missing");
  broken([](hid_t f) { H5Ldelete(f, "parameters", H5P_DEFAULT); }, "'parameters'");
  broken([](hid_t f) { h5::write_attribute(f, "frames", std::uint64_t{6}); }, "6 rows");
  broken(
      [](hid_t f) {
        const h5::Handle group(H5Gopen2(f, "parameters", H5P_DEFAULT), H5Gclose, "parameters");
        h5::write_attribute(group.get(), "climb_speed", std::int64_t{40000});
      },
      "'climb_speed' is 40000");
}

/// Replaces a table by one with the columns that `keep` accepts; integers are of 64 bits, which
/// must not matter.
void rewrite_table(hid_t file, const char* name, std::size_t rows, std::span<const Column> columns,
                   const std::function<bool(const Column&)>& keep) {
  constexpr std::size_t kWidest = std::size_t{8} * kRadioInCapacity;  // bytes of a column
  H5Ldelete(file, name, H5P_DEFAULT);
  std::vector<const Column*> kept;
  for (const Column& column : columns) {
    if (keep(column)) kept.push_back(&column);
  }
  const h5::Handle type(H5Tcreate(H5T_COMPOUND, kWidest * kept.size()), H5Tclose, "type");
  std::size_t offset = 0;
  for (const Column* column : kept) {
    const hid_t element = column->type == ColumnType::kDouble ? H5T_IEEE_F64LE : H5T_STD_I64LE;
    const hsize_t count = column->count;
    const h5::Handle array(H5Tarray_create2(element, 1, &count), H5Tclose, "array");
    h5::check(H5Tinsert(type.get(), column->name, offset, column->array ? array.get() : element),
              "insert");
    offset += std::size_t{8} * column->count;
  }
  const hsize_t size = rows;
  const h5::Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose, "space");
  const h5::Handle dataset(
      H5Dcreate2(file, name, type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Dclose, name);
  std::vector<std::uint64_t> values(kWidest / 8 * kept.size() * rows, 5);
  h5::check(H5Dwrite(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
            "write");
}

TEST_F(SessionTest, OldFilesWithFewerFrameColumnsAreRead) {
  write_run(file_, random_run(3));
  edit([](hid_t file) {
    rewrite_table(file, "frames", 3, kFrameColumns, [](const Column& column) {
      const std::string name = column.name;
      return name != "battery" && name != "faults";
    });
    const h5::Handle group(H5Gopen2(file, "parameters", H5P_DEFAULT), H5Gclose, "parameters");
    H5Adelete(group.get(), "climb_speed");
  });
  const SessionReader reader(file_);
  EXPECT_EQ(reader.missing_columns(), (std::vector<std::string>{"battery", "faults"}));
  EXPECT_EQ(reader.missing_parameters(), (std::vector<std::string>{"climb_speed"}));
  EXPECT_EQ(reader.info().parameters.climb_speed, Parameters{}.climb_speed);
  std::vector<Frame> frames(3);
  reader.read(0, std::span(frames));
  for (const Frame& frame : frames) {
    EXPECT_TRUE(std::isnan(frame.battery));
    EXPECT_EQ(frame.faults, 0);
    EXPECT_EQ(frame.state, 5);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(frame.time), 5U);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(frame.energy), 5U);
  }
}

TEST_F(SessionTest, SamplesNeedAllTheirColumns) {
  write_run(file_, random_run(3));
  edit([](hid_t file) {
    rewrite_table(file, "samples", 3, kSampleColumns,
                  [](const Column& column) { return std::string(column.name) != "pressure"; });
  });
  expect_refused("table 'samples': column 'pressure' is missing");
}

TEST_F(SessionTest, TooManyRadioBytesAreRefused) {
  Recording run = random_run(2);
  run.outputs[1].radio_out_count = kRadioOutCapacity + 1;
  write_run(file_, run);
  std::vector<RobotOutput> outputs(2);
  const SessionReader reader(file_);
  expect_line(message_of<InputError>([&] { reader.read(0, std::span(outputs)); }), file_,
              "row 1: 89 radio bytes");
}

// --- what goes wrong while writing ---

TEST_F(SessionTest, AnExistingFileIsNotOverwritten) {
  put(file_, "precious");
  expect_line(message_of<RunError>([&] { write_run(file_, random_run(1)); }), file_, "exists");
  EXPECT_EQ(get(file_), "precious");
}

TEST_F(SessionTest, AFolderThatIsNotThereIsARunError) {
  const fs::path file = base_ / "missing" / "session.h5";
  expect_line(message_of<RunError>([&] { write_run(file, random_run(1)); }), file,
              "No such file or directory");
}

TEST_F(SessionTest, AFolderThatIsNotWritableIsARunError) {
  fs::permissions(base_, fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read |
                             fs::perms::others_exec);
  EXPECT_TRUE(succeeds_in_child([&]() -> std::string {
    constexpr uid_t kNobody = 65534;  // permissions do not bind root
    if (geteuid() == 0 && seteuid(kNobody) != 0) return "cannot become another user";
    const std::string message = message_of<RunError>([&] { write_run(file_, random_run(1)); });
    return message.find("Permission denied") == std::string::npos ? message : "";
  }));
  fs::permissions(base_, fs::perms::owner_all);
}

/// Records until it fails, as a run would, and reports in which way it did not fail as it should.
std::string record_until_full(const fs::path& file, const std::string& reason) {
  const Recording run = random_run(4096);
  const auto record = [&] {
    SessionWriter writer(file, run.info);
    for (int round = 0; round < 4; ++round) {
      for (std::size_t i = 0; i < run.frames.size(); ++i) {
        writer.append(run.frames[i], run.samples[i], run.outputs[i]);
      }
    }
    writer.finish();
  };
  const std::string message = message_of<RunError>(record);
  const bool good = message.starts_with(file.string()) &&
                    message.find(reason) != std::string::npos &&
                    message.find('\n') == std::string::npos;
  return good ? "" : "message: " + message;
}

TEST_F(SessionTest, AFileSizeLimitIsARunError) {
  EXPECT_TRUE(succeeds_in_child([&]() -> std::string {
    std::signal(SIGXFSZ, SIG_IGN);
    for (const rlim_t limit : {0U, 4096U, 100000U, 1000000U}) {
      const rlimit size{limit, RLIM_INFINITY};
      if (setrlimit(RLIMIT_FSIZE, &size) != 0) return "cannot set the limit";
      fs::remove(file_);
      if (std::string wrong = record_until_full(file_, "File too large"); !wrong.empty()) {
        return wrong;
      }
    }
    return "";
  }));
}

// The library would write again what it could not write, when the program is long past its last
// line.
TEST_F(SessionTest, AProgramEndsOrderlyAfterAWriteError) {
  EXPECT_TRUE(succeeds_in_child([&]() -> std::string {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit size{100000, RLIM_INFINITY};
    if (setrlimit(RLIMIT_FSIZE, &size) != 0) return "cannot set the limit";
    if (std::string wrong = record_until_full(file_, "File too large"); !wrong.empty()) {
      return wrong;
    }
    std::exit(0);
  }));
}

TEST_F(SessionTest, AFullDiskIsARunError) {
  const bool possible = succeeds_in_child([&]() -> std::string {
    // A small disk that only this child sees.
    if (unshare(CLONE_NEWNS) != 0 ||
        mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
        mount("tmpfs", base_.c_str(), "tmpfs", 0, "size=1m") != 0) {
      return kNotPossibleHere;
    }
    if (std::string wrong = record_until_full(file_, "No space left on device"); !wrong.empty()) {
      return wrong;
    }
    // The same for a disk that is full before the run begins.
    put(base_ / "rest", std::string(std::size_t{2} << 20, 'x'));
    return record_until_full(base_ / "second.h5", "No space left on device");
  });
  if (!possible) GTEST_SKIP() << "may not mount a small disk; AFileSizeLimitIsARunError has to do";
}

TEST_F(SessionTest, AKilledRunKeepsItsBlocks) {
  Recording run = random_run(2 * SessionWriter::kBlockRows + 300);
  EXPECT_TRUE(succeeds_in_child([&]() -> std::string {
    SessionWriter writer(file_, run.info);
    writer.write_terrain_before(run.before.view());
    for (std::size_t i = 0; i < run.frames.size(); ++i) {
      writer.append(run.frames[i], run.samples[i], run.outputs[i]);
    }
    _exit(0);
  }));
  const SessionReader reader(file_);
  EXPECT_FALSE(reader.complete());
  EXPECT_TRUE(reader.content_hash().empty());
  ASSERT_EQ(reader.frames(), 2 * SessionWriter::kBlockRows);
  EXPECT_TRUE(reader.terrain_before());
  EXPECT_FALSE(reader.terrain_after());
  run.samples.resize(2048);
  run.outputs.resize(2048);
  expect_rows<kSampleBytes>(reader, run.samples);
  expect_rows<kOutputBytes>(reader, run.outputs);
}

TEST_F(SessionTest, AnUnfinishedFileHasTheTicksThatAllTablesHave) {
  for (const char* table : {"frames", "samples", "outputs"}) {
    fs::remove(file_);
    write_run(file_, random_run(5));
    edit([&](hid_t file) {
      H5Adelete(file, "content_hash");
      const h5::Handle dataset(H5Dopen2(file, table, H5P_DEFAULT), H5Dclose, table);
      const hsize_t rows = 3;
      h5::check(H5Dset_extent(dataset.get(), &rows), table);
    });
    EXPECT_EQ(SessionReader(file_).frames(), 3U) << table;
  }
}

TEST_F(SessionTest, AnAbandonedWriterLeavesAnUnfinishedFile) {
  { const SessionWriter writer(file_, random_run(0).info); }
  EXPECT_FALSE(SessionReader(file_).complete());
}

// --- CSV ---

TEST_F(SessionTest, CsvHasAllNumbersExactly) {
  const Recording run = random_run(1300);
  write_run(file_, run);
  export_frames_csv(SessionReader(file_), base_ / "frames.csv");
  std::ifstream csv(base_ / "frames.csv");
  std::string line;
  ASSERT_TRUE(std::getline(csv, line));
  EXPECT_EQ(line.substr(0, 24), "time [s],x [m],y [m],z [");
  EXPECT_NE(line.find(",pitch [rad],"), std::string::npos);
  EXPECT_NE(line.find(",slip_left [1],"), std::string::npos);
  EXPECT_TRUE(line.ends_with(",state,leveling_state,faults")) << line;
  for (const Frame& frame : run.frames) {
    ASSERT_TRUE(std::getline(csv, line));
    Frame read;
    const char* cursor = line.c_str();
    char* end = nullptr;
#define SCREED_READ(type, name, unit, meaning)                                               \
  read.name = static_cast<type>(std::strtod(cursor, &end));                                  \
  if (std::isnan(frame.name)) read.name = frame.name; /* NaNs lose their payload, no more */ \
  cursor = end + 1;
    SCREED_FRAME_COLUMNS(SCREED_READ)
#undef SCREED_READ
    EXPECT_EQ(cursor, line.c_str() + line.size() + 1);
    ASSERT_EQ(packed<kFrameBytes>(read), packed<kFrameBytes>(frame)) << line;
  }
  EXPECT_FALSE(std::getline(csv, line));
}

TEST_F(SessionTest, CsvWritesTheShortestNumbers) {
  Recording run = random_run(1);
  run.frames[0].time = 0.1;
  run.frames[0].x = -2;
  run.frames[0].y = 1e-9;
  write_run(file_, run);
  export_frames_csv(SessionReader(file_), base_ / "frames.csv");
  EXPECT_NE(get(base_ / "frames.csv").find("\n0.1,-2,1e-09,"), std::string::npos);
}

TEST_F(SessionTest, CsvThatCannotBeWrittenIsARunErrorAndLeavesNothing) {
  write_run(file_, random_run(1300));
  const SessionReader reader(file_);
  const fs::path nowhere = base_ / "missing" / "frames.csv";
  expect_line(message_of<RunError>([&] { export_frames_csv(reader, nowhere); }), nowhere,
              "No such file or directory");
  put(base_ / "frames.csv", "precious");
  EXPECT_TRUE(succeeds_in_child([&]() -> std::string {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit size{50000, RLIM_INFINITY};
    if (setrlimit(RLIMIT_FSIZE, &size) != 0) return "cannot set the limit";
    const std::string message =
        message_of<RunError>([&] { export_frames_csv(reader, base_ / "frames.csv"); });
    return message.find("File too large") == std::string::npos ? message : "";
  }));
  EXPECT_EQ(get(base_ / "frames.csv"), "precious");
  EXPECT_FALSE(fs::exists(base_ / "frames.csv.partial"));
}

// --- replay ---

/// A run of the real core over made-up samples that move, with something on the radio now and then.
Recording robot_run(std::size_t ticks) {
  Recording run = random_run(ticks);
  run.info.parameters = Parameters{};
  run.info.parameters.standalone = 1;
  Robot robot(run.info.board, run.info.parameters, run.info.credentials);
  RobotOutput output{};
  for (std::size_t i = 0; i < ticks; ++i) {
    SensorSample& sample = run.samples[i];
    sample.time_us = static_cast<std::uint32_t>(i * kTickPeriod_us);
    for (int axis = 0; axis < 3; ++axis) {
      sample.gyro[axis] = static_cast<std::int16_t>(sample.gyro[axis] / 256);
      sample.accel[axis] =
          static_cast<std::int16_t>(sample.accel[axis] / 256 + (axis == 2 ? 4096 : 0));
    }
    sample.encoder_left = static_cast<std::uint16_t>(i * 3);
    sample.encoder_right = static_cast<std::uint16_t>(i * 2);
    sample.battery = 4000;
    robot.tick(sample, output);
    run.outputs[i] = output;
  }
  return run;
}

TEST_F(SessionTest, ARecordedRunReplaysToTheByte) {
  const Recording run = robot_run(1500);
  ASSERT_TRUE(std::any_of(run.outputs.begin(), run.outputs.end(),
                          [](const RobotOutput& output) { return output.radio_out_count > 0; }));
  write_run(file_, run);
  const ReplayResult result = replay_session(file_);
  EXPECT_EQ(result.ticks, 1500U);
  EXPECT_FALSE(result.first_difference_tick) << result.first_difference;
  EXPECT_TRUE(result.complete);
  EXPECT_TRUE(result.unchanged);
  ContentHash hash;
  for (const RobotOutput& output : run.outputs) hash.add_bytes(packed<kOutputBytes>(output));
  EXPECT_EQ(result.output_hash, hash.hex());
}

TEST_F(SessionTest, ReplayFindsTheFirstChangedByte) {
  Recording run = robot_run(1500);
  const auto report = std::find_if(run.outputs.begin() + 1100, run.outputs.end(),
                                   [](const RobotOutput& o) { return o.radio_out_count > 0; });
  ASSERT_NE(report, run.outputs.end());
  const int last = report->radio_out_count - 1;
  const int value = report->radio_out[last];
  report->radio_out[last] ^= 1;
  run.outputs.back().duty_right ^= 1;
  write_run(file_, run);
  const ReplayResult result = replay_session(file_);
  EXPECT_EQ(result.ticks, 1500U);
  EXPECT_EQ(result.first_difference_tick, static_cast<std::uint64_t>(report - run.outputs.begin()));
  EXPECT_EQ(result.first_difference, "radio_out[" + std::to_string(last) + "]: expected " +
                                         std::to_string(value ^ 1) + ", got " +
                                         std::to_string(value));
}

TEST_F(SessionTest, ReplayIgnoresRadioBytesThatAreNotValid) {
  Recording run = robot_run(50);
  for (RobotOutput& output : run.outputs) {
    for (int i = output.radio_out_count; i < kRadioOutCapacity; ++i) output.radio_out[i] = 0xEE;
  }
  write_run(file_, run);
  EXPECT_FALSE(replay_session(file_).first_difference_tick);
}

TEST_F(SessionTest, ReplayRefusesWhatItCannotReplay) {
  write_run(file_, random_run(0));
  expect_line(message_of<InputError>([&] { replay_session(file_); }), file_, "no tick");
  fs::remove(file_);
  Recording run = robot_run(3);
  run.info.tick_rate_hz = 50;
  write_run(file_, run);
  expect_line(message_of<InputError>([&] { replay_session(file_); }), file_, "50 ticks per second");
  fs::remove(file_);
  run = robot_run(3);
  run.info.board.motor_nominal_mv = 0;
  write_run(file_, run);
  expect_line(message_of<InputError>([&] { replay_session(file_); }), file_,
              "'motor_nominal_mv' is 0");
}

struct CommandResult {
  int status = -1;
  std::string out;
  std::string err;
};

CommandResult replay_command(const std::vector<std::string>& arguments) {
  CLI::App app;
  std::function<int()> action;
  register_replay_command(app, action);
  std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
  reversed.emplace_back("replay");
  app.parse(reversed);
  CommandResult result;
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  try {
    result.status = action();
  } catch (const InputError&) {
    result.status = 2;
  }
  result.out = testing::internal::GetCapturedStdout();
  result.err = testing::internal::GetCapturedStderr();
  return result;
}

TEST_F(SessionTest, TheReplayCommandTellsTheResult) {
  Recording run = robot_run(40);
  write_run(file_, run);
  for (const fs::path& name : {base_, file_}) {  // run folder and file
    const CommandResult result = replay_command({name.string()});
    EXPECT_EQ(result.status, 0);
    EXPECT_EQ(result.out, "40 ticks replayed, outputs identical\n");
    EXPECT_EQ(result.err, "");
  }
  const std::string hash = replay_session(file_).output_hash;
  EXPECT_EQ(replay_command({file_.string(), "--json"}).out,
            "{\"run\":\"" + file_.string() +
                "\",\"ticks\":40,\"identical\":true,\"first_difference_tick\":null,"
                "\"first_difference\":null,\"output_hash\":\"" +
                hash + "\",\"complete\":true,\"unchanged\":true}\n");

  const int leds = run.outputs[7].leds;
  run.outputs[7].leds ^= 1;
  fs::remove(file_);
  write_run(file_, run);
  const std::string difference =
      "leds: expected " + std::to_string(leds ^ 1) + ", got " + std::to_string(leds);
  CommandResult result = replay_command({file_.string()});
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(result.out, "40 ticks replayed, first difference at tick 7: " + difference + "\n");
  result = replay_command({"--json", file_.string()});
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.out.find("\"identical\":false,\"first_difference_tick\":7,"
                            "\"first_difference\":\"" +
                            difference + "\""),
            std::string::npos)
      << result.out;
}

TEST_F(SessionTest, TheReplayCommandNotesEditedAndUnfinishedRuns) {
  const Recording run = robot_run(SessionWriter::kBlockRows);
  {
    SessionWriter writer(file_, run.info);
    for (std::size_t i = 0; i < run.frames.size(); ++i) {
      writer.append(run.frames[i], run.samples[i], run.outputs[i]);
    }
  }
  EXPECT_NE(replay_command({file_.string()}).err.find("did not end"), std::string::npos);
  fs::remove(file_);
  write_run(file_, run);
  edit([](hid_t file) { h5::write_attribute(file, "seed", std::uint64_t{1}); });
  EXPECT_NE(replay_command({file_.string()}).err.find("content"), std::string::npos);
}

TEST_F(SessionTest, TheReplayCommandRefusesWrongInput) {
  EXPECT_EQ(replay_command({(base_ / "missing").string()}).status, 2);
  EXPECT_EQ(replay_command({base_.string()}).status, 2);  // a folder without a session
  EXPECT_THROW(replay_command({}), CLI::RequiredError);
}

}  // namespace
}  // namespace screed
