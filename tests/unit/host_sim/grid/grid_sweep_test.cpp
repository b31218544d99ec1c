// Sweeps, recordings and charts of the grid world: what is kept in files.
#include <gtest/gtest.h>
#include <hdf5.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "host_sim/core/errors.h"
#include "host_sim/grid/grid_figures.h"
#include "host_sim/grid/grid_recording.h"
#include "host_sim/grid/grid_sweep.h"
#include "host_sim/render/chart/line_chart.h"
#include "tests/temp_folder.h"

namespace screed::testing {
namespace {

class GridFiles : public ::testing::Test {
 protected:
  TempFolder temporary_;
  std::filesystem::path folder_ = temporary_.path();
};

std::vector<SweepPoint> small_sweep() {
  GridConfig config;
  config.noise.width = config.noise.height = 8;
  config.agents = 4;
  config.algorithm = GridAlgorithm::kForager;
  GridConfig other = config;
  other.algorithm = GridAlgorithm::kProbabilistic;
  return {{"ours", 0.0, config}, {"theirs", 1.0, other}};
}

SweepOptions options_of(const std::filesystem::path& results, int threads, int runs = 12) {
  SweepOptions options;
  options.results = results;
  options.threads = threads;
  options.runs = runs;
  return options;
}

using GridSweep = GridFiles;

TEST_F(GridSweep, IsBitIdenticalForAnyNumberOfThreads) {
  const SweepResult one = run_sweep(small_sweep(), options_of(folder_ / "one", 1));
  const SweepResult five = run_sweep(small_sweep(), options_of(folder_ / "five", 5));
  EXPECT_TRUE(one.complete);
  EXPECT_EQ(one.results, five.results);
  EXPECT_EQ(read_text(folder_ / "one"), read_text(folder_ / "five"));
  // Each run is the one that its seed gives alone.
  GridConfig config = small_sweep()[1].config;
  config.seed += 7;
  EXPECT_EQ(one.results[1][7], run_grid(config));
}

TEST_F(GridSweep, GoesOnWhereItStopped) {
  run_sweep(small_sweep(), options_of(folder_ / "whole", 2));
  std::atomic<bool> stop = false;
  SweepOptions options = options_of(folder_ / "broken", 2);
  options.stop = &stop;
  options.progress = [&stop](size_t done, size_t) { stop = done >= 5; };
  const SweepResult broken = run_sweep(small_sweep(), options);
  EXPECT_FALSE(broken.complete);
  const size_t kept = broken.results[0].size() + broken.results[1].size();
  EXPECT_GE(kept, 5U);
  EXPECT_LT(kept, 24U);
  // The power failed in the middle of a line.
  write_text(folder_ / "broken", read_text(folder_ / "broken") + "1,11,12,1,3");
  options.stop = nullptr;
  size_t began_with = 0;
  options.progress = [&began_with](size_t done, size_t) {
    if (began_with == 0) began_with = done;
  };
  const SweepResult resumed = run_sweep(small_sweep(), options);
  EXPECT_TRUE(resumed.complete);
  EXPECT_EQ(resumed.resumed, kept);
  EXPECT_EQ(began_with, kept + 1);
  EXPECT_EQ(read_text(folder_ / "broken"), read_text(folder_ / "whole"));
}

TEST_F(GridSweep, MoreRunsAreAddedToThoseThatAreThere) {
  run_sweep(small_sweep(), options_of(folder_ / "grown", 2, 4));
  const SweepResult grown = run_sweep(small_sweep(), options_of(folder_ / "grown", 2, 6));
  EXPECT_EQ(grown.resumed, 8U);
  EXPECT_EQ(grown.results[0].size(), 6U);
  // Fewer are read from it without loss.
  const SweepResult fewer = run_sweep(small_sweep(), options_of(folder_ / "grown", 2, 2));
  EXPECT_EQ(fewer.results[1].size(), 2U);
  EXPECT_EQ(run_sweep(small_sweep(), options_of(folder_ / "grown", 2, 6)).resumed, 12U);
}

TEST_F(GridSweep, RefusesFilesOfOthers) {
  run_sweep(small_sweep(), options_of(folder_ / "runs", 1, 1));
  auto other = small_sweep();
  other[1].config.p_pick_up = 0.31;
  EXPECT_THROW(run_sweep(other, options_of(folder_ / "runs", 1, 1)), InputError);
  write_text(folder_ / "letter", "Dear Madam,\nthank you\nfor nothing\n");
  EXPECT_THROW(run_sweep(small_sweep(), options_of(folder_ / "letter", 1)), InputError);
  EXPECT_EQ(read_text(folder_ / "letter"), "Dear Madam,\nthank you\nfor nothing\n");
  write_text(folder_ / "runs", read_text(folder_ / "runs") + "0,1,2,3\n");
  EXPECT_THROW(run_sweep(small_sweep(), options_of(folder_ / "runs", 1, 3)), InputError);
  EXPECT_THROW(run_sweep(small_sweep(), options_of(folder_ / "none" / "runs", 1)), RunError);
  EXPECT_THROW(run_sweep(small_sweep(), options_of({}, 1, 0)), InputError);
}

TEST(GridSummary, IsTextbookStatistics) {
  const Summary summary = summarise({2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0});
  EXPECT_DOUBLE_EQ(summary.mean, 5.0);
  // Sample deviation sqrt(32 / 7), over sqrt(8).
  EXPECT_NEAR(summary.standard_error, std::sqrt(32.0 / 7.0 / 8.0), 1e-12);
  EXPECT_EQ(summary.minimum, 2.0);
  EXPECT_EQ(summary.maximum, 9.0);
  EXPECT_EQ(summarise({3.0}).standard_error, 0.0);
}

TEST(GridFigure, EveryNameHasItsPoints) {
  for (const std::string& name : grid_figure_names()) {
    const GridFigure figure = grid_figure(name, GridConfig());
    EXPECT_FALSE(figure.points.empty());
    EXPECT_EQ(figure.points.size() % figure.series.size(), 0U);
    for (const SweepPoint& point : figure.points) EXPECT_NO_THROW(check(point.config));
  }
  EXPECT_THROW(grid_figure("4.1", GridConfig()), InputError);
}

using GridRecording = GridFiles;

TEST_F(GridRecording, ReplaysEveryCycle) {
  GridConfig config;
  config.algorithm = GridAlgorithm::kForager;
  GridRun run(config);
  std::vector<GridFrame> frames = {frame_of(run)};
  GridRecorder recorder(folder_ / "run.h5", run, "test");
  for (int i = 0; i < 2500; ++i) {  // more than two chunks
    run.cycle();
    recorder.add_cycle(run);
    if (i % 250 == 0) frames.push_back(frame_of(run));
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run.h5"));  // not before it is complete
  recorder.finish(run);

  GridReplay replay(folder_ / "run.h5");
  EXPECT_EQ(replay.cycles(), 2500U);
  EXPECT_EQ(replay.value("algorithm"), "forager");
  size_t next = 0;
  while (true) {
    if (next < frames.size() && replay.frame().cycle == frames[next].cycle) {
      const GridFrame& frame = frames[next++];
      ASSERT_EQ(replay.frame().terrain.heights, frame.terrain.heights);
      ASSERT_EQ(replay.frame().units, frame.units);
      for (size_t i = 0; i < frame.agents.size(); ++i) {
        ASSERT_EQ(replay.frame().agents[i].x, frame.agents[i].x);
        ASSERT_EQ(replay.frame().agents[i].y, frame.agents[i].y);
        ASSERT_EQ(replay.frame().agents[i].carries, frame.agents[i].carries);
      }
    }
    if (replay.finished()) break;
    replay.cycle();
  }
  EXPECT_EQ(next, frames.size());
  EXPECT_TRUE(replay.matches());
}

TEST_F(GridRecording, OverwritesNothingAndLeavesNothingHalf) {
  const GridRun run((GridConfig()));
  write_text(folder_ / "taken.h5", "mine");
  EXPECT_THROW(GridRecorder(folder_ / "taken.h5", run, "test"), InputError);
  EXPECT_EQ(read_text(folder_ / "taken.h5"), "mine");
  { const GridRecorder abandoned(folder_ / "run.h5", run, "test"); }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run.h5"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run.h5.partial"));
  EXPECT_THROW(GridRecorder(folder_ / "none" / "run.h5", run, "test"), RunError);
}

TEST_F(GridRecording, RefusesWhatIsNoRecording) {
  EXPECT_THROW(GridReplay(folder_ / "missing.h5"), InputError);
  write_text(folder_ / "text.h5", "no HDF5 at all");
  EXPECT_THROW(GridReplay(folder_ / "text.h5"), InputError);
  const hid_t other =
      H5Fcreate((folder_ / "other.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  H5Fclose(other);
  EXPECT_THROW(GridReplay(folder_ / "other.h5"), InputError);

  // A damaged byte in the middle of the tables.
  GridConfig config;
  config.algorithm = GridAlgorithm::kForager;
  GridRun run(config);
  GridRecorder recorder(folder_ / "run.h5", run, "test");
  for (int i = 0; i < 1500; ++i) {
    run.cycle();
    recorder.add_cycle(run);
  }
  recorder.finish(run);
  std::string bytes = read_text(folder_ / "run.h5");
  write_text(folder_ / "short.h5", bytes.substr(0, bytes.size() / 2));
  EXPECT_THROW(GridReplay(folder_ / "short.h5"), InputError);
}

TEST(LineChart, DrawsEveryPointWithItsErrorBar) {
  Chart chart;
  chart.title = "a < b & c";
  chart.x_label = "x";
  chart.y_label = "y";
  chart.series = {{"one", {{0.0, 10.0, 1.0}, {1.0, 20.0, 2.0}, {2.0, 15.0}}, true}};
  const std::string svg = chart_svg(chart);
  const auto count = [&svg](const std::string& what) {
    int found = 0;
    for (size_t at = svg.find(what); at != std::string::npos; at = svg.find(what, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count("<circle"), 3);
  EXPECT_EQ(count("<polyline"), 1);
  EXPECT_EQ(count("stroke-width=\"1.4\""), 6);  // two error bars of three strokes
  EXPECT_NE(svg.find("a &lt; b &amp; c"), std::string::npos);
  // The upright stroke of the first error bar, y = 9 to 11, against the way through 10 and 20.
  double x[3];
  double y[3];
  ASSERT_EQ(std::sscanf(svg.c_str() + svg.find("points=\""), "points=\"%lf,%lf %lf,%lf %lf,%lf",
                        &x[0], &y[0], &x[1], &y[1], &x[2], &y[2]),
            6);
  const size_t end = svg.find("stroke-width=\"1.4\"");
  double x1 = 0.0;
  double y1 = 0.0;
  double x2 = 0.0;
  double y2 = 0.0;
  ASSERT_EQ(std::sscanf(svg.c_str() + svg.rfind("<line", end),
                        "<line x1=\"%lf\" y1=\"%lf\" x2=\"%lf\" y2=\"%lf\"", &x1, &y1, &x2, &y2),
            4);
  const double unit_px = (y[0] - y[1]) / 10.0;
  EXPECT_EQ(x1, x[0]);
  EXPECT_EQ(x2, x[0]);
  EXPECT_NEAR(y1, y[0] - unit_px, 0.02);
  EXPECT_NEAR(y2, y[0] + unit_px, 0.02);
  EXPECT_EQ(chart_svg(chart), svg);
}

TEST(LineChart, PutsPointsWhereTheAxesSay) {
  Chart chart;
  chart.series = {{"", {{0.0, 0.0}, {10.0, 100.0}}, true}};
  const std::string svg = chart_svg(chart);
  // The ends of the way lie on the lowest and the highest grid line.
  double first_x = 0.0;
  double first_y = 0.0;
  double last_x = 0.0;
  double last_y = 0.0;
  const size_t at = svg.find("points=\"");
  ASSERT_NE(at, std::string::npos);
  ASSERT_EQ(std::sscanf(svg.c_str() + at, "points=\"%lf,%lf %lf,%lf", &first_x, &first_y, &last_x,
                        &last_y),
            4);
  EXPECT_LT(first_x, last_x);
  EXPECT_GT(first_y, last_y);  // y grows upwards
  char line[60];
  std::snprintf(line, sizeof line, "y1=\"%g\"", first_y);
  EXPECT_NE(svg.find(line), std::string::npos);
  std::snprintf(line, sizeof line, "y1=\"%g\"", last_y);
  EXPECT_NE(svg.find(line), std::string::npos);
}

TEST(LineChart, BarsStandOnZero) {
  Chart chart;
  chart.kind = ChartKind::kBars;
  chart.categories = {"a", "b"};
  chart.value_labels = true;
  chart.series = {{"one", {{0.0, 1234.0}, {1.0, 4321.0}}, true}};
  const std::string svg = chart_svg(chart);
  EXPECT_NE(svg.find(">1\u2009234</text>"), std::string::npos);
  EXPECT_NE(svg.find(">0</text>"), std::string::npos);
  EXPECT_NE(svg.find(">b</text>"), std::string::npos);
}

TEST(LineChart, RefusesWhatItCannotDraw) {
  Chart chart;
  EXPECT_THROW(chart_svg(chart), InputError);
  chart.series = {{"one", {{0.0, std::nan("")}}, true}};
  EXPECT_THROW(chart_svg(chart), InputError);
  chart.series = {{"one", {{0.0, 5.0}}, true}};
  EXPECT_NO_THROW(chart_svg(chart));  // a single point is a chart
  chart.width_px = 10;
  EXPECT_THROW(chart_svg(chart), InputError);
  chart.width_px = 760;
  EXPECT_THROW(write_chart("/nowhere/at/all.svg", chart), RunError);
}

}  // namespace
}  // namespace screed::testing
