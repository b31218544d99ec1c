// What the tests of session files share: made-up runs, the folder, and how a complaint has to look.
#pragma once

#include <gtest/gtest.h>
#include <hdf5.h>

#include <array>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "host_sim/core/child_process.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/hdf5_handle.h"
#include "host_sim/core/record.h"
#include "host_sim/run/session/session_layout.h"
#include "host_sim/run/session/session_reader.h"
#include "host_sim/run/session/session_writer.h"
#include "tests/temp_folder.h"

namespace screed {

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
  std::vector<SimFrame> frames;
  std::vector<SensorSample> samples;
  std::vector<RobotOutput> outputs;
  HeightMap before;
  HeightMap after;
};

/// Every bit of every field takes part, NaNs, infinities and all.
inline Recording random_run(std::size_t ticks, std::uint64_t seed = 1) {
  Recording run;
  run.info.program_version = "1.2.3";
  run.info.arithmetic = arithmetic();
  run.info.experiment_name = "hill";
  run.info.experiment_text = "[experiment]\nseed = 7\n# gr\xC3\xBC\xC3\x9F dich\n";
  run.info.seed = 0xFEDCBA9876543210U;
  run.info.board_name = "a_star_32u4";
  run.info.board = {9048, 1831, 195, 7200, 250, 145};
  run.info.parameters.climb_speed() = 123;
  Noise noise(seed);
  for (std::size_t i = 0; i < ticks; ++i) {
    SimFrame frame;
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

inline std::string write_run(const fs::path& file, const Recording& run) {
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

/// Standard output of a program; fails the test when it does not succeed.
inline std::string output_of(const std::string& command) {
  const ShellOutput output = shell_output(command + " 2>&1");
  EXPECT_EQ(output.exit_code, 0) << command << " (package hdf5-tools)\n" << output.text;
  return output.text;
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

inline void expect_line(const std::string& message, const fs::path& file, const std::string& part) {
  EXPECT_EQ(message.find(file.string()), 0U) << message;
  EXPECT_NE(message.find(part), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

class SessionTest : public ::testing::Test {
 protected:
  void expect_refused(const std::string& part) const {
    expect_line(message_of<InputError>([&] { const SessionReader reader(file_); }), file_, part);
  }

  /// Changes the finished file by the library itself.
  void edit(const std::function<void(hid_t)>& change) const {
    const h5::Handle file(H5Fopen(file_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose, "open");
    change(file.get());
  }

  TempFolder folder_;
  fs::path base_ = folder_.path();
  fs::path file_ = base_ / "session.h5";
};

}  // namespace screed
