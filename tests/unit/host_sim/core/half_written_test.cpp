// What is written for good is there whole or not at all: on a disk that gets full on the way, every
// writer says so in one line and leaves the folder as it was.
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <numeric>
#include <set>
#include <sstream>
#include <string>

#include "firmware/protocol/e2e.h"
#include "firmware/protocol/messages.h"
#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/engine/task_worker.h"
#include "host_sim/grid/grid_recording.h"
#include "host_sim/grid/grid_sweep.h"
#include "host_sim/ground_station/telemetry/candump_log.h"
#include "host_sim/ground_station/telemetry/csv_tables.h"
#include "host_sim/ground_station/telemetry/telemetry_mcap.h"
#include "host_sim/render/chart/svg.h"
#include "tests/child_process.h"
#include "tests/file_size_limit.h"
#include "tests/temp_folder.h"

namespace screed::testing {
namespace {

namespace fs = std::filesystem;

class HalfWritten : public ::testing::Test {
 protected:
  std::set<fs::path> files() const {
    std::set<fs::path> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) names.insert(entry.path());
    return names;
  }

  /// `write` cannot put more than `bytes` into a file.
  void expect_nothing_left(rlim_t bytes, const std::function<void()>& write) {
    const std::set<fs::path> before = files();
    std::string message;
    {
      const FileSizeLimit full(bytes);
      try {
        write();
      } catch (const RunError& error) {
        message = error.what();
      }
    }
    EXPECT_TRUE(message.starts_with(folder_.string())) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_EQ(files(), before) << "with " << bytes << " bytes";
  }

  /// A log of some seconds, more than the buffers of what reads it.
  fs::path log() const {
    fs::path path = folder_ / "radio.log";
    std::ofstream file(path);
    for (unsigned i = 0; i < 6000; ++i) {
      CanFrame frame = frame_of(message::Attitude{-5, static_cast<int16_t>(i % 900), 35999});
      frame.id = id_of_node(frame.id, 1);
      e2e_protect(frame.id, static_cast<uint8_t>(i % 16), frame.data, frame.size);
      file << candump_line(uint64_t{i} * 10000U, "can0", frame);
    }
    return path;
  }

  TempFolder temporary_;
  fs::path folder_ = temporary_.path();
};

TEST_F(HalfWritten, PartialFileKeepsWhatStoodThere) {
  const fs::path path = folder_ / "a.txt";
  write_text(path, "old");
  {
    const PartialFile place(path);
    write_text(place.partial(), "half");
  }
  EXPECT_EQ(read_text(path), "old");
  EXPECT_EQ(files().size(), 1U);
  PartialFile place(path);
  write_text(place.partial(), "new");
  place.commit();
  EXPECT_EQ(read_text(path), "new");
  EXPECT_EQ(files().size(), 1U);
}

// In a child: HDF5 keeps what it holds of a file that it could not write, and a program under the
// sanitizers would be told of a leak.
TEST_F(HalfWritten, GridRecording) {
  EXPECT_TRUE(succeeds_in_child([&]() -> std::string {
    GridRun run((GridConfig()));
    // Full at the start, in the middle of a run, and at its end.
    for (const rlim_t bytes : {0U, 3000U, 20000U}) {
      expect_nothing_left(bytes, [&] {
        GridRecorder recorder(folder_ / "run.h5", run, "test");
        for (int i = 0; i < 2500; ++i) {
          run.cycle();
          recorder.add_cycle(run);
        }
        recorder.finish(run);
      });
    }
    return HasFailure() ? "see above" : "";
  }));
}

TEST_F(HalfWritten, GridRecordingWhoseNameIsTakenMeanwhile) {
  const GridRun run((GridConfig()));
  expect_nothing_left(RLIM_INFINITY, [&] {
    const fs::path path = folder_ / "run.h5";
    GridRecorder recorder(path, run, "test");
    fs::create_directory(path);
    write_text(path / "x", "");  // and so cannot be renamed over
    try {
      recorder.finish(run);
    } catch (...) {
      fs::remove_all(path);
      throw;
    }
  });
}

TEST_F(HalfWritten, TableOfASweepKeepsTheOneThatIsThere) {
  GridConfig config;
  config.noise.width = config.noise.height = 8;
  config.agents = 4;
  const std::vector<SweepPoint> points = {{"ours", 0.0, config}};
  SweepOptions options;
  options.folder = folder_;
  options.table = folder_ / "results.csv";
  options.runs = 80;
  const SweepPlan plan = make_sweep_plan(points, options.version);
  const TaskFolder folder{folder_};
  write_text(folder.plan(), sweep_plan_text(plan));
  std::vector<size_t> tasks(static_cast<size_t>(options.runs));
  std::iota(tasks.begin(), tasks.end(), size_t{0});
  std::istringstream request(execute_request(tasks, 1));
  serve_sweep(folder, options.version, request, [](const std::string&) {});
  static_cast<void>(run_sweep(points, options));
  const std::string whole = read_text(options.table);
  // Less than the table and more than the plan.
  const auto bytes = static_cast<rlim_t>(whole.size() - 1);
  ASSERT_GT(bytes, fs::file_size(folder.plan()));
  expect_nothing_left(bytes, [&] { static_cast<void>(run_sweep(points, options)); });
  EXPECT_EQ(read_text(options.table), whole);
  fs::remove(options.table);
  expect_nothing_left(bytes, [&] { static_cast<void>(run_sweep(points, options)); });
}

TEST_F(HalfWritten, TablesAndMcapOfALog) {
  const fs::path path = log();
  const auto decode = [&](auto& to) {
    LogDecoder decoder(path.string());
    DecodedFrame frame;
    while (decoder.next(frame)) to.add(frame);
    static_cast<void>(to.finish());
  };
  fs::create_directory(folder_ / "tables");
  for (const rlim_t bytes : {0U, 100000U}) {
    expect_nothing_left(bytes, [&] {
      CsvTables tables(folder_ / "tables", false);
      decode(tables);
    });
    expect_nothing_left(bytes, [&] {
      TelemetryMcap file((folder_ / "radio.mcap").string());
      decode(file);
    });
  }
}

TEST_F(HalfWritten, PictureOfAnSvg) {
  std::string svg =
      "<svg xmlns='http://www.w3.org/2000/svg' width='300' height='300'>"
      "<rect width='300' height='300' fill='white'/>";
  for (int i = 0; i < 40; ++i) {
    svg += "<circle cx='" + std::to_string(i * 7) + "' cy='" + std::to_string(i * i % 300) +
           "' r='9'/>";
  }
  svg += "</svg>";
  for (const rlim_t bytes : {0U, 1000U}) {
    expect_nothing_left(bytes, [&] { write_svg_as_png(folder_ / "a.png", svg); });
  }
}

}  // namespace
}  // namespace screed::testing
